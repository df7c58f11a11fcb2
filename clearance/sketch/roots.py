"""All real roots of the small numeric clusters: many starts, one list, nearest to the sketch first.

The starts are spread over the turns and places of a cluster; roots are distinguished by their
distance. It is a search, not a proof: a root with a basin smaller than the spacing of the starts
may be missed.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from clearance.sketch.effort import OutOfTime
from clearance.sketch.graph.graph import POINT, SIZE, TURN, PlanStep
from clearance.sketch.problem import RESIDUAL, Problem, entities_of
from clearance.sketch.solve.columns import Columns
from clearance.sketch.solve.execute import DONE, FAILED, TOO_LARGE, Run, execute
from clearance.sketch.solve.newton import descended
from clearance.sketch.solve.search import RESTARTS
from clearance.sketch.start import Sides, sides_hold

SMALL = 10
"""Entities up to which a cluster's other roots are searched."""

STARTS = 400
"""Starts of the search for all roots: the bar in the box shows its last root within the first 60."""

QUICK_STARTS = 60
"""Starts of the search for a nearer root while solving."""

FAR = 0.1
"""[-] Movement of a cluster relative to its extent above which a nearer root is searched for while solving:
only a root within that movement can be nearer, and Newton rarely passes one on a shorter path."""

MOST = 64
"""The most roots: ten entities of two freedoms rarely have more real ones."""


AT_ONCE = 100
"""Starts that go down side by side."""


def is_small(problem: Problem, step: PlanStep) -> bool:
    """Whether a step is a cluster of at most `SMALL` nodes (a body counts as one) and of as many equations as
    freedoms."""
    if not step.numeric:
        return False
    vertices = np.array(step.vertices)
    body, kind = problem.plan.body_of[vertices], problem.system.kind[vertices]
    bodies = np.unique(body[body >= 0]).size
    nodes = bodies + int(np.sum(body < 0))
    freedom = 3 * bodies + int(np.sum(np.where(kind == POINT, 2, 1)[body < 0]))
    return nodes <= SMALL and freedom == len(step.rows)


def roots_of(problem: Problem, step: PlanStep, x: np.ndarray, starts: int = STARTS) -> np.ndarray:
    """All numbers (k, n) found with the cluster's equations true, all else as in x; x's own first."""
    s, vertices = problem.system, np.array(step.vertices)
    columns = Columns(s, vertices, np.array(step.rows), problem.plan.body_of)
    reach = max(_extent(problem, vertices, x), 0.1 * problem.size)
    random, rule = np.random.default_rng(12345), problem.rule(1)
    scale = np.full(columns.n, reach)
    scale[columns.first[columns.single[s.kind[columns.single] == TURN]]] = np.pi
    scale[columns.turns] = np.pi
    sizes = s.member[
        (s.kind[s.vertex_of[s.member]] == SIZE) & np.isin(s.vertex_of[s.member], vertices)
    ]
    found = [x]
    for k in range(0, starts, AT_ONCE):
        steps = scale * random.uniform(-1.0, 1.0, (min(AT_ONCE, starts - k), columns.n))
        scattered = columns.moved(np.repeat(x[None], len(steps), axis=0), steps)
        ends, good = descended(columns, scattered, rule, 40)
        for y in ends[good & (ends[:, sizes] > 0.0).all(axis=1)]:
            if len(found) < MOST and all(_distance(problem, vertices, y, z) > 1e-6 for z in found):
                found.append(y)
    return np.array(found)


def _distance(problem: Problem, vertices: np.ndarray, x: np.ndarray, y: np.ndarray) -> float:
    """The largest difference of two places of a cluster relative to the size; directions as arcs at it."""
    s = problem.system
    i, turning = s.root[vertices], s.kind[vertices] == TURN
    gap = np.where(turning, np.sin(0.5 * (x[i] - y[i])), (x[i] - y[i]) / problem.size)
    ys = i[s.kind[vertices] == POINT] + 1
    across = (x[ys] - y[ys]) / problem.size
    return max(float(np.abs(gap).max(initial=0.0)), float(np.abs(across).max(initial=0.0)))


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
    for k in np.flatnonzero(fates == DONE).tolist():
        step = problem.plan.steps[k]
        if not is_small(problem, step):
            continue
        mine = _places(problem, np.array(step.vertices))
        moved = float(np.abs(x[mine] - sketch[mine]).max(initial=0.0))
        if moved <= FAR * _extent(problem, np.array(step.vertices), sketch):
            continue
        problem.limit.require_time()
        found = roots_of(problem, step, x, QUICK_STARTS)
        away = np.linalg.norm(found[:, mine] - sketch[mine], axis=1)
        if away.min() < 0.999 * away[0]:
            nearer, good = _run_after(problem, k, found[int(np.argmin(away))], sketch)
            x = nearer if good else x
    return x


def _run_after(
    problem: Problem, step: int, x: np.ndarray, sketch: np.ndarray
) -> tuple[np.ndarray, bool]:
    """The numbers after the steps that follow one are run again from x, on the branches of `sketch`; and whether
    every step found its place."""
    out, plan = x.copy(), problem.plan.after(step)
    fates = execute(problem.system, plan, out, Run(sketch, problem.rule(RESTARTS)))
    return out, not np.isin(fates, (FAILED, TOO_LARGE)).any()


def other_solutions(problem: Problem, x: np.ndarray) -> list[tuple[np.ndarray, float]]:
    """The other solutions (n,), one small cluster changed at a time, and their residuals; nearest first."""
    found = []
    for k, step in enumerate(problem.plan.steps):
        if not is_small(problem, step):
            continue
        for root in roots_of(problem, step, x)[1:]:
            complete, _ = _run_after(problem, k, root, x)
            complete = complete[problem.alias]
            residual, _ = problem.residual(complete)
            if residual <= RESIDUAL * problem.size:
                found.append((complete, residual))
    return sorted(found, key=lambda pair: float(np.linalg.norm(pair[0] - x)))


def alternatives_of(
    sketch, problem: Problem, x: np.ndarray, sides: Sides
) -> list[dict[str, np.ndarray]]:
    """The other solutions as numbers of every entity by name, those whose `same_side` holds.

    The search may take as long as the solve; none where there is no time for all.
    """
    try:
        with problem.limit.again() as limit:
            found = other_solutions(replace(problem, limit=limit), x)
    except OutOfTime:
        return []
    return [by_name(sketch, problem, y) for y, _ in found if sides_hold(y, sides, problem.size)]


def by_name(sketch, problem: Problem, x: np.ndarray) -> dict[str, np.ndarray]:
    """The numbers of every entity by name: coordinates, direction and offset, or radius."""
    out = {}
    for name, e in entities_of(sketch, problem).items():
        count = 1 if e.what in ("circle", "arc") else 2
        i = problem.alias[e.variable]
        numbers = x[i : i + count].copy()
        if e.what == "point":
            numbers += sketch.origin
        elif count == 2:
            numbers[1] += np.cos(x[i]) * sketch.origin[1] - np.sin(x[i]) * sketch.origin[0]
        out[name] = numbers
    return out
