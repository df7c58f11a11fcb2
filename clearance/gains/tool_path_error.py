"""How far a tool is off the path that it is to keep: measured at the samples, bounded between them.

A difference of two paths is, between two moments h apart, no longer than at the farther of both and h^2 / 8 times
what both accelerate by. A chain's second derivatives are no longer than the arm of the outer of two joints,
hence the accelerations follow from the greatest rates of the joints. Turns are held against each other by their
matrices, whose difference has the length sqrt(8) sin(angle / 2). Not for: what is kept (`tool_path`).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from clearance.kernels.motion.kinematics import NO_PARENT, SLIDING
from clearance.world.joint_positions import extremes_of, joint_courses
from clearance.world.joint_speeds import greatest_rates
from clearance.world.knots import knots_of
from clearance.world.placed_robot import PlacedRobot
from clearance.world.tool import Tool

PARTS = 16
"""Of each interval, at whose ends the tool is measured."""


@dataclass(frozen=True)
class ToolPathError:
    """How far a tool is off at most: its origin [m], its turn [rad].

    Attributes:
        link: the tool. far, turn: at the samples. far_between, turn_between: at any moment; no less.
    """

    link: str
    far: float
    turn: float
    far_between: float
    turn_between: float


class _Rates(NamedTuple):
    """(n - 1,) what bounds the tool's acceleration in each interval: of its origin, of the matrix of its turn."""

    place: np.ndarray
    turn: np.ndarray


def tool_path_error(before: PlacedRobot, after: PlacedRobot, tool: Tool) -> ToolPathError:
    """How far the tool of a robot with another base and path is off, both tables at the same times."""
    times = before.given_trajectory.times
    shares = np.arange(PARTS) / PARTS
    moments = np.append((times[:-1, None] + np.diff(times)[:, None] * shares).ravel(), times[-1])
    off = _off(before, after, tool, moments)
    bends = [_accelerations(one, tool) for one in (before, after)]
    quick = np.stack([bends[0].place + bends[1].place, bends[0].turn + bends[1].turn], axis=1)
    bow = quick * (np.diff(times)[:, None] / PARTS) ** 2 / 8.0
    between = (np.maximum(off[:-1], off[1:]) + np.repeat(bow, PARTS, axis=0)).max(axis=0)
    most = off[::PARTS].max(axis=0)
    return ToolPathError(
        tool.name, float(most[0]), _angle(most[1]), float(between[0]), _angle(between[1])
    )


def _angle(length: float) -> float:
    """[rad] The angle between two turns whose matrices differ by so much."""
    return float(2.0 * np.arcsin(min(1.0, length / np.sqrt(8.0))))


def _off(before: PlacedRobot, after: PlacedRobot, tool: Tool, times: np.ndarray) -> np.ndarray:
    """(k, 2) how far the origins are apart [m], and how long the difference of the matrices of the turns is."""
    poses = []
    for one in (before, after):
        asked = one.given_trajectory
        at = knots_of(asked.times, asked.positions, asked.velocities).values_at(times)
        poses.append(one.world_from_base @ tool.poses(at))
    off = poses[1] - poses[0]
    turned = np.linalg.norm(off[:, :3, :3], axis=(1, 2))
    return np.stack([np.linalg.norm(off[:, :3, 3], axis=1), turned], axis=1)


def _accelerations(placed: PlacedRobot, tool: Tool) -> _Rates:
    """Bounds in the table's time."""
    courses = {one.joint.child: one for one in joint_courses(placed)}
    swift = turning = bent = bent_turning = np.zeros(placed.given_trajectory.n_steps - 1)
    arm, link = 0.0, tool.link
    while tool.links.parents[link] != NO_PARENT:
        course = courses.get(placed.robot.link_names[link])
        slides = tool.links.kinds[link] == SLIDING
        if course is not None and course.i_column is not None:
            speed, acceleration = greatest_rates(course, placed.given_trajectory)
            swift, bent = (
                was + (1.0 if slides else arm) * more
                for was, more in ((swift, speed), (bent, acceleration))
            )
            if not slides:
                turning, bent_turning = turning + speed, bent_turning + acceleration
        arm += float(np.linalg.norm(tool.links.parent_from_joint[link][:3, 3]))
        if slides and course is not None:
            ends = [course.at_samples, *(extremes_of(course, placed.trajectory) or ())]
            arm += max(float(np.abs(one).max()) for one in ends)
        link = int(tool.links.parents[link])
    return _Rates(2.0 * turning * swift + bent, 3.0**0.5 * (turning**2 + bent_turning))
