"""Compiled ear cutting of one polygon in the plane: exact turns, and a list of the corners that can block an ear.

A corner that turns left is an ear if its triangle has no corner that does not turn left (Meisters, Polygons have
ears, 1975). In a simple polygon, corners that turn left still do so after ears are cut. So the list is sorted once
and only loses corners. All triangles turn left or are flat, and their boundaries add up to the polygon's: they
cover a simple polygon exactly. Not for: which polygons need this (`formats.mesh.polygon_cut`).
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from clearance.compile.declared import Floats2, Integers2
from clearance.compile.decorators import inline, kernel
from clearance.kernels.arithmetic.expansion import N_TERMS, orient2d

LEFT, STRAIGHT, RIGHT, GONE = 1, 0, -1, 2
CUT, CROSSES, TOO_MUCH = 0, 1, 2
N_WAITING, N_TRIANGLES, N_VISITED = 0, 1, 2

_CLEAR = 1e-14
"""[-] A difference of two products beyond this share of their sum has the right sign."""


class CornerRing(NamedTuple):
    """The remaining corners, and those that the next round visits.

    Attributes:
        ahead, behind: (n,) the neighbours of each corner.
        turns: (n,) `LEFT`, `STRAIGHT`, `RIGHT` or `GONE`.
        touched: (n,) the round in which a neighbour was cut off.
        waiting: (n,) the corners touched in this round, `counts[N_WAITING]` of them.
        counts: (3,) by `N_WAITING` corners in `waiting`, `N_TRIANGLES` written, `N_VISITED` corners.
    """

    ahead: np.ndarray
    behind: np.ndarray
    turns: np.ndarray
    touched: np.ndarray
    waiting: np.ndarray
    counts: np.ndarray


@inline
def _turn(points, i, j, k, terms):
    """The exact sign of the turn i, j, k: 1 to the left."""
    return orient2d(
        points[i, 0], points[i, 1], points[j, 0], points[j, 1], points[k, 0], points[k, 1], terms
    )


@inline
def _blocking(points, turns):
    """The corners that may block an ear, in order along the polygon's longer side: (axis, places, corners)."""
    x, y = points[:, 0], points[:, 1]
    axis = 0 if x.max() - x.min() >= y.max() - y.min() else 1
    corners = np.flatnonzero(turns != LEFT)
    corners = corners[np.argsort(points[corners, axis])]
    return axis, points[corners, axis], corners


@inline
def _is_same(points, i, j):
    return points[i, 0] == points[j, 0] and points[i, 1] == points[j, 1]


@inline
def _is_right(points, i, j, k):
    """True if i, j, k turn right by more than rounding: a quick test, False where they hardly turn."""
    left = (points[j, 0] - points[i, 0]) * (points[k, 1] - points[i, 1])
    right = (points[j, 1] - points[i, 1]) * (points[k, 0] - points[i, 0])
    return left - right < -_CLEAR * (abs(left) + abs(right))


@inline
def _contains(points, a, b, c, p, terms):
    """Whether corner p lies in the closed triangle a, b, c, and at none of its corners."""
    for axis in range(2):
        u, v, w, x = points[a, axis], points[b, axis], points[c, axis], points[p, axis]
        if x < min(u, v, w) or x > max(u, v, w):
            return False
    if _is_right(points, a, b, p) or _is_right(points, b, c, p) or _is_right(points, c, a, p):
        return False
    if _is_same(points, p, a) or _is_same(points, p, b) or _is_same(points, p, c):
        return False
    return (
        _turn(points, a, b, p, terms) >= 0
        and _turn(points, b, c, p, terms) >= 0
        and _turn(points, c, a, p, terms) >= 0
    )


@inline
def _is_blocked(b, points, ring, blocking, terms):
    """Whether a corner that does not turn left lies in the triangle of corner b and its neighbours."""
    a, c = ring.behind[b], ring.ahead[b]
    axis, places, corners = blocking
    low = min(points[a, axis], points[b, axis], points[c, axis])
    high = max(points[a, axis], points[b, axis], points[c, axis])
    for k in range(np.searchsorted(places, low), len(places)):
        if places[k] > high:
            break
        p = corners[k]
        ring.counts[N_VISITED] += 1
        if ring.turns[p] == STRAIGHT or ring.turns[p] == RIGHT:
            if p != a and p != c and _contains(points, a, b, c, p, terms):
                return True
    return False


