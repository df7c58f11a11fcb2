"""What tables and reports call the bodies of a pair."""

from __future__ import annotations

from collections.abc import Sequence

from clearance.world.case import Case
from clearance.world.pairs import Pair


def pair_names(case: Case, pairs: Sequence[Pair]) -> tuple[list[str], list[str]]:
    """The link and the obstacle of each pair; links carry their robot's name where there are several."""
    several = len(case.robots) > 1
    links = []
    for pair in pairs:
        robot = case.robots[pair.i_robot].robot
        name = robot.bodies[pair.i_body].name
        links.append(f"{robot.name}/{name}" if several else name)
    return links, [case.obstacles[pair.i_obstacle].name for pair in pairs]
