"""Compiled roots of the systems (11) to (13) near given parameters: feet that slide along the curves.

Not for: proving that a root is the only one (`hausdorff.single_roots`).
"""

import math

from clearance.compile.decorators import inline, kernel
from clearance.kernels.curve.bezier import hypotenuse, jet
from clearance.kernels.curve.nearest import slide_to_foot
from clearance.kernels.curve.pair import CurvePart, Curves
from clearance.kernels.hausdorff.bracket import (
    MOST_STEPS,
    NARROWEST,
    Bracket,
    narrowed,
    secant,
)


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


@kernel
def self_bisector(
    curves: Curves, i: int, t_one: float, t_two: float, j: int, s: float, k: int, r: float
) -> float:
    """Where A between two parameters is equally far from two branches of B: system (13), regula falsi.

    At `t_one` the branch (j, s) is the nearer, at `t_two` the branch (k, r). Feet are followed by Newton's
    method, so that the first two equations hold at every step. nan where the branches do not cross.
    """
    _, d_one = slide_from(curves, i, t_one, j, s)
    _, e_one = slide_from(curves, i, t_one, k, r)
    s, d_two = slide_from(curves, i, t_two, j, s)
    r, e_two = slide_from(curves, i, t_two, k, r)
    bracket = Bracket(t_one, t_two, d_one - e_one, d_two - e_two, 0)
    if not (bracket.f_low <= 0.0 and bracket.f_high >= 0.0) or bracket.f_low == bracket.f_high:
        return math.nan
    t = t_two
    for _ in range(MOST_STEPS):
        t = secant(bracket)
        s, d = slide_from(curves, i, t, j, s)
        r, e = slide_from(curves, i, t, k, r)
        f = d - e
        if abs(f) <= 1e-16 * (d + e) or abs(bracket.high - bracket.low) <= NARROWEST:
            break
        bracket = narrowed(bracket, t, f, f > 0.0)
    return t
