"""Which bodies are measured against which, by which rule, and why the others are not."""

from __future__ import annotations

import itertools
from collections.abc import Collection, Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from functools import cached_property
from typing import NamedTuple

import numpy as np

from clearance.errors import NothingToMeasure
from clearance.geometry.polyhedron import Polyhedron
from clearance.world.body import Body
from clearance.world.carry import Carry
from clearance.world.case import Case, Omission
from clearance.world.cell import once_a_cell
from clearance.world.extents import own_floor
from clearance.world.forest import WORLD, Forest, forest_of
from clearance.world.phase import Phase
from clearance.world.placed_robot import SelfClearance
from clearance.world.rules import matches
from clearance.world.self_pairs import RIGID, self_pairs

OBSTACLE = -1

NO_GEOMETRY = "no geometry"
"""Why a link without a shape is left out."""
"""Stands for the robot of a body that is an obstacle."""


class BodyIndex(NamedTuple):
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

    @property
    def thing(self) -> tuple[bool, int]:
        """Its obstacle as (True, i), or its robot as (False, i)."""
        return self.is_obstacle, self.i_body if self.is_obstacle else self.i_robot

    def shape_in(self, case: Case) -> Polyhedron:
        """Its shape, in its own frame."""
        return self.body_in(case).shape

    def own_name_in(self, case: Case) -> str:
        """Its name without its robot's."""
        return self.body_in(case).name

    def name_in(self, case: Case) -> str:
        """Its name; that of a link has its robot's before it where there are several."""
        name = self.own_name_in(case)
        return name if self.is_obstacle else case.prefix_of(case.robots[self.i_robot]) + name

    def link_in(self, case: Case) -> int:
        """Which of its robot's links it is of."""
        return case.robots[self.i_robot].robot.link_names.index(self.body_in(case).name)

    def frame_in(self, case: Case) -> int:
        """The link of the case's forest that it is fixed to, at the link's own pose; `WORLD` for what stands."""
        forest = forest_of(case)
        if self.is_obstacle:
            return forest.obstacle_links[self.i_body]
        return forest.robot_starts[self.i_robot] + self.link_in(case)

    def poses_in(self, case: Case, link_poses: np.ndarray) -> np.ndarray:
        """(n, 4, 4) `world_from_body` [m], from (n, links, 4, 4) of the case's forest."""
        frame = self.frame_in(case)
        if frame == WORLD:
            standing = case.obstacles[self.i_body].world_from_body
            return np.broadcast_to(standing, (len(link_poses), 4, 4)).copy()
        return np.ascontiguousarray(link_poses[:, frame])

    def padding_in(self, case: Case) -> float:
        """[m] The reduction of its clearance: the given padding, and the shortfall of its surface."""
        shortfall = self.shape_in(case).shortfall
        if self.is_obstacle:
            return case.obstacles[self.i_body].padding + shortfall
        return case.robots[self.i_robot].padding.get(self.own_name_in(case), 0.0) + shortfall

    def is_floor_in(self, case: Case) -> bool:
        """True for the link of floor and walls of a robot's own file, where that stands in the world."""
        if self.is_obstacle:
            return False
        return self.own_name_in(case) == own_floor(case.robots[self.i_robot])

    def body_in(self, case: Case) -> Body:
        """Its name and shape."""
        if self.is_obstacle:
            return case.obstacles[self.i_body].body
        return case.robots[self.i_robot].robot.bodies[self.i_body]


def bodies_of(case: Case) -> list[BodyIndex]:
    """All bodies of a case: links robot by robot, then obstacles."""
    links = [
        BodyIndex(i, k)
        for i, placed in enumerate(case.robots)
        for k in range(len(placed.robot.bodies))
    ]
    return links + [BodyIndex(OBSTACLE, i) for i in range(len(case.obstacles))]


class Pair(NamedTuple):
    """Two bodies whose clearance is wanted.

    Attributes:
        a: a link, or an obstacle where both are. b: any body; of two links of one robot the earlier one.
    """

    a: BodyIndex
    b: BodyIndex

    def has_cloud(self, case: Case) -> bool:
        """True if either body is a cloud of points."""
        return self.a.body_in(case).is_cloud or self.b.body_in(case).is_cloud


@dataclass(frozen=True, eq=False)
class Selection:
    """The pairs that are measured in a phase of a run; nobody changes it.

    Attributes:
        pairs: links and obstacles robot by robot, then links of one robot, then of two, then obstacles.
        rules: of each pair what judges it, as `Limits.rule_names` counts. paddings: [m] of both of its
            bodies, and what paths may be off.
        unmeasured: omitted links and pairs, and why.
    """

    pairs: list[Pair] = field(default_factory=list)
    rules: list[int] = field(default_factory=list)
    paddings: list[float] = field(default_factory=list)
    unmeasured: list[Omission] = field(default_factory=list)

    @cached_property
    def alike(self) -> dict[tuple[int, float], tuple[Pair, ...]]:
        """The pairs that one rule judges, with one padding [m]; by rule, then padding."""
        found: dict[tuple[int, float], list[Pair]] = {}
        for pair, rule, padding in zip(self.pairs, self.rules, self.paddings, strict=True):
            found.setdefault((rule, padding), []).append(pair)
        return {key: tuple(pairs) for key, pairs in sorted(found.items())}


