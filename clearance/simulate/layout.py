"""Lays all measured bodies into one searchable surface, and says what moves them.

Not for: the measuring (`measure`) and the motion itself (`kinematic`, `bullet`).
"""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from clearance.geometry.tree import join
from clearance.kernels.mesh.surface import Surface
from clearance.kernels.motion.kinematics import Links
from clearance.kernels.motion.world import World
from clearance.world.case import Case
from clearance.world.kinematics import joined_links, poses_by_link, seen_from
from clearance.world.motion import Motion
from clearance.world.pairs import BodyIndex, Pair

IN_WORLD = -1
"""The reference of a pair that is measured in the world."""


@dataclass(frozen=True, eq=False)
class Layout:
    """All measured bodies behind one another: links first, then obstacles, then those seen from a link.

    Attributes:
        surface: their trees and faces.
        world: what carries each body, and which to measure against each other.
        references: (p,) the link in whose frame each pair is measured, or `IN_WORLD`.
    """

    surface: Surface
    world: World
    references: np.ndarray

    @property
    def is_in_world(self) -> bool:
        """True if all pairs are measured in the world."""
        return bool((self.references == IN_WORLD).all())

    def to_world(self, positions: np.ndarray, pairs: np.ndarray, points: np.ndarray) -> None:
        """Takes witness points to the world, in place.

        Args:
            positions: (k, columns) of the joints [rad or m]. pairs: (k,) of which the points are, or -1.
            points: (k, 2, 3) [m].
        """
        rows = np.flatnonzero((pairs >= 0) & (self.references[pairs] != IN_WORLD))
        if len(rows):
            poses = poses_by_link(self.world.links, positions[rows])
            seen_from = poses[np.arange(len(rows)), self.references[pairs[rows]]]
            turned = np.einsum("kij,knj->kni", seen_from[:, :3, :3], points[rows])
            points[rows] = turned + seen_from[:, None, :3, 3]


@dataclass(frozen=True, order=True)
class _Place:
    """A body as it is seen from a link, or in the world."""

    reference: int
    body: BodyIndex


def lay_out(case: Case, pairs: Sequence[Pair]) -> Layout:
    """The layout of the bodies in `pairs`."""
    links = joined_links(case.robots)
    first_links = _first_links(case)
    references = [_reference_of(case, pair, links, first_links) for pair in pairs]
    places = _places(pairs, references)
    solids = sorted({place.body for place in places}, key=_links_first)
    link_of = {
        place: first_links[place.body.i_robot] + place.body.link_in(case)
        for place in places
        if not place.body.is_obstacle
    }
    wanted = {(p.reference, link_of[p]) for p in places if p.reference != IN_WORLD}
    links, seen = seen_from(links, sorted(wanted))
    measured = np.array(
        [
            [places.index(_Place(reference, body)) for body in (pair.a, pair.b)]
            for pair, reference in zip(pairs, references, strict=True)
        ],
        dtype=np.int64,
    )
    frames = [_frame_of(place, link_of, seen) for place in places]
    world = World(
        solids=np.array([solids.index(place.body) for place in places], dtype=np.int64),
        frames=np.array(frames, dtype=np.int64),
        groups=_groups(measured, np.array(frames)),
        standing=_standing(case, places),
        pairs=measured,
        links=links,
    )
    shapes = [body.shape_in(case) for body in solids]
    return Layout(join(shapes), world, np.array(references, dtype=np.int64))


def positions_at(motions: Sequence[Motion], steps: np.ndarray | range) -> np.ndarray:
    """(k, columns) [rad or m] the positions of the moving joints of all robots, robot by robot; a copy."""
    these = slice(steps.start, steps.stop) if isinstance(steps, range) else steps
    if len(motions) == 1:
        return np.array(motions[0].positions[these], dtype=np.float64, order="C")
    return np.concatenate([motion.positions[these] for motion in motions], axis=1)


def _links_first(body: BodyIndex) -> tuple[bool, BodyIndex]:
    return body.is_obstacle, body


def _places(pairs: Sequence[Pair], references: Sequence[int]) -> list[_Place]:
    """Each body in each reference that it is seen from; in the world links first, then obstacles."""
    found = {
        _Place(reference, body)
        for pair, reference in zip(pairs, references, strict=True)
        for body in (pair.a, pair.b)
    }
    return sorted(found, key=lambda place: (place.reference, _links_first(place.body)))


def _first_links(case: Case) -> list[int]:
    """The first link of each robot, counted over all robots."""
    counts = (len(placed.robot.link_names) for placed in case.robots)
    return list(itertools.accumulate(counts, initial=0))


def _reference_of(case: Case, pair: Pair, links: Links, first_links: Sequence[int]) -> int:
    """The nearest link above both of one robot; else the world."""
    if pair.b.is_obstacle or pair.a.i_robot != pair.b.i_robot:
        return IN_WORLD
    first = first_links[pair.a.i_robot]
    one, other = first + pair.a.link_in(case), first + pair.b.link_in(case)
    while one != other:  # parents come before children
        if one > other:
            one = int(links.parents[one])
        else:
            other = int(links.parents[other])
    return one


def _frame_of(place: _Place, link_of: dict[_Place, int], seen: dict[tuple[int, int], int]) -> int:
    """The link that carries a body, or -1 for one that stands where it is seen."""
    if place.body.is_obstacle:
        return -1
    if place.reference == IN_WORLD:
        return link_of[place]
    return -1 if place.reference == link_of[place] else seen[place.reference, link_of[place]]


def _groups(pairs: np.ndarray, frames: np.ndarray) -> np.ndarray:
    """(bodies,) the least of the bodies that each is joined to by pairs of which both move."""
    groups = np.arange(len(frames))
    for a, b in pairs[frames[pairs[:, 1]] >= 0]:
        low, high = sorted((groups[a], groups[b]))
        groups[groups == high] = low
    return groups


def _standing(case: Case, places: Sequence[_Place]) -> np.ndarray:
    standing = np.empty((len(places), 4, 4))
    standing[:] = np.eye(4)
    for place, seen in enumerate(places):
        if seen.body.is_obstacle:
            standing[place] = case.obstacles[seen.body.i_body].world_from_body
    return standing
