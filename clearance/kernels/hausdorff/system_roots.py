"""Compiled roots of the systems (11), (12), (13) where a cell holds one at most; each is offered to the state.

Not for: proving that there is one at most (`hausdorff.systems`).
"""

import math

import numpy as np

from clearance.compile.jit import inline, kernel
from clearance.kernels.curve.bezier import jet
from clearance.kernels.curve.nearest import closest_on
from clearance.kernels.hausdorff.exact import common_normal, consider
from clearance.kernels.hausdorff.state import (
    BISECTORS,
    ENDS,
    NORMALS,
    ROOT,
    ROOT_AT_A,
    ROOT_AT_B,
    ROOT_PIECE_A,
    ROOT_PIECE_B,
)


@inline
def _distance_to_cell(pa, pb, i, t, cell, shift_x, shift_y, work):
    """The distance of A's point to one cell of B, and where."""
    here = jet(pa, i, t)
    x, y = here.x + shift_x, here.y + shift_y
    d, _, s = closest_on(pb, int(cell[0]), cell[1], cell[2], x, y, np.inf, work)
    return d, s


@inline
def keep_root(distance, i, t, j, s, state):
    """Keeps a root as that of the greatest distance."""
    state[ROOT], state[ROOT_PIECE_A], state[ROOT_AT_A] = distance, i, t
    state[ROOT_PIECE_B], state[ROOT_AT_B] = j, s


@inline
def _offer(pa, pb, lb, i, t, cell, shift_x, shift_y, state, work):
    """Takes a root in: its own distance, and that of A's point to the whole of B, which may be less."""
    d, s = _distance_to_cell(pa, pb, i, t, cell, shift_x, shift_y, work)
    if d > state[ROOT]:
        keep_root(d, i, t, cell[0], s, state)
    consider(pa, pb, lb, i, t, shift_x, shift_y, 0, state, work)


@inline
def _is_normal(pa, pb, i, t, j, s, shift_x, shift_y):
    """Whether both equations of (12) hold at (t, s) to rounding: the cosines with both tangents vanish."""
    a, b = jet(pa, i, t), jet(pb, j, s)
    ex, ey = a.x + shift_x - b.x, a.y + shift_y - b.y
    gap = ex * ex + ey * ey
    f, g = ex * a.dx + ey * a.dy, ex * b.dx + ey * b.dy
    fine = f * f <= 1e-20 * gap * (a.dx * a.dx + a.dy * a.dy)
    return fine and g * g <= 1e-20 * gap * (b.dx * b.dx + b.dy * b.dy)


@inline
def _slope_at_foot(pa, pb, i, t, cell, shift_x, shift_y, work):
    """The slope of half the squared distance along A at `t`, from A's foot in one cell of B."""
    _, s = _distance_to_cell(pa, pb, i, t, cell, shift_x, shift_y, work)
    a, b = jet(pa, i, t), jet(pb, int(cell[0]), s)
    return (a.x + shift_x - b.x) * a.dx + (a.y + shift_y - b.y) * a.dy


@kernel
def _bisected_normal(pa, pb, i, t0, t1, cell, shift_x, shift_y, work):
    """The parameter in [t0, t1] where `_slope_at_foot` changes its sign; nan where it does not: no root."""
    low, high = t0, t1
    at_low = _slope_at_foot(pa, pb, i, low, cell, shift_x, shift_y, work)
    if at_low * _slope_at_foot(pa, pb, i, high, cell, shift_x, shift_y, work) > 0.0:
        return math.nan
    for _ in range(60):
        t = 0.5 * (low + high)
        if high - low < 2e-16:
            break
        if at_low * _slope_at_foot(pa, pb, i, t, cell, shift_x, shift_y, work) > 0.0:
            low = t
        else:
            high = t
    return 0.5 * (low + high)


@kernel
def try_normal(pa, pb, lb, i, t0, t1, cell, shift_x, shift_y, state, work):
    """System (12), or (11) against an end of B: the one root in T, by Newton's method from its middle.

    The system's determinant has one sign over T and the cell, so that there is one root at most. Newton's
    result counts only with a residual of zero inside T and the cell; else the sign of the slope along the
    foot, monotone here, says whether a root exists, and bisection finds it.
    """
    state[NORMALS if cell[1] != cell[2] else ENDS] += 1.0
    t, j = 0.5 * (t0 + t1), int(cell[0])
    if cell[1] != cell[2]:
        s = 0.5 * (cell[1] + cell[2])
        t, s = common_normal(pa, pb, i, t, t0, t1, j, s, shift_x, shift_y)
        if not _is_normal(pa, pb, i, t, j, s, shift_x, shift_y) or not cell[1] <= s <= cell[2]:
            t = _bisected_normal(pa, pb, i, t0, t1, cell, shift_x, shift_y, work)
            if math.isnan(t):
                return
    else:
        end = jet(pb, j, cell[1])
        low, high = t0, t1
        for _ in range(60):
            t = 0.5 * (low + high)
            if high - low < 2e-16:
                break
            if (
                _slope_to(pa, i, t0, end, shift_x, shift_y)
                * _slope_to(pa, i, t, end, shift_x, shift_y)
                > 0.0
            ):
                low = t
            else:
                high = t
    _offer(pa, pb, lb, i, t, cell, shift_x, shift_y, state, work)


@inline
def _slope_to(pa, i, t, end, shift_x, shift_y):
    here = jet(pa, i, t)
    return (here.x + shift_x - end.x) * here.dx + (here.y + shift_y - end.y) * here.dy


@kernel
def try_bisector(pa, pb, lb, i, t0, t1, one, two, shift_x, shift_y, state, work):
    """System (13): the one point of T that is equally far from two cells, if there is one (regula falsi)."""
    state[BISECTORS] += 1.0
    low, high = t0, t1
    d, _ = _distance_to_cell(pa, pb, i, low, one, shift_x, shift_y, work)
    e, _ = _distance_to_cell(pa, pb, i, low, two, shift_x, shift_y, work)
    f_low = d - e
    d, _ = _distance_to_cell(pa, pb, i, high, one, shift_x, shift_y, work)
    e, _ = _distance_to_cell(pa, pb, i, high, two, shift_x, shift_y, work)
    f_high = d - e
    if f_low * f_high > 0.0 or f_low == f_high:
        return
    side, t = 0, low
    for _ in range(60):
        t = (low * f_high - high * f_low) / (f_high - f_low)
        d, _ = _distance_to_cell(pa, pb, i, t, one, shift_x, shift_y, work)
        e, _ = _distance_to_cell(pa, pb, i, t, two, shift_x, shift_y, work)
        f = d - e
        if abs(f) <= 1e-16 * (d + e) or high - low <= 2e-16:
            break
        if f * f_high > 0.0:
            high, f_high = t, f
            f_low *= 0.5 if side == 1 else 1.0
            side = 1
        else:
            low, f_low = t, f
            f_high *= 0.5 if side == -1 else 1.0
            side = -1
    _offer(pa, pb, lb, i, t, one, shift_x, shift_y, state, work)
