"""Several curves as one: in a chain, or as contours beside each other. Not for: contours that must close."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from clearance.planar.assembly import CurveFields, assembled
from clearance.planar.curve_facts import CurveFacts
from clearance.planar.entries import BadCurve
from clearance.tolerance import MEETING


def joined(parts: Sequence[CurveFacts], *, together: bool) -> CurveFields:
    """Several curves as one: `together` as one contour, each starting where the last ended.

    Raises: BadCurve where two parts do not meet, or there is none.
    """
    parts = list(parts)
    if not parts or not all(isinstance(part, CurveFacts) for part in parts):
        raise BadCurve(f"{len(parts)} parts", where="parts", valid="a list of at least one Curve")
    at, n_contours = 0.0, 0
    rows: list[np.ndarray] = []
    limits: list[np.ndarray] = []
    contours: list[np.ndarray] = []
    for k, part in enumerate(parts):
        cartesian = part.pieces.control.copy()
        cartesian[:, :2] = cartesian[:, :2] / cartesian[:, 2:] + (part.origin - parts[0].origin)
        if together and k and not _meets(rows[-1][-1], cartesian[0], part.size):
            gap = float(np.hypot(*(rows[-1][-1] - cartesian[0])[:2]))
            raise BadCurve(
                f"part {k} starts {gap:g} away from the end of part {k - 1}",
                where="parts",
                valid="parts that meet; use Curve.contours for several contours",
            )
        rows.append(cartesian)
        limits.append(part.limits - part.limits[0, 0] + at)
        at = limits[-1][-1, 1]
        contours.append(np.zeros_like(part.contour) if together else part.contour + n_contours)
        n_contours += int(part.contour[-1]) + 1
    sizes = np.concatenate([np.diff(part.pieces.first) for part in parts])
    first = np.concatenate([[0], np.cumsum(sizes)])
    contour = np.concatenate(contours)
    return assembled(np.concatenate(rows), first, np.concatenate(limits), contour, parts[0].origin)


def _meets(end: np.ndarray, start: np.ndarray, size: float) -> bool:
    return bool(np.hypot(*(end - start)[:2]) <= MEETING * size)
