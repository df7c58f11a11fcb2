"""The start of a solve: coincident points joined, merged numbers made to agree, `same_side` by mirroring.

The rest of the drawing stays as it is. Not for: running the plan (`execution`).
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from clearance.sketch.graph.graph import DIRECTION, OFFSET, RADIUS
from clearance.sketch.problem import RESIDUAL, SETTLED, Problem

Sides = Sequence[tuple[int, int, int]]
"""Every `same_side` as the variables of two points and a line."""


def started(problem: Problem, before: np.ndarray, sides: Sides) -> tuple[np.ndarray, np.ndarray]:
    """(numbers to start from, numbers to stay near to), both (n,), from the drawn numbers."""
    x = before.copy()
    if problem.tables.together:
        _join(problem, x)
    _mirror(problem, x, sides)
    sketch = x.copy()
    for role in (DIRECTION, OFFSET, RADIUS):
        _agree(problem, role, x)
    return x, sketch


def _agree(problem: Problem, role: int, x: np.ndarray) -> None:
    """Makes merged directions, offsets or radii agree, in place on x, unless they do already; lines turn about
    their points' middle."""
    s, n, drawn = problem.system, x.size, x.copy()
    mine = np.flatnonzero(problem.tables.role == role)
    counted = mine[(s.vertex_of[mine] > 0) & (s.scale[mine] != 0.0)]
    root = s.parent[counted]
    count = np.bincount(root, minlength=n + 1)
    total = np.bincount(root, (x[counted] - s.shift[counted]) / s.scale[counted], n + 1)
    mine = mine[(s.parent[mine] != mine) | (count[mine] > 1)]
    root = s.parent[mine]
    merged = s.scale[mine] * total[root] / np.maximum(count[root], 1) + s.shift[mine]
    off = np.zeros(n + 1)
    np.maximum.at(off, root, np.abs(merged - x[mine]))
    changed = off[root] > SETTLED * problem.size
    x[mine[changed]] = merged[changed]
    turned = (
        mine[changed][x[mine[changed]] != drawn[mine[changed]]] if role == DIRECTION else mine[:0]
    )
    if turned.size:
        middle = _middles(problem, drawn)[turned]
        x[turned + 1] = np.cos(x[turned]) * middle[:, 1] - np.sin(x[turned]) * middle[:, 0]


def _join(problem: Problem, x: np.ndarray) -> None:
    """Gives coincident points their mean, unless they already agree."""
    mean = np.bincount(problem.alias, weights=x, minlength=x.size) / np.maximum(problem.weight, 1.0)
    mean = mean[problem.alias]
    changed = np.abs(mean - x) > SETTLED * problem.size
    moved = np.isin(problem.alias, problem.alias[changed])
    x[moved] = mean[moved]
    x[:] = x[problem.alias]


def _middles(problem: Problem, x: np.ndarray) -> np.ndarray:
    """(n, 2) by direction: the point about which a line turns: its points' middle, or its foot."""
    out = np.zeros((x.size, 2))
    ends = problem.tables.line_ends
    if ends.size:
        theta, a, b = ends.T
        foot = np.column_stack([-np.sin(x[theta]) * x[theta + 1], np.cos(x[theta]) * x[theta + 1]])
        out[theta] = foot
        drawn = a >= 0
        a, b = problem.alias[a[drawn]], problem.alias[b[drawn]]
        out[theta[drawn], 0] = 0.5 * (x[a] + x[b])
        out[theta[drawn], 1] = 0.5 * (x[a + 1] + x[b + 1])
    return out


def _heights(x: np.ndarray, p: int, q: int, line: int) -> tuple[float, float, np.ndarray]:
    """The signed distances of two points from a line, and its normal."""
    n = np.array([-np.sin(x[line]), np.cos(x[line])])
    return n @ x[p : p + 2] - x[line + 1], n @ x[q : q + 2] - x[line + 1], n


def _mirror(problem: Problem, x: np.ndarray, sides: Sides) -> None:
    """Mirrors the second point of a `same_side` that is drawn on the wrong side."""
    for p, q, line in sides:
        p, q = problem.alias[p], problem.alias[q]
        first, second, n = _heights(x, p, q, line)
        if first * second < 0.0:
            x[q : q + 2] -= 2.0 * second * n


def sides_hold(x: np.ndarray, sides: Sides, size: float) -> bool:
    """Whether every two points lie on one side of their line (on it counts as either side)."""
    return all(
        min(a * b, 0.0) >= -RESIDUAL * size * size for a, b, _ in (_heights(x, *s) for s in sides)
    )
