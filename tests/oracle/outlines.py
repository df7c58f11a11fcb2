"""Whether points lie inside closed chains of lines and arcs, in rational arithmetic.

A contour is rows of x, y, bulge (tangent of a quarter of the sweep, below 1). The ring of the chords is tested
by parity; each arc adds or takes away the cap between its chord and its circle.
"""

from fractions import Fraction


def inside(point, contours):
    """True if `point` is inside by parity; points on the boundary may be either."""
    x, y = Fraction(point[0]), Fraction(point[1])
    odd = False
    for rows in contours:
        n = len(rows)
        for i in range(n):
            a = tuple(map(Fraction, rows[i]))
            b = tuple(map(Fraction, rows[(i + 1) % n]))
            odd ^= _right_of_point(x, y, a, b) ^ _in_cap(x, y, a, b)
    return odd


def _right_of_point(x, y, a, b):
    """True if the level ray to the right of the point meets the chord from a to b."""
    if (a[1] > y) == (b[1] > y):
        return False
    return a[0] + (y - a[1]) * (b[0] - a[0]) / (b[1] - a[1]) > x


def _in_cap(x, y, a, b):
    bulge = a[2]
    if bulge == 0:
        return False
    dx, dy = b[0] - a[0], b[1] - a[1]
    side = dx * (y - a[1]) - dy * (x - a[0])
    if side * bulge >= 0:  # the arc is on the right of its chord where it turns left
        return False
    lift = (1 - bulge * bulge) / (4 * bulge)
    cx, cy = (a[0] + b[0]) / 2 - dy * lift, (a[1] + b[1]) / 2 + dx * lift
    return (x - cx) ** 2 + (y - cy) ** 2 < (a[0] - cx) ** 2 + (a[1] - cy) ** 2
