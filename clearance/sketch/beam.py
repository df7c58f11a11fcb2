"""The branch of a construction that lies nearest to the drawing, where the drawing's own branch finds no place.

A point at given distances from two others has two places. The drawing has the wrong one where its triangle is
flatter than the drawing is off, and later circles do not meet. So the steps are run for many branches at once.
After each step those survive whose points, set down where they fit best, are off least from the drawing. A wrong
choice moves all that hangs on it, hence it falls behind, or its circles miss each other. A point on which nothing
hangs gets the nearer of its two places at once. Not for: steps that place other things (`folds`).
Source: Lowerre 1976 (beam search); the fit is Schönemann's (`solve.execute`), summed up step by step.
"""

from __future__ import annotations

import heapq
from typing import NamedTuple

import numpy as np

from clearance.sketch.effort import TimeLimit
from clearance.sketch.equations import PointPoint
from clearance.sketch.graph.graph import POINT
from clearance.sketch.problem import Problem
from clearance.sketch.solve.loci import GRAZING

WIDTHS = (64, 256, 1024)
"""Branches that survive at first, and when none of them finds its places: 0.1, 0.3 and 1 s at n = 1000."""


class _Placing(NamedTuple):
    """A point to place: where it is drawn (2,), the points placed before that it has distances from, these, and
    whether another point hangs on it."""

    drawn: np.ndarray
    near: list[int]
    radius: list[float]
    bears: bool


def nearest_branch(problem: Problem, part: int, sketch: np.ndarray) -> np.ndarray | None:
    """Numbers (n,) on the branch of a part that is nearest to the sketch (n,), all else as there.

    None where the part is no construction of points from distances, or no surviving branch finds its places.

    Raises:
        OutOfTime: the problem's limit has passed.
    """
    placings = _placings(problem, part, sketch)
    if placings is None:
        return None
    for width in WIDTHS:
        beam = _Beam(len(placings), width)
        if all(beam.place(placing, problem.limit) for placing in placings.values()):
            out, first = sketch.copy(), np.array(list(placings))
            out[first], out[first + 1] = beam.places[np.argmin(beam.off())].T
            return out
    return None


def _placings(problem: Problem, part: int, sketch: np.ndarray) -> dict[int, _Placing] | None:
    """The points to place by their first variables, in order; None where a step places something else."""
    s = problem.system.plain
    found: dict[int, _Placing] = {}
    order: dict[int, int] = {}
    for step in problem.plan.steps:
        if problem.part[step.vertex] != part:
            continue
        equations = [s.equations[row] for row in step.rows]
        plain = all(isinstance(e, PointPoint) for e in equations)
        if (
            len(step.vertices) != 1
            or len(step.rows) > 2
            or s.kind[step.vertex] != POINT
            or not plain
        ):
            return None
        i, near = s.root[step.vertex], []
        for e in equations:
            other = e.qx if e.px == i else e.px
            if other not in found:  # it is fixed where it is drawn
                order[other] = len(found)
                found[other] = _Placing(sketch[other : other + 2], [], [], True)
            found[other] = found[other]._replace(bears=True)
            near.append(order[other])
        order[i] = len(found)
        found[i] = _Placing(sketch[i : i + 2], near, [s.value[row] for row in step.rows], False)
    return _reordered(found)


def _reordered(found: dict[int, _Placing]) -> dict[int, _Placing]:
    """The points in an order in which each follows those that it hangs on as soon as it can: so wrong choices show
    before many others are made (of 20 constructions of n = 1000, 18 instead of 8 branches were found)."""
    keys, placings = list(found), list(found.values())
    hanging: list[list[int]] = [[] for _ in keys]
    waits = [len(set(placing.near)) for placing in placings]
    for k, placing in enumerate(placings):
        for j in set(placing.near):
            hanging[j].append(k)
    turn: dict[int, int] = {}
    ready = [(0, k) for k, n in enumerate(waits) if n == 0]
    while ready:
        _, k = heapq.heappop(ready)
        turn[k] = len(turn)
        for other in hanging[k]:
            waits[other] -= 1
            if waits[other] == 0:
                heapq.heappush(ready, (-turn[k], other))
    return {keys[k]: placings[k]._replace(near=[turn[j] for j in placings[k].near]) for k in turn}


