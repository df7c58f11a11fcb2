"""Points as a file of a scan has them. Not for: bodies made of them (`formats`)."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np


class Points(NamedTuple):
    """Points of a scan.

    Attributes:
        places: (n, 3) in the file's unit; NaN or infinity where a beam did not come back.
        notes: what reading had to decide, one line each.
        in_metres: True if the file names its units, so that the places are in metres.
    """

    places: np.ndarray
    notes: tuple[str, ...] = ()
    in_metres: bool = False