def measured_pairs(case: Case) -> tuple[list[Pair], list[Omission]]:
    """The pairs to measure, and the omitted ones, of a case in which nothing changes hands.

    Raises:
        NothingToMeasure: there is no pair.
    """
    selection = measured_selection(case)
    return selection.pairs, selection.unmeasured


def measured_selection(case: Case) -> Selection:
    """The same, with what judges each pair and its padding.

    Raises:
        NothingToMeasure: there is no pair.
    """
    rows = (case.allow, case.limits.rules)
    always = (-np.inf, np.inf)
    active = [tuple(row.is_active(*always, ()) for row in table) for table in rows]
    selection = _selected(case, *active, (), frozenset(), frozenset())
    if not selection.pairs:
        raise nothing_to_measure()
    return selection


def selected_pairs(phase: Phase) -> Selection:
    """The pairs to measure in a phase; there may be none."""
    case, span, carried = phase.case, phase.span, phase.carried
    rows = (case.allow, case.limits.rules)
    active = [tuple(row.is_active(*span, carried) for row in table) for table in rows]
    who = tuple(sorted(carried.items()))
    return _selected(case, *active, who, phase.absent_robots, phase.absent_obstacles)


@once_a_cell(16)
def _selected(
    case: Case,
    allow: tuple[bool, ...],
    rules: tuple[bool, ...],
    carried: tuple[tuple[str, Carry], ...],
    absent_robots: frozenset[int],
    absent_obstacles: frozenset[int],
) -> Selection:
    """The same, from which rows of `allow` and of rules are active, and who carries what."""
    active = (allow, rules)
    return _Selector(case, active, dict(carried), absent_robots, absent_obstacles).selection()


def nothing_to_measure() -> NothingToMeasure:
    """The error to raise where there is no pair."""
    return NothingToMeasure(
        "no link-obstacle pair is left to measure",
        valid="at least one obstacle, and a link with geometry that is not excluded or allowed",
    )


