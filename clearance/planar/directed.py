"""One direction of a Hausdorff distance: from the numbers of a search to named values and witnesses.

Shared by the ways of solving (`hausdorff`, `systems`) and by all that sets two curves in one frame.
Not for: searching.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from clearance.errors import BadInput
from clearance.kernels.hausdorff.state import (
    ARCS,
    AT_A,
    AT_B,
    BISECTORS,
    CUTS,
    DISTANCE,
    ENDS,
    GIVEN_UP,
    KEPT,
    LOWER,
    NORMALS,
    PIECE_A,
    PIECE_B,
    PIXELS,
    UPPER,
)
from clearance.planar.curve import Curve

KINDS = ("end", "common_normal", "self_bisector")


@dataclass(frozen=True)
class Tally:
    """What a search did.

    Attributes:
        arcs: arcs of the curve searched.
        trimmed_arcs: arcs that trimming took away.
        pixels: pixels of the distance map.
        end_systems, normal_systems, bisector_systems: systems (11), (12), (13) solved.
        intervals: intervals bounded.
        given_up: intervals left to their bound (0 unless curves are alike without being equal).
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
class Directed:
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
    tally: Tally

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


def directed_of(
    one: Curve, two: Curve, state: list, points: np.ndarray, margin: float, forward: bool
):
    """The `Directed` of a searched curve `one`; `forward` says that it is the caller's a."""
    here, there = points[:2] + one.origin, points[2:4] + two.origin
    at_here = one.parameter_of(int(state[PIECE_A]), state[AT_A])
    at_there = two.parameter_of(int(state[PIECE_B]), state[AT_B])
    return Directed(
        distance=state[DISTANCE],
        lower=max(0.0, state[LOWER] - margin),
        upper=max(state[UPPER], state[DISTANCE]) + margin,
        point_a=here if forward else there,
        point_b=there if forward else here,
        parameter_a=at_here if forward else at_there,
        parameter_b=at_there if forward else at_here,
        kind=KINDS[int(points[4])],
        tally=_tally(state),
    )


def _tally(state: list) -> Tally:
    return Tally(
        arcs=int(state[ARCS]),
        trimmed_arcs=int(state[ARCS] - state[KEPT]),
        pixels=int(state[PIXELS]),
        end_systems=int(state[ENDS]),
        normal_systems=int(state[NORMALS]),
        bisector_systems=int(state[BISECTORS]),
        intervals=int(state[CUTS]),
        given_up=int(state[GIVEN_UP]),
    )
