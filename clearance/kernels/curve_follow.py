"""Compiled upper bound by a map of higher order: |A(t) - B(s(t))| with a polynomial s through several feet.

With s affine the two points drift apart along the curves by the square of the part's length, and where the
curves nearly coincide that drift is the bound. A polynomial of degree k through k + 1 feet leaves a drift of
order k + 1. B(s(t)) is composed in Bernstein form: every product weighs with numbers of [0, 1], so that no
digit is lost, and any s with coefficients in [0, 1] gives a proven bound. Both parts are moved to an end of
B's part first, so that rounding is relative to the parts. Not for: choosing the parts.
Source: DeRose, Composing Bézier simplexes (1988), for the composition.
"""

import math

import numpy as np

from clearance.jit import inlined, kernel
from clearance.kernels.curve_bernstein import greatest
from clearance.kernels.curve_bezier import CHOOSE, cut, hypotenuse

HIGHEST_ORDER = 5
LARGEST_DEGREE = 48  # of B(s(t)) and A together; binomials are at hand up to twice that
ROUNDOFF = 2.0**-53


def _feet_shares() -> np.ndarray:
    """(6, 6) row k: the places in [0, 1] of the k + 1 feet that a map of degree k goes through."""
    shares = np.zeros((HIGHEST_ORDER + 1, HIGHEST_ORDER + 1))
    for k in range(1, HIGHEST_ORDER + 1):
        shares[k, : k + 1] = 0.5 - 0.5 * np.cos(np.pi * np.arange(k + 1) / k)
    return shares


def _interpolations() -> np.ndarray:
    """(6, 6, 6) matrix k: from the values at those places to Bernstein coefficients of degree k."""
    out = np.zeros((HIGHEST_ORDER + 1, HIGHEST_ORDER + 1, HIGHEST_ORDER + 1))
    for k in range(1, HIGHEST_ORDER + 1):
        u = SHARES[k, : k + 1, None]
        basis = np.array([math.comb(k, r) for r in range(k + 1)]) * (
            u ** np.arange(k + 1) * (1.0 - u) ** (k - np.arange(k + 1))
        )
        out[k, : k + 1, : k + 1] = np.linalg.inv(basis)
    return out


SHARES = _feet_shares()
COEFFICIENTS = _interpolations()


