"""Joints of several degrees of freedom as chains of slides and turns, each with a frame of its own between.

A planar joint slides along x and y and turns about z, a ball joint turns about z, y and x, a floating joint does
both. A part is called joint/x, joint/yaw and so on, and its frame the same; the last part carries the child.
Between two samples each part goes as its own values say. Not for: which joints a file has
(`urdf.joints`, `mjcf.joints`).

Source: MoveIt 2, planar_joint_model and floating_joint_model (order of the parts); ROS, URDF (roll, pitch, yaw).
"""

from __future__ import annotations

from collections.abc import Collection, Sequence

import numpy as np

from clearance.errors import BadRobot
from clearance.world.robot import Joint, JointKind, Robot

_X, _Y, _Z = np.eye(3)

_PARTS = {
    "x": (JointKind.PRISMATIC, _X),
    "y": (JointKind.PRISMATIC, _Y),
    "z": (JointKind.PRISMATIC, _Z),
    "yaw": (JointKind.CONTINUOUS, _Z),
    "pitch": (JointKind.CONTINUOUS, _Y),
    "roll": (JointKind.CONTINUOUS, _X),
}

COMPOUND = {
    "planar": ("x", "y", "yaw"),
    "ball": ("yaw", "pitch", "roll"),
    "floating": ("x", "y", "z", "yaw", "pitch", "roll"),
}
"""The parts of each kind, from parent to child."""


def chained(
    kind: str, name: str, parent: str, child: str, parent_from_joint: np.ndarray
) -> list[Joint]:
    """The parts of a joint as joints in a row.

    Args:
        kind: one of `COMPOUND`. parent_from_joint: (4, 4) the child in the parent where all parts are at 0 [m].
    """
    parts = COMPOUND[kind]
    frames = [parent, *(f"{name}/{part}" for part in parts[:-1]), child]
    return [
        Joint(
            name=f"{name}/{part}",
            kind=_PARTS[part][0],
            parent=frames[i],
            child=frames[i + 1],
            parent_from_joint=parent_from_joint if i == 0 else np.eye(4),
            axis=_PARTS[part][1].copy(),
            part_of=(kind, name),
        )
        for i, part in enumerate(parts)
    ]


def frames_between(joints: Sequence[Joint]) -> list[str]:
    """The names of the frames between the parts of compound joints, which are links without a shape."""
    return [joint.name for joint in joints if joint.part_of and joint.child == joint.name]


def notes_on_parts(joints: Sequence[Joint]) -> list[str]:
    """A line for each compound joint: what its parts are called, and how they go between samples."""
    return [
        f"{kind} joint {name!r} is read as {', '.join(names)}; between samples each goes by itself"
        for (kind, name), names in _parts_of(joints).items()
    ]


def require_placed(robot: Robot, given: Collection[str], field: str) -> None:
    """Nothing, if each compound joint has at least one part to which a value is given.

    Where a robot with such a joint is, nobody knows but who placed it: at 0 without a word would be a guess.

    Args:
        field: where a case file gives values.

    Raises:
        BadInput: with the joint and the ways out.
    """
    for (kind, name), names in _parts_of(robot.joints).items():
        if not any(part in given for part in names):
            own = {part: robot.reference.get(part, 0.0) for part in names}
            own = {part: value for part, value in own.items() if value != 0.0}
            there = ", ".join(f"{part}: {value!r}" for part, value in own.items())
            raise BadRobot(
                f"{kind} joint {name!r} is given no place",
                where=field,
                valid=f"{{{there or f'{names[0]}: 0'}}} where it stays {'as its file has it' if own else 'at 0'}, "
                f"or columns of the trajectory ({', '.join(names)})",
            )


def _parts_of(joints: Sequence[Joint]) -> dict[tuple[str, str], list[str]]:
    """The names of the parts of each compound joint, by its kind and name."""
    parts: dict[tuple[str, str], list[str]] = {}
    for joint in joints:
        if joint.part_of is not None:
            parts.setdefault(joint.part_of, []).append(joint.name)
    return parts
