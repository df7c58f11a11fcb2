"""Lengths of bodies, reach of robots, and lengths in words: sizes and places are compared with them;
and floor and walls of a robot's own file.
"""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from clearance.world.body import Body
from clearance.world.case import PlacedRobot
from clearance.world.robot import WORLD_LINK, JointKind, Robot


def reach_of(placed: PlacedRobot) -> float:
    """[m] length of its longest chain of joints, slides included, and of its median body."""
    lengths = [length_of(body) for body in own_bodies(placed.robot)]
    return chain_of(placed) + (float(np.median(lengths)) if lengths else 0.0)


def own_bodies(robot: Robot) -> list[Body]:
    """Its links that have a shape, without the link of floor and walls of its own file."""
    first = 1 if robot.brings_surroundings else 0
    return [*robot.bodies[first:]]


def own_floor(placed: PlacedRobot) -> str | None:
    """The link of floor and walls of the robot's own file, if there are some and they stand."""
    return WORLD_LINK if placed.robot.brings_surroundings and placed.mount is None else None


def chain_of(placed: PlacedRobot) -> float:
    """[m] the longest path from the root over joints' origins, sliding joints as far as they go."""
    slides = dict(slides_of(placed))
    path = {placed.robot.link_names[0]: 0.0}
    for joint in placed.robot.joints:
        step = float(np.linalg.norm(joint.parent_from_joint[:3, 3]))
        step += slides.get(joint.name, 0.0)
        path[joint.child] = path[joint.parent] + step
    return max(path.values())


def slides_of(placed: PlacedRobot) -> tuple[tuple[str, float], ...]:
    """How far [m] each sliding joint goes that is asked to."""
    asked = placed.trajectory
    columns = {} if asked is None else {name: i for i, name in enumerate(asked.joint_names)}
    return tuple(
        (joint.name, float(np.abs(asked.positions[:, columns[joint.name]]).max(initial=0.0)))
        for joint in placed.robot.joints
        if asked is not None and joint.kind is JointKind.PRISMATIC and joint.name in columns
    )


def length_of(body: Body) -> float:
    """[m] the longest side of a body's box."""
    return float(np.ptp(body.shape.bounds, axis=0).max())


def greatest(found: Iterable[tuple[float, str]]) -> list[tuple[float, str]]:
    """The findings, the greatest number first."""
    return sorted(found, key=lambda item: -item[0])


def metres(length: float) -> str:
    """A length [m] in three digits, never in powers of ten for what is long."""
    return f"{length:.3g}" if length < 1000.0 else f"{length:.0f}"
