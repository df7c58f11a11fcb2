"""Checks of the numbers that shapes are made from. Not for: polygons and poses."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from clearance.errors import BadDimension

MOST_SECTIONS = 20_000
"""More sides than this are refused: a typing error, or a tolerance too fine for any use."""


def positive(value: float, field: str) -> float:
    """The value as a float above 0.

    Raises:
        BadDimension: not a finite number above 0.
    """
    number = _number(value, field)
    if not 0.0 < number < np.inf:
        raise BadDimension(
            f"{number:.9g} is given", where=field, valid="a finite number above 0 [m]"
        )
    return number


def at_least_zero(value: float, field: str) -> float:
    """The value as a float, 0 or more."""
    number = _number(value, field)
    if not 0.0 <= number < np.inf:
        raise BadDimension(
            f"{number:.9g} is given", where=field, valid="a finite number, 0 or more [m]"
        )
    return number


def _number(value: float, field: str) -> float:
    try:
        return float(value)
    except (TypeError, ValueError):
        raise BadDimension(f"{value!r:.60} is not a number", where=field) from None


def three_positive(size: Sequence[float], field: str) -> np.ndarray:
    """(3,) the sizes along x, y, z.

    Raises:
        BadDimension: not three finite numbers above 0.
    """
    try:
        sizes = list(size)
    except TypeError:
        sizes = []
    if len(sizes) != 3:
        raise BadDimension(f"{size!r:.60} is given", where=field, valid="three numbers above 0 [m]")
    return np.array([positive(x, field) for x in sizes])


def sections_for(radius: float, tolerance: float, sections: int | None) -> int:
    """How many sides a regular polygon round a circle needs: `sections` if given, else by the tolerance.

    The polygon's corners stand radius (1 / cos(pi / n) - 1) outside the circle.

    Raises:
        BadDimension: fewer than 3 sides, or more than `MOST_SECTIONS`.
    """
    if sections is not None:
        if not isinstance(sections, int | np.integer) or not 3 <= sections <= MOST_SECTIONS:
            raise BadDimension(
                f"{sections!r:.60} is given",
                where="sections",
                valid=f"a whole number, 3 to {MOST_SECTIONS}",
            )
        return int(sections)
    with np.errstate(over="ignore"):
        ratio = 0.999999 * positive(tolerance, "tolerance") / radius  # allows for the push by ulps
    ratio = min(ratio, 1e300)  # it overflows for a radius of 1e-320
    # cos(x) = 1 / (1 + ratio), written as sin(x / 2)^2 so that a small ratio loses no digits
    half_angle = 2.0 * np.arcsin(np.sqrt(0.5 * ratio / (1.0 + ratio)))
    n = max(8, int(np.ceil(np.pi / half_angle)))
    if n > MOST_SECTIONS:
        raise BadDimension(
            f"{tolerance:.9g} needs {n} sides for radius {radius:.9g}",
            where="tolerance",
            valid=f"at most {MOST_SECTIONS} sides",
        )
    return n
