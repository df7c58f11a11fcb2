"""What robots carry: the link and robot that an obstacle, in hand or mounted, is on at last."""

from __future__ import annotations

from clearance.world.case import Case
from clearance.world.forest import WORLD, carried_by, forest_of
from clearance.world.phase import Phase


def link_below(phase: Phase, i_obstacle: int) -> tuple[int, int] | None:
    """The robot and its link that an obstacle is on in a phase, carried or mounted; None where there is none."""
    if i_obstacle in phase.absent_obstacles:
        return None
    case = phase.case
    forest = forest_of(case)
    link = forest.obstacle_links[i_obstacle]
    if link == WORLD:
        return None
    for above in carried_by(forest, link):
        for i_robot, start in enumerate(forest.robot_starts):
            if start <= above < start + len(case.robots[i_robot].robot.link_names):
                return i_robot, above - start
    return None


def robots_below(case: Case, i_robot: int) -> list[int]:
    """The robots that a robot stands on, nearest first, in a case in which nothing changes hands."""
    forest = forest_of(case)
    found: list[int] = []
    for above in carried_by(forest, forest.robot_starts[i_robot]):
        for i, start in enumerate(forest.robot_starts):
            if i != i_robot and start <= above < start + len(case.robots[i].robot.link_names):
                found += [i] if i not in found else []
    return found
