"""All real roots of the small numeric clusters: many starts, one list, nearest to the sketch first.

The starts are spread over the turns and places a cluster can take; roots are told apart by their
distance. It is a search, not a proof: a root with a basin smaller than the spacing of the starts
may be missed.
"""

from __future__ import annotations

import numpy as np

from clearance.kernels.sketch.graph.graph import POINT
from clearance.kernels.sketch.graph.plan_steps import block_of
from clearance.kernels.sketch.solve.execute import DONE
from clearance.kernels.sketch.solve.motion import NumericCluster
from clearance.kernels.sketch.solve.roots import RootSearch, cluster_roots
from clearance.sketch.problem import RESIDUAL, Problem
from clearance.sketch.start import Sides, sides_hold
from clearance.sketch.steps import residual_of, run_after, stopping_rule

SMALL = 10
"""Entities up to which a cluster's other roots are searched."""

STARTS = 400
"""Starts of the search for all roots: the bar in the box shows its last root within the first 60."""

QUICK_STARTS = 60
"""Starts of the search for a nearer root while solving."""

FAR = 0.1
"""[-] Movement of a cluster relative to its extent above which a nearer root is looked for while solving:
only a root within that movement can be nearer, and Newton rarely passes one on a shorter way."""

MOST = 64
"""Roots that are kept: ten entities of two freedoms rarely have more real ones."""


def is_small(problem: Problem, b: int) -> bool:
    """Whether a cluster has at most `SMALL` nodes (a body counts as one) and as many equations as
    freedoms."""
    vertices, rows = block_of(problem.plan.steps, b)
    body, kind = problem.plan.body_of[vertices], problem.system.kind[vertices]
    bodies = np.unique(body[body >= 0]).size
    nodes = bodies + int(np.sum(body < 0))
    freedom = 3 * bodies + int(np.sum(np.where(kind == POINT, 2, 1)[body < 0]))
    return nodes <= SMALL and freedom == rows.size


def roots_of(problem: Problem, b: int, x: np.ndarray, starts: int = STARTS) -> np.ndarray:
    """All numbers (k, n) found with the cluster's equations true, all else as in x; x's own first."""
    plan = problem.plan
    vertices, rows = block_of(problem.plan.steps, b)
    reach = max(_extent(problem, vertices, x), 0.1 * problem.size)
    cluster = NumericCluster(vertices, rows, plan.body_of)
    search = RootSearch(problem.size, reach, starts, MOST)
    rule = stopping_rule(problem, 1)
    return cluster_roots(problem.system, cluster, x, plan.held.size, rule, search)


def _places(problem: Problem, vertices: np.ndarray) -> np.ndarray:
    """The variables of the points among vertices."""
    s = problem.system
    roots = s.root[vertices[s.kind[vertices] == POINT]]
    return np.concatenate([roots, roots + 1])


def _extent(problem: Problem, vertices: np.ndarray, x: np.ndarray) -> float:
    places = x[_places(problem, vertices)]
    return float(np.ptp(places)) if places.size else 0.0


def nearest_roots(problem: Problem, x: np.ndarray, sketch: np.ndarray, fates: np.ndarray):
    """x with every small cluster that was moved far at its root nearest to the sketch."""
    for k in np.flatnonzero((fates == DONE) & (problem.plan.steps.block >= 0)):
        b = int(problem.plan.steps.block[k])
        vertices, _ = block_of(problem.plan.steps, b)
        mine = _places(problem, vertices)
        moved = float(np.abs(x[mine] - sketch[mine]).max(initial=0.0))
        if moved <= FAR * _extent(problem, vertices, sketch) or not is_small(problem, b):
            continue
        problem.limit.require_left()
        found = roots_of(problem, b, x, QUICK_STARTS)
        away = np.linalg.norm(found[:, mine] - sketch[mine], axis=1)
        if away.min() < 0.999 * away[0]:
            nearer, good = run_after(problem, b, found[int(np.argmin(away))], sketch)
            x = nearer if good else x
    return x


def other_solutions(problem: Problem, x: np.ndarray) -> list[tuple[np.ndarray, float]]:
    """The other solutions (n,), one small cluster changed at a time, and their residuals; nearest first."""
    found = []
    for b in range(problem.plan.steps.block_row_start.size - 1):
        if not is_small(problem, b):
            continue
        for root in roots_of(problem, b, x)[1:]:
            complete, _ = run_after(problem, b, root, x)
            complete = complete[problem.alias]
            residual, _ = residual_of(problem, complete)
            if residual <= RESIDUAL * problem.size:
                found.append((complete, residual))
    return sorted(found, key=lambda pair: float(np.linalg.norm(pair[0] - x)))


def alternatives_of(
    sketch, problem: Problem, x: np.ndarray, sides: Sides
) -> list[dict[str, np.ndarray]]:
    """The other solutions as numbers of every entity by name, those whose `same_side` holds."""
    return [
        _by_name(sketch, problem, y)
        for y, _ in other_solutions(problem, x)
        if sides_hold(y, sides, problem.size)
    ]


def _by_name(sketch, problem: Problem, x: np.ndarray) -> dict[str, np.ndarray]:
    out = {}
    for name, e in sketch.entities.items():
        count = 1 if e.what in ("circle", "arc") else 2
        i = problem.alias[e.variable]
        numbers = x[i : i + count].copy()
        if e.what == "point":
            numbers += sketch.origin
        elif count == 2:
            numbers[1] += np.cos(x[i]) * sketch.origin[1] - np.sin(x[i]) * sketch.origin[0]
        out[name] = numbers
    return out
