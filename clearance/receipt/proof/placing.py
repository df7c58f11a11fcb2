"""Where bodies are in the middle of a piece of the motion, and how far from straight they move in it.

With joint k swinging by w_k (to either side) and bending by b_k, a point x of a body goes from the middle to
x + t v(x) + r, |t| <= 1, with v(x) = v0 + omega x x, the sum of w_k a_k x (x - c_k) over joints that turn and of
w_k a_k over those that slide. With d_k = |w_k| + b_k, and rho_k no less than how far the body gets from axis k,

    |r| <= sum_k d_k rho_k (d_k / 2 + sum_{j above, turning} d_j) + sum_k b_k rho_k            (k turning)
         + sum_k d_k sum_{j above, turning} d_j + sum_k b_k                                     (k sliding).

The proof is in `NOTES.md`. Not for: whether two bodies keep apart (`separation`).
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from clearance.receipt.proof.joint_paths import Arcs, JointPositions, Pieces, joint_positions
from clearance.receipt.proof.motion_data import FIXED, NONE, SLIDING, Stretch
from clearance.receipt.proof.views import Views

LEVEL = 2.0**-44
"""[-] Of how far a body reaches, for each link on the way to it: more than poses and sums are rounded by."""

OUTWARD = 1.0 + 2.0**-40
"""Covers the rounding of bounds that are sums of positive numbers."""


class Placed(NamedTuple):
    """Views in the middle of pieces, (..., k) each: place view * pieces + piece is that of a view in a piece.

    Attributes:
        turn: (3, 3, k) and at: (3, k) [m] the poses. omega, v0: (3, k) [rad], [m] the swing v.
        way: [m] no point gets farther from where it is in the middle. rest: [m] the bound of |r| above.
        rounding: [m] of all that is computed of such a view along a unit vector.
    """

    turn: np.ndarray
    at: np.ndarray
    omega: np.ndarray
    v0: np.ndarray
    way: np.ndarray
    rest: np.ndarray
    rounding: np.ndarray


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
        bounds = _bounds(view, stretch, views, balls, joints, frames)
        for part, bound in zip((found.way, found.rest, found.rounding), bounds, strict=True):
            part[own] = bound
    return found


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


def _bounds(
    view: int,
    stretch: Stretch,
    views: Views,
    balls: Balls,
    positions: JointPositions,
    frames: Frames,
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """(pieces,) each, way, rest and rounding of one view."""
    middle, radius = balls.middle[view], float(balls.radius[view])
    frame = int(views.frames[view])
    chain = _chain(views, frame)
    n = positions.middle.shape[0]
    centre = np.zeros((n, 3)) if frame == NONE else frames.turn[frame] @ middle + frames.at[frame]
    joints = stretch.joints
    reach = np.sqrt((middle * middle).sum()) + radius + np.abs(views.poses[view, :3, 3]).sum()
    way, rest, turns = np.zeros(n), np.zeros(n), np.zeros(n)
    off = _off(views.poses[view])
    moving = []
    for frame in chain:
        link = int(views.links[frame])
        reach = reach + np.abs(joints.fixed[link, :3, 3]).sum()
        off += _off(joints.fixed[link])
        if joints.parents[link] == NONE or joints.kinds[link] == FIXED:
            continue
        most = np.abs(positions.swing[:, link]) + positions.bend[:, link]
        if joints.kinds[link] == SLIDING:
            reach = reach + np.abs(positions.middle[:, link]) + most
        else:
            turns = turns + most
        moving.append((frame, link, most))
    above = turns.copy()
    for frame, link, most in moving:  # from the body to the base
        bend = positions.bend[:, link]
        if joints.kinds[link] == SLIDING:
            rest = rest + most * above + bend
            way = way + most
            continue
        above = above - most
        arm = _across(frames.axis[frame], centre - frames.joint[frame])
        rho = np.sqrt((arm * arm).sum(axis=1)) + radius + way
        rest = rest + rho * (most * (0.5 * most + np.maximum(above, 0.0)) + bend)
        way = way + most * rho
    size = (reach + way) * (1.0 + turns)
    rounding = ((len(chain) + 4) * LEVEL + 4.0 * off) * size
    return way * OUTWARD, rest * OUTWARD, rounding


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
