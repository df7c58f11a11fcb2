"""Joints of a checked URDF document to ours: kinds, limits, unit axes, mimics that lead somewhere."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from clearance.errors import BadInput, UnknownJoint, at, nearest_name
from clearance.load.urdf_elements import number, numbers, pose_of
from clearance.world.robot import Joint, JointKind, Mimic

if TYPE_CHECKING:
    from lxml.etree import _Element as Element

_KINDS = tuple(kind.value for kind in JointKind)


def joints_of(root: Element) -> tuple[list[Joint], list[str]]:
    """The joints in file order, and notes on what had to be decided.

    Raises:
        BadInput: a kind that is not supported, an axis of length zero, limits the wrong way round,
            a mimic that follows itself. UnknownJoint: a mimic of a joint that is not there.
    """
    joints = []
    for element in root.iterfind("joint"):
        with at(f"joint {element.get('name')!r}"):
            joints.append(_joint(element))
    by_name = {joint.name: joint for joint in joints}
    notes: list[str] = []
    for i, joint in enumerate(joints):
        if joint.mimic is not None:
            with at(f"joint {joint.name!r} mimic"):
                joints[i], note = _with_checked_mimic(joint, by_name)
            notes += note
    return joints, notes


def _joint(element: Element) -> Joint:
    if element.get("type") not in _KINDS:
        raise BadInput(
            f"type {element.get('type')!r} is not supported", valid=f"one of {', '.join(_KINDS)}"
        )
    kind = JointKind(element.get("type"))
    lower, upper = _limits(element.find("limit"), kind)
    return Joint(
        name=element.get("name"),
        kind=kind,
        parent=element.find("parent").get("link"),
        child=element.find("child").get("link"),
        parent_from_joint=pose_of(element),
        axis=_axis(element.find("axis"), kind),
        lower=lower,
        upper=upper,
        mimic=_mimic(element.find("mimic"), kind),
    )


def _axis(element: Element | None, kind: JointKind) -> np.ndarray:
    """(3,) of length one; a fixed joint's axis says nothing and becomes x."""
    along_x = (1.0, 0.0, 0.0)
    if kind is JointKind.FIXED:
        return np.array(along_x)
    axis = np.array(along_x if element is None else numbers(element, "xyz", along_x))
    greatest = np.abs(axis).max()
    if greatest == 0:
        raise BadInput("axis is 0 0 0", valid="a direction is needed")
    axis = axis / greatest
    return axis / np.linalg.norm(axis)


def _limits(element: Element | None, kind: JointKind) -> tuple[float, float]:
    """Lower and upper limit: infinite where neither is written, 0 where one is not (URDF)."""
    if kind in (JointKind.FIXED, JointKind.CONTINUOUS) or element is None:
        return -np.inf, np.inf
    if element.get("lower") is None and element.get("upper") is None:
        return -np.inf, np.inf
    lower, upper = number(element, "lower", 0.0), number(element, "upper", 0.0)
    if lower > upper:
        raise BadInput(f"lower limit {lower:g} is above upper limit {upper:g}")
    return lower, upper


def _mimic(element: Element | None, kind: JointKind) -> Mimic | None:
    if element is None or kind is JointKind.FIXED:
        return None
    return Mimic(
        element.get("joint"), number(element, "multiplier", 1.0), number(element, "offset", 0.0)
    )


def _with_checked_mimic(joint: Joint, by_name: dict[str, Joint]) -> tuple[Joint, list[str]]:
    """The joint; one that follows a fixed joint cannot move and becomes fixed at its offset."""
    master, seen = joint, [joint.name]
    while master.mimic is not None:
        if master.mimic.joint not in by_name:
            raise UnknownJoint(
                f"unknown joint {master.mimic.joint!r}",
                valid=nearest_name(master.mimic.joint, by_name),
            )
        master = by_name[master.mimic.joint]
        if master.name in seen:
            raise BadInput(f"joints follow each other in a circle: {', '.join(seen)}")
        seen.append(master.name)
    if master.kind is not JointKind.FIXED:
        return joint, []
    position = _position_at_rest(joint, by_name)
    pose = joint.parent_from_joint @ _motion(joint, position)
    still = replace(joint, kind=JointKind.FIXED, mimic=None, parent_from_joint=pose)
    return still, [
        f"joint {joint.name!r} follows fixed joint {master.name!r} and stays at {position:g}"
    ]


def _position_at_rest(joint: Joint, by_name: dict[str, Joint]) -> float:
    """The position that a chain of mimics gives when its master is at 0."""
    if joint.mimic is None:
        return 0.0
    return (
        joint.mimic.multiplier * _position_at_rest(by_name[joint.mimic.joint], by_name)
        + joint.mimic.offset
    )


def _motion(joint: Joint, position: float) -> np.ndarray:
    """(4, 4) pose of the child in the joint frame at `position`. Source: Rodrigues' formula."""
    pose = np.eye(4)
    if joint.kind is JointKind.PRISMATIC:
        pose[:3, 3] = joint.axis * position
        return pose
    x, y, z = joint.axis
    cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    pose[:3, :3] += np.sin(position) * cross + (1 - np.cos(position)) * (cross @ cross)
    return pose
