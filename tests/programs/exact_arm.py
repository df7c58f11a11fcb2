"""Where an arm is, and joints for a pose, in long double, by the joints of its robot alone."""

from __future__ import annotations

import numpy as np

from clearance.programs.arm import Arm
from clearance.world.robot import JointKind

Pose = tuple[np.ndarray, np.ndarray]
"""A rotation (3, 3) and an origin (3,) [m]."""


def turn(vector: np.ndarray) -> np.ndarray:
    """(3, 3) the rotation by a vector [rad]."""
    found = np.eye(3, dtype=np.longdouble)
    angle = np.sqrt((np.asarray(vector, dtype=np.longdouble) ** 2).sum())
    if angle == 0.0:
        return found
    x, y, z = np.asarray(vector, dtype=np.longdouble) / angle
    cross = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    return found + np.sin(angle) * cross + (1.0 - np.cos(angle)) * cross @ cross


def vector_of(rotation: np.ndarray) -> np.ndarray:
    """(3,) the vector of a rotation by less than a quarter turn."""
    skew = 0.5 * np.array(
        [rotation[(k + 2) % 3, (k + 1) % 3] - rotation[(k + 1) % 3, (k + 2) % 3] for k in range(3)]
    )
    sine = np.sqrt((skew**2).sum())
    return skew * (np.arcsin(sine) / sine if sine else 1.0)


def links_at(arm: Arm, joints: np.ndarray) -> tuple[dict[str, Pose], dict[str, Pose]]:
    """The pose of each link, and of the frame of the joint above it; joints that are not the arm's at 0."""
    known = dict(zip((one.name for one in arm.joints), joints, strict=True))
    links, frames = {arm.robot.link_names[0]: (np.eye(3), np.zeros(3))}, {}
    for joint in arm.robot.joints:
        turned, at = links[joint.parent]
        own = joint.parent_from_joint.astype(np.longdouble)
        turned, at = turned @ own[:3, :3], turned @ own[:3, 3] + at
        frames[joint.child] = turned, at
        value = known.get(joint.name, 0.0)
        if joint.kind is JointKind.PRISMATIC:
            at = at + turned @ joint.axis * value
        elif joint.kind is not JointKind.FIXED:
            turned = turned @ turn(joint.axis * value)
        links[joint.child] = turned, at
    return links, frames


def tool_at(arm: Arm, joints: np.ndarray) -> Pose:
    """The pose of the tool."""
    turned, at = links_at(arm, joints)[0][arm.link]
    own = arm.link_from_tool.astype(np.longdouble)
    return turned @ own[:3, :3], turned @ own[:3, 3] + at


def joints_for(arm: Arm, wanted: Pose, start: np.ndarray) -> np.ndarray:
    """(k,) joints near others (k,) that hold the tool, by Newton's method of least motion, to 1e-15."""
    joints = np.array(start, dtype=np.longdouble)
    for _ in range(20):
        turned, at = tool_at(arm, joints)
        off = np.concatenate([wanted[1] - at, vector_of(wanted[0] @ turned.T)])
        if np.abs(off).max() < 1e-15:
            return joints
        frames, columns = links_at(arm, joints)[1], []
        for joint in arm.joints:
            axis = frames[joint.child][0] @ joint.axis
            slides = joint.kind is JointKind.PRISMATIC
            way = axis if slides else np.cross(axis, at - frames[joint.child][1])
            columns.append(np.concatenate([way, 0.0 * axis if slides else axis]))
        rates = np.array(columns, dtype=float).T
        joints = joints + np.linalg.lstsq(rates, off.astype(float), rcond=None)[0]
    raise AssertionError(f"{float(np.abs(off).max())} is left")
