"""What robots carry: the link and robot that an obstacle, in hand or mounted, is on at last."""

from __future__ import annotations

from collections.abc import Iterator

from clearance.world.case import Case
from clearance.world.forest import carried_by, forest_of
from clearance.world.phase import Phase


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
