"""The least distance of two planar curves, with a proven error and its witnesses. Not for: Hausdorff."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from clearance.kernels.hausdorff.gap import least_distance
from clearance.planar.curve import Curve
from clearance.planar.directed import placed
from clearance.tolerance import LEAST_GAP


@dataclass(frozen=True)
class Minimum:
    """The least distance of two curves; 0 where they cross or touch.

    Attributes:
        distance: the distance of the witnesses, in the curves' unit.
        error_bound: the true value is at most this far below it, proven.
        point_a, point_b: (2,) the witnesses.
        parameter_a, parameter_b: their parameters.
    """

    distance: float
    error_bound: float
    point_a: np.ndarray
    point_b: np.ndarray
    parameter_a: float
    parameter_b: float


def minimum_distance(a: Curve, b: Curve) -> Minimum:
    """The least distance between any point of `a` and any point of `b`.

    Exactness: proven, by separating directions of control polygons; `error_bound` includes rounding.
    Ties: the first found.
    """
    shift, size = placed(a, b)
    gap = LEAST_GAP * size
    found = least_distance(a.pieces, a.leaves, b.pieces, b.leaves, shift[0], shift[1], gap)
    best = dict(zip(found.dtype.names, found[0].item(), strict=True))
    margin = a.rounding + b.rounding + gap
    at_a = a.parameter_of(best["piece_a"], best["at_a"])
    at_b = b.parameter_of(best["piece_b"], best["at_b"])
    return Minimum(
        distance=best["distance"],
        error_bound=best["distance"] - max(0.0, best["lower"] - margin) + margin,
        point_a=a.point(at_a),
        point_b=b.point(at_b),
        parameter_a=at_a,
        parameter_b=at_b,
    )
