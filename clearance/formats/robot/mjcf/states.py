"""The keyframes of an MJCF model, and its reference pose, as positions of our joints by name.

Not for: what rests in one (`resting`).
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from clearance.formats.robot.compound_joints import COMPOUND
from clearance.formats.robot.mjcf.model import MjcfJoint, MjcfModel
from clearance.geometry.pose import pose_from_quaternion
from clearance.world.names import checked_name

_N_POSITIONS = {"free": 7, "ball": 4}
"""Numbers of a joint in a keyframe, where they are not one: a place, and a quaternion with the scalar first."""


def states_of(model: MjcfModel) -> dict[str, dict[str, float]]:
    """[rad] or [m] by keyframe and joint; of a joint of several degrees of freedom each part."""
    return {
        checked_name(key.name): dict(_positions(model.joints, key.positions)) for key in model.keys
    }


def reference_of(model: MjcfModel) -> dict[str, float]:
    """[rad] or [m] by joint, where the model is as it is written: the place of a free body, `ref` of a hinge."""
    return dict(_positions(model.joints, model.reference))


def _positions(joints: tuple[MjcfJoint, ...], positions: np.ndarray) -> Iterator[tuple[str, float]]:
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
