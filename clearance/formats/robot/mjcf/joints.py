"""The bodies and joints of an MJCF model as links and joints of ours, which of them follow others, and its
keyframes.

A link is a body, in the body's own frame; the root is the world. Where a body has several joints, or one that
is not at its origin, frames stand between, called body:joint. A free joint says where its body is in the world,
as its seven numbers in MuJoCo do. Equality constraints become joints that follow others; closed loops and
tendons are left out and told of. Not for: shapes (`shapes`), nor what rests in a keyframe (`resting`).

Source: MuJoCo, engine_core_smooth (mj_kinematics): joints of a body act in their order, each about its own
place.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np

from clearance.errors import BadRobot, at
from clearance.formats.robot.compound_joints import COMPOUND, chained
from clearance.formats.robot.mjcf.mujoco_adapter import MjcfBody, MjcfFollower, MjcfJoint, MjcfModel
from clearance.geometry.pose import pose_from_quaternion, pose_from_rotation_vector
from clearance.world.names import checked_name, require_own_names
from clearance.world.notice import Notice, Severity
from clearance.world.robot import Joint, JointKind, Mimic

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
        raise BadRobot(f"its axis is {joint.axis.tolist()}", valid="a direction")
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
    return pose_from_rotation_vector([0.0, 0.0, 0.0], (-joint.reference * axis).tolist())


def _moved(place: np.ndarray) -> np.ndarray:
    pose = np.eye(4)
    pose[:3, 3] = place
    return pose


def with_followers(
    joints: Sequence[Joint], model: MjcfModel
) -> tuple[list[Joint], list[str], list[Notice]]:
    """The joints, those that follow one as a line with their mimic; notes, and warnings on what is not followed.

    MuJoCo counts both joints from their references: y - y0 = a0 + a1 (x - x0).
    """
    references = {joint.name: joint.reference for joint in model.joints}
    found = {joint.name: joint for joint in joints}
    notes: list[str] = []
    notices: list[Notice] = []
    for row in model.follows:
        why = _why_not(row, found)
        if not row.active:
            notes.append(f"the equality of joint {row.joint!r} is not active and not followed")
        elif why:
            notices.append(_not_followed(row, why))
        elif row.master is None:
            value = references[row.joint] + row.polynomial[0]
            notices.append(_not_followed(row, f"it is held at {value:g}"))
        else:
            a0, a1 = row.polynomial[:2]
            offset = references[row.joint] + a0 - a1 * references[row.master]
            found[row.joint] = replace(found[row.joint], mimic=Mimic(row.master, a1, offset))
            notes.append(
                f"joint {row.joint!r} follows {row.master!r} by an equality, as if it were rigid"
            )
    return [found[joint.name] for joint in joints], notes, notices


def _why_not(row: MjcfFollower, joints: dict[str, Joint]) -> str:
    for name in (row.joint, row.master):
        if name is not None and name not in joints:
            return f"joint {name!r} has several degrees of freedom"
    if joints[row.joint].mimic is not None:
        return f"it follows {joints[row.joint].mimic.joint!r} already"  # type: ignore[union-attr]
    if any(row.polynomial[2:]):
        return "it is no line but a polynomial"
    return ""


def _not_followed(row: MjcfFollower, why: str) -> Notice:
    text = (
        f"the equality of joint {row.joint!r} is not followed: {why}; give the joint its own values"
    )
    return Notice(Severity.WARNING, "equality", text)


_N_POSITIONS = {"free": 7, "ball": 4}
"""Numbers of a joint in a keyframe, where they are not one: a place, and a quaternion with the scalar first."""


def states_of(model: MjcfModel) -> dict[str, dict[str, float]]:
    """[rad] or [m] by keyframe and joint; of a joint of several degrees of freedom each part."""
    return {
        checked_name(key.name): dict(_positions_in(model.joints, key.positions))
        for key in model.keys
    }


def reference_of(model: MjcfModel) -> dict[str, float]:
    """[rad] or [m] by joint, where the model is as it is written: the place of a free body, `ref` of a hinge."""
    return dict(_positions_in(model.joints, model.reference))


def _positions_in(
    joints: tuple[MjcfJoint, ...], positions: np.ndarray
) -> Iterator[tuple[str, float]]:
    begin = 0
    for joint in joints:
        end = begin + _N_POSITIONS.get(joint.kind, 1)
        own = positions[begin:end].tolist()
        begin = end
        if joint.kind not in _N_POSITIONS:
            yield joint.name, own[0]
            continue
        values = [*own[:-4], *_turns(own[-4:])]
        parts = COMPOUND["floating" if joint.kind == "free" else "ball"]
        yield from zip((f"{joint.name}/{part}" for part in parts), values, strict=True)


def _turns(quaternion: list[float]) -> list[float]:
    """Yaw, pitch and roll [rad] of a quaternion of any length, the scalar first; roll is 0 where yaw says all.

    Exactness: the rotation is right to a few roundings, and to about 1e-8 where pitch is a quarter turn.
    """
    w, x, y, z = np.array(quaternion) / np.linalg.norm(quaternion)
    rotation = pose_from_quaternion([0.0, 0.0, 0.0], [x, y, z, w])[:3, :3]
    cosine = np.hypot(rotation[0, 0], rotation[1, 0])
    pitch = np.arctan2(-rotation[2, 0], cosine)
    if cosine < 1e-8:
        return [float(np.arctan2(-rotation[0, 1], rotation[1, 1])), float(pitch), 0.0]
    yaw = np.arctan2(rotation[1, 0], rotation[0, 0])
    roll = np.arctan2(rotation[2, 1], rotation[2, 2])
    return [float(yaw), float(pitch), float(roll)]
