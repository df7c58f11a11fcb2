"""Runs a construction plan: closed steps by ruler and compass, numeric clusters by search.

A step whose equations already hold is skipped, which makes a second solve after one change cheap. Rigid bodies
bar the ways on which a descent gets past a wrong fold, so clusters of many bodies are first tried with all their
points free. Where all hangs on the initial cluster it is freed, too; it sets the cluster down afterwards.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from clearance.sketch.effort import OutOfTime
from clearance.sketch.graph.graph import POINT, SLIDE, TURN, ConstructionPlan, PlanStep
from clearance.sketch.solve.columns import Columns
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
        if (
            BANDED <= columns.n
            and np.where(s.kind[vertices] == POINT, 2, 1).sum() <= FREED * columns.n
        ):
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


def find_freed(
    s: System,
    plan: ConstructionPlan,
    step: PlanStep,
    x: np.ndarray,
    sketch: np.ndarray,
    rule: StoppingRule,
) -> np.ndarray | None:
    """Numbers (n,) at which a cluster's equations hold, from the sketch with all its points free; None for none.

    A base that came out mirrored will do only where no other cluster hangs on it already.
    """
    base = _base_of(s, plan, step)
    own = plan.body_of == base if base >= 0 else np.zeros(s.kind.size, bool)
    inside = own.copy()
    inside[list(step.vertices)] = True
    columns = Columns(s, np.flatnonzero(inside), _inner_rows(s, plan, step, inside))
    start = x.copy()
    points = s.root[inside & (s.kind == POINT)]
    start[points], start[points + 1] = sketch[points], sketch[points + 1]
    merged = s.member[(inside & (s.kind != POINT))[s.vertex_of[s.member]]]
    number = sketch[s.root[s.vertex_of[merged]]]
    start[merged] = s.scale[merged] * number + s.shift[merged]
    found = solve_cluster(columns, start, rule)
    if found is None or base < 0:
        return found
    part, base_points = np.where(inside, 0, -1), own & (s.kind == POINT)
    found = set_down(s, part, np.array([3]), found, x, base_points.astype(float))
    i = s.root[base_points][:, None] + np.arange(2)
    off = np.abs(found[i] - x[i]).max(initial=0.0)
    alone = next(other for other in plan.steps if other.numeric) is step
    return found if alone or off <= rule.tolerance else None


def _base_of(s: System, plan: ConstructionPlan, step: PlanStep) -> int:
    """The initial cluster, if the step's equations hang on nothing else besides its vertices; else -1."""
    around = np.unique(s.ends[list(step.rows)])
    around = np.setdiff1d(around[around > 0], step.vertices)
    bodies = np.unique(plan.body_of[around])
    return int(bodies[0]) if bodies.size == 1 and bodies[0] >= 0 and plan.fixed[bodies[0]] else -1


def _inner_rows(
    s: System, plan: ConstructionPlan, step: PlanStep, inside: np.ndarray
) -> np.ndarray:
    """The step's equations, and those within the bodies that are freed."""
    body = plan.body_of[s.ends[:, 0]]
    within = (s.ends[:, 0] > 0) & inside[s.ends[:, 0]] & (body >= 0)
    within &= ((s.ends < 0) | (plan.body_of[s.ends] == body[:, None])).all(axis=1)
    within[plan.dependent] = False
    within[list(step.rows)] = False
    return np.concatenate([np.array(step.rows, np.int64), np.flatnonzero(within)])


def set_down(s: System, part, freedom, x: np.ndarray, sketch: np.ndarray, weight) -> np.ndarray:
    """The numbers (n,) with every part of `freedom` 3 (turn and shift) or 2 (shift) moved rigidly to lie nearest
    the sketch.

    `part` (v,) with -1 outside, `freedom` (parts,) other than 2 and 3 leaves a part alone, `weight`
    (v,) of the points. Offsets of lines follow; a part without points stays.
    """
    mine = np.flatnonzero((part >= 0) & (freedom[part] >= 2))
    points = mine[s.kind[mine] == POINT]
    p, i, w = part[points], s.root[points], weight[points]
    total = np.bincount(p, w, freedom.size)
    mine = mine[total[part[mine]] > 0.0]
    total = np.where(total > 0.0, total, 1.0)
    middle, goal = (
        np.column_stack([np.bincount(p, w * y[i + k], freedom.size) / total for k in (0, 1)])
        for y in (x, sketch)
    )
    a, b = (y[i[:, None] + (0, 1)] - at[p] for y, at in ((x, middle), (sketch, goal)))
    dot = np.bincount(p, w * np.sum(a * b, axis=1), freedom.size)
    cross = np.bincount(p, w * (a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]), freedom.size)
    angle = np.where(freedom == 3, np.arctan2(cross, dot), 0.0)
    out, number = x.copy(), x[s.root]
    c, si = np.cos(angle)[p], np.sin(angle)[p]
    out[i] = goal[p, 0] + c * a[:, 0] - si * a[:, 1]
    out[i + 1] = goal[p, 1] + si * a[:, 0] + c * a[:, 1]
    turns, slides = mine[s.kind[mine] == TURN], mine[s.kind[mine] == SLIDE]
    number[turns] += angle[part[turns]]
    p, theta = part[slides], x[s.root[slides] - 1]
    number[slides] += np.sin(theta) * middle[p, 0] - np.cos(theta) * middle[p, 1]
    theta = theta + angle[p]
    number[slides] += np.cos(theta) * goal[p, 1] - np.sin(theta) * goal[p, 0]
    follows = np.zeros(s.kind.size, bool)
    follows[turns] = follows[slides] = True
    m = s.member[follows[s.vertex_of[s.member]]]
    out[m] = s.scale[m] * number[s.vertex_of[m]] + s.shift[m]
    return out
