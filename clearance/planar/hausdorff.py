"""The exact Hausdorff distance between two planar curves, with a proven error and its witnesses.

`hausdorff` measures, `within` only decides. The work is done in `kernels.hausdorff`, one direction at a time;
here its numbers get names. Not for: profiles along a curve (`deviation`), the least distance (`minimum`).
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from clearance.errors import BadInput, ClearanceError
from clearance.kernels.hausdorff.directed_curve import directed_curve
from clearance.kernels.hausdorff.polyline import directed_polyline
from clearance.kernels.hausdorff.state import SEARCH_STATE, SearchGoal
from clearance.planar.curve import Curve
from clearance.planar.directed import (
    DirectedDistance,
    SearchTally,
    arrays_of,
    directed_of,
    placed,
    segments_of,
)
from clearance.planar.entries import checked_number
from clearance.tolerance import LAST_BITS, SHARPER, TIE

BUDGET = 200_000.0
"""Intervals after which a search gives the rest up with their bounds; only the error bound suffers."""

INTERVALS_A_PIECE = 20.0
"""Further intervals of long curves for each piece of both: up to seven are seen on noisy outlines."""


SHARP_INTERVALS, SHARP_INTERVALS_A_PIECE, MOST_SHARP = 250.0, 0.5, 400.0
"""Intervals until which a search tries for the last bits; after them the given tolerance is enough."""

ASKED = 0.25
"""The share of the tolerance that a search may leave open then; the rest is for rounding."""


class UnknownMethod(BadInput):
    """A method of solution that there is not."""


class Undecided(ClearanceError):
    """Whether a distance keeps a limit could not be proven either way.

    Attributes:
        lower, upper: what is proven of the distance.
    """

    def __init__(self, lower: float, upper: float, limit: float) -> None:
        super().__init__(
            f"a distance between {lower:.6g} and {upper:.6g} against the limit {limit:.6g}",
            where="within",
            valid="a limit outside these bounds",
        )
        self.lower, self.upper = lower, upper


@dataclass(frozen=True)
class Hausdorff:
    """The Hausdorff distance of two curves: the greater of the two directed ones.

    Attributes:
        distance: the distance, in the curves' unit.
        error_bound: the true value is within this of `distance`, proven, in the same unit.
        point_a, point_b: (2,) the witnesses on a and on b.
        parameter_a, parameter_b: their parameters.
        direction: "a_to_b" or "b_to_a": which of the directed distances it is; "a_to_b" where they tie.
        kind: "end", "common_normal" or "self_bisector": systems (11), (12), (13) of Kim, Oh, Kim (2010).
        directed: both directed distances, "a_to_b" and "b_to_a".
        tally: what the search did, both directions together.
    """

    distance: float
    error_bound: float
    point_a: np.ndarray
    point_b: np.ndarray
    parameter_a: float
    parameter_b: float
    direction: str
    kind: str
    directed: dict[str, DirectedDistance]
    tally: SearchTally

    @property
    def lower(self) -> float:
        """A proven lower bound of the distance."""
        return max(one.lower for one in self.directed.values())

    @property
    def upper(self) -> float:
        """A proven upper bound of the distance."""
        return max(one.upper for one in self.directed.values())


def hausdorff(
    a: Curve, b: Curve, *, method: str = "trimmed", tolerance: float = 1e-12
) -> Hausdorff:
    """The Hausdorff distance between the curves `a` and `b`, exact up to a proven error.

    Args:
        a, b: curves of any number of contours.
        method: "trimmed" (the default: map, trimming and certificates) or "paper" (as Kim, Oh, Kim publish it:
            trimming by a page of pixels, the systems (11) to (13) on the rest, the greatest distance of *all*
            roots, which can be above the true one: `planar/PAPER.md`).
        tolerance: the error to reach, relative to the size of both curves together.

    Exactness: `error_bound` is proven for every method; by default it is above `tolerance`
        only where rounding or the budget of intervals stopped the search.
    Ties: the first found; the direction "a_to_b". Where points of different kinds reach the same distance
        (symmetric curves), the methods may name either, and `kind` and the witnesses with it.
    Raises: UnknownMethod, BadCurve, NotFinite.
    Source: Kim, Oh, Kim (2010), sections 3 and 4; Elber, Grandine (2008) for the systems.
    """
    tolerance = checked_number(tolerance, "tolerance", least=0.0)
    if method == "trimmed":
        return greater_of(*_trimmed(a, b, tolerance))
    if method != "paper":
        raise UnknownMethod(f"{method!r}", where="method", valid="'trimmed' or 'paper'")
    from clearance.planar.systems import paper

    return greater_of(*paper(a, b))


def within(a: Curve, b: Curve, distance: float) -> bool:
    """Whether the Hausdorff distance of `a` and `b` is at most `distance`; no search goes on beyond that.

    Exactness: True and False are both proven, up to rounding (below 1e-13 of the curves'
        size), within which a distance counts as equal to the limit and so as within.
    Raises: Undecided where neither could be proven; BadCurve, NotFinite.
    """
    distance = checked_number(distance, "distance", least=0.0)
    shift, size = placed(a, b)
    slack = a.rounding + b.rounding + LAST_BITS * size
    gap = LAST_BITS * size
    aim = SearchGoal(gap, gap, math.inf, distance, distance + slack, _budget(a, b))
    found, _ = _solve(a, b, shift, aim)
    lower, upper = float(found["lower"].max()), float(found["upper"].max())
    if lower > distance + slack:
        return False
    if upper > distance + TIE * size + slack:
        raise Undecided(max(0.0, lower - slack), upper + slack, distance)
    return True


def greater_of(forth: DirectedDistance, back: DirectedDistance) -> Hausdorff:
    """The `Hausdorff` of two directed distances."""
    first = forth.distance >= back.distance
    top = forth if first else back
    lower, upper = max(forth.lower, back.lower), max(forth.upper, back.upper)
    return Hausdorff(
        distance=top.distance,
        error_bound=max(top.distance - lower, upper - top.distance),
        point_a=top.point_a,
        point_b=top.point_b,
        parameter_a=top.parameter_a,
        parameter_b=top.parameter_b,
        direction="a_to_b" if first else "b_to_a",
        kind=top.kind,
        directed={"a_to_b": forth, "b_to_a": back},
        tally=SearchTally(*map(sum, zip(forth.tally, back.tally, strict=True))),
    )


def _budget(a: Curve, b: Curve) -> float:
    return BUDGET + INTERVALS_A_PIECE * (a.n_pieces + b.n_pieces)


def _solve(a: Curve, b: Curve, shift: np.ndarray, aim: SearchGoal) -> tuple[np.ndarray, np.ndarray]:
    """Both directed searches: (2,) SEARCH_STATE and witnesses (2, 5); no more once one is beyond the limit.

    Polylines are searched straight from their segments, which takes a tenth of the time.
    """
    states, points = np.zeros(2, SEARCH_STATE), np.empty((2, 5))
    straight = a.is_polyline and b.is_polyline
    search, arrays = (directed_polyline, segments_of) if straight else (directed_curve, arrays_of)
    for k, (one, two, step) in enumerate(((a, b, shift), (b, a, -shift))):
        search(arrays(one), arrays(two), step[0], step[1], aim, states[k : k + 1], points[k])
        if states["lower"][k] > aim.limit:
            states["lower"] = states["lower"][k]
            break
    return states, points


def _trimmed(a: Curve, b: Curve, tolerance: float) -> tuple[DirectedDistance, DirectedDistance]:
    shift, size = placed(a, b)
    gap = max(tolerance * SHARPER, LAST_BITS) * size
    sharp = min(MOST_SHARP, SHARP_INTERVALS + SHARP_INTERVALS_A_PIECE * (a.n_pieces + b.n_pieces))
    wide = max(gap, ASKED * tolerance * size)
    found, points = _solve(a, b, shift, SearchGoal(gap, wide, sharp, 0.0, math.inf, _budget(a, b)))
    margin = a.rounding + b.rounding + LAST_BITS * size
    forth = directed_of(a, b, found[0], points[0], margin, True)
    return forth, directed_of(b, a, found[1], points[1], margin, False)
