"""Joint positions at any instant of a motion, and how they bend about it: on lines, or on cubics with velocities.

Instants are counted in steps. Not for: what that does to the points of a link (`chain_bounds`).
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from clearance.world.cubic import Cubics, cubics_of, position_on
from clearance.world.kinematics import positions_by_link, velocities_by_link
from clearance.world.motion import Motion


class Course(NamedTuple):
    """The joints above all links about the middles of n intervals, at middle + s half, |s| <= 1.

    position(s) = position + speed s + bend s^2 / 2 + jerk s^3 / 6; linear motion has neither bend nor jerk.

    Attributes: (n, n_links) each [rad] or [m].
    """

    position: np.ndarray
    speed: np.ndarray
    bend: np.ndarray
    jerk: np.ndarray


def positions_at(motion: Motion, instant: np.ndarray) -> np.ndarray:
    """(k, joints) positions at instants (k,), in steps; the steps' own to the last bit."""
    step, share = _located(motion, instant)
    ahead = np.minimum(step + 1, motion.n_steps - 1)
    if motion.velocities is None or motion.n_steps == 1:
        return motion.positions[step] * (1.0 - share) + motion.positions[ahead] * share
    found = position_on(_cubics(motion, motion.velocities, step), share)
    return np.where(share == 1.0, motion.positions[ahead], found)


def course_of(motion: Motion, low: np.ndarray, high: np.ndarray) -> Course:
    """The motion about the middles of intervals from `low` to `high` (n,), none across a step."""
    robot = motion.placed.robot
    middle, half = 0.5 * (low + high), 0.5 * (high - low)[:, None]
    position = positions_by_link(robot, positions_at(motion, middle))
    if motion.velocities is None:
        ends = [positions_by_link(robot, positions_at(motion, at)) for at in (low, high)]
        none = np.zeros_like(position)
        return Course(position, 0.5 * (ends[1] - ends[0]), none, none)
    step, share = _located(motion, middle)
    cubic, rest = _cubics(motion, motion.velocities, step), 1.0 - share
    slope = (
        cubic.step + rest * (1.0 - 3.0 * share) * cubic.e0 + share * (3.0 * share - 2.0) * cubic.e1
    )
    curve = 2.0 * ((3.0 * share - 2.0) * cubic.e0 + (3.0 * share - 1.0) * cubic.e1)
    rates = (half * slope, half**2 * curve, half**3 * 6.0 * (cubic.e0 + cubic.e1))
    return Course(position, *(velocities_by_link(robot, rate) for rate in rates))


def _located(motion: Motion, instant: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The step before each instant (the last interval's for the end), and the share (k, 1) run through."""
    step = np.clip(np.floor(instant).astype(int), 0, max(0, motion.n_steps - 2))
    return step, (instant - step)[:, None]


def _cubics(motion: Motion, velocities: np.ndarray, step: np.ndarray) -> Cubics:
    found = cubics_of(motion.times, motion.positions, velocities)
    return Cubics(*(part[step] for part in found))
