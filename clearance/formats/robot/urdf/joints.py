"""Joints of a checked URDF document to ours: kinds, limits, unit axes, mimics that lead somewhere."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from clearance.errors import BadDimension, BadRobot, at
from clearance.formats.robot.compound_joints import chained, notes_on_parts
from clearance.formats.robot.urdf.elements import number, numbers, pose_of
from clearance.geometry.pose import pose_from_rotation_vector
from clearance.tolerance import REACH
from clearance.world.mimics import masters_of
from clearance.world.names import require_own_names
from clearance.world.notice import naming
from clearance.world.robot import Joint, JointKind, Mimic

if TYPE_CHECKING:
    from lxml.etree import _Element as Element

_COMPOUND = ("planar", "floating")

_KINDS = (*(kind.value for kind in JointKind), *_COMPOUND)


def joints_of(root: Element) -> tuple[list[Joint], list[str]]:
    """The joints in file order, and notes on what had to be decided.

    Raises:
        BadInput: a kind that is not supported, an axis of length zero, limits the wrong way round,
            a mimic that follows itself. UnknownJoint: a mimic of a joint that is not there.
    """
    joints: list[Joint] = []
    for element in root.iterfind("joint"):
        with at(f"joint {element.get('name')!r}"):
            joints += _joints(element)
    require_own_names("joint", [joint.name for joint in joints])
    masters = masters_of(joints)
    fixed = {joint.name for joint in joints if joint.kind is JointKind.FIXED}
    notes = [*notes_on_parts(joints), *_on_no_limits(joints), *_on_no_axis(root), *_on_speeds(root)]
    for i, (joint, master, _, position) in enumerate(masters[joint.name] for joint in joints):
        if joint.mimic is not None and master in fixed:
            joints[i] = _at_rest(joint, position)
            notes.append(
                f"joint {joint.name!r} follows fixed joint {master!r} and stays at {position:g}"
            )
    return joints, notes


def _joints(element: Element) -> list[Joint]:
    """The joint of an element, or the parts of one of several degrees of freedom."""
    kind = element.get("type")
    if kind not in _COMPOUND:
        return [_joint(element)]
    if element.find("mimic") is not None:
        raise BadRobot(f"a {kind} joint has a <mimic>", valid="<mimic> of a joint of one axis")
    if kind == "planar" and _axis(element.find("axis"), JointKind.PRISMATIC).tolist() != [0, 0, 1]:
        raise BadRobot(
            "a planar joint whose axis is not z, the plane's x and y are not said",
            valid='<axis xyz="0 0 1"/>, the plane turned by <origin rpy="…">',
        )
    parent, child = (element.find(end).get("link") for end in ("parent", "child"))
    return chained(kind, element.get("name"), parent, child, pose_of(element))


def _joint(element: Element) -> Joint:
    if element.get("type") not in _KINDS:
        raise BadRobot(
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
        velocity=_velocity(element.find("limit")),
    )


def _axis(element: Element | None, kind: JointKind) -> np.ndarray:
    """(3,) of length one; a fixed joint's axis says nothing and becomes x."""
    along_x = (1.0, 0.0, 0.0)
    if kind is JointKind.FIXED:
        return np.array(along_x)
    axis = np.array(along_x if element is None else numbers(element, "xyz", along_x))
    greatest = np.abs(axis).max()
    if greatest == 0:
        raise BadRobot("axis is 0 0 0", valid="a direction is needed")
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
        raise BadRobot(f"lower limit {lower:g} is above upper limit {upper:g}")
    return lower, upper


def _on_no_limits(joints: list[Joint]) -> list[str]:
    """A note on joints that should have limits, and have none."""
    needed = (JointKind.REVOLUTE, JointKind.PRISMATIC)
    names = [
        repr(joint.name)
        for joint in joints
        if joint.kind in needed and joint.part_of is None and joint.upper == np.inf
    ]
    return naming("joints without <limit>, taken as unlimited", names, 8)


def _on_no_axis(root: Element) -> list[str]:
    """A note on joints that move along or about x since the file does not say otherwise (URDF)."""
    names = [
        repr(joint.get("name"))
        for joint in root.iterfind("joint")
        if joint.get("type") not in ("fixed", *_COMPOUND)
        and (joint.find("axis") is None or joint.find("axis").get("xyz") is None)
    ]
    return naming("joints without <axis>, taken as x", names, 8)


def _on_speeds(root: Element) -> list[str]:
    """A note on speeds that are no numbers."""
    given = ((limit.getparent(), limit.get("velocity", "")) for limit in root.iter("limit"))
    names = [
        f"{text!r:.20} of {joint.get('name')!r}"
        for joint, text in given
        if text.strip() and _number(text) is None
    ]
    return naming("velocities that are no numbers, taken as unlimited", names, 4)


def _number(text: str) -> float | None:
    try:
        return float(text)
    except ValueError:
        return None


def _velocity(element: Element | None) -> float:
    """The greatest speed; infinite where none is written, or what many exporters write for none: 0, or no
    number.
    """
    given = None if element is None else _number(element.get("velocity", ""))
    return given if given is not None and 0.0 < given < np.inf else np.inf


def _mimic(element: Element | None, kind: JointKind) -> Mimic | None:
    if element is None or kind is JointKind.FIXED:
        return None
    mimic = Mimic(
        element.get("joint"), number(element, "multiplier", 1.0), number(element, "offset", 0.0)
    )
    for what, value in (("multiplier", mimic.multiplier), ("offset", mimic.offset)):
        if abs(value) > REACH:
            raise BadDimension(
                f"{what} {value:g} is given", where="mimic", valid=f"{REACH:g} or less"
            )
    return mimic


def _at_rest(joint: Joint, position: float) -> Joint:
    """A joint that follows a fixed one cannot move: it becomes fixed at its offset."""
    moved, still = (joint.axis * position).tolist(), [0.0, 0.0, 0.0]
    slides = joint.kind is JointKind.PRISMATIC
    motion = pose_from_rotation_vector(*((moved, still) if slides else (still, moved)))
    pose = joint.parent_from_joint @ motion
    return replace(joint, kind=JointKind.FIXED, mimic=None, parent_from_joint=pose)
