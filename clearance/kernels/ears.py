"""Compiled ear cutting of one polygon in the plane: exact turns, and a grid over what can block an ear.

A corner that turns left is an ear if no corner that does not turn left lies in its triangle (Meisters, Polygons
have ears, 1975). Corners that turn left keep doing so while ears go, so the grid is made once and only loses
corners. All triangles turn left or are flat, and their boundaries add up to the polygon's: where it is simple
they cover exactly it. Not for: which polygons need this (`load.polygon_cut`).
"""

from __future__ import annotations

import numpy as np

from clearance.jit import kernel
from clearance.kernels.expansion import N_TERMS, orient2d

CUT, CROSSES, TOO_MUCH = 0, 1, 2


@kernel
def _turn(points, i, j, k, terms):
    """The exact sign of the turn i, j, k: 1 to the left."""
    return orient2d(
        points[i, 0], points[i, 1], points[j, 0], points[j, 1], points[k, 0], points[k, 1], terms
    )


@kernel
def _cell(points, i, least, per_length, n_side, axis):
    """The column or row of the grid that a corner is in."""
    return min(n_side - 1, int((points[i, axis] - least[axis]) * per_length[axis]))


@kernel
def _grid(points, blocking, least, per_length, n_side):
    """The corners that may block an ear, sorted by cell: (starts, corners)."""
    starts = np.zeros(n_side * n_side + 1, dtype=np.int64)
    cells = np.full(len(points), -1)
    for i in range(len(points)):
        if blocking[i]:
            column = _cell(points, i, least, per_length, n_side, 0)
            cells[i] = column * n_side + _cell(points, i, least, per_length, n_side, 1)
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


@kernel
def _is_same(points, i, j):
    return points[i, 0] == points[j, 0] and points[i, 1] == points[j, 1]


@kernel
def _holds(points, a, b, c, p, terms):
    """Whether corner p lies in the closed triangle a, b, c, and at none of its corners."""
    if _is_same(points, p, a) or _is_same(points, p, b) or _is_same(points, p, c):
        return False
    return (
        _turn(points, a, b, p, terms) >= 0
        and _turn(points, b, c, p, terms) >= 0
        and _turn(points, c, a, p, terms) >= 0
    )


@kernel
def _is_blocked(points, a, b, c, blocking, grid, least, per_length, n_side, work, terms):
    """Whether a corner that does not turn left lies in the triangle; `work[0]` counts what was looked at."""
    starts, corners = grid
    low = np.empty(2, dtype=np.int64)
    high = np.empty(2, dtype=np.int64)
    for axis in range(2):
        cells = (
            _cell(points, a, least, per_length, n_side, axis),
            _cell(points, b, least, per_length, n_side, axis),
            _cell(points, c, least, per_length, n_side, axis),
        )
        low[axis], high[axis] = min(cells), max(cells)
    for column in range(low[0], high[0] + 1):
        first = starts[column * n_side + low[1]]
        last = starts[column * n_side + high[1] + 1]
        work[0] += 1 + last - first
        for k in range(first, last):
            p = corners[k]
            if blocking[p] and p != a and p != b and p != c and _holds(points, a, b, c, p, terms):
                return True
    return False


@kernel
def cut_ears(points, triangles, work):
    """Fills (k - 2, 3) `triangles` with the positions of the triangles of a (k, 2) polygon that turns left.

    Args:
        points: all within 1 of 0, so that products of coordinates do not overflow.
        work: (1,) how many corners and cells may still be looked at; what was is taken off.

    Returns:
        `CUT`; `CROSSES` where no ear is left, `TOO_MUCH` where the work was used up.
    """
    n = len(points)
    terms = np.empty(N_TERMS)
    ahead, behind = (np.arange(n) + 1) % n, (np.arange(n) - 1) % n
    blocking = np.empty(n, dtype=np.bool_)
    n_blocking = 0
    least, per_length = np.empty(2), np.empty(2)
    for i in range(n):
        blocking[i] = _turn(points, behind[i], i, ahead[i], terms) <= 0
        n_blocking += blocking[i]
    n_side = int(np.sqrt(n_blocking)) + 1
    for axis in range(2):
        least[axis] = points[:, axis].min()
        size = points[:, axis].max() - least[axis]
        per_length[axis] = n_side / size if size > 0.0 else 0.0
    grid = _grid(points, blocking, least, per_length, n_side)
    spent = np.zeros(1, dtype=np.int64)
    i, n_written, n_failed, takes_straight = 0, 0, 0, False
    while n - n_written > 3:
        before, after = behind[i], ahead[i]
        turn = _turn(points, before, i, after, terms)
        spent[0] += 1
        is_ear = (turn == 0 and takes_straight) or (
            turn > 0
            and not _is_blocked(
                points, before, i, after, blocking, grid, least, per_length, n_side, spent, terms
            )
        )
        if spent[0] > work[0]:
            return TOO_MUCH
        if not is_ear:
            i = after
            n_failed += 1
            if n_failed > n - n_written:  # once round in vain: straight corners then go as well
                if takes_straight:
                    return CROSSES
                takes_straight, n_failed = True, 0
            continue
        triangles[n_written] = (before, i, after)
        n_written += 1
        ahead[before], behind[after] = after, before
        blocking[i] = False
        for j in (before, after):
            if blocking[j]:
                blocking[j] = _turn(points, behind[j], j, ahead[j], terms) <= 0
        n_failed = 0
        takes_straight = takes_straight and turn == 0
        i = after if takes_straight else before
    triangles[n_written] = (behind[i], i, ahead[i])
    work[0] -= spent[0]
    return CUT if _turn(points, behind[i], i, ahead[i], terms) >= 0 else CROSSES
