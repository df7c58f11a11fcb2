"""The bodies and joints of an MJCF model as links and joints of ours: one motion and one frame each.

A link is a body, in the body's own frame; the root is the world. Where a body has several joints, or one that is
not at its origin, frames stand between, called body:joint. A free joint says where its body is in the world, as
its seven numbers in MuJoCo do. Not for: shapes (`shapes`).

Source: MuJoCo, engine_core_smooth (mj_kinematics): joints of a body act in their order, each about its own place.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from clearance.errors import BadInput, at
from clearance.formats.robot.compound_joints import chained
from clearance.formats.robot.mjcf.model import MjcfBody, MjcfJoint, MjcfModel
from clearance.world.names import require_own_names
from clearance.world.robot import Joint, JointKind

_COMPOUND = {"free": "floating", "ball": "ball"}


def joints_of(model: MjcfModel) -> list[Joint]:
    """The joints of a model; their children are its bodies, but for the world, and the frames between.

    Raises:
        DuplicateName: names that tables could not keep apart. BadInput: an axis that is none.
    """
    by_body: dict[int, list[MjcfJoint]] = {}
    for joint in model.joints:
        by_body.setdefault(joint.body, []).append(joint)
    found = [
        joint
        for i, body in enumerate(model.bodies)
        if i > 0
        for joint in _joints_of(body, model.bodies[body.parent].name, by_body.get(i, []))
    ]
    require_own_names("joint", [joint.name for joint in found])
    return found


def _joints_of(body: MjcfBody, parent: str, joints: list[MjcfJoint]) -> Iterator[Joint]:
    """A chain from the parent to the body.

    `before` is the pose, in the last frame of the chain, of the body as it is until the next joint acts.
    """
    if not joints:
        yield Joint(f"{body.name}/fixed", JointKind.FIXED, parent, body.name, body.pose)
        return
    before, frame = body.pose, parent
    for i, joint in enumerate(joints):
        is_last = i == len(joints) - 1 and not joint.place.any()
        child = body.name if is_last else f"{body.name}:{joint.name}"
        with at(f"joint {joint.name!r}"):
            yield from _chain(joint, frame, child, before)
        before, frame = _moved(-joint.place), child
    if frame != body.name:
        yield Joint(f"{body.name}/fixed", JointKind.FIXED, frame, body.name, before)


def _chain(joint: MjcfJoint, parent: str, child: str, before: np.ndarray) -> Iterator[Joint]:
    """The joint, from where its body was before it acts to where the body is turned or moved about its place."""
    if joint.kind in _COMPOUND:
        here = np.eye(4) if joint.kind == "free" else before @ _moved(joint.place)
        yield from chained(_COMPOUND[joint.kind], joint.name, parent, child, here)
        return
    with np.errstate(all="ignore"):  # what overflows is refused
        axis = joint.axis / np.linalg.norm(joint.axis)
    if not np.isfinite(axis).all():
        raise BadInput(f"its axis is {joint.axis.tolist()}", valid="a direction")
    lower, upper = joint.limits or (-np.inf, np.inf)
    yield Joint(
        name=joint.name,
        kind=_kind(joint),
        parent=parent,
        child=child,
        parent_from_joint=before @ _moved(joint.place) @ _to_zero(joint, axis),
        axis=axis,
        lower=lower,
        upper=upper,
    )


def _kind(joint: MjcfJoint) -> JointKind:
    if joint.kind == "slide":
        return JointKind.PRISMATIC
    return JointKind.CONTINUOUS if joint.limits is None else JointKind.REVOLUTE


def _to_zero(joint: MjcfJoint, axis: np.ndarray) -> np.ndarray:
    """(4, 4) the motion from the reference, at which bodies are as written, to the value 0."""
    if joint.reference == 0.0:
        return np.eye(4)
    if joint.kind == "slide":
        return _moved(-joint.reference * axis)
    x, y, z = axis
    cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    pose = np.eye(4)
    half = np.sin(-0.5 * joint.reference)
    pose[:3, :3] += np.sin(-joint.reference) * cross + 2.0 * half * half * (cross @ cross)
    return pose


def _moved(place: np.ndarray) -> np.ndarray:
    pose = np.eye(4)
    pose[:3, 3] = place
    return pose
