"""The pairs of bodies that an MJCF model filters from collision, with a reason each.

MuJoCo tests two geoms if a `<pair>` names them. Else it tests them if no `<exclude>` names their bodies, neither
body is the parent of the other, and the bits of contype and conaffinity meet. Bodies welded together count as one;
a body welded to the world is no parent. Not for: what the pairs do (`world.self_pairs`).

Source: MuJoCo, Computation, "Collision detection: selection"; engine_collision_driver.c (`filterBodyPair`).
"""

from __future__ import annotations

import itertools
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property

from clearance.formats.robot.mjcf.model import MjcfGeom, MjcfModel
from clearance.world.collision_matrix import ADJACENT, CollisionMatrix
from clearance.world.notice import listed

PARENT = "MuJoCo's filter of parent and child"
EXCLUDE = "<exclude> in the model"
BITS = "contype and conaffinity"
"""Reasons why MuJoCo does not test two bodies, beside being neighbours on one joint."""


@dataclass(frozen=True, eq=False)
class MjcfFilters:
    """What keeps the bodies of a model from colliding.

    Args:
        measured: bodies with a shape.
        colliding: those of them whose shape consists of geoms that collide; bits do not filter the others.
        neighbours: pairs of bodies that one joint joins.
    """

    model: MjcfModel
    measured: frozenset[str]
    colliding: frozenset[str]
    neighbours: frozenset[frozenset[str]]

    @cached_property
    def rows(self) -> tuple[tuple[str, str, str], ...]:
        """Pairs of bodies with a shape that MuJoCo does not test, and why."""
        bodies = self.model.bodies
        return tuple(
            (bodies[a].name, bodies[b].name, reason)
            for a, b in itertools.combinations(self._geoms, 2)
            if bodies[a].welded_to != bodies[b].welded_to and (reason := self._reason(a, b))
        )

    @property
    def matrix(self) -> CollisionMatrix:
        """The rows as an SRDF has them."""
        return CollisionMatrix(disabled=self.rows)

    def notes(self) -> Iterator[str]:
        """A line for each filter that leaves out more than neighbours, and for pairs of `<pair>`."""
        for reason in (EXCLUDE, PARENT, BITS):
            told = [f"{a} - {b}" for a, b, why in self.rows if why == reason]
            if told:
                yield f"self_clearance without srdf leaves out ({reason}): {listed(told, 6)}"
        if self._asked_for:
            bodies = self.model.bodies
            told = [f"{bodies[a].name} - {bodies[b].name}" for a, b in sorted(self._asked_for)]
            yield f"self_clearance without srdf measures, as <pair> says: {listed(told, 6)}"

    @cached_property
    def _geoms(self) -> dict[int, list[MjcfGeom]]:
        """The geoms of each body that has a shape."""
        found: dict[int, list[MjcfGeom]] = {}
        for geom in self.model.geoms:
            if self.model.bodies[geom.body].name in self.measured:
                found.setdefault(geom.body, []).append(geom)
        return dict(sorted(found.items()))

    @cached_property
    def _asked_for(self) -> frozenset[tuple[int, int]]:
        ends = ([self.model.geoms[i].body for i in pair] for pair in self.model.pairs)
        return frozenset((min(one), max(one)) for one in ends)

    @cached_property
    def _excluded(self) -> frozenset[frozenset[str]]:
        return frozenset(map(frozenset, self.model.excludes))

    def _reason(self, a: int, b: int) -> str | None:
        bodies = self.model.bodies
        names = frozenset((bodies[a].name, bodies[b].name))
        if (a, b) in self._asked_for:
            return None
        if names in self._excluded:
            return EXCLUDE
        if self.model.filters_parents and self._is_parent(a, b):
            return ADJACENT if names in self.neighbours else PARENT
        if names <= self.colliding and not self._bits_meet(a, b):
            return BITS
        return None

    def _is_parent(self, a: int, b: int) -> bool:
        """True if one is the parent of the other, welded bodies counting as one; the world is no parent."""
        bodies = self.model.bodies
        one, other = bodies[a].welded_to, bodies[b].welded_to
        parents = [bodies[bodies[end].parent].welded_to for end in (one, other)]
        return 0 not in (one, other) and (one == parents[1] or other == parents[0])

    def _bits_meet(self, a: int, b: int) -> bool:
        """True if two of their geoms may collide."""
        return any(
            one.contype & other.conaffinity or other.contype & one.conaffinity
            for one, other in itertools.product(self._geoms[a], self._geoms[b])
        )
