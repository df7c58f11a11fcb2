"""What robots have in hand: the link and robot that a carried part, and all that stands on it, is on at last."""

from __future__ import annotations

from clearance.world.case import Case
from clearance.world.forest import WORLD, carried_by, forest_of
from clearance.world.phase import Phase


def holding_link(phase: Phase, i_obstacle: int) -> tuple[int, int] | None:
    """The robot and its link that hold an obstacle in a phase; None for what is not in hand, or absent.

    A part that is carried by something that no robot carries is in no robot's hand.
    """
    if not _is_in_hand(phase, i_obstacle):
        return None
    return link_below(phase, i_obstacle)


def link_below(phase: Phase, i_obstacle: int) -> tuple[int, int] | None:
    """The robot and its link that an obstacle is on in a phase, carried or riding; None where there is none."""
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


def _is_in_hand(phase: Phase, i_obstacle: int) -> bool:
    """True if an obstacle is carried, or stands on one that is."""
    obstacles = phase.case.obstacles
    places = {obstacle.name: i for i, obstacle in enumerate(obstacles)}
    while obstacles[i_obstacle].name not in phase.carried:
        mount = obstacles[i_obstacle].mount
        if mount is None or mount.on not in places:
            return False
        i_obstacle = places[mount.on]
    return True


def robots_below(case: Case, i_robot: int) -> list[int]:
    """The robots that a robot stands on, nearest first, in a case in which nothing changes hands."""
    forest = forest_of(case)
    found: list[int] = []
    for above in carried_by(forest, forest.robot_starts[i_robot]):
        for i, start in enumerate(forest.robot_starts):
            if i != i_robot and start <= above < start + len(case.robots[i].robot.link_names):
                found += [i] if i not in found else []
    return found
