"""The joints that bring a tool to poses: Newton's method, damped, of least joint motion.

Not for: going along a path (`following`), and what is proven of the answer (`enclosure`).
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from clearance.errors import BadProgram
from clearance.geometry.quaternions import half_skew
from clearance.programs.arm import Arm
from clearance.world.robot import Joint, JointKind
from clearance.world.tool import Tool

REACHED = 1e-12
"""[m] and [rad]: a pose that is this near is reached, where rounding allows."""

MOST_STEPS, MOST_FROM_AFAR = 12, 60
"""Steps to poses near those of known joints, and to any."""


class Solved(NamedTuple):
    """What Newton's method came to.

    Attributes:
        positions: (n, k) [rad or m]. residual: (n,) [m or rad] of each pose.
    """

    positions: np.ndarray
    residual: np.ndarray


def joints_at(
    tool: Tool,
    wanted: np.ndarray,
    start: np.ndarray,
    free: np.ndarray | None = None,
    most_steps: int = MOST_STEPS,
) -> Solved:
    """The joints for poses (n, 4, 4) seen from the root, from joints (n, k) where they are.

    Steps are of least joint motion, damped by the square of what is left (Sugihara 2011): far from the poses they
    keep from singularities, near them they are Newton's.

    Args:
        free: (k,) the joints that may move, all if not given; the others stay as in `start`.
    """
    own = np.ones(start.shape[1], dtype=bool) if free is None else free
    at, least = start.copy(), np.full(len(start), np.inf)
    for _ in range(most_steps):
        poses, rates = tool.poses_and_rates(at)
        off = off_pose(wanted, poses)
        left = np.abs(off).max(axis=1)
        if (left <= REACHED).all() or ((left >= least).all() and (left <= 1e-9).all()):
            break
        least = np.minimum(least, left)
        damping = (off**2).sum(axis=1)
        at[:, own] += least_motion(rates[:, :, own], off[:, :, None], damping)[:, :, 0]
    cosines = np.einsum("nij,nij->n", wanted[:, :3, :3], poses[:, :3, :3])
    return Solved(at, np.where(cosines > 1.0, left, np.pi))  # the sine of half a turn is 0 too


def off_pose(wanted: np.ndarray, poses: np.ndarray) -> np.ndarray:
    """(n, 6) what brings poses (n, 4, 4) to those that are wanted: a way [m] and a turn, sine times axis."""
    turned = wanted[:, :3, :3] @ np.swapaxes(poses[:, :3, :3], 1, 2)
    return np.hstack([wanted[:, :3, 3] - poses[:, :3, 3], half_skew(turned)])


def least_motion(
    rates: np.ndarray, aims: np.ndarray, damping: np.ndarray | float = 0.0
) -> np.ndarray:
    """(n, k, m) the joints' motion of least length whose rates (n, 6, k) are nearest to the aims (n, 6, m).

    Args:
        damping: (n,) by which it is shorter. `DAMPING` of the greatest rate squared is added; it leaves the answer
            to rounding but where the arm is singular.
    """
    turned, n_joints = np.swapaxes(rates, 1, 2), rates.shape[2]
    square = turned @ rates if n_joints < 6 else rates @ turned
    level = damping + DAMPING * np.trace(square, axis1=1, axis2=2) + 1e-300
    damped = square + level[:, None, None] * np.eye(square.shape[1])
    if n_joints < 6:
        return np.linalg.solve(damped, turned @ aims)
    return np.asarray(turned @ np.linalg.solve(damped, aims))


DAMPING = 1e-14

SEEDS = 64
"""Starts from which joints for a pose far away are searched."""


def nearest_joints(arm: Arm, wanted: np.ndarray, now: np.ndarray, ranges: np.ndarray) -> np.ndarray:
    """(k,) the joints for a pose (4, 4) that are nearest to where they are now, by the joint that goes farthest.

    Of those that damped least squares find from `SEEDS` starts within the ranges: none nearer is excluded.

    Args:
        ranges: (k, 2) where they may be; a joint stays at a range of no width.

    Raises:
        BadInput: none is found within the ranges.
    """
    low, high = ranges.T
    near, free = np.clip(now, low, high), low < high
    drawn = np.random.default_rng(0).random((SEEDS, len(now)))
    spread = np.linspace(0.0, 1.0, SEEDS)[:, None] ** 2
    low, high = np.maximum(low, near - np.pi), np.minimum(high, near + np.pi)
    starts = near + spread * (low + drawn * (high - low) - near)
    all_wanted = np.tile(wanted, (SEEDS, 1, 1))
    found = joints_at(arm.tool, all_wanted, starts, free, MOST_FROM_AFAR)
    positions = _turned_into(arm, found.positions, ranges)
    within = (positions >= ranges[:, 0]) & (positions <= ranges[:, 1])
    fits = (found.residual <= 1e-9) & within.all(axis=1)
    if not fits.any():
        raise _unreached(arm, wanted, now, ranges)
    ways = np.where(fits, np.abs(positions - now).max(axis=1), np.inf)
    return np.asarray(positions[int(np.argmin(ways))])


def _turned_into(arm: Arm, positions: np.ndarray, ranges: np.ndarray) -> np.ndarray:
    """(n, k) joints of the same pose: those outside their range by as few whole turns as bring them past its end.

    A joint that another follows by no whole factor stays as it is.
    """
    whole = arm.follows.copy()
    for one in arm.chain.joints:
        whole[one.column] &= one.turns and float(one.factor).is_integer()
    low, high = np.where(whole[:, None], ranges, [-np.inf, np.inf]).T
    below = np.ceil(np.maximum(low - positions, 0.0) / (2.0 * np.pi))
    above = np.ceil(np.maximum(positions - high, 0.0) / (2.0 * np.pi))
    return np.asarray(positions + 2.0 * np.pi * (below - above))


ANOTHER = (
    "another configuration of the target (RAPID: [cf1, cf4, cf6, cfx], or `ConfJ\\Off` before the move to ignore "
    "it; KRL: S and T; FANUC: CONFIG; else `within`)"
)
"""The remedy where a pose is within reach, and not in the configuration that is asked for."""


def _unreached(arm: Arm, wanted: np.ndarray, now: np.ndarray, ranges: np.ndarray) -> BadProgram:
    """Why no joints within the ranges bring the tool to a pose: beyond reach, or in another configuration only."""
    open_ranges = np.where((ranges[:, 0] < ranges[:, 1])[:, None], arm.ranges, ranges)
    narrow = np.flatnonzero((open_ranges != ranges).any(axis=1))
    place = arm.place(wanted)
    if not narrow.size:
        return BadProgram(
            f"no joints within their limits bring the tool to {place}", valid="a pose within reach"
        )
    asked = " and ".join(range_of(arm.joints[i], *ranges[i]) for i in narrow)
    problem = f"the configuration of the target asks for {asked}, and no such joints bring the tool to {place}"
    try:
        found = nearest_joints(arm, wanted, now, open_ranges)
    except BadProgram:
        return BadProgram(
            f"{problem}, nor any others within their limits", valid="a pose within reach"
        )
    other = ", ".join(f"{arm.joints[i].name} {_shown(arm.joints[i], found[i])}" for i in narrow)
    return BadProgram(f"{problem}; the tool reaches it with {other}", valid=ANOTHER)


def range_of(joint: Joint, low: float, high: float) -> str:
    """A joint and a range of it [rad or m], in words."""
    return f"{joint.name} {_shown(joint, low)} to {_shown(joint, high)}"


def _shown(joint: Joint, value: float) -> str:
    """A position of a joint [rad or m], as people read it."""
    is_slide = joint.kind is JointKind.PRISMATIC
    shown = round(float(value if is_slide else np.degrees(value)), 9)
    return f"{shown:.4g} m" if is_slide else f"{shown:.4g} deg"
