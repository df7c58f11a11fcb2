"""Numbers and positions of a sketch, checked where they enter."""

from __future__ import annotations

import math
from collections.abc import Sequence

from clearance.errors import BadShape, NotFinite


def number(value: object, where: str) -> float:
    """The value as a finite float.

    Raises:
        NotFinite: it is not a number, or not finite.
    """
    try:
        out = float(value)  # type: ignore[arg-type]
    except (TypeError, ValueError, OverflowError):
        raise NotFinite(
            f"{value!r:.60} is not a number", where=where, valid="a finite number"
        ) from None
    if not math.isfinite(out):
        raise NotFinite(f"the value is {out}", where=where, valid="a finite number")
    return out


def two(position: Sequence[float], where: str) -> tuple[float, float]:
    """A position as two finite floats.

    Raises:
        BadShape: it is not a pair.
        NotFinite: one is not a finite number.
    """
    try:
        x, y = position
    except (TypeError, ValueError):
        raise BadShape(
            f"{position!r} is not a position", where=where, valid="two numbers"
        ) from None
    return number(x, where), number(y, where)
