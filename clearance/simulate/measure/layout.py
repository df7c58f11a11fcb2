"""Lays all measured bodies into one searchable surface, and says what moves them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np

from clearance.geometry.edges import ahead_of
from clearance.geometry.tree import join
from clearance.kernels.mesh.surface import ANYTHING, Surface
from clearance.kernels.motion.kinematics import Links
from clearance.kernels.motion.world import World
from clearance.world.case import Case, Limits
from clearance.world.cell import once_a_cell
from clearance.world.forest import WORLD, carried_by, forest_of, joined_positions
from clearance.world.kinematics import links_alone, poses_by_link, seen_from
from clearance.world.motion import Motion
from clearance.world.pairs import BodyIndex, Pair

IN_WORLD = -1
"""The reference of a pair that is measured in the world."""


class SeenBody(NamedTuple):
    """A body as it is seen from a link, or in the world."""

    reference: int
    body: BodyIndex


@dataclass(frozen=True, eq=False)
class Layout:
    """All measured bodies behind one another: links first, then obstacles, then those seen from a link.

    Attributes:
        surface: their trees and faces.
        world: what carries each body, and which to measure against each other.
        references: (p,) the link in whose frame each pair is measured, or `IN_WORLD`.
        swapped: (p,) True where the second body of a pair is the first in `world.pairs`, since only that one
            moves.
        places: of each body what it is, and from where it is seen.
        origins: (links,) which link of the case's forest each is, or -1 where it stands as the origin that others
            are seen from.
    """

    surface: Surface
    world: World
    references: np.ndarray
    swapped: np.ndarray
    places: Sequence[SeenBody]
    origins: np.ndarray

    @property
    def is_in_world(self) -> bool:
        """True if all pairs are measured in the world, their bodies in order."""
        return bool((self.references == IN_WORLD).all() and not self.swapped.any())

    @cached_property
    def whole_faces(self) -> Surface:
        """The surface as `with_whole_faces` makes it."""
        return with_whole_faces(self.surface)

    def to_world(self, positions: np.ndarray, pairs: np.ndarray, points: np.ndarray) -> None:
        """Takes witness points to the world, and to the order of the pair's bodies, in place.

        Args:
            positions: (k, columns) of the joints [rad or m]. pairs: (k,) of which the points are, or -1.
            points: (k, 2, 3) [m].
        """
        rows = self._is_seen_from_link[pairs].nonzero()[0]
        if len(rows):
            seen_from = self._references_at(positions[rows], pairs[rows])
            turned = np.einsum("kij,knj->kni", seen_from[:, :3, :3], points[rows])
            points[rows] = turned + seen_from[:, None, :3, 3]
        swapped = self._is_swapped[pairs].nonzero()[0]
        if len(swapped):
            points[swapped] = points[swapped][:, ::-1]

    def from_world(
        self, positions: np.ndarray, pairs: np.ndarray, points: np.ndarray
    ) -> np.ndarray:
        """(k, 2, 3) [m] witness points in the world as their pairs are measured; the inverse of `to_world`."""
        points = points.copy()
        swapped = self._is_swapped[pairs].nonzero()[0]
        if len(swapped):
            points[swapped] = points[swapped][:, ::-1]
        rows = self._is_seen_from_link[pairs].nonzero()[0]
        if len(rows):
            seen_from = self._references_at(positions[rows], pairs[rows])
            away = points[rows] - seen_from[:, None, :3, 3]
            points[rows] = np.einsum("kji,knj->kni", seen_from[:, :3, :3], away)
        return points

    @cached_property
    def _is_seen_from_link(self) -> np.ndarray:
        """(p + 1,) True where a pair is measured in the frame of a link; the last is no pair, -1."""
        return np.append(self.references != IN_WORLD, False)

    @cached_property
    def _is_swapped(self) -> np.ndarray:
        """(p + 1,) `swapped`; the last is no pair, -1."""
        return np.append(self.swapped, False)

    @cached_property
    def _reference_links(self) -> tuple[Links, np.ndarray]:
        """The links that pairs are measured from, with what they hang on, and (p,) which of these is a pair's."""
        references = np.maximum(self.references, 0)  # nobody asks where the world stands
        wanted, which = np.unique(references, return_inverse=True)
        links, places = links_alone(self.world.links, wanted)
        return links, places[which]

    def _references_at(self, positions: np.ndarray, pairs: np.ndarray) -> np.ndarray:
        """(k, 4, 4) [m] where the link stands that each pair is measured from, at positions (k, columns)."""
        links, places = self._reference_links
        return poses_by_link(links, positions)[np.arange(len(pairs)), places[pairs]]


@dataclass(frozen=True, eq=False)
class PairsInMotion:
    """Pairs of bodies of a case in which nothing changes hands, and how all moves.

    Attributes:
        motions: one for each robot of the case, with the same steps.
        limits: of the pairs' distances; those of the case if not given.
    """

    case: Case
    motions: Sequence[Motion]
    pairs: Sequence[Pair]
    limits: Limits = None  # type: ignore[assignment]  # always there once it is made

    def __post_init__(self) -> None:
        if self.limits is None:
            object.__setattr__(self, "limits", self.case.limits)

    @cached_property
    def layout(self) -> Layout:
        """All bodies in one searchable surface."""
        return lay_out(self.case, self.pairs)


