"""Compiled nearest point of a curve: certified, complete, through the tree of arcs.

An arc says where the curve may be nearest (its distance less its error is a lower bound); within such a
leaf the Bernstein form of the squared distance decides: a part whose coefficients all lie above the best
is out, a part on which the derivative rises has one minimum, found by Newton's method, anything else is
halved. Not for: distances between two curves.
"""

import math
from typing import NamedTuple

import numpy as np

from clearance.compile.declared import Floats3
from clearance.compile.decorators import inline, kernel
from clearance.kernels.curve.arc import EPS, ROUNDOFF, S0, S1, arc_distance
from clearance.kernels.curve.arc_fit import BUCKET, Leaves
from clearance.kernels.curve.bernstein import cubic_square
from clearance.kernels.curve.bezier import CHOOSE, Pieces, cut, hypotenuse, jet
from clearance.kernels.curve.boxes import cut_sq, nearest_in, with_bucket
from clearance.kernels.curve.scratch import MAP

DEEPEST = 60
SETTLED = 1e-9
"""A Newton step so short that the next, of the order of its square, would be rounding."""


class Foot(NamedTuple):
    """The nearest point of a curve: its distance, a proven lower bound of it, the leaf, piece and parameter."""

    distance: float
    lower: float
    leaf: int
    piece: int
    local: float


@inline
def rising_slope(points, n, rational, work):
    """Half the squared distance's slope, by Bernstein coefficients, as to the parameter of `points`.

    `points` are homogeneous about the query point. For rational pieces the slope is taken times w^3, which
    has the same sign and root. Returns (slope at 0, slope at 1, least slope, greatest slope, least rise).
    """
    if n == 3 and not rational:
        return _cubic_slope(points)
    q, d, g = work[0], work[1], work[2]
    for k in range(n + 1):
        for c in range(3):
            q[k, c] = CHOOSE[n, k] * points[k, c]
    for k in range(n):
        for c in range(3):
            d[k, c] = n * CHOOSE[n - 1, k] * (points[k + 1, c] - points[k, c])
    m = 2 * n - 1
    for k in range(m + 1):  # <q, q'>, scaled
        value = 0.0
        for i in range(max(0, k - n + 1), min(n, k) + 1):
            value += q[i, 0] * d[k - i, 0] + q[i, 1] * d[k - i, 1]
        g[k, 0] = value
    if rational:
        m = _rational_slope(q, d, g, n)
    rise, least, most = np.inf, g[0, 0], g[0, 0]
    before = g[0, 0]
    for k in range(1, m + 1):
        value = g[k, 0] / CHOOSE[m, k]
        rise = min(rise, value - before)
        least, most = min(least, value), max(most, value)
        before = value
    return g[0, 0], g[m, 0], least, most, m * rise


@inline
def _cubic_slope(points):
    """`rising_slope` of a polynomial cubic, written out."""
    ax, ay, bx, by = points[0, 0], points[0, 1], points[1, 0], points[1, 1]
    cx, cy, dx, dy = points[2, 0], points[2, 1], points[3, 0], points[3, 1]
    ux, uy, vx, vy, wx, wy = bx - ax, by - ay, cx - bx, cy - by, dx - cx, dy - cy
    a, f = 3.0 * (ax * ux + ay * uy), 3.0 * (dx * wx + dy * wy)
    b = 1.2 * (ax * vx + ay * vy) + 1.8 * (bx * ux + by * uy)
    c = 0.3 * (ax * wx + ay * wy) + 1.8 * (bx * vx + by * vy) + 0.9 * (cx * ux + cy * uy)
    d = 0.9 * (bx * wx + by * wy) + 1.8 * (cx * vx + cy * vy) + 0.3 * (dx * ux + dy * uy)
    e = 1.8 * (cx * wx + cy * wy) + 1.2 * (dx * vx + dy * vy)
    rise = min(min(b - a, c - b), min(d - c, min(e - d, f - e)))
    least = min(min(a, b), min(min(c, d), min(e, f)))
    most = max(max(a, b), max(max(c, d), max(e, f)))
    return a, f, least, most, 5.0 * rise


@inline
def _rational_slope(q, d, g, n):
    """Turns <q, q'> in column 0 of `g` into <q, q'> w - <q, q> w', scaled; returns its degree."""
    for k in range(2 * n + 1):
        value = 0.0
        for i in range(max(0, k - n), min(n, k) + 1):
            value += q[i, 0] * q[k - i, 0] + q[i, 1] * q[k - i, 1]
        g[k, 1] = value
    m = 3 * n - 1
    for k in range(m + 1):
        value = 0.0
        for i in range(max(0, k - n), min(2 * n - 1, k) + 1):
            value += g[i, 0] * q[k - i, 2]
        for i in range(max(0, k - n + 1), min(2 * n, k) + 1):
            value -= g[i, 1] * d[k - i, 2]
        g[k, 2] = value
    for k in range(m + 1):
        g[k, 0] = g[k, 2]
    return m


