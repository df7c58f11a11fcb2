"""Runs a construction plan: closed steps by ruler and compass, numeric clusters by search.

A step whose equations already hold is skipped, which makes a second solve after one change cheap.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from clearance.sketch.effort import OutOfTime
from clearance.sketch.graph.graph import POINT
from clearance.sketch.graph.steps import ConstructionPlan, PlanStep
from clearance.sketch.solve.columns import Columns
from clearance.sketch.solve.freed import find_freed, freedoms
from clearance.sketch.solve.newton import StoppingRule
from clearance.sketch.solve.place import place
from clearance.sketch.solve.search import BANDED, solve_cluster
from clearance.sketch.solve.system import System

DONE, FAILED, TOO_LARGE, SKIPPED = 0, 1, 2, 3
"""Fates of a step: placed; no such place found; a cluster not tried; its equations held already."""

LARGEST_BLOCK = 6000
"""Equations of a numeric cluster up to which it is tried; large ones are solved on a band."""

FREED = 4
"""How many times more unknowns a cluster may have with its bodies' points free than with bodies."""


class Run(NamedTuple):
    """How the steps of a plan are run.

    Attributes:
        sketch: (n,) the numbers whose branches the closed steps follow.
        rule: when a step is skipped, and when a numeric one has found its place.
        turned: the steps that take the branch opposite to the sketch.
        active: (v,) 0 for the vertices of parts that need no work; all need some by default.
    """

    sketch: np.ndarray
    rule: StoppingRule
    turned: frozenset[int] = frozenset()
    active: Sequence[int] | None = None


def execute(s: System, plan: ConstructionPlan, x: np.ndarray, run: Run) -> np.ndarray:
    """Runs the steps of a plan in place on x (n,); the fate of each.

    Raises:
        OutOfTime: x is as far as the steps came.
    """
    numbers, sketch, fates = x.tolist(), run.sketch.tolist(), np.full(len(plan.steps), SKIPPED)
    for k, step in enumerate(plan.steps):
        if run.active is not None and not run.active[step.vertex]:
            continue
        turned = k in run.turned
        if not turned and s.plain.holds(step.rows, numbers, run.rule.settled):
            continue
        if not _is_numeric(s, step):
            done = place(s.plain, step, numbers, sketch, -1.0 if turned else 1.0)
            fates[k] = DONE if done else FAILED
            continue
        x[:] = numbers
        run.rule.limit.require_time()
        fates[k] = _solve_numeric(s, plan, step, x, run)
        numbers = x.tolist()
    x[:] = numbers
    return fates


def _is_numeric(s: System, step: PlanStep) -> bool:
    """Whether a step is a cluster, or a circle from three conditions."""
    return step.numeric or (step.partner >= 0 and s.plain.kind[step.vertex] == POINT)


def _solve_numeric(
    s: System,
    plan: ConstructionPlan,
    step: PlanStep,
    x: np.ndarray,
    run: Run,
) -> int:
    """The fate of one numeric step, in place on x."""
    if len(step.rows) > LARGEST_BLOCK:
        return TOO_LARGE
    vertices, rows = np.array(step.vertices), np.array(step.rows, np.int64)
    body_of = plan.body_of if step.numeric else np.full(s.kind.size, -1)
    columns = Columns(s, vertices, rows, body_of)
    found = None
    try:
        if BANDED <= columns.n and freedoms(s, vertices) <= FREED * columns.n:
            found = find_freed(s, plan, step, x, run.sketch, run.rule)
        if found is None:
            found = solve_cluster(columns, x, run.rule)
    except OutOfTime as stop:
        if stop.x is not None:
            x[:] = stop.x
        raise
    if found is None:
        return FAILED
    x[:] = found
    return DONE