@inline
def _cut_off(i, points, ring, triangles, stamp, terms):
    """Cuts corner i off; its neighbours are turned anew and wait for the next round."""
    before, after = ring.behind[i], ring.ahead[i]
    triangles[ring.counts[N_TRIANGLES]] = (before, i, after)
    ring.counts[N_TRIANGLES] += 1
    ring.ahead[before], ring.behind[after] = after, before
    ring.turns[i] = GONE
    for j in (before, after):
        ring.turns[j] = _turn(points, ring.behind[j], j, ring.ahead[j], terms)
        if ring.touched[j] != stamp:
            ring.touched[j] = stamp
            ring.waiting[ring.counts[N_WAITING]] = j
            ring.counts[N_WAITING] += 1


@inline
def _cut_straight(points, ring, triangles, stamp, terms):
    """Cuts all straight corners off, if there is no ear."""
    for i in range(len(points)):
        if ring.turns[i] == STRAIGHT and ring.counts[N_TRIANGLES] < len(triangles) - 1:
            _cut_off(i, points, ring, triangles, stamp, terms)


@inline
def _cut_ears(visited, points, ring, triangles, blocking, stamp, terms):
    """One round: cuts off the ears among some corners, but no two neighbours, which would make needles."""
    ring.counts[N_WAITING] = 0
    for i in visited:
        if ring.counts[N_TRIANGLES] == len(triangles) - 1:
            return
        ring.counts[N_VISITED] += 1
        if ring.turns[i] == LEFT and ring.touched[i] != stamp:
            if not _is_blocked(i, points, ring, blocking, terms):
                _cut_off(i, points, ring, triangles, stamp, terms)


@inline
def _ring_of(points, terms):
    """The ring of all corners."""
    n = len(points)
    ahead, behind = (np.arange(n) + 1) % n, (np.arange(n) - 1) % n
    turns = np.empty(n, dtype=np.int64)
    for i in range(n):
        turns[i] = _turn(points, behind[i], i, ahead[i], terms)
    counts = np.zeros(3, dtype=np.int64)
    return CornerRing(ahead, behind, turns, np.full(n, -1), np.empty(n, dtype=np.int64), counts)


@inline
def _cut_rounds(points, ring, triangles, blocking, most, terms):
    """Cuts ears, round after round, until three corners remain; then `CUT`."""
    visited, all_are = np.flatnonzero(ring.turns == LEFT), True
    stamp = 0
    while ring.counts[N_TRIANGLES] < len(triangles) - 1:
        n_before = ring.counts[N_TRIANGLES]
        _cut_ears(visited, points, ring, triangles, blocking, stamp, terms)
        stamp += 1
        if ring.counts[N_VISITED] > most:
            return TOO_MUCH
        if ring.counts[N_TRIANGLES] > n_before:
            visited, all_are = ring.waiting[: ring.counts[N_WAITING]].copy(), False
            continue
        if all_are:  # no ear remains: the rest is straight, or crosses itself
            _cut_straight(points, ring, triangles, stamp, terms)
            if ring.counts[N_TRIANGLES] == n_before:
                return CROSSES
        visited, all_are = np.flatnonzero(ring.turns == LEFT), True
        ring.counts[N_VISITED] += len(points)
    return CUT


@kernel
def cut_ears(points: Floats2, triangles: Integers2, most: int) -> tuple[int, int]:
    """Fills (k - 2, 3) `triangles` with the positions of the triangles of a (k, 2) polygon that turns left.

    Args:
        points: all within 1 of 0, so that products of coordinates do not overflow.
        most: corners to visit.

    Returns:
        The outcome: `CUT`, `CROSSES` without an ear, `TOO_MUCH` where `most` was reached; and the number visited.
    """
    terms = np.empty(N_TERMS)
    ring = _ring_of(points, terms)
    blocking = _blocking(points, ring.turns)
    outcome = _cut_rounds(points, ring, triangles, blocking, most, terms)
    if outcome == CUT:
        i, j, k = np.flatnonzero(ring.turns != GONE)  # three in the ring's order
        triangles[len(triangles) - 1] = (i, j, k)
        outcome = CUT if _turn(points, i, j, k, terms) >= 0 else CROSSES
    return outcome, ring.counts[N_VISITED]
