"""Compiled roots of the systems (11) to (13) near given parameters: feet that slide along the curves.

Not for: proving that a root is the only one (`hausdorff.single_roots`).
"""

import math
from typing import NamedTuple

from clearance.compile.decorators import inline, kernel
from clearance.kernels.curve.bezier import hypotenuse, jet
from clearance.kernels.curve.nearest import slide_to_foot
from clearance.kernels.curve.pair import CurvePart, Curves
from clearance.kernels.hausdorff.bracket import Bracket, root_in, value_at


@inline
def slide_from(curves, i, t, j, s):
    """The foot of A's point at (i, t) on piece `j` of B, followed from the parameter `s`: (s, distance)."""
    here = jet(curves.a, i, t)
    x, y = here.x + curves.shift_x, here.y + curves.shift_y
    s = slide_to_foot(curves.b, j, x, y, s, 0.0, 1.0)
    there = jet(curves.b, j, s)
    return s, hypotenuse(there.x - x, there.y - y)


@kernel
def common_normal(
    curves: Curves, part: CurvePart, t: float, j: int, s: float
) -> tuple[float, float]:
    """A root (t, s) of system (12) near the given one, held to A's `part` and to [0, 1]: Newton's method.

    Where the foot stands at an end of B's piece, s stays and the root is that of (11): the end's normal to A.
    """
    for _ in range(10):
        a, b = jet(curves.a, part.piece, t), jet(curves.b, j, s)
        ex, ey = a.x + curves.shift_x - b.x, a.y + curves.shift_y - b.y
        f, g = ex * a.dx + ey * a.dy, ex * b.dx + ey * b.dy
        f_t = a.dx * a.dx + a.dy * a.dy + ex * a.ddx + ey * a.ddy
        cross = a.dx * b.dx + a.dy * b.dy
        g_s = ex * b.ddx + ey * b.ddy - b.dx * b.dx - b.dy * b.dy
        if (s == 0.0 and g <= 0.0) or (s == 1.0 and g >= 0.0):
            g, cross, g_s = 0.0, 0.0, 1.0
        determinant = f_t * g_s + cross * cross
        if determinant == 0.0:
            break
        dt = -(f * g_s + g * cross) / determinant
        ds = -(f_t * g - cross * f) / determinant
        moved, slid = min(part.t1, max(part.t0, t + dt)), min(1.0, max(0.0, s + ds))
        done = abs(moved - t) <= 1e-16 and abs(slid - s) <= 1e-16
        t, s = moved, slid
        if done:
            break
    return t, s


class _Branches(NamedTuple):
    """How much farther a point of A's piece `i` is from one branch of B than from another, both followed."""

    i: int
    j: int
    s: float
    k: int
    r: float


@value_at.register
def _(function: _Branches, curves, t):
    s, d = slide_from(curves, function.i, t, function.j, function.s)
    r, e = slide_from(curves, function.i, t, function.k, function.r)
    return _Branches(function.i, function.j, s, function.k, r), d - e, 1e-16 * (d + e)


@kernel
def self_bisector(
    curves: Curves, i: int, t_one: float, t_two: float, j: int, s: float, k: int, r: float
) -> float:
    """Where A between two parameters is equally far from two branches of B: system (13), regula falsi.

    At `t_one` the branch (j, s) is the nearer, at `t_two` the branch (k, r). Feet are followed by Newton's
    method, so that the first two equations hold at every step. nan where the branches do not cross.
    """
    branches = _Branches(i, j, s, k, r)
    _, f_one, _ = value_at(branches, curves, t_one)
    branches, f_two, _ = value_at(branches, curves, t_two)
    if not (f_one <= 0.0 and f_two >= 0.0) or f_one == f_two:
        return math.nan
    return root_in(Bracket(t_one, t_two, f_one, f_two, 0), branches, curves)[0]
