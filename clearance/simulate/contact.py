"""Looks closer at the steps in contact: which pairs overlap, how deep, in which region.

Called when the clearance of every step is known and some of them are 0; a run without contact does not even
load this room. Not for: whether there is contact (`measure`).
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np

from clearance.errors import ClearanceError
from clearance.geometry.convex_parts import ConvexParts, convex_parts
from clearance.geometry.polyhedron import Polyhedron
from clearance.geometry.pose import inverse
from clearance.query.contact import BodyPair, Contact
from clearance.query.distance import distance
from clearance.simulate.contact_rows import ContactRows
from clearance.simulate.parts import blocks
from clearance.simulate.record import StepContact
from clearance.simulate.steps import pair_names
from clearance.world.body import Body, Obstacle
from clearance.world.case import Case
from clearance.world.motion import Motion
from clearance.world.pairs import Pair

MOST_KNOWN = 1000
"""Poses whose overlap is remembered, in case they occur again."""

Box = tuple[np.ndarray, np.ndarray]
"""The least and the greatest coordinates (3,) [m]."""


def find_contacts(
    case: Case,
    motions: Sequence[Motion],
    pairs: Sequence[Pair],
    clearance: np.ndarray,
    nearest: np.ndarray,
) -> tuple[Sequence[StepContact], tuple[str, ...]]:
    """The overlap of every pair in contact, step by step and pair by pair; and notes, one line each.

    Args:
        clearance: (n,) [m] of every step; those at 0 are looked at.
        nearest: (n,) the pair that has it. It is in contact for sure; the others are asked.
    """
    finder = _Finder(case, tuple(motions), tuple(pairs))
    names = list(zip(*pair_names(case, pairs), strict=True))
    rows = ContactRows(names, motions[0].times, finder.once_more)
    for step in _touching(clearance):
        for i_pair, found in finder.at(step, int(nearest[step])):
            rows.add(step, i_pair, found)
    return (rows if len(rows) else ()), finder.notes()


@dataclass(eq=False)
class _Finder:
    """Overlaps of one run; bodies are cut into parts once, and a pose between two bodies is asked once."""

    case: Case
    motions: tuple[Motion, ...]
    pairs: tuple[Pair, ...]
    _parts: dict[int, ConvexParts | str] = field(default_factory=dict)
    _known: dict[tuple[int, bytes], Contact | None] = field(default_factory=dict)
    _made: dict[int, BodyPair] = field(default_factory=dict)
    _told: dict[str, None] = field(default_factory=dict)

    def at(self, step: int, i_nearest: int) -> Iterator[tuple[int, Contact]]:
        """The pairs in contact at one step, in order, each with its overlap in the world frame."""
        for i, world_from_link in self._near(step):
            world_from_obstacle = self._obstacle(i).world_from_body
            b_from_a = inverse(world_from_obstacle) @ world_from_link
            key = (i, b_from_a.tobytes())
            is_sure = i == i_nearest
            if key not in self._known or (is_sure and self._known[key] is None):
                if len(self._known) >= MOST_KNOWN:
                    del self._known[next(iter(self._known))]
                self._known[key] = self._asked(i, b_from_a, is_sure)
            found = self._known[key]
            if found is not None:
                yield i, found.placed(world_from_obstacle)

    def once_more(self, step: int, i_pair: int) -> Contact:
        """The overlap of a pair that was found in contact at a step."""
        return dict(self.at(step, i_pair))[i_pair]

    def _near(self, step: int) -> Iterator[tuple[int, np.ndarray]]:
        """The pairs whose boxes meet at one step, each with its link's pose."""
        poses = [motion.poses(step, step + 1)[0] for motion in self.motions]
        boxes: dict[tuple[int, int], Box] = {}
        for i, pair in enumerate(self.pairs):
            link = (pair.i_robot, pair.i_body)
            robot, body = self.case.robots[pair.i_robot].robot, self._link(i)
            pose = poses[pair.i_robot][robot.link_names.index(body.name)]
            if link not in boxes:
                boxes[link] = _world_box(body.shape, pose)
            if _meet(boxes[link], self._obstacle_boxes[pair.i_obstacle]):
                yield i, pose

    def _link(self, i_pair: int) -> Body:
        pair = self.pairs[i_pair]
        return self.case.robots[pair.i_robot].robot.bodies[pair.i_body]

    def _obstacle(self, i_pair: int) -> Obstacle:
        return self.case.obstacles[self.pairs[i_pair].i_obstacle]

    @cached_property
    def _names(self) -> tuple[list[str], list[str]]:
        return pair_names(self.case, self.pairs)

    @cached_property
    def _obstacle_boxes(self) -> list[Box]:
        return [_world_box(o.body.shape, o.world_from_body) for o in self.case.obstacles]

    def notes(self) -> tuple[str, ...]:
        """What stands for the bodies that were in contact, where it is not they themselves."""
        return tuple(self._told)

    def _asked(self, i_pair: int, b_from_a: np.ndarray, is_sure: bool) -> Contact | None:
        """The overlap of a pair in the obstacle's frame.

        Seen from there, rounding may part bodies that touch in the world: a pair that is sure is not asked.
        """
        a, b = self._link(i_pair).shape, self._obstacle(i_pair).body.shape
        near = distance(a, b, pose_a=b_from_a)
        if not (near.contact or is_sure):
            return None
        links, obstacles = self._names
        parts = self._cut(a, links[i_pair]), self._cut(b, obstacles[i_pair])
        if any(isinstance(part, str) for part in parts):
            return None
        pair = self._made.setdefault(i_pair, BodyPair(a, b, *parts))
        return pair.contact(b_from_a, near.point_b)

    def _cut(self, body: Polyhedron, name: str) -> ConvexParts | str:
        if id(body) not in self._parts:
            try:
                made = convex_parts(body)
                note = made.note
            except ClearanceError as error:
                made = note = f"no depth, {error.problem}"
            self._parts[id(body)] = made
            if note:
                self._told[f"contact: {name}: {note}"] = None
        return self._parts[id(body)]


def _touching(clearance: np.ndarray) -> Iterator[int]:
    for block in blocks(len(clearance)):
        yield from (block.start + np.flatnonzero(clearance[block] <= 0.0)).tolist()


def _meet(a: Box, b: Box) -> bool:
    """False only if two axis-parallel boxes are apart."""
    return bool((a[0] <= b[1]).all() and (b[0] <= a[1]).all())


def _world_box(body: Polyhedron, pose: np.ndarray) -> Box:
    """A box around the body in the world, a little wider than rounding."""
    middle = pose[:3, :3] @ body.bounds.mean(axis=0) + pose[:3, 3]
    half = np.abs(pose[:3, :3]) @ (0.5 * (body.bounds[1] - body.bounds[0]))
    half += 1e-12 * (np.abs(middle).max() + half.max())
    return middle - half, middle + half
