"""The limits of a run at a problem's size, its error, and the part of a plan after one cluster."""

from __future__ import annotations

import numpy as np

from clearance.kernels.sketch.equations import worst
from clearance.kernels.sketch.solve.execute import (
    DONE,
    FAILED,
    TOO_LARGE,
    PlanRun,
    StepTolerances,
    place_closed,
    solve_numeric,
)
from clearance.kernels.sketch.solve.motion import StoppingRule
from clearance.kernels.sketch.solve.search import RESTARTS
from clearance.sketch.problem import RESIDUAL, SETTLED, Problem

LARGEST_BLOCK = 6000
"""Equations of a numeric cluster up to which it is tried; large ones are solved on a band."""

FLOOR = 2e-16
"""[-] What a numeric cluster aims at, relative to the size: about one rounding of a coordinate."""


def stopping_rule(problem: Problem, attempts: int) -> StoppingRule:
    """When the search for a cluster's place ends, at the problem's size."""
    return StoppingRule(FLOOR * problem.size, RESIDUAL * problem.size, attempts)


def limits_of(problem: Problem, attempts: int = RESTARTS) -> StepTolerances:
    """The limits of a run at the problem's size."""
    size = problem.size
    return StepTolerances(SETTLED * size, LARGEST_BLOCK, stopping_rule(problem, attempts))


def residual_of(problem: Problem, x: np.ndarray) -> tuple[float, int]:
    """The largest residual [m] of all equations, and its row."""
    s = problem.system
    return worst(s.code, s.var, s.coef, s.value, x, problem.length_scale)


def execute(
    problem: Problem, x, sketch, turned, active, limits: StepTolerances, plan=None
) -> np.ndarray:
    """Runs the steps of a plan in place on x (n,); the fate (s,) of each.

    Numeric steps are compiled apart: most sketches need none. For `turned` and `active` see
    `clearance.kernels.sketch.solve.execute.PlanRun`.
    """
    plan = problem.plan if plan is None else plan
    steps, fate = plan.steps, np.full(plan.steps.vertex.shape[0], DONE)
    run = PlanRun(turned, active, fate)
    s, k = problem.system, 0
    while True:
        k = place_closed(s, steps, x, sketch, run, limits.settled, k)
        if k == fate.size:
            return fate
        problem.limit.require_left()
        fate[k] = solve_numeric(s, plan, x, sketch, k, limits)
        k += 1


def run_after(
    problem: Problem, block: int, x: np.ndarray, sketch: np.ndarray
) -> tuple[np.ndarray, bool]:
    """The numbers after the steps that follow a numeric cluster are run again from x, on the branches
    of `sketch`; and whether every step found its place."""
    steps = problem.plan.steps
    later = int(np.flatnonzero(steps.block == block)[0]) + 1
    steps = steps._replace(
        vertex=steps.vertex[later:], partner=steps.partner[later:], edges=steps.edges[later:],
        block=steps.block[later:], origin=steps.origin[later:],
    )  # fmt: skip
    out = x.copy()
    every = np.ones(problem.system.kind.size, np.uint8)
    turned = np.ones(steps.vertex.size)
    plan = problem.plan._replace(steps=steps)
    fates = execute(problem, out, sketch, turned, every, limits_of(problem), plan)
    return out, not ((fates == FAILED) | (fates == TOO_LARGE)).any()