@inline
def least_square(points, n, rational, out):
    """The least Bernstein coefficient of the squared distance from the origin, and the largest |point|^2."""
    least, reach = np.inf, 0.0
    if n == 3 and not rational:
        degree = cubic_square(points, out)
        for k in range(degree + 1):
            least = min(least, out[k, 0])
        for k in range(4):
            reach = max(reach, points[k, 0] ** 2 + points[k, 1] ** 2)
        return least, reach
    for k in range(2 * n + 1):
        value, weight = 0.0, 0.0
        for i in range(max(0, k - n), min(n, k) + 1):
            j = k - i
            c = CHOOSE[n, i] * CHOOSE[n, j]
            value += c * (points[i, 0] * points[j, 0] + points[i, 1] * points[j, 1])
            weight += c * points[i, 2] * points[j, 2]
        least = min(least, value / weight)
    for k in range(n + 1):
        square = points[k, 0] ** 2 + points[k, 1] ** 2
        reach = max(reach, square / points[k, 2] ** 2)
    return least, reach


@inline
def _slopes(pieces, i, x, y, t):
    """Of half the squared distance from (x, y) to piece `i` at `t`: its slope, its bend, and the speed squared."""
    here = jet(pieces, i, t)
    ex, ey = here.x - x, here.y - y
    speed_sq = here.dx * here.dx + here.dy * here.dy
    return ex * here.dx + ey * here.dy, speed_sq + ex * here.ddx + ey * here.ddy, speed_sq


@inline
def slide_to_foot(pieces, i, x, y, t, low, high):
    """A local minimum of the distance from (x, y) to piece `i` on [low, high], from `t` on.

    Newton's method on the slope, held to the interval; a descent where the distance is not convex. Any
    result is a point of the curve: callers that need more prove it themselves.
    """
    for _ in range(12):
        slope, bend, speed_sq = _slopes(pieces, i, x, y, t)
        if bend < 0.02 * speed_sq:
            bend = max(speed_sq, -bend)
        if bend == 0.0:
            break
        moved = min(high, max(low, t - slope / bend))
        done = abs(moved - t) <= SETTLED
        t = moved
        if done:
            break
    return t


@inline
def _foot_between(pieces, i, x, y, t, low, high):
    """The root of the slope on [low, high], where it rises from negative to positive: Newton in a bracket."""
    for _ in range(60):
        slope, bend, _ = _slopes(pieces, i, x, y, t)
        if slope > 0.0:
            high = t
        else:
            low = t
        moved = t - slope / bend
        if not (bend > 0.0 and low <= moved <= high):
            moved = 0.5 * (low + high)
        done = abs(moved - t) <= SETTLED
        t = moved
        if done:
            break
    return t


@inline
def _cut_about(pieces, i, a, b, x, y, points):
    """Writes the control points of piece `i` on [a, b] about (x, y); returns their degree."""
    n = cut(pieces, i, a, b, points)
    for k in range(n + 1):
        points[k, 0] -= x * points[k, 2]
        points[k, 1] -= y * points[k, 2]
    return n


@inline
def _distance_at(pieces, i, x, y, t):
    """The distance from (x, y) to the point of piece `i` at `t`."""
    here = jet(pieces, i, t)
    return hypotenuse(here.x - x, here.y - y)


@inline
def _foot_where_rising(pieces, i, x, y, a, b, slope, points, n):
    """Where the distance is least on [a, b], if its square's slope rises there: (t, distance, lower bound).

    `slope` is what `rising_slope` gives for `points`, the control points about (x, y).

    Many arguments: it is inlined into its one caller, whose locals they are.
    """
    at_a, at_b, _, _, rise = slope
    t = a if at_a >= 0.0 else b
    if at_a < 0.0 < at_b:
        t = _foot_between(pieces, i, x, y, a + (b - a) * at_a / (at_a - at_b), a, b)
    here = jet(pieces, i, t)
    distance = hypotenuse(here.x - x, here.y - y)
    defect = _newton_defect_sq(here, x, y, t, a, b, rise, points, n)
    return t, distance, math.sqrt(max(0.0, distance * distance - defect))


