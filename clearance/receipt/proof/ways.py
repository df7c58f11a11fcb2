"""How far bodies move off where they are in the middle of a piece: by joints, bends and errors, link by link.

The bounds are those of `placing`. Not for: where bodies are (`placing`).
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from clearance.receipt.proof.error_terms import OUTWARD, Error, across_rows
from clearance.receipt.proof.joint_paths import JointPositions
from clearance.receipt.proof.motion_data import FIXED, NONE, SLIDING, Errors, MountFrames, Stretch
from clearance.receipt.proof.views import Views, chain_above

LEVEL = 2.0**-44
"""[-] Of how far a body reaches, for each link on the way to it: more than poses and sums are rounded by."""


class PieceFrames(NamedTuple):
    """Frames in the middle of pieces, (frames, pieces, ...) each; axis and joint are those it hangs by."""

    turn: np.ndarray
    at: np.ndarray
    omega: np.ndarray
    v0: np.ndarray
    axis: np.ndarray
    joint: np.ndarray


class Balls(NamedTuple):
    """Balls that hold each view's body in its own frame: (views, 3) and (views,) [m]."""

    middle: np.ndarray
    radius: np.ndarray


class Step(NamedTuple):
    """What moves a view by one frame of its chain, the joint first.

    Attributes:
        kind: of the joint. axis, at: (pieces, 3) its axis, and a point of it [m].
        most: (pieces,) how far it swings and bends; bend: (pieces,) of that.
        length: (pieces,) [m] at most from the frame above.
        off: how far the frame's rotation is from one. errors: of the joint, then of frames, from the body outward.
        own: [rad or m] that of the joint, which is the first of these; 0 where it has none.
    """

    kind: int
    axis: np.ndarray
    at: np.ndarray
    most: np.ndarray
    bend: np.ndarray
    length: np.ndarray
    off: float
    errors: list[Error]
    own: float = 0.0


def steps_of(
    view: int, stretch: Stretch, views: Views, positions: JointPositions, frames: PieceFrames
) -> list[Step]:
    """From a body to the base; what stands in the world on frames that may be off has one step."""
    found = []
    chain = chain_above(views.above, int(views.frames[view]))
    joints = stretch.joints
    for frame in chain:
        link = int(views.links[frame])
        kind = FIXED if joints.parents[link] == NONE else int(joints.kinds[link])
        most = np.abs(positions.swing[:, link]) + positions.bend[:, link]
        length = np.zeros(len(most)) + np.abs(joints.fixed[link, :3, 3]).sum()
        if kind == SLIDING:
            length = length + np.abs(positions.middle[:, link]) + most
        axis, at = frames.axis[frame], frames.joint[frame]
        errors = _errors_at(stretch.errors, link, kind, frame, positions, frames)
        own = 0.0 if stretch.errors is None or kind == FIXED else float(stretch.errors.joint[link])
        off = _off(joints.fixed[link])
        found.append(Step(kind, axis, at, most, positions.bend[:, link], length, off, errors, own))
    body = int(views.bodies[view])
    if stretch.errors is not None and stretch.carriers[body] == NONE:
        n, zero = len(positions.middle), np.zeros(len(positions.middle))
        pose = np.repeat(views.poses[view][None], n, axis=0)
        errors = _mount_errors(stretch.errors.of_bodies, body, pose[:, :3, :3], pose[:, :3, 3])
        point = np.zeros((n, 3))
        found.append(Step(FIXED, point, point, zero, zero, zero, 0.0, errors))
    return found


def _errors_at(
    errors: Errors | None,
    link: int,
    kind: int,
    frame: int,
    positions: JointPositions,
    frames: PieceFrames,
) -> list[Error]:
    """What may be off where a link hangs."""
    if errors is None:
        return []
    axis, at, found = frames.axis[frame], frames.joint[frame], []
    if kind != FIXED and errors.joint[link] > 0.0:
        found.append(Error(float(errors.joint[link]), axis, None if kind == SLIDING else at))
    origin = at - axis * positions.middle[:, link, None] if kind == SLIDING else at
    found += _place(float(errors.xyz[link]), float(errors.angle[link]), origin)
    return found + _mount_errors(errors.of_links, link, frames.turn[frame], frames.at[frame])


