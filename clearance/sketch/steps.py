"""The limits of a run at a problem's size, its error, and the part of a plan after one cluster."""

from __future__ import annotations

import numpy as np

from clearance.sketch.problem import RESIDUAL, SETTLED, Problem
from clearance.sketch.solve.execute import FAILED, TOO_LARGE, Run, StepTolerances, execute
from clearance.sketch.solve.newton import StoppingRule
from clearance.sketch.solve.search import RESTARTS

LARGEST_BLOCK = 6000
"""Equations of a numeric cluster up to which it is tried; large ones are solved on a band."""

FLOOR = 2e-16
"""[-] What a numeric cluster aims at, relative to the size: about one rounding of a coordinate."""


def stopping_rule(problem: Problem, attempts: int) -> StoppingRule:
    """When the search for a cluster's place ends, at the problem's size."""
    size = problem.size
    return StoppingRule(FLOOR * size, RESIDUAL * size, attempts, problem.limit)


def limits_of(problem: Problem, attempts: int = RESTARTS) -> StepTolerances:
    """The limits of a run at the problem's size."""
    size = problem.size
    return StepTolerances(SETTLED * size, LARGEST_BLOCK, stopping_rule(problem, attempts))


def errors_of(problem: Problem, x: np.ndarray) -> np.ndarray:
    """(m,) [m] how far every equation is off at x (n,); infinite where that is no number."""
    error = np.abs(problem.system.all_rows.errors(x)) * problem.length_scale
    return np.where(error <= 1.7e308, error, np.inf)


def residual_of(problem: Problem, x: np.ndarray) -> tuple[float, int]:
    """The largest residual [m] of all equations, and its row; (0, -1) where all are 0."""
    error = errors_of(problem, x)
    largest = float(error.max(initial=0.0))
    return largest, int(np.argmax(error)) if largest > 0.0 else -1


def run_after(
    problem: Problem, step: int, x: np.ndarray, sketch: np.ndarray
) -> tuple[np.ndarray, bool]:
    """The numbers after the steps that follow one are run again from x, on the branches of `sketch`; and whether
    every step found its place."""
    out, every = x.copy(), bytes([1]) * problem.system.kind.size
    plan = problem.plan.after(step)
    fates = execute(problem.system, plan, out, Run(sketch, every), limits_of(problem))
    return out, not ((fates == FAILED) | (fates == TOO_LARGE)).any()
