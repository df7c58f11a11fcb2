"""Padding: by how much the clearance of a body is lessened, as a distance, not by moving its surface."""

from __future__ import annotations

import math

from clearance.errors import BadDimension


def checked_padding(padding: float) -> float:
    """The padding [m].

    Raises:
        BadDimension: it is not a number, or below 0.
    """
    if not (isinstance(padding, int | float) and 0.0 <= padding < math.inf):
        raise BadDimension(f"padding is {padding!r:.60}", valid="0 m or more")
    return float(padding)
