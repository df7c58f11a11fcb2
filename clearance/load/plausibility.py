"""Values that are valid but look like a wrong unit: each becomes a loud note in the case, never an
error.

Not for: values that cannot be right (`schema`, `trajectory_file`).
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from clearance.load import schema
from clearance.world.case import Limits, PlacedRobot
from clearance.world.cubic import extremes_between
from clearance.world.robot import Joint, JointKind
from clearance.world.trajectory import Trajectory

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

FAR = 100.0
"""[m] No cell is so large; in millimetres it is usual."""

LARGE_SCALE = 100.0
"""[-] Mesh files are in metres or finer units, so that scales are 1 or less: 1000 is mistaken for 0.001."""

TOO_FAST = 10.0
"""Velocities that mean ten times the way of the positions: degrees are 57 times radians, millimetres 1000."""

LEAST_WAY = 1e-3
"""[rad or m] A way below this is rest, and says nothing about units."""

ROUNDING = 1e-9
"""[rad or m] A joint that is beyond its limit by less than this is at it."""


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
        notes += pose_notes(f"obstacle {obstacle.name!r}", obstacle.pose.xyz, obstacle.pose.rpy)
    return notes


def pose_notes(what: str, xyz: Sequence[float], rpy: Sequence[float] | None) -> list[str]:
    """A note if a place looks like millimetres, and one if angles look like degrees."""
    notes = []
    farthest = max(map(abs, xyz))
    if farthest > FAR:
        notes.append(
            f"CHECK UNITS: {what} stands {farthest:g} m away; lengths are in metres, is this millimetres?"
        )
    greatest = max(map(abs, rpy or [0.0]))
    if greatest > 2.0 * np.pi:
        notes.append(
            f"CHECK UNITS: {what} has an angle of {greatest:g} rad in its rpy; angles are in radians, "
            "is this degrees?"
        )
    return notes


def scale_notes(scale: Sequence[float]) -> list[str]:
    """A note if a mesh is made larger than any unit asks for."""
    greatest = max(map(abs, scale))
    if greatest < LARGE_SCALE:
        return []
    return [
        f"CHECK UNITS: the mesh is scaled by {greatest:g}; lengths are in metres, and a file in millimetres "
        "needs 0.001"
    ]


def motion_notes(placed: PlacedRobot) -> list[str]:
    """Notes on joints that leave their limits or whose values look like degrees."""
    joints = {joint.name: joint for joint in placed.robot.moving_joints}
    asked = placed.trajectory
    notes = []
    for name, column in zip(asked.joint_names, asked.positions.T, strict=True):
        notes += _joint_notes(joints[name], column)
    for name, value in placed.fixed_positions.items():
        notes += _joint_notes(joints[name], np.array([value]))
    if asked.velocities is not None:
        least, greatest = extremes_between(asked.times, asked.positions, asked.velocities)
        for i, name in enumerate(asked.joint_names):
            notes += _velocity_notes(joints[name], asked, i)
            notes += _notes_between(joints[name], asked.positions[:, i], least[:, i], greatest[:, i])
    return notes


def _joint_notes(joint: Joint, positions: np.ndarray) -> list[str]:
    notes = []
    greatest = float(np.abs(positions).max())
    if _turns(joint) and greatest > LARGE_TURN:
        notes.append(
            f"CHECK UNITS: joint {joint.name!r} goes to {greatest:g} rad; "
            "angles are in radians, is this degrees?"
        )
    beyond = np.maximum(positions - joint.upper, joint.lower - positions)
    n_beyond = int((beyond > 0).sum())
    if n_beyond:
        notes.append(f"{_leaves(joint, beyond)} in {n_beyond} of {len(positions)} steps")
    return notes


def _velocity_notes(joint: Joint, asked: Trajectory, i_column: int) -> list[str]:
    """A note if the velocities mean a way that is many times what the positions go."""
    speed = np.abs(asked.velocities[:, i_column])
    gone = float(np.abs(np.diff(asked.positions[:, i_column])).sum())
    meant = float((0.5 * (speed[1:] + speed[:-1]) * np.diff(asked.times)).sum())
    if meant <= TOO_FAST * gone or meant <= TOO_FAST * LEAST_WAY:
        return []
    unit, other = ("rad/s", "degrees/s") if _turns(joint) else ("m/s", "mm/s")
    return [
        f"CHECK UNITS: the velocities of joint {joint.name!r} mean a way of {meant:.3g} where its positions "
        f"go {gone:.3g}; velocities are in {unit}, is this {other}?"
    ]


def _notes_between(
    joint: Joint, positions: np.ndarray, least: np.ndarray, greatest: np.ndarray
) -> list[str]:
    """A note if the joint goes farther beyond its limits between two samples than at them."""
    at_samples = np.maximum(positions - joint.upper, joint.lower - positions)
    ends = np.maximum(0.0, np.maximum(at_samples[:-1], at_samples[1:]))
    beyond = np.maximum(greatest - joint.upper, joint.lower - least)
    farther = beyond > ends + ROUNDING
    if not farther.any():
        return []
    return [
        f"CHECK: {_leaves(joint, beyond[farther])} between two samples, on the cubic that its velocities make, "
        f"in {int(farther.sum())} of {len(beyond)} intervals"
    ]


def _leaves(joint: Joint, beyond: np.ndarray) -> str:
    unit = "rad" if _turns(joint) else "m"
    return (
        f"joint {joint.name!r} leaves its limits {joint.lower:g} to {joint.upper:g} {unit} "
        f"by up to {float(beyond.max()):.3g} {unit}"
    )


def _turns(joint: Joint) -> bool:
    return joint.kind in (JointKind.REVOLUTE, JointKind.CONTINUOUS)
