"""One direction of a Hausdorff distance: from the numbers of a search to named values and witnesses.

Shared by the ways of solving (`hausdorff`, `systems`) and by all that sets two curves in one frame.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from clearance.errors import BadInput
from clearance.kernels.curve.pair import CurveArrays
from clearance.kernels.hausdorff.segments import Segments
from clearance.planar.curve import Curve

KINDS = ("end", "common_normal", "self_bisector")

COUNTED = ("pixels", "ends", "normals", "bisectors", "cuts", "given_up")
"""Fields of SEARCH_STATE, `n_` before them, that a `SearchTally` has behind its arcs."""


class SearchTally(NamedTuple):
    """The work of a search.

    Attributes:
        arcs: arcs of the curve searched.
        trimmed_arcs: arcs that trimming took away.
        pixels: pixels of the distance map.
        end_systems, normal_systems, bisector_systems: systems (11), (12), (13) solved.
        intervals: intervals bounded.
        given_up: intervals with a bound only (0 unless curves are alike without being equal).
    """

    arcs: int
    trimmed_arcs: int
    pixels: int
    end_systems: int
    normal_systems: int
    bisector_systems: int
    intervals: int
    given_up: int

    @property
    def systems(self) -> int:
        return self.end_systems + self.normal_systems + self.bisector_systems


@dataclass(frozen=True)
class DirectedDistance:
    """The distance from each point of one curve to the other curve, at its greatest.

    Attributes:
        distance: the value at the witnesses.
        lower, upper: proven bounds, rounding included.
        point_a, point_b: (2,) the witnesses on the first and on the second curve given.
        parameter_a, parameter_b: their parameters.
        kind: "end", "common_normal" or "self_bisector".
        tally: what the search did.
    """

    distance: float
    lower: float
    upper: float
    point_a: np.ndarray
    point_b: np.ndarray
    parameter_a: float
    parameter_b: float
    kind: str
    tally: SearchTally

    @property
    def error_bound(self) -> float:
        return max(self.distance - self.lower, self.upper - self.distance)


def placed(a: Curve, b: Curve) -> tuple[np.ndarray, float]:
    """The step from b's origin to a's, and the size of both curves together."""
    for name, curve in (("a", a), ("b", b)):
        if not isinstance(curve, Curve):
            raise BadInput(f"a {type(curve).__name__}", where=name, valid="a clearance Curve")
    (ax0, ay0), (ax1, ay1) = a.corners
    (bx0, by0), (bx1, by1) = b.corners
    size = math.hypot(max(ax1, bx1) - min(ax0, bx0), max(ay1, by1) - min(ay0, by0))
    return a.origin - b.origin, size


def arrays_of(curve: Curve) -> CurveArrays:
    """The curve as an argument of kernels."""
    return CurveArrays(curve.pieces, curve.leaves, curve.joints)


def segments_of(curve: Curve) -> Segments:
    """A polyline as an argument of kernels."""
    return Segments(curve.pieces, curve.segment_boxes, curve.joints)


def directed_of(
    one: Curve, two: Curve, state: np.void, points: np.ndarray, margin: float, forward: bool
) -> DirectedDistance:
    """The `DirectedDistance` of a searched curve `one`; `forward` says that it is the caller's a.

    Args:
        state: a record of SEARCH_STATE; points: (5,) its witness.
    """
    assert state.dtype.names is not None
    known = dict(zip(state.dtype.names, state.item(), strict=True))
    here, there = points[:2] + one.origin, points[2:4] + two.origin
    at_here = one.parameter_of(known["piece_a"], known["at_a"])
    at_there = two.parameter_of(known["piece_b"], known["at_b"])
    return DirectedDistance(
        distance=known["distance"],
        lower=max(0.0, known["lower"] - margin),
        upper=max(known["upper"], known["distance"]) + margin,
        point_a=here if forward else there,
        point_b=there if forward else here,
        parameter_a=at_here if forward else at_there,
        parameter_b=at_there if forward else at_here,
        kind=KINDS[int(points[4])],
        tally=SearchTally(
            known["n_arcs"],
            known["n_arcs"] - known["n_kept"],
            *(known[f"n_{name}"] for name in COUNTED),
        ),
    )
