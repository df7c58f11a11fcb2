"""Positions at any instant of a motion, and how they bend about it: on lines, or on cubics with velocities.

Instants are counted in steps. Not for: the links that these move (`chain`).
"""

from __future__ import annotations

import numpy as np

from clearance.world.cubic import Cubics, cubics_of, position_on
from clearance.world.motion import Motion
from clearance.world.pose_table import PoseTable
from clearance.world.slerp import slerp


def positions_at(motion: Motion, instant: np.ndarray) -> np.ndarray:
    """(k, joints) positions at instants (k,), in steps; the steps' own to the last bit."""
    step, share = located(instant, motion.n_steps)
    ahead = np.minimum(step + 1, motion.n_steps - 1)
    if motion.velocities is None or motion.n_steps == 1:
        return motion.positions[step] * (1.0 - share) + motion.positions[ahead] * share
    found = position_on(_cubics(motion, motion.velocities, step), share)
    return np.where(share == 1.0, motion.positions[ahead], found)


def columns_at(table: PoseTable, instant: np.ndarray) -> np.ndarray:
    """(k, 7) position [m] and quaternion of an obstacle at instants (k,), in steps; the steps' own likewise."""
    step, share = located(instant, len(table))
    ahead = np.minimum(step + 1, len(table) - 1)
    places = table.positions[step] * (1.0 - share) + table.positions[ahead] * share
    turned = slerp(table.quaternions[step], table.quaternions[ahead], share[:, 0])
    return np.concatenate([places, turned], axis=1)


def rates_about(
    motion: Motion, low: np.ndarray, high: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Speed, bend and jerk (n, joints) on the cubics, as in `chain.Course`; no interval goes across a step."""
    middle, half = 0.5 * (low + high), 0.5 * (high - low)[:, None]
    step, share = located(middle, motion.n_steps)
    assert motion.velocities is not None
    cubic, rest = _cubics(motion, motion.velocities, step), 1.0 - share
    slope = (
        cubic.step + rest * (1.0 - 3.0 * share) * cubic.e0 + share * (3.0 * share - 2.0) * cubic.e1
    )
    curve = 2.0 * ((3.0 * share - 2.0) * cubic.e0 + (3.0 * share - 1.0) * cubic.e1)
    return half * slope, half**2 * curve, half**3 * 6.0 * (cubic.e0 + cubic.e1)


def located(instant: np.ndarray, n_steps: int) -> tuple[np.ndarray, np.ndarray]:
    """The step before each instant (the last interval's for the end), and the share (k, 1) run through."""
    step = np.clip(np.floor(instant).astype(int), 0, max(0, n_steps - 2))
    return step, (instant - step)[:, None]


def _cubics(motion: Motion, velocities: np.ndarray, step: np.ndarray) -> Cubics:
    found = cubics_of(motion.times, motion.positions, velocities)
    return Cubics(*(part[step] for part in found))
