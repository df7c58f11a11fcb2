"""Joint motion between samples that carry velocities: each joint on the cubic that has them at both ends.

In units of the interval, with D the step and e0, e1 what the velocities exceed the mean velocity by,
q(s) = q0 + s D + s (1 - s) ((1 - s) e0 - s e1). Source: cubic Hermite interpolation, as ROS's joint trajectory
controller does it where positions and velocities are given. Not for: proofs (`kernels.motion.joint_path`).
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from clearance.world.trajectory import Trajectory


class Cubics(NamedTuple):
    """(n - 1, k) each: position at the start, step, and excesses at the start and at the end [rad or m]."""

    start: np.ndarray
    step: np.ndarray
    e0: np.ndarray
    e1: np.ndarray


def cubics_of(times: np.ndarray, positions: np.ndarray, velocities: np.ndarray) -> Cubics:
    """The cubics between n samples; shapes (n,) [s], (n, k) and (n, k)."""
    step, length = np.diff(positions, axis=0), np.diff(times)[:, None]
    return Cubics(
        positions[:-1], step, length * velocities[:-1] - step, length * velocities[1:] - step
    )


def position_on(cubics: Cubics, share: np.ndarray) -> np.ndarray:
    """(n - 1, k) the positions at `share` (0 to 1) of each interval; shapes broadcast."""
    rest = 1.0 - share
    return (
        cubics.start + share * cubics.step + share * rest * (rest * cubics.e0 - share * cubics.e1)
    )


def velocity_on(cubics: Cubics, share: np.ndarray) -> np.ndarray:
    """(n - 1, k) the derivative by the share there; shapes broadcast."""
    rest = 1.0 - share
    straight = cubics.step + (rest - share) * (rest * cubics.e0 - share * cubics.e1)
    return straight - share * rest * (cubics.e0 + cubics.e1)


def extremes_between(
    times: np.ndarray, positions: np.ndarray, velocities: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """(n - 1, k) least and greatest positions in each interval, its ends included.

    Exactness: right to a few roundings of the greatest term; the roots of the derivative have the form
        that does not cancel.
    """
    cubics = cubics_of(times, positions, velocities)
    a, b, c = 3.0 * (cubics.e0 + cubics.e1), -2.0 * cubics.e0 - cubics.e1, cubics.step + cubics.e0
    root = np.sqrt(np.maximum(b * b - a * c, 0.0))  # of a s^2 + 2 b s + c
    larger = -(b + np.copysign(root, b))
    reached = [positions[:-1], positions[1:]]
    for above, below in ((larger, a), (c, larger)):
        share = np.divide(above, below, out=np.zeros_like(a), where=np.abs(above) < np.abs(below))
        reached.append(position_on(cubics, np.maximum(share, 0.0)))
    return np.min(reached, axis=0), np.max(reached, axis=0)


def positions_along(trajectory: Trajectory, times: np.ndarray) -> np.ndarray:
    """(len(times), k) the positions of a trajectory at any times; before and after it, its first and last."""
    return values_along(trajectory.times, trajectory.positions, trajectory.velocities, times)


def values_along(
    knots: np.ndarray, positions: np.ndarray, velocities: np.ndarray | None, times: np.ndarray
) -> np.ndarray:
    """(len(times), k) the same of samples; shapes (n,) [s], (n, k) and (n, k)."""
    if velocities is None or len(knots) == 1:
        columns = [np.interp(times, knots, column) for column in positions.T]
        return np.array(columns).reshape(-1, len(times)).T
    interval = np.clip(np.searchsorted(knots, times, side="right") - 1, 0, len(knots) - 2)
    share = np.clip((times - knots[interval]) / np.diff(knots)[interval], 0.0, 1.0)[:, None]
    cubics = cubics_of(knots, positions, velocities)
    return position_on(Cubics(*(part[interval] for part in cubics)), share)
