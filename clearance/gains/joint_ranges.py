"""How a path of joints stands to their limits of place and speed. Not for: keeping them (`offsets`)."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from clearance.errors import BadChange
from clearance.world.joint_positions import JointCourse
from clearance.world.joint_speeds import ROUNDING as SIX_DIGITS
from clearance.world.joint_speeds import greatest_rates
from clearance.world.notice import listed
from clearance.world.placed_robot import NO_LIMIT, PlacedRobot

ROUNDING = 1e-9
"""[rad], [m], or that a second: what is less beyond a limit is at it."""


SPEED, OWN_SPEED = "speed limit", "speed limit of the robot's own file"
ACCELERATION = "acceleration limit"


@dataclass(frozen=True, eq=False)
class JointRange:
    """What one limit leaves a joint.

    Attributes:
        joint: its name. what: which limit. times: (n,) [s] of the table.
        headroom: (n,) [unit] left; negative beyond it.
        unit: "rad" or "m", or that a second or a second squared.
    """

    joint: str
    what: str
    times: np.ndarray
    headroom: np.ndarray
    unit: str


def joint_ranges(placed: PlacedRobot) -> Iterator[JointRange]:
    """What is left of each limit of the joints that a robot's table names: places at its samples, greatest speeds
    and accelerations between them."""
    asked, rate = placed.given_trajectory, placed.timing.rate
    joints = {joint.name: joint for joint in placed.robot.moving_joints}
    times = asked.times
    for i, name in enumerate(asked.joint_names):
        joint, own = joints[name], asked.positions[:, i]
        unit = "m" if joint.kind == "prismatic" else "rad"
        if np.isfinite(joint.upper):
            yield JointRange(name, "upper limit", times, joint.upper - own, unit)
        if np.isfinite(joint.lower):
            yield JointRange(name, "lower limit", times, own - joint.lower, unit)
        limit = placed.motion_limits.get(name, NO_LIMIT)
        if len(times) < 2:
            continue
        speed, acceleration = greatest_rates(JointCourse(joint, own, i), asked)
        for what, most, given, unit_of in (
            (SPEED, limit.velocity, speed * rate, f"{unit}/s"),
            (OWN_SPEED, joint.velocity, speed * rate, f"{unit}/s"),
            (ACCELERATION, limit.acceleration, acceleration * rate**2, f"{unit}/s²"),
        ):
            if np.isfinite(most):
                headroom = (1.0 + SIX_DIGITS) * most - given
                yield JointRange(name, what, times[:-1], headroom, unit_of)


def too_fast(placed: PlacedRobot) -> str:
    """Which joints are faster than the robot's own file lets them be; empty if none is."""
    beyond = [one for one in joint_ranges(placed) if one.what == OWN_SPEED]
    parts = [
        f"{one.joint} by {-one.headroom.min():.3g} {one.unit}"
        for one in beyond
        if one.headroom.min() < -ROUNDING
    ]
    return listed(parts, 4)


def require_within_limits(placed: PlacedRobot) -> None:
    """Nothing, if a robot's table keeps the limits of its joints, but for the speeds of the robot's own file.

    These are often no more than a placeholder: `too_fast` tells of them.

    Raises:
        BadInput: which joint is beyond which limit, when and by how much.
    """
    if placed.trajectory is None:
        return
    for one in joint_ranges(placed):
        worst = int(np.argmin(one.headroom))
        if one.what != OWN_SPEED and one.headroom[worst] < -ROUNDING:
            raise BadChange(
                f"joint {one.joint!r} is {-one.headroom[worst]:.6g} {one.unit} beyond its {one.what} at "
                f"{one.times[worst]:.3f} s of its table already",
                valid="a path within the limits of the joints, or other limits",
            )
