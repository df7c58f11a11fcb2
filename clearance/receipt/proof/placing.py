"""Where bodies are in the middle of a piece of the motion, and how far from straight they move in it.

With joint k swinging by w_k (to either side) and bending by b_k, a point x of a body goes from the middle to
x + t v(x) + r, |t| <= 1, with v(x) = v0 + omega x x, the sum of w_k a_k x (x - c_k) over joints that turn and of
w_k a_k over those that slide. With d_k = |w_k| + b_k, and rho_k no less than how far the body gets from axis k,

    |r| <= sum_k d_k rho_k (d_k / 2 + sum_{j above, turning} d_j) + sum_k b_k rho_k            (k turning)
         + sum_k d_k sum_{j above, turning} d_j + sum_k b_k                                     (k sliding).

Errors of joints are added to d_k, those of frames are joints more; their first order is not in v but in `terms`. The
proof is in `NOTES.md`. Not for: whether two bodies keep apart (`separation`).
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from clearance.receipt.proof.error_terms import OUTWARD, Error, Terms, terms_of
from clearance.receipt.proof.joint_paths import Arcs, JointPositions, Pieces, joint_positions
from clearance.receipt.proof.motion_data import FIXED, NONE, SLIDING, Errors, Held, Stretch
from clearance.receipt.proof.views import Views

LEVEL = 2.0**-44
"""[-] Of how far a body reaches, for each link on the way to it: more than poses and sums are rounded by."""


class Placed(NamedTuple):
    """Views in the middle of pieces, (..., k) each: place view * pieces + piece is that of a view in a piece.

    Attributes:
        turn: (3, 3, k) and at: (3, k) [m] the poses. omega, v0: (3, k) [rad], [m] the swing v.
        way: [m] no point gets farther from where it is in the middle. rest: [m] the bound of |r| above.
        rounding: [m] of all that is computed of such a view along a unit vector.
        terms: what errors do to the first order; None where there are none.
    """

    turn: np.ndarray
    at: np.ndarray
    omega: np.ndarray
    v0: np.ndarray
    way: np.ndarray
    rest: np.ndarray
    rounding: np.ndarray
    terms: Terms | None = None


class Frames(NamedTuple):
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


def placed(
    stretch: Stretch,
    arcs: dict[int, Arcs],
    views: Views,
    balls: Balls,
    pieces: Pieces,
    wanted: np.ndarray,
) -> Placed:
    """The views in some pieces; those that are not `wanted` (views,) are left undefined."""
    joints = joint_positions(stretch, arcs, pieces)
    frames = _frames(stretch, arcs, views, pieces, joints, views.frames_of(np.flatnonzero(wanted)))
    n = len(pieces.interval)
    shape = len(views.frames) * n
    found = Placed(
        np.zeros((3, 3, shape)), *(np.zeros((3, shape)) for _ in range(3)),
        *(np.zeros(shape) for _ in range(3)),
    )  # fmt: skip
    errors: list[list[Error]] = [[] for _ in views.frames]
    for view in np.flatnonzero(wanted).tolist():
        frame, own = int(views.frames[view]), slice(view * n, (view + 1) * n)
        pose = views.poses[view, :3]
        found.turn[:, :, own], found.at[:, own] = pose[:, :3, None], pose[:, 3:]
        if frame != NONE:
            found.turn[:, :, own] = np.moveaxis(frames.turn[frame], 0, -1)
            for part, moving in (
                (found.at, frames.at),
                (found.omega, frames.omega),
                (found.v0, frames.v0),
            ):
                part[:, own] = moving[frame].T
        steps = _steps(view, stretch, views, joints, frames)
        errors[view] = [error for step in steps for error in step.errors]
        bounds = _bounds(view, stretch, views, balls, steps, frames)
        for part, bound in zip((found.way, found.rest, found.rounding), bounds, strict=True):
            part[own] = bound
    return found if stretch.errors is None else found._replace(terms=terms_of(errors, n))


def _frames(
    stretch: Stretch,
    arcs: dict[int, Arcs],
    views: Views,
    pieces: Pieces,
    positions: JointPositions,
    wanted: np.ndarray,
) -> Frames:
    n, shape = len(pieces.interval), (len(views.above), len(pieces.interval), 3)
    found = Frames(np.empty((*shape, 3)), *(np.zeros(shape) for _ in range(5)))
    still = np.broadcast_to(np.eye(3), (n, 3, 3)), *(np.zeros((n, 3)) for _ in range(3))
    joints = stretch.joints
    for frame in np.flatnonzero(wanted).tolist():
        link, above = int(views.links[frame]), int(views.above[frame])
        turn, at, omega, v0 = still if above == NONE else (part[above] for part in found[:4])
        fixed, own = joints.fixed[link, :3, :3], joints.axes[link]
        joint = turn @ joints.fixed[link, :3, 3] + at
        turn = turn @ fixed
        if link in arcs:
            turn = turn @ arcs[link].start[pieces.interval]
            own = arcs[link].axis[pieces.interval]
        axis = (turn * own[..., None, :]).sum(axis=2)
        middle, swing = positions.middle[:, link], positions.swing[:, link, None]
        kind = FIXED if joints.parents[link] == NONE else int(joints.kinds[link])
        if kind == SLIDING:
            joint = joint + axis * middle[:, None]
            v0 = v0 + swing * axis
        elif kind != FIXED:
            turn = turn @ _turned(own, middle)
            omega, v0 = omega + swing * axis, v0 - swing * _across(axis, joint)
        for part, value in zip(found, (turn, joint, omega, v0, axis, joint), strict=True):
            part[frame] = value
    return found


def _across(u: np.ndarray, v: np.ndarray) -> np.ndarray:
    """(n, 3) vector products; `np.cross` takes three times as long for a few hundred."""
    found = np.empty(v.shape)
    for i, j, k in ((0, 1, 2), (1, 2, 0), (2, 0, 1)):
        found[:, i] = u[:, j] * v[:, k] - u[:, k] * v[:, j]
    return found


def _turned(axis: np.ndarray, angle: np.ndarray) -> np.ndarray:
    """(n, 3, 3) turns about axes (3,) or (n, 3) by angles (n,)."""
    x, y, z = np.broadcast_to(axis, (len(angle), 3)).T
    sine, versine = np.sin(angle), 2.0 * np.sin(0.5 * angle) ** 2
    turn = np.empty((len(angle), 3, 3))
    for i, j, a, b, c in ((0, 1, x, y, z), (1, 2, y, z, x), (2, 0, z, x, y)):
        turn[:, i, i] = 1.0 - versine * (b * b + c * c)
        turn[:, i, j] = versine * a * b - sine * c
        turn[:, j, i] = versine * a * b + sine * c
    return turn


class Step(NamedTuple):
    """What moves a view by one frame of its chain, the joint first.

    Attributes:
        kind: of the joint. axis, at: (pieces, 3) its axis, and a point of it [m]. most: (pieces,) how far it swings
            and bends; bend: (pieces,) of that. length: (pieces,) [m] at most from the frame above.
        off: how far the frame's rotation is from one. errors: of the joint, then of frames, from the body outward.
    """

    kind: int
    axis: np.ndarray
    at: np.ndarray
    most: np.ndarray
    bend: np.ndarray
    length: np.ndarray
    off: float
    errors: list[Error]


def _steps(
    view: int, stretch: Stretch, views: Views, positions: JointPositions, frames: Frames
) -> list[Step]:
    """From a body to the base; what stands in the world on frames that may be off has one step."""
    found = []
    chain = _chain(views, int(views.frames[view]))
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
        found.append(
            Step(kind, axis, at, most, positions.bend[:, link], length, _off(joints.fixed[link]), errors)
        )  # fmt: skip
    body = int(views.bodies[view])
    if stretch.errors is not None and stretch.carriers[body] == NONE:
        n, zero = len(positions.middle), np.zeros(len(positions.middle))
        pose = np.repeat(views.poses[view][None], n, axis=0)
        held = _held(stretch.errors.of_bodies, body, pose[:, :3, :3], pose[:, :3, 3])
        point = np.zeros((n, 3))
        found.append(Step(FIXED, point, point, zero, zero, zero, 0.0, held))
    return found


def _errors_at(
    errors: Errors | None,
    link: int,
    kind: int,
    frame: int,
    positions: JointPositions,
    frames: Frames,
) -> list[Error]:
    """What may be off where a link hangs."""
    if errors is None:
        return []
    axis, at, found = frames.axis[frame], frames.joint[frame], []
    if kind != FIXED and errors.joint[link] > 0.0:
        found.append(Error(float(errors.joint[link]), axis, None if kind == SLIDING else at))
    origin = at - axis * positions.middle[:, link, None] if kind == SLIDING else at
    found += _place(float(errors.xyz[link]), float(errors.angle[link]), origin)
    return found + _held(errors.of_links, link, frames.turn[frame], frames.at[frame])


def _held(held: Held, which: int, turn: np.ndarray, at: np.ndarray) -> list[Error]:
    """Those of the frames that a link or body stands on."""
    found = []
    for i in np.flatnonzero(held.which == which).tolist():
        origin = turn @ held.origins[i] + at
        found += _place(float(held.xyz[i]), float(held.angle[i]), origin)
    return found


def _place(xyz: float, angle: float, origin: np.ndarray) -> list[Error]:
    turning = [Error(angle, None, origin)] if angle > 0.0 else []
    return [*turning, Error(xyz, None, None)] if xyz > 0.0 else turning


def _bounds(
    view: int,
    stretch: Stretch,
    views: Views,
    balls: Balls,
    steps: Sequence[Step],
    frames: Frames,
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """(pieces,) each, way, rest and rounding of one view."""
    middle, radius = balls.middle[view], float(balls.radius[view])
    frame = int(views.frames[view])
    pose = views.poses[view]
    turn, at = (pose[:3, :3], pose[:3, 3]) if frame == NONE else (frames.turn[frame], frames.at[frame])
    centre = turn @ middle + at
    reach = np.sqrt((middle * middle).sum()) + radius + np.abs(pose[:3, 3]).sum()
    off = _off(pose) + sum(step.off for step in steps)
    motions = [motion for step in steps for motion in _motions(step)]
    above = sum((one.most for one in motions if one.origin is not None), np.zeros(1))
    size = reach + sum((step.length for step in steps), np.zeros(1))
    turns = above
    way, rest = np.zeros(1), np.zeros(1)
    for axis, origin, most, bend in motions:  # from the body to the base
        if origin is None:
            rest = rest + most * above + bend
            way, size = way + most, size + most
            continue
        above = above - most
        arm = centre - origin if axis is None else _across(axis, centre - origin)
        rho = np.sqrt((arm * arm).sum(axis=-1)) + radius + way
        rest = rest + rho * (most * (0.5 * most + np.maximum(above, 0.0)) + bend)
        way = way + most * rho
    rounding = ((len(steps) + 4) * LEVEL + 4.0 * off) * (size + way) * (1.0 + turns)
    return way * OUTWARD, rest * OUTWARD, rounding


class Motion(NamedTuple):
    """A turn about an axis through `origin`, or about any, or a slide, where there is none; `bend` is part of `most`."""

    axis: np.ndarray | None
    origin: np.ndarray | None
    most: np.ndarray
    bend: np.ndarray


def _motions(step: Step) -> list[Motion]:
    """The joint with its own error, which has the same axis, then all others."""
    still = np.zeros(1)
    if step.kind == FIXED:
        return [Motion(e.axis, e.origin, still + e.size, still) for e in step.errors]
    own = [e for e in step.errors if e.axis is not None]
    most = step.most + sum(e.size for e in own)
    joint = Motion(step.axis, None if step.kind == SLIDING else step.at, most, step.bend)
    rest = [e for e in step.errors if e.axis is None]
    return [joint, *(Motion(e.axis, e.origin, still + e.size, still) for e in rest)]


def _chain(views: Views, frame: int) -> list[int]:
    """A frame and all above it."""
    found = []
    while frame != NONE:
        found.append(frame)
        frame = int(views.above[frame])
    return found


def _off(pose: np.ndarray) -> float:
    """How far the rotation of a pose is from one, beyond rounding."""
    turn = pose[:3, :3]
    return float(np.abs(turn.T @ turn - np.eye(3)).max())