@inlined
def order_for(n, m):
    """The degree of the map for a part of A of degree `n` and one of B of degree `m`; below 2 none is tried."""
    return min(HIGHEST_ORDER, (LARGEST_DEGREE - n) // m)


@inlined
def _set_map(feet, order, curve_map):
    """Writes the map's coefficients into columns 0 (times s) and 1 (times 1 - s) of `curve_map`, scaled.

    They are relative to the stretch [low, high] that they span, which is returned.
    """
    low, high = 1.0, 0.0
    for r in range(order + 1):
        value = 0.0
        for c in range(order + 1):
            value += COEFFICIENTS[order, r, c] * feet[c]
        value = min(1.0, max(0.0, value))
        curve_map[r, 0] = value
        low, high = min(low, value), max(high, value)
    for r in range(order + 1):
        share = (curve_map[r, 0] - low) / (high - low) if high > low else 0.0
        share = min(1.0, max(0.0, share))
        curve_map[r, 0] = CHOOSE[order, r] * share
        curve_map[r, 1] = CHOOSE[order, r] * (1.0 - share)
    return low, high


@inlined
def _compose(composed, n, curve_map, order, columns):
    """Turns the n + 1 points composed[:, 0] into the scaled coefficients composed[0] of degree n times order.

    De Casteljau's scheme with a polynomial for its ratio.
    """
    degree = 0
    for level in range(1, n + 1):
        for i in range(n + 1 - level):
            for r in range(degree + order, -1, -1):
                for c in range(columns):
                    value = 0.0
                    for k in range(max(0, r - degree), min(order, r) + 1):
                        value += curve_map[k, 1] * composed[i, r - k, c]
                        value += curve_map[k, 0] * composed[i + 1, r - k, c]
                    composed[n + 1, r, c] = value
            for r in range(degree + order + 1):
                for c in range(columns):
                    composed[i, r, c] = composed[n + 1, r, c]
        degree += order
    return degree


@inlined
def _relative(points, n, x, y):
    """Takes (x, y) off the points; returns the largest coordinate left."""
    reach = 0.0
    for k in range(n + 1):
        points[k, 0] -= x * points[k, 2]
        points[k, 1] -= y * points[k, 2]
        reach = max(reach, max(abs(points[k, 0]), abs(points[k, 1])) / points[k, 2])
    return reach


@inlined
def _raised(row, degree, to, columns, spare):
    """Raises scaled coefficients to the degree `to`."""
    if to == degree:
        return
    for r in range(to + 1):
        for c in range(columns):
            value = 0.0
            for k in range(max(0, r - degree), min(to - degree, r) + 1):
                value += CHOOSE[to - degree, k] * row[r - k, c]
            spare[r, c] = value
    for r in range(to + 1):
        for c in range(columns):
            row[r, c] = spare[r, c]


@inlined
def _gaps(one, n, two, m, rational, spare):
    """Scaled coefficients of one - two into `spare`, with its weight where rational; returns their degree."""
    if not rational:
        degree = max(n, m)
        _raised(one, n, degree, 2, spare)
        _raised(two, m, degree, 2, spare)
        for r in range(degree + 1):
            spare[r, 0], spare[r, 1] = one[r, 0] - two[r, 0], one[r, 1] - two[r, 1]
        return degree
    for r in range(n + m + 1):
        x, y, w = 0.0, 0.0, 0.0
        for k in range(max(0, r - m), min(n, r) + 1):
            x += one[k, 0] * two[r - k, 2] - two[r - k, 0] * one[k, 2]
            y += one[k, 1] * two[r - k, 2] - two[r - k, 1] * one[k, 2]
            w += one[k, 2] * two[r - k, 2]
        spare[r, 0], spare[r, 1], spare[r, 2] = x, y, w
    return n + m


@inlined
def _largest_sq(gap, degree, rational):
    """The largest squared coefficient, what rounding of their products is relative to."""
    largest = 0.0
    for r in range(degree + 1):
        weight = gap[r, 2] if rational else CHOOSE[degree, r]
        largest = max(largest, (gap[r, 0] ** 2 + gap[r, 1] ** 2) / weight**2)
    return largest


@inlined
def _squares(gap, degree, rational, out):
    """Bernstein coefficients (or their ratios) of the squared length of `gap`, scaled, into out[:, 0]."""
    for r in range(2 * degree + 1):
        square, weight = 0.0, 0.0
        for k in range(max(0, r - degree), min(degree, r) + 1):
            square += gap[k, 0] * gap[r - k, 0] + gap[k, 1] * gap[r - k, 1]
            if rational:
                weight += gap[k, 2] * gap[r - k, 2]
        out[r, 0] = square / (weight if rational else CHOOSE[2 * degree, r])
    return 2 * degree


@kernel
def follow_bound(pa, pb, i, t0, t1, j, feet, order, shift_x, shift_y, work, composed):
    """A proven upper bound of the distance of A on [t0, t1] to B, where it is largest, and its rounding.

    `feet` are parameters on piece `j` at the places SHARES[order] of [t0, t1]. Returns (bound, share of
    [t0, t1], rounding), (inf, 0, 0) where the feet span nothing.
    """
    p, q, curve_map, spare, out = work[6], work[7], work[5], work[8], work[9]
    low, high = _set_map(feet, order, curve_map)
    if not high > low:
        return np.inf, 0.0, 0.0
    n = cut(pa, i, t0, t1, p)
    m = cut(pb, j, low, high, q)
    x, y = q[0, 0] / q[0, 2], q[0, 1] / q[0, 2]
    reach = _relative(q, m, x, y)
    reach = max(reach, _relative(p, n, x - shift_x, y - shift_y))
    rational = pa.rational[i] or pb.rational[j]
    columns = 3 if rational else 2
    for k in range(m + 1):
        for c in range(columns):
            composed[k, 0, c] = q[k, c]
    degree = _compose(composed, m, curve_map, order, columns)
    for k in range(n + 1):
        for c in range(columns):
            p[k, c] *= CHOOSE[n, k]
    degree = _gaps(p, n, composed[0], degree, rational, spare)
    largest_sq = _largest_sq(spare, degree, rational)
    degree = _squares(spare, degree, rational, out)
    most, which = greatest(out, degree)
    bound = math.sqrt(most)
    # each of m levels sums 2 (order + 1) products, the common degree one more run; squares up to `degree`
    steps = m * (2 * order + 6) + degree + 16
    rounding = 2.0 * ROUNDOFF * steps * reach
    rounding += math.sqrt(most + 2.0 * ROUNDOFF * (degree + 8) * largest_sq) - bound
    return bound, which / degree, rounding


@inlined
def drift(off, distance):
    """What a drift of `off` along the curves adds to a distance."""
    return hypotenuse(off, distance) - distance
