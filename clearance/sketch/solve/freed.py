"""Clusters of many bodies, solved with all their points free.

Rigid bodies bar the ways on which a descent gets past a wrong fold. Where all hangs on the initial cluster it is
freed, too; the cluster is set down by it afterwards. Not for: the search (`search`).
"""

from __future__ import annotations

import numpy as np

from clearance.sketch.graph.graph import POINT
from clearance.sketch.graph.steps import ConstructionPlan, PlanStep
from clearance.sketch.solve.columns import Columns
from clearance.sketch.solve.fit import set_down
from clearance.sketch.solve.newton import StoppingRule
from clearance.sketch.solve.search import solve_cluster
from clearance.sketch.solve.system import System


def freedoms(s: System, vertices: np.ndarray) -> int:
    """How many unknowns vertices have, each by itself."""
    return int(np.where(s.kind[vertices] == POINT, 2, 1).sum())


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
