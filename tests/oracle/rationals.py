"""Numbers of the oracle: exact points, a common integer grid for them, vectors of integers and the
root.

All floats are dyadic, so a set of points fits a grid of step 1 / scale. Everything else computes
with Python integers on that grid, which is many times faster than Fractions and just as exact.
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from fractions import Fraction

Point = tuple[int, int, int]


def exact_points(points: Iterable[Iterable]) -> list[tuple[Fraction, ...]]:
    """The points as triples of Fractions, each coordinate exactly the number given."""
    return [_triple(point) for point in points]


def posed(
    points: Iterable[Iterable], pose: Iterable[Iterable] | None
) -> list[tuple[Fraction, ...]]:
    """R v + t for each point, exactly; `pose` (4, 4) is taken number by number, no orthogonality
    needed."""
    exact = exact_points(points)
    if pose is None:
        return exact
    scale, (grid,) = on_grid(exact)
    turn_scale, (*rows, shift) = _whole_rows(pose)
    step = scale * turn_scale
    return [
        tuple(Fraction(dot(row, v) + t * scale, step) for row, t in zip(rows, shift, strict=True))
        for v in grid
    ]


def _whole_rows(pose: Iterable[Iterable]) -> tuple[int, list[Point]]:
    """A scale, and multiplied by it the rows of R and, after them, t."""
    rows = [[_fraction(entry) for entry in row] for row in list(pose)[:3]]
    scale, (turn, (shift,)) = on_grid([tuple(row[:3]) for row in rows], [tuple(r[3] for r in rows)])
    return scale, [*turn, shift]


def on_grid(*groups: list[tuple[Fraction, ...]]) -> tuple[int, list[list[Point]]]:
    """The least common scale of all points, and the groups of points multiplied by it."""
    scale = math.lcm(*{x.denominator for group in groups for point in group for x in point})
    scaled = [
        [tuple(x.numerator * (scale // x.denominator) for x in point) for point in group]
        for group in groups
    ]
    return scale, scaled


def minus(a: Point, b: Point) -> Point:
    """a - b."""
    return (a[0] - b[0], a[1] - b[1], a[2] - b[2])


def dot(a: Point, b: Point) -> int:
    """a · b."""
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


def cross(a: Point, b: Point) -> Point:
    """a × b."""
    return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])


def root(sq: Fraction | int, digits: int = 50) -> Fraction:
    """The square root, rounded down to `digits` significant decimal digits or better.

    Exact where the root is rational. By integer square root alone.
    """
    sq = Fraction(sq)
    if sq < 0:
        raise ValueError(f"no root of {sq}")
    exact = Fraction(math.isqrt(sq.numerator), math.isqrt(sq.denominator))
    if exact * exact == sq:
        return exact
    # 4^shift * sq has at least 2 * digits decimal digits, so its integer root has `digits` of them
    wanted_bits = math.ceil(2 * digits * math.log2(10)) + 2
    shift = max(0, (wanted_bits - sq.numerator.bit_length() + sq.denominator.bit_length()) // 2 + 1)
    return Fraction(math.isqrt((sq.numerator << (2 * shift)) // sq.denominator), 1 << shift)


def error(distance: float, sq: Fraction) -> Fraction:
    """|distance - root(sq)| with the root to 50 digits."""
    return abs(_fraction(distance) - root(sq))


def _triple(point: Iterable) -> tuple[Fraction, ...]:
    x, y, z = point
    return (_fraction(x), _fraction(y), _fraction(z))


def _fraction(number) -> Fraction:
    plain = number.item() if hasattr(number, "item") else number  # numpy scalars to Python's
    return Fraction(plain)
