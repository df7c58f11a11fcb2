"""Compiled roots of the systems (11), (12), (13) where a cell holds one at most; each is offered to the state.

Not for: proving that there is one at most (`hausdorff.single_roots`).
"""

import math
from typing import NamedTuple

import numpy as np

from clearance.compile.decorators import inline
from clearance.kernels.curve.bezier import jet
from clearance.kernels.curve.nearest import closest_on
from clearance.kernels.hausdorff.bounds import consider
from clearance.kernels.hausdorff.bracket import (
    MOST_STEPS,
    NARROWEST,
    Bracket,
    root_in,
    value_at,
)
from clearance.kernels.hausdorff.roots import common_normal
from clearance.kernels.hausdorff.single_roots import PIECE, S0, S1

ROUNDED_SQ = 1e-20  # a squared cosine no larger is that of a right angle, to rounding


@inline
def _distance_to_cell(curves, i, t, cell, work):
    """The distance of A's point to one cell of B, and where."""
    here = jet(curves.a, i, t)
    x, y = here.x + curves.shift_x, here.y + curves.shift_y
    d, _, s = closest_on(curves.b, int(cell[PIECE]), cell[S0], cell[S1], x, y, np.inf, work)
    return d, s


@inline
def keep_root(distance, i, t, j, s, state):
    """Keeps a root where its distance is the greatest."""
    if distance > state.root:
        state.root, state.root_piece_a, state.root_at_a = distance, i, t
        state.root_piece_b, state.root_at_b = j, s


@inline
def _offer(pair, i, t, cell, state, work):
    """Takes a root in: its own distance, and that of A's point to the whole of B, which may be less."""
    d, s = _distance_to_cell(pair.curves, i, t, cell, work)
    keep_root(d, i, t, int(cell[PIECE]), s, state)
    consider(pair, i, t, 0, state, work)


@inline
def _is_normal(curves, i, t, j, s):
    """Whether both equations of (12) hold at (t, s) to rounding: the cosines with both tangents vanish."""
    a, b = jet(curves.a, i, t), jet(curves.b, j, s)
    ex, ey = a.x + curves.shift_x - b.x, a.y + curves.shift_y - b.y
    gap = ex * ex + ey * ey
    f, g = ex * a.dx + ey * a.dy, ex * b.dx + ey * b.dy
    fine = f * f <= ROUNDED_SQ * gap * (a.dx * a.dx + a.dy * a.dy)
    return fine and g * g <= ROUNDED_SQ * gap * (b.dx * b.dx + b.dy * b.dy)


@inline
def _slope_at_foot(curves, i, t, cell, work):
    """The slope of half the squared distance along A at `t`, from A's foot in one cell of B."""
    s = cell[S0]
    if cell[S0] != cell[S1]:
        _, s = _distance_to_cell(curves, i, t, cell, work)
    a, b = jet(curves.a, i, t), jet(curves.b, int(cell[PIECE]), s)
    return (a.x + curves.shift_x - b.x) * a.dx + (a.y + curves.shift_y - b.y) * a.dy


@inline
def _bisected_normal(curves, part, cell, at_start, work):
    """The parameter in `part` where `_slope_at_foot`, `at_start` at its start, changes its sign; else its end."""
    low, high = part.t0, part.t1
    for _ in range(MOST_STEPS):
        t = 0.5 * (low + high)
        if high - low < NARROWEST:
            break
        if at_start * _slope_at_foot(curves, part.piece, t, cell, work) > 0.0:
            low = t
        else:
            high = t
    return 0.5 * (low + high)


@inline
def _normal_to_piece(curves, part, cell, work):
    """The one root of (12) in A's part and a cell with length, by Newton's method or bisection; nan if none."""
    t, j, s = 0.5 * (part.t0 + part.t1), int(cell[PIECE]), 0.5 * (cell[S0] + cell[S1])
    t, s = common_normal(curves, part, t, j, s)
    if _is_normal(curves, part.piece, t, j, s) and cell[S0] <= s <= cell[S1]:
        return t
    at_start = _slope_at_foot(curves, part.piece, part.t0, cell, work)
    if at_start * _slope_at_foot(curves, part.piece, part.t1, cell, work) > 0.0:
        return math.nan
    return _bisected_normal(curves, part, cell, at_start, work)


@inline
def try_normal(pair, part, cell, state, work):
    """System (12), or (11) against an end of B: the one root in T, by Newton's method from its middle.

    The system's determinant has one sign over T and the cell, so that there is one root at most. Newton's
    result counts only with a residual of zero inside T and the cell; else the sign of the slope along the
    foot, monotone here, says whether a root exists, and bisection finds it.
    """
    curves = pair.curves
    if cell[S0] != cell[S1]:
        state.n_normals += 1
        t = _normal_to_piece(curves, part, cell, work)
        if math.isnan(t):
            return
    else:
        state.n_ends += 1
        at_start = _slope_at_foot(curves, part.piece, part.t0, cell, work)
        t = _bisected_normal(curves, part, cell, at_start, work)
    _offer(pair, part.piece, t, cell, state, work)


class _Cells(NamedTuple):
    """How much farther a point of A's piece `i` is from one cell than from another, signed to rise."""

    i: int
    sign: float


@value_at.register
def _(function: _Cells, arrays, t):
    curves, one, two, work = arrays
    d, _ = _distance_to_cell(curves, function.i, t, one, work)
    e, _ = _distance_to_cell(curves, function.i, t, two, work)
    return function, function.sign * (d - e), 1e-16 * (d + e)


@inline
def try_bisector(pair, part, one, two, state, work):
    """System (13): the one point of T that is equally far from two cells, if there is one (regula falsi)."""
    state.n_bisectors += 1
    i, arrays = part.piece, (pair.curves, one, two, work)
    _, f_low, _ = value_at(_Cells(i, 1.0), arrays, part.t0)
    _, f_high, _ = value_at(_Cells(i, 1.0), arrays, part.t1)
    if f_low * f_high > 0.0 or f_low == f_high:
        return
    sign = 1.0 if f_high > f_low else -1.0
    bracket = Bracket(part.t0, part.t1, sign * f_low, sign * f_high, 0)
    t, _ = root_in(bracket, _Cells(i, sign), arrays)
    _offer(pair, i, t, one, state, work)
