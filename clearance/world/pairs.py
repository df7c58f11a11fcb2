"""Which bodies are measured against which, and why the others are not."""

from __future__ import annotations

import itertools
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from fnmatch import fnmatchcase

import numpy as np

from clearance.errors import NothingToMeasure
from clearance.geometry.polyhedron import Polyhedron
from clearance.world.body import Body
from clearance.world.case import Case, Omission, PlacedRobot, SelfClearance
from clearance.world.self_pairs import RIGID, self_pairs

OBSTACLE = -1
"""Stands for the robot of a body that is an obstacle."""


@dataclass(frozen=True, order=True)
class BodyIndex:
    """A body of a case.

    Attributes:
        i_robot: into `case.robots`, or `OBSTACLE`.
        i_body: into the robot's `bodies`, or into `case.obstacles`.
    """

    i_robot: int
    i_body: int

    @property
    def is_obstacle(self) -> bool:
        """False for a link of a robot."""
        return self.i_robot == OBSTACLE

    def shape_in(self, case: Case) -> Polyhedron:
        """Its shape, in its own frame."""
        return self.body_in(case).shape

    def own_name_in(self, case: Case) -> str:
        """Its name without its robot's."""
        return self.body_in(case).name

    def name_in(self, case: Case) -> str:
        """Its name; that of a link has its robot's before it where there are several."""
        name = self.own_name_in(case)
        if self.is_obstacle or len(case.robots) == 1:
            return name
        return f"{case.robots[self.i_robot].robot.name}/{name}"

    def link_in(self, case: Case) -> int:
        """Which of its robot's links it is of."""
        return case.robots[self.i_robot].robot.link_names.index(self.body_in(case).name)

    def poses_in(self, case: Case, link_poses: Sequence[np.ndarray]) -> np.ndarray:
        """(n, 4, 4) `world_from_body` [m], from (n, n_links, 4, 4) of each robot."""
        if self.is_obstacle:
            standing = case.obstacles[self.i_body].world_from_body
            return np.broadcast_to(standing, (len(link_poses[0]), 4, 4)).copy()
        return np.ascontiguousarray(link_poses[self.i_robot][:, self.link_in(case)])

    def body_in(self, case: Case) -> Body:
        """Its name and shape."""
        if self.is_obstacle:
            return case.obstacles[self.i_body].body
        return case.robots[self.i_robot].robot.bodies[self.i_body]


@dataclass(frozen=True)
class Pair:
    """Two bodies whose clearance is wanted.

    Attributes:
        a: a link. b: a link or an obstacle; of two links of one robot, one that does not hang on `a`.
    """

    a: BodyIndex
    b: BodyIndex


def measured_pairs(case: Case) -> tuple[list[Pair], list[Omission]]:
    """The pairs to measure, and what is left out.

    Robots first, then links, then obstacles in their order; then the links of each robot that is to be measured
    against itself; then those of each two robots.

    Raises:
        NothingToMeasure: no pair is left.
    """
    pairs: list[Pair] = []
    unmeasured: list[Omission] = []
    for i_robot, placed in enumerate(case.robots):
        unmeasured += _links_left_out(placed)
        for link in _links(case, i_robot):
            others = (BodyIndex(OBSTACLE, k) for k in range(len(case.obstacles)))
            _sort_out(case, ((link, other) for other in others), pairs, unmeasured)
    for i_robot, placed in enumerate(case.robots):
        if placed.self_clearance:
            _sort_out(case, _unexcused(case, i_robot, unmeasured), pairs, unmeasured)
    for i_robot, i_other in itertools.combinations(range(len(case.robots)), 2):
        both = itertools.product(_links(case, i_robot), _links(case, i_other))
        _sort_out(case, both, pairs, unmeasured)
    if not pairs:
        raise NothingToMeasure(
            "no link-obstacle pair is left to measure",
            valid="at least one obstacle, and a link with geometry that is not excluded or allowed",
        )
    return pairs, unmeasured


def _links(case: Case, i_robot: int) -> list[BodyIndex]:
    """The links of a robot that have a shape and are not excluded."""
    placed = case.robots[i_robot]
    excluded = frozenset(placed.exclude_links)
    bodies = enumerate(placed.robot.bodies)
    return [BodyIndex(i_robot, i) for i, body in bodies if body.name not in excluded]


def _unexcused(
    case: Case, i_robot: int, unmeasured: list[Omission]
) -> Iterator[tuple[BodyIndex, BodyIndex]]:
    """Pairs of links of one robot, the later link first; those that are excused are noted."""
    placed = case.robots[i_robot]
    asked = placed.self_clearance or SelfClearance()
    links = {placed.robot.bodies[link.i_body].name: link for link in _links(case, i_robot)}
    for pair in self_pairs(placed.robot, asked.matrix, trust_never=asked.trust_never):
        if pair.link_a not in links or pair.link_b not in links:
            continue
        one, other = links[pair.link_b], links[pair.link_a]
        if pair.excused is None:
            yield one, other
        elif pair.excused != RIGID:
            reason = f"excused: {pair.excused}"
            unmeasured.append(Omission(one.name_in(case), other.name_in(case), reason))


def _sort_out(
    case: Case,
    bodies: Iterable[tuple[BodyIndex, BodyIndex]],
    pairs: list[Pair],
    unmeasured: list[Omission],
) -> None:
    """Adds what is measured to the pairs, and what a rule of the case allows to what is not."""
    for one, other in bodies:
        rule = _allowing_rule(case, one, other)
        if rule is None:
            pairs.append(Pair(one, other))
        else:
            reason = f"allowed by {list(rule)}"
            unmeasured.append(Omission(one.name_in(case), other.name_in(case), reason))


def _links_left_out(placed: PlacedRobot) -> list[Omission]:
    with_shape = {body.name for body in placed.robot.bodies}
    excluded = frozenset(placed.exclude_links)
    left_out = [Omission(name, "*", "excluded in the case file") for name in placed.exclude_links]
    left_out += [
        Omission(name, "*", "no geometry")
        for name in placed.robot.link_names
        if name not in with_shape and name not in excluded
    ]
    return left_out


def _allowing_rule(case: Case, one: BodyIndex, other: BodyIndex) -> tuple[str, str] | None:
    """The first rule that allows two bodies to touch; of two links, in either order."""
    for rule in case.allow:
        if _is_called(case, one, rule[0]) and _is_called(case, other, rule[1]):
            return rule
        if (
            not other.is_obstacle
            and _is_called(case, other, rule[0])
            and _is_called(case, one, rule[1])
        ):
            return rule
    return None


def _is_called(case: Case, body: BodyIndex, pattern: str) -> bool:
    """True if a pattern is of a body's name, or of a link's without its robot's."""
    return matches(body.name_in(case), pattern) or matches(body.own_name_in(case), pattern)


def matches(name: str, pattern: str) -> bool:
    """True if `pattern` is the name itself (which may hold `[`, `*` or `?`) or a wildcard for it."""
    return name == pattern or fnmatchcase(name, pattern)
