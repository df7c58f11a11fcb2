"""One robot among all that moves in its case: its name, where its links are, what it stands on and carries."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from clearance.errors import BadInput
from clearance.world.case import Case
from clearance.world.forest import carried_by, forest_of, link_poses_at
from clearance.world.motion import kinematic_motion
from clearance.world.phase import Phase
from clearance.world.placed_robot import PlacedRobot
from clearance.world.timeline import Timeline, timeline_of


@dataclass(frozen=True, eq=False)
class RobotInCell:
    """A robot of one of several cases.

    Attributes:
        name: unique among them. i_case: which case it is of, from 0. i_robot: which robot of that case.
    """

    name: str
    i_case: int
    i_robot: int
    timeline: Timeline

    @property
    def placed(self) -> PlacedRobot:
        """The robot as its case has it."""
        return self.timeline.motions[self.i_robot].placed

    @property
    def n_steps(self) -> int:
        """Steps of its case's run."""
        return len(self.timeline.times)

    def poses(self, step: int) -> np.ndarray:
        """(links, 4, 4) `world_from_link` [m] of its links at a step of the run."""
        phase = self.timeline.phase_of(step)
        own = slice(step - phase.first, step - phase.first + 1)
        start = forest_of(phase.case).robot_starts[self.i_robot]
        links = slice(start, start + len(self.placed.robot.link_names))
        return link_poses_at(phase.case, phase.motions, own)[0, links]

    def stands_on(self, other: RobotInCell) -> bool:
        """True if it stands on a link of another robot, or on something that does."""
        below = robots_below(self.timeline.phases[0].case, self.i_robot)
        return self.i_case == other.i_case and other.i_robot in below


def robots_in_cell(cases: Sequence[Case]) -> list[RobotInCell]:
    """All robots, each with a name of its own: the robot's, with its case's where that is not enough.

    Raises:
        BadInput: fewer than two. NoTrajectory: a case in which nothing moves.
    """
    names = [(case.name, placed.robot.name) for case in cases for placed in case.robots]
    if len(names) < 2:
        raise BadInput(
            f"{len(names)} robot is given", valid="cases with two or more robots in all are needed"
        )
    unique = iter(_unique_names(names))
    timelines = [timeline_of(case, [*map(kinematic_motion, case.robots)]) for case in cases]
    return [
        RobotInCell(next(unique), i_case, i_robot, timeline)
        for i_case, timeline in enumerate(timelines)
        for i_robot in range(len(timeline.motions))
    ]


def _unique_names(found: Sequence[tuple[str, str]]) -> list[str]:
    """A name for each of some pairs of a case's and a robot's name."""
    names = [name for _, name in found]
    full = [name if names.count(name) == 1 else f"{case}/{name}" for case, name in found]
    return [
        name if full.count(name) == 1 else f"{name}#{full[: i + 1].count(name)}"
        for i, name in enumerate(full)
    ]


def link_below(phase: Phase, i_obstacle: int) -> tuple[int, int] | None:
    """The robot and its link that an obstacle is on in a phase, carried or mounted; None where there is none."""
    if i_obstacle in phase.absent_obstacles:
        return None
    case = phase.case
    return next(_carriers(case, forest_of(case).obstacle_links[i_obstacle]), None)


def robots_below(case: Case, i_robot: int) -> list[int]:
    """The robots that a robot stands on, nearest first, in a case in which nothing changes hands."""
    below = (i for i, _ in _carriers(case, forest_of(case).robot_starts[i_robot]) if i != i_robot)
    return list(dict.fromkeys(below))


def _carriers(case: Case, link: int) -> Iterator[tuple[int, int]]:
    """The robot, and its link, of each link that carries a link of the forest, nearest first."""
    forest = forest_of(case)
    for above in carried_by(forest, link):
        for i_robot, start in enumerate(forest.robot_starts):
            if start <= above < start + len(case.robots[i_robot].robot.link_names):
                yield i_robot, above - start