@inline
def closest_on(pieces, i, s0, s1, x, y, best, work):
    """The nearest point of piece `i` on [s0, s1]: (distance, lower bound, parameter), if below `best`.

    Else (inf, lower bound above `best` less rounding, s0). `work` is (6, k, 3).
    """
    start = pieces.first[i]
    rational = pieces.rational[i]
    if pieces.first[i + 1] - start == 2 and not rational:
        return _closest_on_line(pieces.control, start, s0, s1, x, y)
    points, stack = work[0], work[1]
    stack[0, 0], stack[0, 1] = s0, s1
    top, found, lower, where = 1, best, np.inf, s0
    fine = (
        -1.0
    )  # what the points' rounding is relative to: those of the whole, not of ever smaller parts
    while top > 0:
        top -= 1
        a, b = stack[top, 0], stack[top, 1]
        n = _cut_about(pieces, i, a, b, x, y, points)
        least, reach = least_square(points, n, rational, work[2])
        fine = math.sqrt(reach) if fine < 0.0 else fine
        slack = (n + 8.0) * ROUNDOFF * reach  # of 2 n + 1 sums of products, each term below `reach`
        if least - slack > found * found:
            continue
        slope = rising_slope(points, n, rational, work[2:5])
        _, _, falling, climbing, rise = slope
        if falling >= 0.0 or climbing <= 0.0:
            t = a if falling >= 0.0 else b
            distance = _distance_at(pieces, i, x, y, t)
            lower = min(lower, distance)
            if distance < found:
                found, where = distance, t
            continue
        if rise > 0.0:
            t, distance, below = _foot_where_rising(pieces, i, x, y, a, b, slope, points, n)
            if distance < found:
                found, where = distance, t
            if distance - below <= 4.0 * ROUNDOFF * fine or b - a < 1e-14:
                lower = min(lower, below)
                continue
        middle = 0.5 * (a + b)
        distance = _distance_at(pieces, i, x, y, middle)
        if distance < found:
            found, where = distance, middle
        if least >= found * found - slack or top + 2 >= DEEPEST or b - a < 1e-14:
            lower = min(lower, math.sqrt(max(0.0, least - slack)))
            continue
        stack[top, 0], stack[top, 1] = middle, b
        stack[top + 1, 0], stack[top + 1, 1] = a, middle
        top += 2
    if found < best:
        return found, min(lower, found), where
    return np.inf, lower, s0


@inline
def _closest_on_line(control, start, s0, s1, x, y):
    x0, y0 = control[start, 0] / control[start, 2], control[start, 1] / control[start, 2]
    x1, y1 = (
        control[start + 1, 0] / control[start + 1, 2],
        control[start + 1, 1] / control[start + 1, 2],
    )
    dx, dy = x1 - x0, y1 - y0
    length_sq = dx * dx + dy * dy
    t = s0
    if length_sq > 0.0:
        t = min(s1, max(s0, ((x - x0) * dx + (y - y0) * dy) / length_sq))
    u = 1.0 - t
    distance = hypotenuse(u * x0 + t * x1 - x, u * y0 + t * y1 - y)
    return distance, distance, t


@inline
def _newton_defect_sq(here, x, y, t, a, b, rise, points, n):
    """How much the square of the distance may fall below that of the point `here`, at most.

    With H = half the square's slope times w^3, by the parameter of `points`: H rises by at least `rise`, so
    its root is |H| / rise away, and on the way the half square falls by at most |H| / min w^3 a unit.

    Many arguments: a point, an interval and its control points, which stand together nowhere else.
    """
    slope = (here.x - x) * here.dx + (here.y - y) * here.dy
    if (t == a and slope >= 0.0) or (t == b and slope <= 0.0):
        return 0.0
    least, most = points[0, 2], points[0, 2]
    for k in range(1, n + 1):
        least, most = min(least, points[k, 2]), max(most, points[k, 2])
    height = abs(slope) * (b - a) * most**3
    return 2.0 * (height / rise) * (height / least**3)


class _NearestFoot(NamedTuple):
    """The nearest point so far: as `Foot`, and the leaf that was tried first."""

    distance: float
    lower: float
    leaf: int
    local: float
    hint: int


@cut_sq.register
def _(best: _NearestFoot):
    return best.distance * best.distance


@with_bucket.register
def _(best: _NearestFoot, arrays, bucket, x, y):
    pieces, leaves, work = arrays
    distance, lower, leaf, local, hint = best
    for k in range(bucket * BUCKET, min(leaves.arcs.shape[0], (bucket + 1) * BUCKET)):
        row = leaves.arcs[k]
        if k == hint or arc_distance(row, x, y) - row[EPS] >= distance:
            continue
        there, below, s = closest_on(
            pieces, leaves.piece[k], row[S0], row[S1], x, y, distance, work
        )
        lower = min(lower, below)
        if there < distance:
            distance, leaf, local = there, k, s
    return _NearestFoot(distance, lower, leaf, local, hint)


@kernel
def nearest(
    pieces: Pieces, leaves: Leaves, x: float, y: float, hint: int, bound: float, work: Floats3
) -> Foot:
    """The `Foot` of (x, y) on a curve; `hint` is a leaf to try first, distances from `bound` on are not sought.

    Exactness: `lower` is proven up to the rounding of the evaluation; ties go to the first found.
    `work` is (6, k, 3), the last of it the stack of the tree.
    """
    row = leaves.arcs[hint]
    there, lower, local = closest_on(
        pieces, leaves.piece[hint], row[S0], row[S1], x, y, bound, work
    )
    best = _NearestFoot(min(there, bound), lower, hint, local, hint)
    # the stack is where no map is made meanwhile
    best = nearest_in(leaves.boxes, x, y, best, (pieces, leaves, work), work[MAP])
    lower = min(best.lower, best.distance)
    return Foot(best.distance, lower, best.leaf, leaves.piece[best.leaf], best.local)
