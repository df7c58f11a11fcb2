"""Compiled upper bound by a map of higher order: |A(t) - B(s(t))| with a polynomial s through several feet.

With s affine the two points drift apart along the curves by the square of the part's length, and where the
curves nearly coincide that drift is the bound. A polynomial of degree k through k + 1 feet leaves a drift of
order k + 1. B(s(t)) is composed in Bernstein form: every product weighs with numbers of [0, 1], so that no
digit is lost, and any s with coefficients in [0, 1] gives a proven bound. Both parts are moved to an end of
B's part first, so that rounding is relative to the parts. Not for: choosing the parts.
Source: DeRose, Composing Bézier simplexes (1988), for the composition.
"""

import math
from typing import NamedTuple

import numpy as np

from clearance.compile.decorators import inline
from clearance.kernels.curve.arc import ROUNDOFF
from clearance.kernels.curve.bernstein import greatest
from clearance.kernels.curve.bezier import CHOOSE, cut, hypotenuse
from clearance.kernels.curve.scratch import LARGEST_DEGREE, MAP, PART_A, PART_B, SQUARES

HIGHEST_ORDER = 5


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


class MapFeet(NamedTuple):
    """The feet on piece `piece` of B that a map of degree `order` goes through.

    Attributes:
        at: (order + 1,) their parameters, for the places SHARES[order] of A's part.
    """

    piece: int
    order: int
    at: np.ndarray


