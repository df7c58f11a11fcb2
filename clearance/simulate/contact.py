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
from clearance.query.contact import Contact, Pair
from clearance.query.distance import distance
from clearance.simulate.record import StepContact
from clearance.simulate.steps import pair_names
from clearance.world.case import Case
from clearance.world.motion import Motion
from clearance.world.pairs import Pair as NamedPair

Box = tuple[np.ndarray, np.ndarray]
"""The least and the greatest coordinates (3,) [m]."""


def find_contacts(
    case: Case, motions: Sequence[Motion], pairs: Sequence[NamedPair], clearance: np.ndarray
) -> tuple[tuple[StepContact, ...], tuple[str, ...]]:
    """The overlap of every pair in contact, step by step and pair by pair; and notes, one line each.

    Args:
        clearance: (n,) [m] of every step; those at 0 are looked at.
    """
    finder = _Finder(case, tuple(motions), tuple(pairs))
    touching = np.flatnonzero(clearance <= 0.0).tolist()
    found = tuple(row for step in touching for row in finder.at(step))
    return found, finder.notes()


@dataclass(eq=False)
class _Finder:
    """Overlaps of one run; bodies are cut into parts once, and a pose between two bodies is asked once."""

    case: Case
    motions: tuple[Motion, ...]
    pairs: tuple[NamedPair, ...]
    _parts: dict[int, ConvexParts | str] = field(default_factory=dict)
    _known: dict[tuple[int, bytes], Contact | None] = field(default_factory=dict)
    _told: dict[str, None] = field(default_factory=dict)

    def at(self, step: int) -> Iterator[StepContact]:
        """The contacts of one step, in the order of the pairs."""
        links, obstacles = self._names
        poses = [motion.poses(step, step + 1)[0] for motion in self.motions]
        link_boxes: dict[tuple[int, int], Box] = {}
        for i, pair in enumerate(self.pairs):
            robot = self.case.robots[pair.i_robot].robot
            body, obstacle = robot.bodies[pair.i_body], self.case.obstacles[pair.i_obstacle]
            world_from_link = poses[pair.i_robot][robot.link_names.index(body.name)]
            link = (pair.i_robot, pair.i_body)
            if link not in link_boxes:
                link_boxes[link] = _world_box(body.shape, world_from_link)
            if not _meet(link_boxes[link], self._obstacle_boxes[pair.i_obstacle]):
                continue
            b_from_a = inverse(obstacle.world_from_body) @ world_from_link
            key = (i, b_from_a.tobytes())
            if key not in self._known:
                names = (links[i], obstacles[i])
                self._known[key] = self._asked(body.shape, obstacle.body.shape, b_from_a, names)
            found = self._known[key]
            if found is not None:
                time = float(self.motions[0].times[step])
                placed = found.placed(obstacle.world_from_body)
                yield StepContact(step, time, links[i], obstacles[i], placed)

    @cached_property
    def _names(self) -> tuple[list[str], list[str]]:
        return pair_names(self.case, self.pairs)

    @cached_property
    def _obstacle_boxes(self) -> list[Box]:
        return [_world_box(o.body.shape, o.world_from_body) for o in self.case.obstacles]

    def notes(self) -> tuple[str, ...]:
        """What stands for the bodies that were in contact, where it is not they themselves."""
        return tuple(self._told)

    def _asked(
        self, a: Polyhedron, b: Polyhedron, b_from_a: np.ndarray, names: tuple[str, str]
    ) -> Contact | None:
        """The overlap in the obstacle's frame."""
        near = distance(a, b, pose_a=b_from_a)
        if not near.contact:
            return None
        parts = [self._cut(body, name) for body, name in zip((a, b), names, strict=True)]
        if any(isinstance(part, str) for part in parts):
            return None
        return Pair(a, b, *parts).contact(b_from_a, near.point_b)

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


def _meet(a: Box, b: Box) -> bool:
    """False only if two axis-parallel boxes are apart."""
    return bool((a[0] <= b[1]).all() and (b[0] <= a[1]).all())


def _world_box(body: Polyhedron, pose: np.ndarray) -> Box:
    """A box around the body in the world, a little wider than rounding."""
    middle = pose[:3, :3] @ body.bounds.mean(axis=0) + pose[:3, 3]
    half = np.abs(pose[:3, :3]) @ (0.5 * (body.bounds[1] - body.bounds[0]))
    half += 1e-12 * (np.abs(middle).max() + half.max())
    return middle - half, middle + half
