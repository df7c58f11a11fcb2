"""Values that are valid but look like a wrong unit: each becomes a loud note in the case, never an
error.

Not for: values that cannot be right (`schema`, `trajectory_file`).
"""

from __future__ import annotations

import numpy as np

from clearance.load import schema
from clearance.world.case import Limits, PlacedRobot
from clearance.world.robot import Joint, JointKind

LARGE_LIMIT = 0.5
"""[m] A clearance limit above half a metre would forbid a robot most of its cell; in millimetres it
is usual.
"""

LARGE_RADIUS = 5.0
"""[m] No arm of this world works near a pipe or ball of more than ten metres across; 5 mm is a
usual radius.
"""

LARGE_TURN = 4 * np.pi
"""[rad] Two full turns: more than industrial wrists have, and passed at once by angles given in
degrees.
"""


def limit_notes(limits: Limits) -> list[str]:
    """A note for each limit that looks like millimetres."""
    given = {"fail": limits.fail, "warn": limits.warn}
    return [
        f"CHECK UNITS: limits.{key} is {value:g} m; limits are in metres, is this millimetres?"
        for key, value in given.items()
        if value > LARGE_LIMIT
    ]


def obstacle_notes(obstacles: list[schema.Obstacle]) -> list[str]:
    """A note for each round obstacle whose radius looks like millimetres."""
    notes = []
    for obstacle in obstacles:
        shape = obstacle.pipe or obstacle.cylinder or obstacle.sphere
        radius = getattr(shape, "outer_radius", None) or getattr(shape, "radius", 0.0)
        if radius > LARGE_RADIUS:
            notes.append(
                f"CHECK UNITS: obstacle {obstacle.name!r} has a radius of {radius:g} m; "
                "lengths are in metres, is this millimetres?"
            )
    return notes


def motion_notes(placed: PlacedRobot) -> list[str]:
    """Notes on joints that leave their limits or whose values look like degrees."""
    joints = {joint.name: joint for joint in placed.robot.moving_joints}
    notes = []
    for name, column in zip(
        placed.trajectory.joint_names, placed.trajectory.positions.T, strict=True
    ):
        notes += _joint_notes(joints[name], column)
    for name, value in placed.fixed_positions.items():
        notes += _joint_notes(joints[name], np.array([value]))
    return notes


def _joint_notes(joint: Joint, positions: np.ndarray) -> list[str]:
    notes = []
    turns = joint.kind in (JointKind.REVOLUTE, JointKind.CONTINUOUS)
    greatest = float(np.abs(positions).max())
    if turns and greatest > LARGE_TURN:
        notes.append(
            f"CHECK UNITS: joint {joint.name!r} goes to {greatest:g} rad; "
            "angles are in radians, is this degrees?"
        )
    beyond = np.maximum(positions - joint.upper, joint.lower - positions)
    n_beyond = int((beyond > 0).sum())
    if n_beyond:
        unit = "rad" if turns else "m"
        notes.append(
            f"joint {joint.name!r} leaves its limits {joint.lower:g} to {joint.upper:g} {unit} "
            f"by up to {float(beyond.max()):.3g} {unit} in {n_beyond} of {len(positions)} steps"
        )
    return notes
