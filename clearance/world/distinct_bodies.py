"""Checks on the bodies of one case: links have surfaces, and all names are different."""

from __future__ import annotations

from collections.abc import Sequence

from clearance.errors import BadInput, BadShape, DuplicateName
from clearance.world.body import Obstacle
from clearance.world.robot import Robot


def require_surfaces(robot: Robot) -> None:
    """Refuses links that are clouds of points."""
    for body in robot.bodies:
        if body.is_cloud:
            raise BadShape(
                f"link {body.name!r} of robot {robot.name!r} is a cloud of points",
                valid="links have surfaces; only obstacles may be clouds",
            )


def require_distinct_names(robots: Sequence[Robot], obstacles: Sequence[Obstacle]) -> None:
    """Refuses names that several links or obstacles share."""
    for i, robot in enumerate(robots):
        if "/" in robot.name:
            raise BadInput(
                f"robot {robot.name!r} has a '/' in its name",
                where=f"robots[{i}]",
                valid="another name, since links of several robots are called robot/link",
            )
    names = {robot.name for robot in robots}
    names |= {f"{robot.name}/{link}" for robot in robots for link in robot.link_names}
    names |= {link for robot in robots for link in robot.link_names}  # as patterns say them
    for i, obstacle in enumerate(obstacles):
        if obstacle.name in names:
            raise DuplicateName(
                f"an obstacle and a robot or its link are both called {obstacle.name!r}",
                where=f"obstacles[{i}]",
                valid="another name for the obstacle",
            )


def require_other_names(robot: Robot, obstacles: Sequence[Obstacle]) -> None:
    """Refuses an obstacle with a link's name where a name could be either's."""
    for obstacle in obstacles:
        if obstacle.name in robot.link_names:
            raise DuplicateName(
                f"an obstacle and a link of robot {robot.name!r} are both called {obstacle.name!r}",
                valid="another name for the obstacle, since links are meant by their names too",
            )
