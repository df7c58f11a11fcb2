"""All real roots of the small numeric clusters: many starts, one list, nearest to the sketch first.

The starts are spread over the turns and places a cluster can take; roots are told apart by their
distance. It is a search, not a proof: a root with a basin smaller than the spacing of the starts
may be missed.
"""

from __future__ import annotations

import numpy as np

from clearance.kernels.sketch_graph import POINT, SLIDE, TURN
from clearance.kernels.sketch_place import System
from clearance.kernels.sketch_search import solve_block
from clearance.sketch.execution import residual_of, run_after
from clearance.sketch.problem import RESIDUAL, Problem
from clearance.sketch.start import sides_hold

SMALL = 10
"""Entities up to which a cluster's other roots are searched."""

STARTS = 400
"""Starts of the search: the bar in the box shows its last root within the first 60."""

DISTINCT = 1e-6
"""[-] Distance relative to the size from which two roots are different."""


def block_of(problem: Problem, b: int) -> tuple[np.ndarray, np.ndarray]:
    """(vertices, rows) of a numeric cluster."""
    p = problem.plan
    vertices = p.block_vertex[p.block_vertex_start[b] : p.block_vertex_start[b + 1]]
    return vertices, p.block_row[p.block_row_start[b] : p.block_row_start[b + 1]]


def is_small(problem: Problem, b: int) -> bool:
    """Whether a cluster has at most `SMALL` nodes (a body counts as one) and as many equations as
    freedoms."""
    vertices, rows = block_of(problem, b)
    body, kind = problem.plan.body_of[vertices], problem.system.kind[vertices]
    nodes = len(set(body[body >= 0])) + int(np.sum(body < 0))
    freedom = 3 * len(set(body[body >= 0])) + int(np.sum(np.where(kind == POINT, 2, 1)[body < 0]))
    return nodes <= SMALL and freedom == rows.size


def roots_of(problem: Problem, b: int, x: np.ndarray) -> list[np.ndarray]:
    """All numbers (n,) found with the cluster's equations true, everything else as in x; x's own
    first."""
    s, size = problem.system, problem.size
    vertices, rows = block_of(problem, b)
    random = np.random.default_rng(7)
    mine = _variables(s, vertices)
    places = x[mine[s_role(problem, mine)]]
    reach = max(float(np.ptp(places)) if places.size else 0.0, 0.1 * size)
    found = [x]
    for _ in range(STARTS):
        tried = x.copy()
        _scatter(problem, vertices, tried, random, reach)
        pivot = _pivots(problem, tried)
        body_of = problem.plan.body_of
        if not solve_block(
            s, vertices, rows, tried, body_of, pivot, 2e-16 * size, RESIDUAL * size, 1
        ):
            continue
        if _is_new(problem, tried, found, mine):
            found.append(tried)
    return found


def s_role(problem: Problem, variables: np.ndarray) -> np.ndarray:
    """Which of the variables are coordinates of points."""
    return problem.tables.role[variables] < 2


def _variables(s: System, vertices) -> np.ndarray:
    out = []
    for v in vertices:
        if s.kind[v] == POINT:
            out += [s.root[v], s.root[v] + 1]
        else:
            out += list(s.member[s.member_start[v] : s.member_start[v + 1]])
    return np.array(out, np.int64)


def _is_new(problem: Problem, tried: np.ndarray, found: list[np.ndarray], mine: np.ndarray) -> bool:
    turns = problem.tables.role[mine] == 2
    for other in found:
        gap = tried[mine] - other[mine]
        gap[turns] = problem.size * np.sin(0.5 * gap[turns])
        if np.abs(gap).max() <= DISTINCT * problem.size:
            return False
    return bool((tried[problem.tables.role == 4] > 0.0).all())


def _pivots(problem: Problem, x: np.ndarray) -> np.ndarray:
    s, body = problem.system, problem.plan.body_of
    out = np.zeros((problem.plan.held.size, 2))
    for b in range(out.shape[0]):
        roots = s.root[(body == b) & (s.kind == POINT)]
        if roots.size:
            out[b] = x[roots].mean(), x[roots + 1].mean()
    return out


def _scatter(problem: Problem, vertices, x: np.ndarray, random, reach: float) -> None:
    """Turns and shifts every body, and every free vertex, at random."""
    s, body = problem.system, problem.plan.body_of
    pivot = _pivots(problem, x)
    moves: dict[int, tuple[float, np.ndarray]] = {}
    ordered = sorted(vertices, key=lambda v: s.kind[v] != SLIDE)
    for v in ordered:
        b, i = int(body[v]), s.root[v]
        key = b if b >= 0 else -1 - int(v)
        if key not in moves:
            moves[key] = random.uniform(-np.pi, np.pi), reach * random.uniform(-0.5, 0.5, 2)
        turn, shift = moves[key]
        if b < 0:
            if s.kind[v] == POINT:
                x[i : i + 2] += shift
            else:
                change = turn if s.kind[v] == TURN else shift[0]
                _set(s, v, x[i] + change, x)
        elif s.kind[v] == POINT:
            c, si = np.cos(turn), np.sin(turn)
            x[i : i + 2] = (
                pivot[b] + shift + np.array([[c, -si], [si, c]]) @ (x[i : i + 2] - pivot[b])
            )
        elif s.kind[v] == SLIDE:
            d = x[i] - np.array([-np.sin(x[i - 1]), np.cos(x[i - 1])]) @ pivot[b]
            t = x[i - 1] + turn
            _set(s, v, d + np.array([-np.sin(t), np.cos(t)]) @ (pivot[b] + shift), x)
        elif s.kind[v] == TURN:
            _set(s, v, x[i] + turn, x)


def _set(s: System, v: int, number: float, x: np.ndarray) -> None:
    mine = s.member[s.member_start[v] : s.member_start[v + 1]]
    x[mine] = s.scale[mine] * number + s.shift[mine]


def other_solutions(problem: Problem, x: np.ndarray) -> list[tuple[np.ndarray, float]]:
    """The other solutions (n,), one small cluster changed at a time, and their residuals; nearest first."""
    found = []
    for b in range(problem.plan.block_row_start.size - 1):
        if not is_small(problem, b):
            continue
        for root in roots_of(problem, b, x)[1:]:
            complete = run_after(problem, b, root)[problem.alias]
            residual, _ = residual_of(problem, complete)
            if residual <= RESIDUAL * problem.size:
                found.append((complete, residual))
    return sorted(found, key=lambda pair: float(np.linalg.norm(pair[0] - x)))


def alternatives_of(sketch, problem: Problem, x: np.ndarray) -> list[dict[str, np.ndarray]]:
    """The other solutions as numbers of every entity by name, those whose `same_side` holds."""
    sides = sketch.sides()
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
        out[name] = x[i : i + count].copy()
    return out