@dataclass(eq=False)
class _Selector:
    """Sorts the pairs of a case, in a stretch of its run, into those that are measured and those that are not."""

    case: Case
    active: tuple[tuple[bool, ...], tuple[bool, ...]]
    carried: Mapping[str, Carry]
    absent_robots: frozenset[int]
    absent_obstacles: frozenset[int]
    found: Selection = field(default_factory=Selection)

    def __post_init__(self) -> None:
        case = self.case
        self.forest: Forest = forest_of(case)
        self.stands_alone = all(obstacle.stands for obstacle in case.obstacles) and not any(
            placed.mount for placed in case.robots
        )
        self.robots = [i for i in range(len(case.robots)) if i not in self.absent_robots]
        obstacles = range(len(case.obstacles))
        self.obstacles = [
            BodyIndex(OBSTACLE, i) for i in obstacles if i not in self.absent_obstacles
        ]
        self.allow = [*itertools.compress(case.allow, self.active[0])]
        rules = enumerate(case.limits.rules, start=1)
        self.rules = [*itertools.compress(rules, self.active[1])]

    def selection(self) -> Selection:
        """All pairs, sorted."""
        case = self.case
        for i_robot in self.robots:
            self.found.unmeasured.extend(_omitted_links(case, i_robot))
            for link in _links(case, i_robot):
                self._sort_out((link, other) for other in self.obstacles)
        for i_robot in self.robots:
            if case.robots[i_robot].self_clearance:
                self._sort_out(self._unexcused(i_robot))
        for i_robot, i_other in itertools.combinations(self.robots, 2):
            self._sort_out(itertools.product(_links(case, i_robot), _links(case, i_other)))
        self._sort_out(self._of_obstacles())
        return self.found

    def _of_obstacles(self) -> Iterator[tuple[BodyIndex, BodyIndex]]:
        """Two obstacles that can move against each other."""
        if self.stands_alone:
            return
        for one, other in itertools.combinations(self.obstacles, 2):
            parts = [self._rigid_part(body) for body in (one, other)]
            if parts[0] != parts[1]:
                yield one, other

    def _unexcused(self, i_robot: int) -> Iterator[tuple[BodyIndex, BodyIndex]]:
        """Pairs of links of one robot, the later link first; those that are excused are noted."""
        case, placed = self.case, self.case.robots[i_robot]
        asked = placed.self_clearance or SelfClearance()
        links = {placed.robot.bodies[link.i_body].name: link for link in _links(case, i_robot)}
        for pair in self_pairs(placed.robot, asked.matrix, trust_never=asked.trust_never):
            if pair.link_a not in links or pair.link_b not in links:
                continue
            one, other = links[pair.link_b], links[pair.link_a]
            if pair.excused is None:
                yield one, other
            elif pair.excused != RIGID:
                self._leave_out(one, other, f"excused: {pair.excused}")

    def _sort_out(self, bodies: Iterable[tuple[BodyIndex, BodyIndex]]) -> None:
        """Adds measured pairs to the pairs, and the others to the omissions."""
        for one, other in bodies:
            why = self._why_not(one, other)
            if why is not None:
                self._leave_out(one, other, why)
                continue
            self.found.pairs.append(Pair(one, other))
            self.found.rules.append(self._rule_of(one, other))
            paddings = one.padding_in(self.case) + other.padding_in(self.case)
            self.found.paddings.append(paddings + self.case.path_error)

    def _why_not(self, one: BodyIndex, other: BodyIndex) -> str | None:
        """Why a pair is not measured, or None."""
        names = names_of(self.case, one), names_of(self.case, other)
        ordered = other.is_obstacle and not one.is_obstacle
        for row in self.allow:
            if row.matches_in_order(*names) if ordered else row.matches(*names):
                return str(row)
        for part, mate in (names, names[::-1]):
            carry = self.carried.get(part[0])
            why = None if carry is None else _why_while_carried(carry, mate)
            if why is not None:
                return why
        if self._is_rigid(one, other):
            return "moves with it"
        return "both stand in the world" if self._stand_together(one, other) else None

    def _stand_together(self, one: BodyIndex, other: BodyIndex) -> bool:
        """True if one is the floor of a robot's own file, and the other stands as well: nothing moves them."""
        case = self.case
        if one.is_floor_in(case) and other.is_floor_in(case):
            return True
        for floor, body in ((one, other), (other, one)):
            if floor.is_floor_in(case) and body.is_obstacle:
                return self._rigid_part(body) == WORLD
        return False

    def _is_rigid(self, one: BodyIndex, other: BodyIndex) -> bool:
        """True if two bodies, not of one robot, are joined by fixed joints and neither stands in the world."""
        if self.stands_alone:
            return False
        if one.i_robot == other.i_robot and not one.is_obstacle:
            return False
        part = self._rigid_part(one)
        return part != WORLD and part == self._rigid_part(other)

    def _rigid_part(self, body: BodyIndex) -> int:
        frame = body.frame_in(self.case)
        return WORLD if frame == WORLD else self.forest.rigid_part(frame)

    def _rule_of(self, one: BodyIndex, other: BodyIndex) -> int:
        """The judge of a pair: the last rule that matches it, or the limits by themselves."""
        names = names_of(self.case, one), names_of(self.case, other)
        return next((i for i, rule in reversed(self.rules) if rule.matches(*names)), 0)

    def _leave_out(self, one: BodyIndex, other: BodyIndex, reason: str) -> None:
        names = one.name_in(self.case), other.name_in(self.case)
        self.found.unmeasured.append(Omission(*names, reason))


def _why_while_carried(carry: Carry, mate: Collection[str]) -> str | None:
    """Why a part that is carried is not measured against a body of some names, or None."""
    if carry.by in mate:
        return f"moves with it while {carry.part} is carried {carry.window}"
    for pattern in carry.touch:
        if any(matches(name, pattern) for name in mate):
            return carry.excuse(pattern)
    return None


def _links(case: Case, i_robot: int) -> list[BodyIndex]:
    """The links of a robot that have a shape and are not excluded."""
    placed = case.robots[i_robot]
    excluded = frozenset(placed.exclude_links)
    bodies = enumerate(placed.robot.bodies)
    return [BodyIndex(i_robot, i) for i, body in bodies if body.name not in excluded]


def _omitted_links(case: Case, i_robot: int) -> list[Omission]:
    placed = case.robots[i_robot]
    before = case.prefix_of(placed)
    with_shape = {body.name for body in placed.robot.bodies}
    excluded = frozenset(placed.exclude_links)
    omitted = [
        Omission(before + name, "*", "excluded in the case file") for name in placed.exclude_links
    ]
    omitted += [
        Omission(before + name, "*", NO_GEOMETRY)
        for name in placed.robot.link_names
        if name not in with_shape and name not in excluded
    ]
    return omitted


def names_of(case: Case, body: BodyIndex) -> tuple[str, ...]:
    """The names that a pattern may be of: the body's, and a link's without its robot's."""
    name, own = body.name_in(case), body.own_name_in(case)
    return (name,) if name == own else (name, own)