def lay_out(case: Case, pairs: Sequence[Pair]) -> Layout:
    """The layout of the bodies in `pairs`."""
    return _laid_out(case, tuple(pairs))


@once_a_cell(2)
def _laid_out(case: Case, pairs: tuple[Pair, ...]) -> Layout:
    solids = sorted(
        {body for pair in pairs for body in pair}, key=lambda one: (one.is_obstacle, one)
    )
    number = {body: i for i, body in enumerate(solids)}
    frames = np.array([body.frame_in(case) for body in solids])
    numbers = np.array([(number[a], number[b]) for a, b in pairs], dtype=np.int64)
    references = _references(case, frames[numbers])
    seen_bodies, rows = np.unique(
        (references[:, None] + 1) * len(solids) + numbers, return_inverse=True
    )  # in the world first; links, then obstacles
    measured = rows.reshape(-1, 2).astype(np.int64)
    solid_of = seen_bodies % len(solids)
    at = (seen_bodies // len(solids) - 1).tolist()
    places = [SeenBody(reference, solids[i]) for reference, i in zip(at, solid_of, strict=True)]
    link_of = {
        place: int(frames[i])
        for place, i in zip(places, solid_of, strict=True)
        if frames[i] != WORLD
    }
    wanted = {(p.reference, link_of[p]) for p in places if p.reference != IN_WORLD}
    links, seen = seen_from(forest_of(case).links, sorted(wanted))
    carriers = [_frame_of(place, link_of, seen) for place in places]
    stands = np.array(carriers, dtype=np.int64) == -1
    swapped = stands[measured[:, 0]] & ~stands[measured[:, 1]]
    measured[swapped] = measured[swapped][:, ::-1]
    world = World(
        solids=solid_of,
        frames=np.array(carriers, dtype=np.int64),
        groups=_groups(measured, np.array(carriers)),
        standing=_standing(case, places),
        pairs=measured,
        links=links,
    )
    shapes = [body.shape_in(case) for body in solids]
    return Layout(join(shapes), world, references, swapped, places, _origins(links, seen))


def with_whole_faces(surface: Surface) -> Surface:
    """The surface in which every face owns all its corners and edges, not only those it answers for."""
    starts, corners = surface.face_starts, surface.face_vertices
    ends = np.stack([corners, corners[ahead_of(starts)]], axis=1)
    edge_starts = starts
    if (np.diff(starts) < 2).any():  # a point of a cloud has no edge
        is_edge = np.repeat(np.diff(starts) > 1, np.diff(starts))
        ends, edge_starts = ends[is_edge], np.concatenate([[0], np.cumsum(is_edge)])[starts]
    return surface._replace(
        vertex_starts=starts,
        owned_vertices=corners,
        edge_starts=edge_starts,
        owns=np.full(len(starts) - 1, ANYTHING, dtype=np.uint16),
        owned_edges=ends,
    )


def positions_at(case: Case, motions: Sequence[Motion], steps: np.ndarray | range) -> np.ndarray:
    """(k, columns) [rad or m] the positions of all that moves, as `world.forest` has its columns; a copy."""
    return joined_positions(
        case, motions, slice(steps.start, steps.stop) if isinstance(steps, range) else steps
    )


def _references(case: Case, links: np.ndarray) -> np.ndarray:
    """(p,) the nearest link above both of two links (p, 2); the world where there is none, or one stands there."""
    references = np.full(len(links), IN_WORLD, dtype=np.int64)
    forest = forest_of(case)
    for i in np.flatnonzero((links != WORLD).all(axis=1)):
        one, other = links[i].tolist()
        above = set(carried_by(forest, other))
        references[i] = next((link for link in carried_by(forest, one) if link in above), IN_WORLD)
    return references


def _frame_of(
    place: SeenBody, link_of: dict[SeenBody, int], seen: dict[tuple[int, int], int]
) -> int:
    """The link that carries a body, or -1 for one that stands where it is seen."""
    if place not in link_of:
        return -1
    if place.reference == IN_WORLD:
        return link_of[place]
    return -1 if place.reference == link_of[place] else seen[place.reference, link_of[place]]


def _origins(links: Links, seen: dict[tuple[int, int], int]) -> np.ndarray:
    """(links,) as in `Layout`: those that are seen from others lie behind all others."""
    origins = np.arange(len(links.parents))
    for (reference, link), place in seen.items():
        origins[place] = -1 if link == reference else link
    return origins


def _groups(pairs: np.ndarray, frames: np.ndarray) -> np.ndarray:
    """(bodies,) the least of the bodies that each is joined to by pairs of which both move."""
    groups = np.arange(len(frames))
    for a, b in pairs[frames[pairs[:, 1]] >= 0]:
        low, high = sorted((groups[a], groups[b]))
        groups[groups == high] = low
    return groups


def _standing(case: Case, places: Sequence[SeenBody]) -> np.ndarray:
    standing = np.empty((len(places), 4, 4))
    standing[:] = np.eye(4)
    for place, seen in enumerate(places):
        if seen.body.is_obstacle and seen.reference == IN_WORLD:
            standing[place] = case.obstacles[seen.body.i_body].world_from_body
    return standing