@inline
def order_for(n, m):
    """The highest degree of a map for a part of A of degree `n`, one of B of degree `m`; below 2 none serves."""
    return min(HIGHEST_ORDER, (LARGEST_DEGREE - n) // m)


@inline
def least_order(bend, length, fine, most):
    """The degree of a map that likely leaves a drift below `fine`, at most `most`.

    `bend` is how far the middle foot is off the middle, as a share of the `length` between the outer feet; the
    terms of the feet's map fall about as its powers.
    """
    left = length * 2.0 * bend
    for order in range(2, most):
        left *= 2.0 * bend
        if left <= fine:
            return order
    return most


@inline
def _set_map(feet, curve_map):
    """Writes the map's coefficients into columns 0 (times s) and 1 (times 1 - s) of `curve_map`, scaled.

    They are relative to the stretch [low, high] that they span, which is returned.
    """
    order, low, high = feet.order, 1.0, 0.0
    for r in range(order + 1):
        value = 0.0
        for c in range(order + 1):
            value += COEFFICIENTS[order, r, c] * feet.at[c]
        value = min(1.0, max(0.0, value))
        curve_map[r, 0] = value
        low, high = min(low, value), max(high, value)
    for r in range(order + 1):
        share = (curve_map[r, 0] - low) / (high - low) if high > low else 0.0
        share = min(1.0, max(0.0, share))
        curve_map[r, 0] = CHOOSE[order, r] * share
        curve_map[r, 1] = CHOOSE[order, r] * (1.0 - share)
    return low, high


@inline
def _compose(composed, n, curve_map, order, columns):
    """Turns the points composed[:n + 1, :, 0] into the scaled coefficients composed[0] of degree n times order.

    De Casteljau's scheme with a polynomial for its ratio; row n + 1 is work space.
    """
    degree, made = 0, composed[n + 1]
    for level in range(1, n + 1):
        for i in range(n + 1 - level):
            one, two = composed[i], composed[i + 1]
            made[:columns, : degree + order + 1] = 0.0
            for k in range(order + 1):
                share, rest = curve_map[k, 0], curve_map[k, 1]
                for c in range(columns):
                    for r in range(degree + 1):
                        made[c, r + k] += rest * one[c, r] + share * two[c, r]
            one[:columns, : degree + order + 1] = made[:columns, : degree + order + 1]
        degree += order
    return degree


@inline
def _relative(points, n, x, y):
    """Takes (x, y) off the points; returns the largest coordinate left."""
    reach = 0.0
    for k in range(n + 1):
        points[k, 0] -= x * points[k, 2]
        points[k, 1] -= y * points[k, 2]
        reach = max(reach, max(abs(points[k, 0]), abs(points[k, 1])) / points[k, 2])
    return reach


@inline
def _raised(row, degree, to, made):
    """Raises the scaled coefficients in `row` to the degree `to`, into the same row."""
    if to == degree:
        return
    made[: to + 1] = 0.0
    for k in range(to - degree + 1):
        factor = CHOOSE[to - degree, k]
        for r in range(degree + 1):
            made[r + k] += factor * row[r]
    row[: to + 1] = made[: to + 1]


@inline
def _gaps(one, n, two, m, rational, gap):
    """Scaled coefficients of one - two into `gap`, with its weight where rational; returns their degree."""
    if not rational:
        degree = max(n, m)
        for c in range(2):
            _raised(one[c], n, degree, gap[2])
            _raised(two[c], m, degree, gap[2])
            for r in range(degree + 1):
                gap[c, r] = one[c, r] - two[c, r]
        return degree
    gap[:, : n + m + 1] = 0.0
    for k in range(n + 1):
        x, y, w = one[0, k], one[1, k], one[2, k]
        for r in range(m + 1):
            gap[0, r + k] += x * two[2, r] - two[0, r] * w
            gap[1, r + k] += y * two[2, r] - two[1, r] * w
            gap[2, r + k] += w * two[2, r]
    return n + m


@inline
def _largest_sq(gap, degree, rational):
    """The largest squared coefficient, which bounds the square, and its index."""
    largest, which = 0.0, 0
    for r in range(degree + 1):
        weight = gap[2, r] if rational else CHOOSE[degree, r]
        square = (gap[0, r] ** 2 + gap[1, r] ** 2) / weight**2
        if square > largest:
            largest, which = square, r
    return largest, which


@inline
def _squares(gap, degree, rational, out):
    """Bernstein coefficients (or their ratios) of the squared length of `gap`, scaled, into out[:, 0]."""
    for r in range(2 * degree + 1):
        square, weight = 0.0, 0.0
        low = max(0, r - degree)
        for k in range(low, (r + 1) // 2):
            square += 2.0 * (gap[0, k] * gap[0, r - k] + gap[1, k] * gap[1, r - k])
            weight += 2.0 * gap[2, k] * gap[2, r - k]
        if r % 2 == 0:
            square += gap[0, r // 2] ** 2 + gap[1, r // 2] ** 2
            weight += gap[2, r // 2] ** 2
        out[r, 0] = square / (weight if rational else CHOOSE[2 * degree, r])
    return 2 * degree


@inline
def follow_bound(curves, part, feet, enough, work):
    """A proven upper bound of the distance of a part of A to B, where it is largest, and its rounding.

    The largest coefficient itself will do where it is below `enough`; else the squares' coefficients are the
    bound. Returns (bound, share of the part, rounding), (inf, 0, 0) where the feet span nothing.

    Args:
        feet: `MapFeet`. work: `SearchScratch`.
    """
    planes, composed, order = work.planes, work.composed, feet.order
    p, q, curve_map = planes[PART_A], planes[PART_B], planes[MAP]
    low, high = _set_map(feet, curve_map)
    if not high > low:
        return np.inf, 0.0, 0.0
    n = cut(curves.a, part.piece, part.t0, part.t1, p)
    m = cut(curves.b, feet.piece, low, high, q)
    x, y = q[0, 0] / q[0, 2], q[0, 1] / q[0, 2]
    reach = _relative(q, m, x, y)
    reach = max(reach, _relative(p, n, x - curves.shift_x, y - curves.shift_y))
    rational = curves.a.rational[part.piece] or curves.b.rational[feet.piece]
    columns = 3 if rational else 2
    gap, own = composed[m + 2], composed[m + 1]
    for c in range(columns):
        for k in range(m + 1):
            composed[k, c, 0] = q[k, c]
    degree = _compose(composed, m, curve_map, order, columns)
    for c in range(columns):
        for k in range(n + 1):
            own[c, k] = CHOOSE[n, k] * p[k, c]
    # each of m levels sums 2 (order + 1) products, the common degree one more run
    degree = _gaps(own, n, composed[0], degree, rational, gap)
    rounding = 2.0 * ROUNDOFF * reach * (m * (2 * order + 6) + 2 * degree + 16)
    largest_sq, which = _largest_sq(gap, degree, rational)
    if largest_sq <= enough * enough:
        return math.sqrt(largest_sq), which / degree, rounding
    degree = _squares(gap, degree, rational, planes[SQUARES])
    most, which = greatest(planes[SQUARES], degree)
    bound = math.sqrt(most)
    # half as many terms as the gap's degree in each sum, as many in the weights', and a few operations more
    rounding += math.sqrt(most + ROUNDOFF * (degree // 2 + 12) * largest_sq) - bound
    return bound, which / degree, rounding


@inline
def drift(off, distance):
    """What a drift of `off` along the curves adds to a distance."""
    return hypotenuse(off, distance) - distance
