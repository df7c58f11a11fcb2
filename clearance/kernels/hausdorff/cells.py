"""The cells of B that may hold a foot of A's points, by level: halved, paired, and left out where none is needed.

A cell without length is an end or corner of B. Not for: which systems are settled (`hausdorff.systems`).
"""

from typing import NamedTuple

import numpy as np

from clearance.compile.decorators import inline
from clearance.kernels.curve.interval import enclose
from clearance.kernels.hausdorff.single_roots import (
    OPEN,
    PIECE,
    S0,
    S1,
    foot_slopes,
    gap_box,
    gap_sq,
)

DEEPEST = 34
MOST_CELLS, MOST_PAIRS = 4000, 40_000


class CellTable(NamedTuple):
    """Cells and pairs of cells of every level, and scratch of the level at hand.

    Attributes:
        cells: (levels, MOST_CELLS, 4) piece, s0, s1, whether its normal is open; n_cells: (levels,).
        pairs: (levels, MOST_PAIRS, 2) cells whose bisector is open; n_pairs: (levels,).
        boxes: (MOST_CELLS, 4, 6) of each new cell, `curve.interval.enclose`.
        child: (MOST_CELLS, 2) the halves of each old cell, -1 where none may hold a foot.
        ranges: (MOST_CELLS, 2) the squared distances of each new cell.
    """

    cells: np.ndarray
    n_cells: np.ndarray
    pairs: np.ndarray
    n_pairs: np.ndarray
    boxes: np.ndarray
    child: np.ndarray
    ranges: np.ndarray


@inline
def new_table():
    """A table without cells."""
    levels = DEEPEST + 2
    return CellTable(
        np.empty((levels, MOST_CELLS, 4)),
        np.zeros(levels, np.int64),
        np.empty((levels, MOST_PAIRS, 2), np.int64),
        np.zeros(levels, np.int64),
        np.empty((MOST_CELLS, 4, 6)),
        np.empty((MOST_CELLS, 2), np.int64),
        np.empty((MOST_CELLS, 2)),
    )


@inline
def _put(cell, piece, s0, s1, is_open):
    cell[PIECE], cell[S0], cell[S1], cell[OPEN] = piece, s0, s1, is_open


@inline
def _put_first_cells(b_parts, ends_b, cells):
    """The parts of B and its ends and corners as cells; returns their number, 0 where they are too many."""
    n = 0
    for k in range(b_parts.shape[0]):
        j = int(b_parts[k, 0])
        if n + 3 > cells.shape[0]:
            return 0
        _put(cells[n], j, b_parts[k, 1], b_parts[k, 2], 1.0)
        n += 1
        for side in range(2):
            is_known = side == 0 and j > 0 and ends_b[j - 1, 1]
            if ends_b[j, side] and not is_known and b_parts[k, 1 + side] == side:
                _put(cells[n], j, side, side, 1.0)
                n += 1
    return n


@inline
def begin_table(b_parts, ends_b, table):
    """Fills level 0: all cells, all pairs. Returns whether they fit, and that there are any."""
    n = _put_first_cells(b_parts, ends_b, table.cells[0])
    n_pairs, most = 0, table.pairs.shape[1]
    for k in range(n):
        for m in range(k + 1):
            if n_pairs < most:
                table.pairs[0, n_pairs, 0], table.pairs[0, n_pairs, 1] = k, m
                n_pairs += 1
    table.n_cells[0], table.n_pairs[0] = n, n_pairs
    return n > 0 and n * (n + 1) // 2 <= most


@inline
def put_child_cells(systems, table, level, split, a_box, points, gap):
    """Halves of the cells of the level before that may hold a foot, their boxes, `child` and `ranges`.

    Returns their number, -1 where there are too many.
    """
    curves, old, new = systems.pair.curves, table.cells[level - 1], table.cells[level]
    boxes, n = table.boxes, 0
    for k in range(table.n_cells[level - 1]):
        table.child[k, 0], table.child[k, 1] = -1, -1
        halved = split and old[k, S0] != old[k, S1]
        for half in range(2 if halved else 1):
            s0, s1 = old[k, S0], old[k, S1]
            if halved:
                middle = 0.5 * (s0 + s1)
                s0, s1 = (s0, middle) if half == 0 else (middle, s1)
            if n >= new.shape[0]:
                return -1
            enclose(systems.b, int(old[k, PIECE]), s0, s1, points, boxes[n])
            gap_box(a_box[0], boxes[n, 0], curves, gap)
            if s0 != s1:
                slopes = foot_slopes(gap, boxes[n])
                # no foot, or only farthest points, in this cell
                if slopes.low > 0.0 or slopes.high < 0.0 or slopes.rise_low > 0.0:
                    continue
            table.ranges[n, 0], table.ranges[n, 1] = gap_sq(gap)
            _put(new[n], old[k, PIECE], s0, s1, old[k, OPEN])
            table.child[k, half] = n
            n += 1
    return n


@inline
def keep_needed(table, level, n, n_pairs):
    """Takes out the new cells that no open system needs; returns how many stay."""
    cells, pairs, needed = table.cells[level], table.pairs[level], np.zeros(n, np.int64)
    for k in range(n):
        needed[k] = cells[k, OPEN] != 0.0
    for p in range(n_pairs):
        needed[pairs[p, 0]], needed[pairs[p, 1]] = 1, 1
    used = 0
    for k in range(n):
        if needed[k]:
            cells[used] = cells[k]
            needed[k] = used
            used += 1
    for p in range(n_pairs):
        pairs[p, 0], pairs[p, 1] = needed[pairs[p, 0]], needed[pairs[p, 1]]
    return used