class _Beam:
    """Several branches: the places (branches, n, 2) of their points, and the sums of which their fit is made.

    These are the sums of places and drawn places, of their squares, and of their dot and cross products.
    """

    def __init__(self, n: int, width: int) -> None:
        self.places, self.count, self.width = np.zeros((1, n, 2)), 0, width
        self.sums = np.zeros((1, 8))

    def off(self, more: np.ndarray | float = 0.0, count: int = 0) -> np.ndarray:
        """[m^2] how far the points are off from where they are drawn, where they fit best, with more of them."""
        n = self.count + count
        ax, ay, bx, by, aa, bb, dot, cross = np.moveaxis(self.sums + more, -1, 0)
        dot, cross = dot - (ax * bx + ay * by) / n, cross - (ax * by - ay * bx) / n
        spread = aa - (ax * ax + ay * ay) / n + bb - (bx * bx + by * by) / n
        return spread - 2.0 * np.hypot(dot, cross)

    def place(self, placing: _Placing, limit: TimeLimit) -> bool:
        """Places one more point in every branch and keeps the nearest branches; False where none finds a place."""
        limit.require_time()
        found, good = _candidates(self.places, placing)
        (x, y), (bx, by) = np.moveaxis(found, -1, 0), placing.drawn
        drawn = np.broadcast_to([bx, by, bx * bx + by * by], (*x.shape, 3))
        more = np.stack(
            [x, y, drawn[..., 0], drawn[..., 1], x * x + y * y, drawn[..., 2],
             x * bx + y * by, x * by - y * bx], axis=-1,
        )  # fmt: skip
        self.sums = self.sums[:, None]
        off = np.where(good, self.off(more, 1), np.inf)
        self.sums = (self.sums + more).reshape(-1, 8)
        every = np.arange(off.size).reshape(off.shape)
        if not placing.bears:
            every = every[np.arange(len(off)), np.argmin(off, axis=1)]
        price = off.ravel()[every.ravel()]
        best = every.ravel()[np.argsort(price, kind="stable")][: self.width]
        best = best[np.isfinite(off.ravel()[best])]
        self.sums = self.sums[best]
        self.places = self.places[best // off.shape[1]]
        self.places[:, self.count] = found.reshape(-1, 2)[best]
        self.count += 1
        return bool(best.size)


def _candidates(places: np.ndarray, placing: _Placing) -> tuple[np.ndarray, np.ndarray]:
    """(places (branches, 1 or 2, 2) of a point, marks of those that there are) from those of others."""
    if not placing.near:
        return np.broadcast_to(placing.drawn, (len(places), 1, 2)), np.ones((len(places), 1), bool)
    a, r = places[:, placing.near[0]], placing.radius[0]
    if len(placing.near) == 1:
        away = placing.drawn - a
        length = np.linalg.norm(away, axis=1, keepdims=True)
        away = np.where(length > 0.0, away / np.where(length > 0.0, length, 1.0), (1.0, 0.0))
        return (a + r * away)[:, None], np.full((len(places), 1), r >= 0.0)
    q = placing.radius[1]
    d = places[:, placing.near[1]] - a
    span = np.linalg.norm(d, axis=1)
    good = span > 0.0
    span = np.where(good, span, 1.0)
    along = 0.5 * (span + (r - q) * (r + q) / span)
    square = (r - along) * (r + along)
    good &= square >= -GRAZING * (r * r + span * span)
    u = d / span[:, None]
    foot = a + along[:, None] * u
    up = np.sqrt(np.maximum(square, 0.0))[:, None] * np.column_stack([-u[:, 1], u[:, 0]])
    return np.stack([foot + up, foot - up], axis=1), np.repeat(good[:, None], 2, axis=1)
