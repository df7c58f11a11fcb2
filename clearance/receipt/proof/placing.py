"""Where bodies are in the middle of a piece of the motion, and how far from straight they move in it.

With joint k swinging by w_k (to either side) and bending by b_k, a point x of a body goes from the middle to
x + t v(x) + r, |t| <= 1, with v(x) = v0 + omega x x, the sum of w_k a_k x (x - c_k) over joints that turn and of
w_k a_k over those that slide. With d_k = |w_k| + b_k, and rho_k no less than how far the body gets from axis k,

    |r| <= sum_k d_k rho_k (d_k / 2 + sum_{j above, turning} d_j) + sum_k b_k rho_k            (k turning)
         + sum_k d_k sum_{j above, turning} d_j + sum_k b_k                                     (k sliding).

Errors of joints are added to d_k, those of frames are joints more; their first order is not in v but in `terms`.
The proof is in `NOTES.md`. Not for: whether two bodies keep apart (`separation`).
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from clearance.receipt.proof.error_terms import Error, Terms, across_rows, terms_of
from clearance.receipt.proof.joint_paths import (
    Arcs,
    IntervalPieces,
    JointPositions,
    joint_positions,
)
from clearance.receipt.proof.motion_data import FIXED, NONE, SLIDING, Stretch
from clearance.receipt.proof.views import Views
from clearance.receipt.proof.ways import Balls, PieceFrames, bounds_of, steps_of


class PlacedViews(NamedTuple):
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


def placed(
    stretch: Stretch,
    arcs: dict[int, Arcs],
    views: Views,
    balls: Balls,
    pieces: IntervalPieces,
    wanted: np.ndarray,
) -> PlacedViews:
    """The views in some pieces; those that are not `wanted` (views,) are left undefined."""
    joints = joint_positions(stretch, arcs, pieces)
    frames = _frames(stretch, arcs, views, pieces, joints, views.frames_of(np.flatnonzero(wanted)))
    n = len(pieces.interval)
    shape = len(views.frames) * n
    found = PlacedViews(
        np.zeros((3, 3, shape)), np.zeros((3, shape)), np.zeros((3, shape)), np.zeros((3, shape)),
        np.zeros(shape), np.zeros(shape), np.zeros(shape),
    )  # fmt: skip
    errors: list[list[Error]] = [[] for _ in views.frames]
    anyway = np.zeros(shape)
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
        steps = steps_of(view, stretch, views, joints, frames)
        errors[view] = [error for step in steps for error in step.errors]
        bounds = bounds_of(view, stretch, views, balls, steps, frames)
        parts = found.way, found.rest, found.rounding, anyway
        for part, bound in zip(parts, bounds, strict=True):
            part[own] = bound
    return found if stretch.errors is None else found._replace(terms=terms_of(errors, n, anyway))


def _frames(
    stretch: Stretch,
    arcs: dict[int, Arcs],
    views: Views,
    pieces: IntervalPieces,
    positions: JointPositions,
    wanted: np.ndarray,
) -> PieceFrames:
    n, shape = len(pieces.interval), (len(views.above), len(pieces.interval), 3)
    found = PieceFrames(np.empty((*shape, 3)), *(np.zeros(shape) for _ in range(5)))
    still = np.broadcast_to(np.eye(3), (n, 3, 3)), *(np.zeros((n, 3)) for _ in range(3))
    joints = stretch.joints
    for frame in np.flatnonzero(wanted).tolist():
        link, above = int(views.links[frame]), int(views.above[frame])
        turn, at, omega, v0 = still if above == NONE else (part[above] for part in found[:4])
        fixed, own = joints.fixed[link, :3, :3], joints.axes[link]
        joint = turn @ joints.fixed[link, :3, 3] + at
        turn = (turn.reshape(-1, 3) @ fixed).reshape(-1, 3, 3)
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
            omega, v0 = omega + swing * axis, v0 - swing * across_rows(axis, joint)
        for part, value in zip(found, (turn, joint, omega, v0, axis, joint), strict=True):
            part[frame] = value
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