def _mount_errors(mounts: MountFrames, which: int, turn: np.ndarray, at: np.ndarray) -> list[Error]:
    """Those of the frames that a link or body stands on."""
    found = []
    for i in np.flatnonzero(mounts.which == which).tolist():
        origin, axis = turn @ mounts.origins[i] + at, turn @ mounts.axes[i]
        xyz, angle = float(mounts.xyz[i]), float(mounts.angle[i])
        if not mounts.axes[i].any():
            found += _place(xyz, angle, origin)
        elif angle > 0.0:
            found.append(Error(angle, axis, origin))
        else:
            found.append(Error(xyz, axis, None))
    return found


def _place(xyz: float, angle: float, origin: np.ndarray) -> list[Error]:
    turning = [Error(angle, None, origin)] if angle > 0.0 else []
    return [*turning, Error(xyz, None, None)] if xyz > 0.0 else turning


def bounds_of(
    view: int,
    stretch: Stretch,
    views: Views,
    balls: Balls,
    steps: Sequence[Step],
    frames: PieceFrames,
) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """(pieces,) each: way, rest, rounding of one view, and what shifts and turns about any axis are of its way."""
    middle, radius = balls.middle[view], float(balls.radius[view])
    frame = int(views.frames[view])
    pose = views.poses[view]
    turn, at = (
        (pose[:3, :3], pose[:3, 3]) if frame == NONE else (frames.turn[frame], frames.at[frame])
    )
    centre = turn @ middle + at
    reach = np.sqrt((middle * middle).sum()) + radius + np.abs(pose[:3, 3]).sum()
    off = _off(pose) + sum(step.off for step in steps)
    motions = [motion for step in steps for motion in _motions(step)]
    above = sum((one.most for one in motions if one.origin is not None), np.zeros(1))
    size = reach + sum((step.length for step in steps), np.zeros(1))
    turns = above
    way, rest, anyway = np.zeros(1), np.zeros(1), np.zeros(1)
    for axis, origin, most, bend in motions:  # from the body to the base
        if origin is None:
            rest = rest + most * above + bend
            way, size = way + most, size + most
            if axis is None:
                anyway = anyway + most
            continue
        above = above - most
        arm = centre - origin if axis is None else across_rows(axis, centre - origin)
        rho = np.sqrt((arm * arm).sum(axis=-1)) + radius + way
        rest = rest + rho * (most * (0.5 * most + np.maximum(above, 0.0)) + bend)
        way = way + most * rho
        if axis is None:
            anyway = anyway + most * rho
    rounding = ((len(steps) + 4) * LEVEL + 4.0 * off) * (size + way) * (1.0 + turns)
    return way * OUTWARD, rest * OUTWARD, rounding, anyway * OUTWARD


class Motion(NamedTuple):
    """A turn about an axis through `origin`, or any; without an origin a slide. `bend` is part of `most`."""

    axis: np.ndarray | None
    origin: np.ndarray | None
    most: np.ndarray
    bend: np.ndarray


def _motions(step: Step) -> list[Motion]:
    """The joint with its own error, which has the same axis, then all others."""
    still = np.zeros(1)
    if step.kind == FIXED:
        return [Motion(e.axis, e.origin, still + e.size, still) for e in step.errors]
    origin = None if step.kind == SLIDING else step.at
    joint = Motion(step.axis, origin, step.most + step.own, step.bend)
    rest = step.errors[1:] if step.own > 0.0 else step.errors
    return [joint, *(Motion(e.axis, e.origin, still + e.size, still) for e in rest)]


def _off(pose: np.ndarray) -> float:
    """How far the rotation of a pose is from one, beyond rounding."""
    turn = pose[:3, :3]
    return float(np.abs(turn.T @ turn - np.eye(3)).max())
