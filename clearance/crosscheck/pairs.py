"""The measured pairs of a record, each body ready for both questions: how far (FCL), inside or not
(winding).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from clearance.crosscheck.fcl_adapter import PeerBody
from clearance.crosscheck.triangles import TriangleSoup, is_inside, triangle_soup
from clearance.geometry.point_cloud import PointCloud
from clearance.world.body import Body
from clearance.world.case import Case
from clearance.world.pairs import BodyIndex, Pair

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


def peer_pairs(case: Case, measured: Sequence[Pair]) -> tuple[list[Mover], list[PeerPair]]:
    """The bodies of some pairs of a case, and these pairs.

    Links are named as in the record: with their robot's name where there are several.
    """
    bodies = dict.fromkeys(body for pair in measured for body in pair)
    movers = [Mover(body, _side_of(case, body)) for body in bodies]
    place = {body: i for i, body in enumerate(bodies)}
    pairs = [
        PeerPair(place[a], movers[place[a]].side, place[b], movers[place[b]].side)
        for a, b in measured
    ]
    return movers, pairs


def _side_of(case: Case, body: BodyIndex) -> PeerSide:
    return replace(peer_side(body.body_in(case)), name=body.name_in(case))


def peer_side(body: Body) -> PeerSide:
    """A body cut into triangles, as FCL tree and as numpy arrays."""
    soup = triangle_soup(body.shape)
    return PeerSide(body.name, soup, PeerBody(soup), PointLocator(soup))


class PointLocator:
    """Distances of points from one body's surface; the spheres round its triangles are made
    once.
    """

    def __init__(self, soup: TriangleSoup) -> None:
        self._corners = soup.corners
        self._centres = self._corners.mean(axis=1)
        self._radii = np.linalg.norm(self._corners - self._centres[:, None], axis=2).max(axis=1)

    def distances(self, point: np.ndarray) -> np.ndarray:
        """(n,) [m] the distances of a point (3,) in the body frame from every triangle."""
        return point_triangle_distances(point, self._corners)

    def distance(self, point: np.ndarray) -> float:
        """The distance [m] of a point (3,) in the body frame from the surface."""
        return float(point_triangle_distances(point, self.near(point)).min())

    def near(self, point: np.ndarray) -> np.ndarray:
        """(k, 3, 3) the triangles that may be nearest, by the spheres round them."""
        to_centres = np.linalg.norm(self._centres - point, axis=1)
        near = to_centres - self._radii <= (to_centres + self._radii).min() * (1 + 1e-12)
        return self._corners[near]


def point_triangle_distances(point: np.ndarray, corners: np.ndarray) -> np.ndarray:
    """(n,) [m] the distances of one point (3,) from triangles (n, 3, 3), also those without area.

    The nearest point of a triangle is in its plane's interior or on one of its sides; both are
    measured and the lesser counts.
    """
    sides = ((corners[:, k], corners[:, (k + 1) % 3]) for k in range(3))
    on_sides = np.min([_segment_distances(point, *side) for side in sides], axis=0)
    a, ab, ac = corners[:, 0], corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    normals = np.cross(ab, ac)
    area_sq = (normals * normals).sum(axis=1)
    flat = area_sq == 0.0
    area_sq = np.where(flat, 1.0, area_sq)
    offset = point - a
    v = (np.cross(offset, ac) * normals).sum(axis=1) / area_sq
    w = (np.cross(ab, offset) * normals).sum(axis=1) / area_sq
    over = ~flat & (v >= 0) & (w >= 0) & (v + w <= 1)
    height = np.abs((offset * normals).sum(axis=1)) / np.sqrt(area_sq)
    return np.where(over, height, on_sides)


def _segment_distances(point: np.ndarray, starts: np.ndarray, ends: np.ndarray) -> np.ndarray:
    along = ends - starts
    length_sq = (along * along).sum(axis=1)
    t = ((point - starts) * along).sum(axis=1) / np.where(length_sq == 0.0, 1.0, length_sq)
    return np.linalg.norm(starts + t.clip(0.0, 1.0)[:, None] * along - point, axis=1)
