"""The measured pairs of a record, each body ready for both questions: how far (FCL), inside or not
(winding).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from clearance.crosscheck.containment import is_inside
from clearance.crosscheck.fcl_adapter import PeerBody
from clearance.crosscheck.triangles import TriangleSoup, triangle_soup
from clearance.crosscheck.witness import PointLocator
from clearance.geometry.point_cloud import PointCloud
from clearance.record.record import Samples
from clearance.world.body import Body
from clearance.world.case import Case
from clearance.world.pairs import BodyIndex, Pair, measured_pairs

if TYPE_CHECKING:
    from scipy.spatial import cKDTree

MOST_POINTS = 2_000_000
"""Points of a cloud for FCL: it needs 1 GB and 6 s for a million."""


def is_too_large(case: Case, pair: Pair) -> bool:
    """True if a body of a pair is a cloud of too many points for FCL."""
    shapes = (body.body_in(case).shape for body in pair)
    return any(isinstance(shape, PointCloud) and shape.n_points > MOST_POINTS for shape in shapes)


@dataclass(frozen=True, eq=False)
class PeerSide:
    """One body of the run."""

    name: str
    soup: TriangleSoup
    peer: PeerBody
    locator: PointLocator

    @cached_property
    def tree(self) -> cKDTree:
        """The vertices, for queries about a point."""
        from scipy.spatial import cKDTree

        return cKDTree(self.soup.vertices)

    def distance(self, point: np.ndarray, solid: bool) -> float:
        """The distance [m] of a point (3,) in the body frame from the surface, or from the
        solid; of a cloud from its balls.
        """
        if self.soup.radius > 0.0:
            beyond = self.locator.distance(point) - self.soup.radius
            return max(0.0, beyond) if solid else abs(beyond)
        if solid and is_inside(self.soup, point[None])[0]:
            return 0.0
        return self.locator.distance(point)


@dataclass(frozen=True, eq=False)
class PeerPair:
    """A measured pair.

    Attributes:
        i_mover, i_other: index into the movers of the run, and that of the second body.
    """

    i_mover: int
    link: PeerSide
    i_other: int
    other: PeerSide

    @property
    def radii(self) -> float:
        """[m] of the balls of both bodies, if they are clouds: what is between their points is more by that."""
        return self.link.soup.radius + self.other.soup.radius


@dataclass(frozen=True)
class Mover:
    """A body that is measured against something, and its side; one that stands is a mover as well."""

    body: BodyIndex
    side: PeerSide


def peer_pairs(
    record: Samples, measured: Sequence[Pair] | None = None
) -> tuple[list[Mover], list[PeerPair]]:
    """The bodies that take part and every pair that the record does not list as unmeasured.

    Links are named as in the record: with their robot's name where there are several.

    Args:
        measured: the pairs, where they are not all that the case measures.
    """
    case = record.case
    omitted = {(entry.link, entry.obstacle) for entry in record.unmeasured}
    places: dict[BodyIndex, int] = {}
    movers: list[Mover] = []

    def place_of(body: BodyIndex) -> int:
        if body not in places:
            places[body] = len(movers)
            movers.append(Mover(body, _side_of(case, body)))
        return places[body]

    pairs: list[PeerPair] = []
    for pair in measured_pairs(case)[0] if measured is None else measured:
        if (pair.a.name_in(case), pair.b.name_in(case)) in omitted:
            continue
        a, b = place_of(pair.a), place_of(pair.b)
        pairs.append(PeerPair(a, movers[a].side, b, movers[b].side))
    return movers, pairs


def _side_of(case: Case, body: BodyIndex) -> PeerSide:
    return replace(peer_side(body.body_in(case)), name=body.name_in(case))


def peer_side(body: Body) -> PeerSide:
    """A body cut into triangles, as FCL tree and as numpy arrays."""
    soup = triangle_soup(body.shape)
    return PeerSide(body.name, soup, PeerBody(soup), PointLocator(soup))
