"""Compiled ear cutting of one polygon in the plane: exact turns, and a grid of the corners that can block an ear.

A corner that turns left is an ear if its triangle has no corner that does not turn left (Meisters, Polygons have
ears, 1975). In a simple polygon, corners that turn left still do so after ears are cut. So the grid is made once
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
        counts: (3,) by `N_WAITING` corners in `waiting`, `N_TRIANGLES` written, `N_VISITED` corners and cells.
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
def _cell(value, least, per_length, n_side, axis):
    """The column or row of the grid that a coordinate is in; the same or a later one for a greater coordinate."""
    return int(min(n_side - 1.0, max(0.0, (value - least[axis]) * per_length[axis])))


@inline
def _grid(points, turns, frame):
    """The corners that may block an ear, sorted by cell: (starts, corners)."""
    least, per_length, n_side = frame
    starts = np.zeros(n_side * n_side + 1, dtype=np.int64)
    cells = np.full(len(points), -1)
    for i in range(len(points)):
        if turns[i] != LEFT:
            column = _cell(points[i, 0], least, per_length, n_side, 0)
            cells[i] = column * n_side + _cell(points[i, 1], least, per_length, n_side, 1)
            starts[cells[i] + 1] += 1
    for c in range(n_side * n_side):
        starts[c + 1] += starts[c]
    corners = np.empty(starts[-1], dtype=np.int64)
    filled = starts[:-1].copy()
    for i in range(len(points)):
        if cells[i] >= 0:
            corners[filled[cells[i]]] = i
            filled[cells[i]] += 1
    return starts, corners


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
def _rows_within(points, a, b, c, left, right):
    """The least and greatest ordinate that the triangle has between two abscissae, give or take a rounding."""
    low, high = np.inf, -np.inf
    for i, j in ((a, b), (b, c), (c, a)):
        if points[i, 0] > points[j, 0]:
            i, j = j, i
        if points[j, 0] < left or points[i, 0] > right:
            continue
        width = points[j, 0] - points[i, 0]
        for x in (left, right):
            share = (x - points[i, 0]) / width if width > 0.0 else 0.0
            y = points[i, 1] + min(1.0, max(0.0, share)) * (points[j, 1] - points[i, 1])
            low, high = min(low, y), max(high, y)
        if width == 0.0:
            low, high = min(low, points[j, 1]), max(high, points[j, 1])
    return low, high


@inline
def _is_blocked(b, points, ring, grid, frame, terms):
    """Whether a corner that does not turn left lies in the triangle of corner b and its neighbours."""
    a, c = ring.behind[b], ring.ahead[b]
    starts, corners = grid
    least, per_length, n_side = frame
    first = _cell(min(points[a, 0], points[b, 0], points[c, 0]), least, per_length, n_side, 0)
    last = _cell(max(points[a, 0], points[b, 0], points[c, 0]), least, per_length, n_side, 0)
    for column in range(first, last + 1):
        left = least[0] + (column - 0.5) / per_length[0] if column > first else -np.inf
        right = least[0] + (column + 1.5) / per_length[0] if column < last else np.inf
        low, high = _rows_within(points, a, b, c, left, right)
        bottom = max(0, _cell(low, least, per_length, n_side, 1) - 1)
        top = min(n_side - 1, _cell(high, least, per_length, n_side, 1) + 1)
        begin, end = starts[column * n_side + bottom], starts[column * n_side + top + 1]
        ring.counts[N_VISITED] += 1 + end - begin
        for k in range(begin, end):
            p = corners[k]
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
def _cut_ears(visited, points, ring, triangles, grid, frame, stamp, terms):
    """One round: cuts off the ears among some corners, but no two neighbours, which would make needles."""
    ring.counts[N_WAITING] = 0
    for i in visited:
        if ring.counts[N_TRIANGLES] == len(triangles) - 1:
            return
        ring.counts[N_VISITED] += 1
        if ring.turns[i] == LEFT and ring.touched[i] != stamp:
            if not _is_blocked(i, points, ring, grid, frame, terms):
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
def _frame_of(points, turns):
    """The grid's corner, its cells per length, and how many there are a side: one for each blocking corner."""
    n_side = int(np.sqrt(np.count_nonzero(turns != LEFT))) + 1
    least, per_length = np.empty(2), np.empty(2)
    for axis in range(2):
        least[axis] = points[:, axis].min()
        size = points[:, axis].max() - least[axis]
        per_length[axis] = n_side / size if size > 0.0 else 1.0
    return least, per_length, n_side


@inline
def _cut_rounds(points, ring, triangles, grid, frame, most, terms):
    """Cuts ears, round after round, until three corners remain; then `CUT`."""
    visited, all_are = np.flatnonzero(ring.turns == LEFT), True
    stamp = 0
    while ring.counts[N_TRIANGLES] < len(triangles) - 1:
        n_before = ring.counts[N_TRIANGLES]
        _cut_ears(visited, points, ring, triangles, grid, frame, stamp, terms)
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
        most: corners and cells to visit.

    Returns:
        The outcome: `CUT`, `CROSSES` without an ear, `TOO_MUCH` where `most` was reached; and the number visited.
    """
    terms = np.empty(N_TERMS)
    ring = _ring_of(points, terms)
    frame = _frame_of(points, ring.turns)
    grid = _grid(points, ring.turns, frame)
    outcome = _cut_rounds(points, ring, triangles, grid, frame, most, terms)
    if outcome == CUT:
        i, j, k = np.flatnonzero(ring.turns != GONE)  # three in the ring's order
        triangles[len(triangles) - 1] = (i, j, k)
        outcome = CUT if _turn(points, i, j, k, terms) >= 0 else CROSSES
    return outcome, ring.counts[N_VISITED]
