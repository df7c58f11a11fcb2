"""What the clearance of a moment changes by, with each joint, base and obstacle: one-sided, exact.

The distance of two bodies has a slope each way in whatever moves them, and the two differ where several nearest
points, or several pairs, are as near: parallel faces, a body midway between two. So every pair within `BAND` of
the nearest is measured again a step of `STEP` either way, and each way the least of their slopes counts.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from clearance.query.pair_query import Query
from clearance.record.moment import Moment
from clearance.record.sensitivity import NO_SLOPE, Rate, Sensitivity
from clearance.simulate.answers.handling import gap_between
from clearance.simulate.answers.point_motion import owners_of
from clearance.simulate.answers.rule_pairs import MeasuredRule
from clearance.simulate.answers.transfers import Transfers
from clearance.simulate.measure.sections import Section
from clearance.world.case import Case
from clearance.world.forest import forest_of, positions_between
from clearance.world.pairs import Pair

STEP = 1e-7
"""[rad] or [m] Slopes are off by at most STEP x lever² / (2 x distance), where they change; rounding adds 1e-8."""

BAND = 1e-5
"""[m] A pair that is no farther above the nearest counts with it: as little takes it there."""

LEAST = 1e-5
"""[m] Bodies that are nearer have no lasting slope: they count as touching."""


def sensitivity_of(rules: Sequence[MeasuredRule], moment: Moment) -> Sensitivity:
    """That of a moment, of the pairs that some rules judge."""
    if moment.touches:
        return Sensitivity(why_not="the bodies are in contact")
    if moment.time_b is not None:
        return Sensitivity(why_not="the clocks of the bodies are not tied")
    if any(rule.pairs is None for rule in rules):
        return Sensitivity(why_not="only the nearest pair of each step is known")
    answers = [answer for rule in rules if rule.pairs for answer in rule.pairs.answers]
    sections = [one.section for one in answers if _covers(one.section, moment)]
    near = [found for section in sections for found in _near(section, moment)]
    if not any({*one.names} == {moment.link, moment.obstacle} for one in near):
        return Sensitivity(why_not="its pair is not measured at one time")
    if min(one.distance for one in near) < LEAST:
        return Sensitivity(why_not="the bodies are all but in contact")
    return Sensitivity(tuple(one.names for one in near), tuple(_rates(near)))


def _covers(section: Section, moment: Moment) -> bool:
    last = moment.step + int(moment.between)
    return section.tied and section.steps.start <= moment.step and last < section.steps.stop


@dataclass(frozen=True, eq=False)
class _NearPair:
    """A pair at the moment.

    Attributes:
        columns: (m,) of the forest there. distance: [m] without padding.
    """

    section: Section
    pair: Pair
    columns: np.ndarray
    distance: float

    @property
    def case(self) -> Case:
        return self.section.phase.case

    @property
    def names(self) -> tuple[str, str]:
        return self.pair.a.name_in(self.case), self.pair.b.name_in(self.case)

    @property
    def clearance(self) -> float:
        """[m] Less padding."""
        return self.distance - self.section.padding

    @cached_property
    def slopes(self) -> np.ndarray:
        """(joints + 3, 2) [m per unit] more and less: of each joint, and of b moved along x, y and z."""
        n = n_joint_columns(self.case)
        steps = np.zeros((2 * n, len(self.columns)))
        steps[np.arange(n), np.arange(n)] = STEP
        steps[n + np.arange(n), np.arange(n)] = -STEP
        still = np.zeros((6, len(self.columns)))
        poses = forest_of(self.case).poses(self.columns + np.concatenate([steps, still]))
        a, b = (np.array(body.poses_in(self.case, poses)) for body in self.pair)
        b[2 * n :, :3, 3] += STEP * np.concatenate([np.eye(3), -np.eye(3)])
        found = Query(*(body.shape_in(self.case) for body in self.pair)).distances(a, b)
        slopes = (found.distances - self.distance) / STEP
        more = np.concatenate([slopes[:n], slopes[2 * n : 2 * n + 3]])
        return np.column_stack([more, np.concatenate([slopes[n : 2 * n], slopes[2 * n + 3 :]])])

    def along(self, *, moves_a: bool, moves_b: bool) -> np.ndarray:
        """(3, 2) more and less where a, b, both or neither move along x, y and z."""
        own = self.slopes[-3:]
        if moves_a == moves_b:
            return np.zeros((3, 2))
        return own if moves_b else own[:, ::-1]


def n_joint_columns(case: Case) -> int:
    """How many of a forest's columns are joints of robots: they come first."""
    return sum(len(placed.robot.moving_joints) for placed in case.robots)


def _near(section: Section, moment: Moment) -> list[_NearPair]:
    """The pairs of a section that are at most `BAND` farther than the moment's."""
    case, own = section.phase.case, moment.step - section.phase.first
    motions = section.phase.motions
    columns = positions_between(case, motions, own, moment.share)
    poses = forest_of(case).poses(columns[None])
    reach = moment.clearance + section.padding + BAND
    found = []
    for pair in section.pairs:
        a, b = ((body.shape_in(case), body.poses_in(case, poses)[0]) for body in pair)
        distance = gap_between(*a, *b, far=reach)
        if distance <= reach:
            found.append(_NearPair(section, pair, columns, distance))
    return found


def _rates(near: list[_NearPair]) -> Iterator[Rate]:
    """All that move at least one of the pairs, the least of the slopes of all pairs each way."""
    case = near[0].case
    n, column = n_joint_columns(case), 0
    joints = np.min([one.slopes[:n] for one in near], axis=0)
    moved = np.any([np.abs(one.slopes[:n]) > NO_SLOPE for one in near], axis=(0, 2))
    for placed in case.robots:
        for joint in placed.robot.moving_joints:
            if moved[column]:
                unit = "m" if joint.kind == "prismatic" else "rad"
                yield _rate("joint", placed.robot.name, joint.name, unit, joints[column])
            column += 1
    yield from _of_places(near, case)


def _of_places(near: list[_NearPair], case: Case) -> Iterator[Rate]:
    """Of bases and obstacles that stand or move by themselves.

    Parts that are picked up or let go elsewhere where they are moved are not reported: their way depends on how
    they are turned since.
    """
    robots = [("base", one.robot.name, one.mount, (False, i)) for i, one in enumerate(case.robots)]
    obstacles = [
        ("obstacle", one.name, one.mount, (True, i)) for i, one in enumerate(case.obstacles)
    ]
    for kind, name, mount, thing in (*robots, *obstacles):
        transfers = Transfers(case, thing)
        if mount is not None or any(transfers.has_of(one.case, one.pair) for one in near):
            continue
        sides = [tuple(thing in owners_of(one.case, body) for body in one.pair) for one in near]
        if not any(a != b for a, b in sides):
            continue
        rows = [one.along(moves_a=a, moves_b=b) for one, (a, b) in zip(near, sides, strict=True)]
        least = np.min(rows, axis=0)
        for axis, slopes in zip("xyz", least, strict=True):
            yield _rate(kind, name, axis, "m", slopes)


def _rate(kind: str, of: str, name: str, unit: str, slopes: np.ndarray) -> Rate:
    """The rate of both slopes; one that is true both ways is their mean, which is off by less."""
    more, less = (0.0 if abs(slope) < NO_SLOPE else float(slope) for slope in slopes)
    made = Rate(kind, of, name, unit, more, less)
    if made.both_ways:
        mean = (more - less) / 2.0
        return replace(made, more=mean, less=-mean)
    return made
