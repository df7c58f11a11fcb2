"""Ways out of a minimum of the errors: flat triangles folded over, which the drawing may have mirrored.

A sliver's height is less than the drawing is off, so the sketch does not determine its side; a descent from the
wrong side ends where the last errors pull against each other, a stress. A fold moves a point to its mirror
image in the line through two points that it has distances from. To the first order all of the part gives
way except along the stress, so a fold would leave the stress's share of the errors behind it. Folds
that leave less, and move little for that, are tried first, each by a descent. Not for: the descent (`descent`).
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from clearance.sketch.descent import CORRECTIONS, Iterate, ProblemPart, descend
from clearance.sketch.effort import OutOfTime
from clearance.sketch.equations import PointPoint, are, places
from clearance.sketch.graph.graph import RADIUS
from clearance.sketch.problem import Problem

GAIN = 0.02
"""[-] Share of the error that a fold must promise."""

TRIED, ALTOGETHER = 16, 40
"""Folds tried in one minimum, and in all of them."""

LOWER = 0.9
"""[-] Share of the sum below which another minimum counts as a better one."""

FIRST_DAMPING = 1e-4
"""[-] First damping after a fold: what is right elsewhere must not be thrown about."""


WAYS = (CORRECTIONS, 1)
"""Corrections of the first descent: with fewer another minimum may be found."""


class Fold(NamedTuple):
    """A point's first variable, where it goes (2,), and how far it goes for what is gained."""

    variable: int
    goal: np.ndarray
    price: float


def solve_from(problem: Problem, part: int, x: np.ndarray, tolerance: float) -> np.ndarray | None:
    """Numbers (n,) near x at which all equations of a part hold to `tolerance`; None when none were found."""
    work = ProblemPart(problem, part)
    if not work.rows.size or not work.n:
        return None
    sizes = problem.tables.role == RADIUS
    for corrections in WAYS:
        place = _descended(work, descend(work, x.copy(), corrections=corrections), tolerance)
        if place is not None and (place.x[sizes] > 0.0).all():
            return place.x
    return None


def _descended(work: ProblemPart, place: Iterate | None, tolerance: float) -> Iterate | None:
    """The root that is reached from a minimum over folds; None for none."""
    remaining = ALTOGETHER
    while place is not None and np.abs(place.error).max() > tolerance:
        place, used = _unfolded(work, place, min(remaining, TRIED))
        remaining -= used
    return place


def _unfolded(work: ProblemPart, place: Iterate, most: int) -> tuple[Iterate | None, int]:
    """(a lower minimum beyond a fold, None when there is none; how many folds were tried)."""
    for k, fold in enumerate(folds(work, place)[:most]):
        start = place.x.copy()
        start[fold.variable : fold.variable + 2] = fold.goal
        try:
            other = descend(work, start, FIRST_DAMPING)
        except OutOfTime:
            raise OutOfTime(place.x) from None
        if other.total < LOWER * place.total:
            return other, k + 1
    return None, most


def folds(work: ProblemPart, place: Iterate) -> list[Fold]:
    """The folds at a minimum that promise to gain, the best first."""
    whole = float(np.linalg.norm(place.error))
    out = []
    for i, near, stress, reach in _joined(work, place):
        goals = _mirrored(place.x[i : i + 2], near)
        away = np.linalg.norm(goals[:, None] - near[None], axis=2) - reach
        gain = whole - np.abs(whole + (away @ stress) / whole)
        moved = np.linalg.norm(goals - place.x[i : i + 2], axis=1)
        for k in np.flatnonzero((gain > GAIN * whole) & (moved > 0.0)):
            out.append(Fold(i, goals[k], float(moved[k] / gain[k])))
    return sorted(out, key=lambda fold: (fold.price, fold.variable))


def _joined(work: ProblemPart, place: Iterate):
    """By point: its first variable, the points it has distances from (k, 2), their errors (k,), and the
    distances now (k,)."""
    s = work.system
    mine = are(s.code[work.rows], PointPoint)
    ends, error = places(PointPoint, s.var[work.rows[mine]]), place.error[mine]
    point, other = np.concatenate([ends.px, ends.qx]), np.concatenate([ends.qx, ends.px])
    error = np.concatenate([error, error])
    order = np.argsort(point, kind="stable")
    bounds = np.flatnonzero(np.diff(point[order], prepend=-1, append=-1))
    for low, high in zip(bounds[:-1], bounds[1:], strict=True):
        chosen = order[low:high]
        i = int(point[chosen[0]])
        if chosen.size > 2 and work.first[s.vertex_of[i]] >= 0:
            near = place.x[other[chosen][:, None] + np.arange(2)]
            yield i, near, error[chosen], np.linalg.norm(near - place.x[i : i + 2], axis=1)


def _mirrored(p: np.ndarray, near: np.ndarray) -> np.ndarray:
    """(pairs, 2) the mirror images of p in the lines through every two of some points."""
    a, b = np.triu_indices(near.shape[0], 1)
    along = near[b] - near[a]
    length = np.linalg.norm(along, axis=1)
    along, start = along[length > 0.0] / length[length > 0.0, None], near[a][length > 0.0]
    foot = start + along * np.sum((p - start) * along, axis=1)[:, None]
    return 2.0 * foot - p
