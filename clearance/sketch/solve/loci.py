"""Loci of a point: what a condition leaves to it, a line n . p = c or a circle, and where two of them meet.

Two loci meet in at most two points; the one on the same side as in the sketch counts, so that no
branch ever flips. Not for: placing (`sketch.solve.place`).
"""

from __future__ import annotations

import math
from typing import NamedTuple

from clearance.sketch.equations import (
    FromCircle,
    FromLine,
    Lengths,
    Linear,
    MiddleOn,
    PointPoint,
)
from clearance.sketch.solve.system import PlainSystem

GRAZING = 4e-13
"""How far, relative to the squared lengths, two loci may miss each other and still count as touching."""


class Straight(NamedTuple):
    """The line nx x + ny y = c with a unit normal."""

    nx: float
    ny: float
    c: float


class Round(NamedTuple):
    """The circle about (x, y) of radius r."""

    x: float
    y: float
    r: float


Locus = Straight | Round
Place = tuple[float, float]


def _straight(nx: float, ny: float, c: float) -> Straight | None:
    length = math.hypot(nx, ny)
    return None if length == 0.0 else Straight(nx / length, ny / length, c / length)


def locus(s: PlainSystem, row: int, i: int, x: list[float]) -> Locus | None:
    """The locus of the point at variable i for an equation; None for one that does not place it."""
    e, coef, value = s.equations[row], s.coef[row], s.value[row]
    match e:
        case Linear():
            pairs = list(zip(coef, e, strict=True))
            rest = sum(c * x[k] for c, k in pairs if k >= 0 and k not in (i, i + 1))
            a, b = (sum(c for c, k in pairs if k == at) for at in (i, i + 1))
            return _straight(a, b, value - rest)
        case FromLine():
            c = x[e.d] + value + coef[0] * x[e.r]
            return Straight(-math.sin(x[e.theta]), math.cos(x[e.theta]), c)
        case Lengths():
            return _of_lengths(e, value, i, x)
    if e[0] == e[2]:
        return None
    qx, qy = (x[k] for k in (e[2:4] if e[0] == i else e[:2]))  # the other of two points
    match e:
        case PointPoint():
            return Round(qx, qy, value)
        case FromCircle():
            return Round(qx, qy, coef[0] * x[e.r] + coef[1] * x[e.s] + value)
    sin, cos = math.sin(x[e.theta]), math.cos(x[e.theta])
    if isinstance(e, MiddleOn):
        return Straight(-sin, cos, 2.0 * x[e.d] + sin * qx - cos * qy)
    return Straight(cos, sin, cos * qx + sin * qy)


def _of_lengths(e: Lengths, k: float, i: int, x: list[float]) -> Locus | None:
    """The locus of p for |p - q| = k |u - w| or |p - q| = k |p - w| (p at i, in either pair)."""
    first, second = [e.px, e.qx], [e.ux, e.wx]
    if first == [i, i] or second == [i, i]:
        return None
    if i in first and i in second:
        q, w = (pair[1 - pair.index(i)] for pair in (first, second))
        return _in_ratio((x[q], x[q + 1]), (x[w], x[w + 1]), k)
    mine, other = (first, second) if i in first else (second, first)
    q, (u, w) = mine[1 - mine.index(i)], other
    length = math.hypot(x[u] - x[w], x[u + 1] - x[w + 1])
    if mine is second:
        return Round(x[q], x[q + 1], length / k) if k else None
    return Round(x[q], x[q + 1], k * length)


def _in_ratio(q: Place, w: Place, k: float) -> Locus | None:
    """The locus of points k times as far from q as from w."""
    (qx, qy), (wx, wy) = q, w
    if k == 1.0:
        return _straight(wx - qx, wy - qy, 0.5 * (wx * wx + wy * wy - qx * qx - qy * qy))
    g = 1.0 - k * k
    radius = k * math.hypot(qx - wx, qy - wy) / abs(g)
    return Round((qx - k * k * wx) / g, (qy - k * k * wy) / g, radius)


def nearest_on(locus: Locus, p: Place) -> Place | None:
    """The point of a line or circle that is nearest to p; None on a circle of negative radius."""
    px, py = p
    if isinstance(locus, Straight):
        gap = locus.nx * px + locus.ny * py - locus.c
        return px - gap * locus.nx, py - gap * locus.ny
    dx, dy, r = px - locus.x, py - locus.y, locus.r
    length = math.hypot(dx, dy)
    if r < 0.0:
        return None
    if length == 0.0:
        return locus.x + r, locus.y
    return locus.x + r * dx / length, locus.y + r * dy / length


def root_of(square: float, scale: float) -> float:
    """The square root, 0 for a negative number within rounding of `scale`, -1 otherwise."""
    if square >= 0.0:
        return math.sqrt(square)
    return 0.0 if square >= -GRAZING * scale else -1.0


class _Cut(NamedTuple):
    """The chord that a locus cuts off a circle: across (dx, dy) of length d, `along` from the centre that way."""

    dx: float
    dy: float
    d: float
    along: float


def _cut(circle: Round, other: Locus) -> _Cut | None:
    """See `_Cut`; None for circles about one centre."""
    if isinstance(other, Straight):
        gap = other.nx * circle.x + other.ny * circle.y - other.c
        return _Cut(other.nx, other.ny, 1.0, -gap)
    dx, dy, r = other.x - circle.x, other.y - circle.y, circle.r
    d = math.hypot(dx, dy)
    return None if d == 0.0 else _Cut(dx, dy, d, 0.5 * (d + (r - other.r) * (r + other.r) / d))


def _two_lines(first: Straight, second: Straight) -> Place | None:
    """The common point of two lines."""
    det = first.nx * second.ny - second.nx * first.ny
    if abs(det) < 1e-12:
        return None
    x = (first.c * second.ny - second.c * first.ny) / det
    return x, (first.nx * second.c - second.nx * first.c) / det


def meet(
    first: Locus, second: Locus, drawn: tuple[Locus, Locus], p: Place, turned: float
) -> Place | None:
    """The common point of two loci on the sketch's side (`turned` 1) or the other (-1); None for none.

    `drawn` are the same loci in the sketch, p the point there. Where p lies between both, the nearer one.
    """
    if isinstance(first, Straight) and isinstance(second, Straight):
        return _two_lines(first, second)
    if isinstance(first, Straight):
        first, second, drawn = second, first, drawn[::-1]
    circle, (a, b) = first, drawn
    if not (isinstance(circle, Round) and isinstance(a, Round) and type(b) is type(second)):
        return None
    cut, was, r = _cut(circle, second), _cut(a, b), circle.r
    if cut is None or r < 0.0 or (isinstance(second, Round) and second.r < 0.0):
        return None
    far = cut.d if isinstance(second, Round) else 0.0
    h = root_of((r - cut.along) * (r + cut.along), r * r + far * far)
    if h < 0.0:
        return None
    nx, ny = cut.dx / cut.d, cut.dy / cut.d
    fx, fy = circle.x + cut.along * nx, circle.y + cut.along * ny
    plus, minus = (fx - h * ny, fy + h * nx), (fx + h * ny, fy - h * nx)
    side = 0.0 if was is None else was.dx * (p[1] - a.y) - was.dy * (p[0] - a.x)
    ahead = side > 0.0 or (side == 0.0 and math.dist(plus, p) <= math.dist(minus, p))
    return plus if ahead == (turned > 0.0) else minus
