"""Lengths of bodies, reach of robots, and lengths in words: sizes and places are compared with them;
and floor and walls of a robot's own file.
"""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from clearance.world.body import Body
from clearance.world.mimics import followers
from clearance.world.placed_robot import PlacedRobot
from clearance.world.robot import WORLD_LINK, JointKind, Robot

PLANE_SIZE = 40.0, 40.0, 20.0
"""[m] The box that stands for an infinite plane, below it: two sides, and how deep it is."""


def reach_of(placed: PlacedRobot) -> float:
    """[m] No point of its links gets farther from its root: offsets, slides and the farthest corner of a link."""
    paths = _paths(placed)
    ends = (paths[body.name] + farthest_corner(body) for body in own_bodies(placed.robot))
    return max(ends, default=chain_of(placed))


def farthest_corner(body: Body) -> float:
    """[m] No point of a body is farther from its frame."""
    return float(np.linalg.norm(np.abs(body.shape.bounds).max(axis=0)))


def own_bodies(robot: Robot) -> list[Body]:
    """Its links that have a shape, without the link of floor and walls of its own file."""
    first = 1 if robot.brings_surroundings else 0
    return [*robot.bodies[first:]]


def own_floor(placed: PlacedRobot) -> str | None:
    """The link of floor and walls of the robot's own file, if there are some and they stand."""
    return WORLD_LINK if placed.robot.brings_surroundings and placed.mount is None else None


def chain_of(placed: PlacedRobot) -> float:
    """[m] the longest path from the root over joints' origins, sliding joints as far as they go."""
    return max(_paths(placed).values())


def _paths(placed: PlacedRobot) -> dict[str, float]:
    """[m] the length of the path from the root to each link."""
    slides = dict(slides_of(placed))
    path = {placed.robot.link_names[0]: 0.0}
    for joint in placed.robot.joints:
        step = float(np.linalg.norm(joint.parent_from_joint[:3, 3]))
        step += slides.get(joint.name, 0.0)
        path[joint.child] = path[joint.parent] + step
    return path


def slides_of(placed: PlacedRobot) -> tuple[tuple[str, float], ...]:
    """How far [m] each sliding joint goes from 0."""
    asked, found = placed.trajectory, []
    columns = {} if asked is None else {name: i for i, name in enumerate(asked.joint_names)}
    for joint, master, factor, offset in followers(placed.robot):
        if joint.kind is not JointKind.PRISMATIC:
            continue
        at = np.array([placed.fixed_positions.get(master, 0.0)])
        if asked is not None and master in columns:
            at = asked.positions[:, columns[master]]
        ends = factor * np.array([at.min(), at.max()]) + offset
        found.append((joint.name, float(np.abs(ends).max())))
    return tuple(found)


def length_of(body: Body) -> float:
    """[m] the longest side of a body's box."""
    return float(np.ptp(body.shape.bounds, axis=0).max())


def greatest(found: Iterable[tuple[float, str]]) -> list[tuple[float, str]]:
    """The findings, the greatest number first."""
    return sorted(found, key=lambda item: -item[0])


def metres(length: float) -> str:
    """A length [m] in three digits, never in powers of ten for what is long."""
    return f"{length:.3g}" if length < 1000.0 else f"{length:.0f}"
