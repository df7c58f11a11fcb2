"""How far two outlines differ: certified Hausdorff distance, deviation along them, areas, who made the worst."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from clearance.errors import BadInput
from clearance.planar.deviation import Deviation, deviation
from clearance.planar.hausdorff import Hausdorff, hausdorff
from clearance.profiles.outline_file import DrawnOutline

SAMPLES = 600
"""Points along each outline at which its deviation is measured, all joints among them."""

PERCENTILES = (50, 95, 99)

SAME_PLANE = 1e-9
"""[m] or [-] Coordinates of two planes differ by no more where the planes are one but for rounding."""


@dataclass(frozen=True)
class Exceedance:
    """A stretch of an outline that is farther than the limit from the other.

    Attributes:
        outline: "a" or "b".
        start, end: (2,) its ends. length: along the outline.
        distance: the greatest at a sample of it. point: (2,) there.
    """

    outline: str
    start: tuple[float, float]
    end: tuple[float, float]
    length: float
    distance: float
    point: tuple[float, float]


@dataclass(frozen=True, eq=False)
class OutlineComparison:
    """Differences of outline a and outline b, in their unit (metres for profiles).

    Attributes:
        found: the Hausdorff distance, both ways, with witnesses and proven error.
        forth, back: deviation along a from b and along b from a.
        gained, lost: area of b outside a and of a outside b; None where either encloses no region.
        beyond: stretches beyond `limit`, in order along a and then b.
        makers: for "a" and "b" the link and step that made the worst point there, where it is a sweep.
    """

    a: DrawnOutline
    b: DrawnOutline
    found: Hausdorff
    forth: Deviation
    back: Deviation
    gained: float | None
    lost: float | None
    limit: float | None
    beyond: tuple[Exceedance, ...]
    makers: dict[str, tuple[str, int]]

    @property
    def verdict(self) -> str:
        """ "within" or "beyond" where the proven bounds of the distance say so, else "undecided"."""
        if self.limit is None or self.found.upper <= self.limit:
            return "within"
        return "beyond" if self.found.lower > self.limit else "undecided"

    @property
    def within_limit(self) -> bool:
        """True if there is no limit, or the proven upper bound of the distance keeps it; undecided is False."""
        return self.verdict == "within"


def compare(a: DrawnOutline, b: DrawnOutline, *, limit: float | None = None) -> OutlineComparison:
    """Outline a against outline b.

    Args:
        limit: in the outlines' unit, for `beyond` and `within_limit`.

    Raises:
        BadInput: two swept profiles whose coordinates are not of one plane.
    """
    _require_one_plane(a, b)
    found = hausdorff(a.curve, b.curve)
    forth = deviation(a.curve, b.curve, limit=limit, samples=SAMPLES)
    back = deviation(b.curve, a.curve, limit=limit, samples=SAMPLES)
    gained = lost = None
    if not (a.region_fault or b.region_fault):
        from clearance.profiles.region import area, difference

        gained, lost = area(difference(b.region, a.region)), area(difference(a.region, b.region))
    makers: dict[str, tuple[str, int]] = {}
    for side, drawn, at in (("a", a, found.parameter_a), ("b", b, found.parameter_b)):
        if drawn.profile is None:
            continue
        maker = drawn.profile.maker(min(int(np.floor(at)), drawn.profile.n_pieces - 1))
        if maker is not None:
            makers[side] = maker
    beyond = (*_beyond("a", a, forth), *_beyond("b", b, back))
    return OutlineComparison(a, b, found, forth, back, gained, lost, limit, beyond, makers)


def _require_one_plane(a: DrawnOutline, b: DrawnOutline) -> None:
    one, two = a.profile, b.profile
    if one is None or two is None:
        return
    aside = (one.plane_origin - two.plane_origin) @ one.plane_axes.T
    turned = one.plane_axes - two.plane_axes
    if max(np.abs(aside).max(), np.abs(turned).max()) > SAME_PLANE:
        planes = f"{a.name} is drawn in {one.plane!r} and {b.name} in {two.plane!r}"
        raise BadInput(
            f"{planes}, whose coordinates differ", where="plane", valid="sweeps with one --plane"
        )


def _beyond(side: str, drawn: DrawnOutline, profile: Deviation) -> list[Exceedance]:
    found = []
    for low, high in profile.beyond:
        ends = drawn.curve.point(np.array([low, high]))
        inside = np.flatnonzero((profile.parameter >= low) & (profile.parameter <= high))
        if not len(inside):
            continue
        worst = inside[np.argmax(profile.distance[inside])]
        length = profile.arc_length[inside[-1]] - profile.arc_length[inside[0]]
        length += np.hypot(*(ends[0] - profile.point[inside[0]]))
        length += np.hypot(*(ends[1] - profile.point[inside[-1]]))
        found.append(
            Exceedance(
                side,
                tuple(ends[0].tolist()),
                tuple(ends[1].tolist()),
                float(length),
                float(profile.distance[worst]),
                tuple(profile.point[worst].tolist()),
            )
        )
    return found


SCHEMA = "urn:clearance:comparison:1"
"""The name of the JSON Schema, which `clearance schema --results comparison` prints."""


def as_data(found: OutlineComparison) -> dict[str, Any]:
    """A comparison as JSON-ready values."""
    whole = found.found
    return {
        "$schema": SCHEMA,
        "a": found.a.name,
        "b": found.b.name,
        "hausdorff": {
            "distance": whole.distance,
            "error_bound": whole.error_bound,
            "direction": whole.direction,
            "point_a": whole.point_a.tolist(),
            "point_b": whole.point_b.tolist(),
        },
        "directed": {
            name: {
                "distance": one.distance,
                "upper": one.upper,
                "lower": one.lower,
                "point_a": one.point_a.tolist(),
                "point_b": one.point_b.tolist(),
            }
            for name, one in whole.directed.items()
        },
        "deviation": {"a_to_b": _spread(found.forth), "b_to_a": _spread(found.back)},
        "area_gained": found.gained,
        "area_lost": found.lost,
        "limit": found.limit,
        "within_limit": found.within_limit,
        "verdict": found.verdict,
        "beyond": [vars(one) for one in found.beyond],
        "worst_made_by": {
            side: {"link": link, "step": step} for side, (link, step) in found.makers.items()
        },
        "bounds": {
            side: drawn.profile.bound
            for side, drawn in (("a", found.a), ("b", found.b))
            if drawn.profile is not None
        },
    }


def _spread(profile: Deviation) -> dict[str, float]:
    found = {"mean": profile.mean, "spacing": profile.spacing}
    return found | {f"percentile_{share}": profile.percentile(share) for share in PERCENTILES}
