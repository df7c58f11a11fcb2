"""Where each joint is in the middle of a piece of an interval, and how far from there it gets in it.

In units of the interval a joint on a cubic is at q(s) = q0 + s D + s (1 - s) ((1 - s) e0 - s e1), whose third
derivative is 6 g, g = e0 + e1. So about the middle a of a piece of half length h, |x| <= h,

    q(a + x) = q(a) + x q'(a) + b,   |b| <= h^2 (|q''(a)| / 2 + |g| h).

h q'(a) is the swing, the bound of b the bend. Not for: what that does to bodies (`placing`).
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from clearance.receipt.proof.motion_data import BALL, NONE, Stretch

ROUNDING = 2.0**-46
"""[-] Of all sizes that enter: more than what is rounded in positions and swings."""

HALF_TURN = 2.0**-20
"""[-] Nearer than this to a right angle between quaternions, which way round is shorter is left open."""


class IntervalPieces(NamedTuple):
    """Pieces of intervals: which (k,), and from where to where, 0 to 1, (k,) each; multiples of a power of 1/2."""

    interval: np.ndarray
    low: np.ndarray
    high: np.ndarray


class JointPositions(NamedTuple):
    """(k, links) each, [rad or m]: position in the middle, signed swing, and bend with all rounding in it."""

    middle: np.ndarray
    swing: np.ndarray
    bend: np.ndarray


class Arcs(NamedTuple):
    """How ball joints turn in each interval: from an orientation (n, 3, 3) about an axis (n, 3) by angles (n,)."""

    start: np.ndarray
    axis: np.ndarray
    angle: np.ndarray


def joint_positions(
    stretch: Stretch, arcs: dict[int, Arcs], pieces: IntervalPieces
) -> JointPositions:
    """Those of the joints above all links in some pieces."""
    joints, i = stretch.joints, pieces.interval
    moved = np.where((joints.columns != NONE) & (joints.kinds != BALL))[0]
    columns, factors = joints.columns[moved], joints.factors[moved]
    straight = [_of(stretch.positions, i + end, columns, factors) for end in (0, 1)]
    q0, step = straight[0], straight[1] - straight[0]
    length = (stretch.times[i + 1] - stretch.times[i])[:, None]
    cubic = stretch.cubic[columns]
    e0, e1 = (
        np.where(cubic, length * _of(stretch.rates, i + end, columns, factors) - step, 0.0)
        for end in (0, 1)
    )
    a, h = 0.5 * (pieces.low + pieces.high)[:, None], 0.5 * (pieces.high - pieces.low)[:, None]
    g, rest = e0 + e1, 1.0 - a
    shape = joints.offsets[moved] + q0 + a * step + a * rest * (rest * e0 - a * e1)
    slope = step + e0 - 2.0 * a * (g + e0) + 3.0 * a * a * g
    curve = 6.0 * a * g - 2.0 * (g + e0)
    sizes = np.abs(joints.offsets[moved]) + np.abs(q0) + np.abs(straight[1])
    sizes = sizes + 2.0 * (np.abs(e0) + np.abs(e1) + np.abs(step))
    found = JointPositions(*(np.zeros((len(i), len(joints.parents))) for _ in range(3)))
    found.middle[:, moved], found.swing[:, moved] = shape, h * slope
    found.bend[:, moved] = h * h * (0.5 * np.abs(curve) + np.abs(g) * h) + ROUNDING * sizes
    for link, arc in arcs.items():
        found.middle[:, link] = a[:, 0] * arc.angle[i]
        found.swing[:, link] = h[:, 0] * arc.angle[i]
    return found


def _of(
    table: np.ndarray, rows: np.ndarray, columns: np.ndarray, factors: np.ndarray
) -> np.ndarray:
    return table[rows[:, None], columns[None]] * factors


def arcs_of(stretch: Stretch) -> dict[int, Arcs]:
    """Of each ball joint, by its link, how it turns from step to step: about one axis, the shorter way.

    Raises:
        ValueError: half a turn from a step to the next: both ways are equally long.
    """
    found = {}
    for link in np.flatnonzero(stretch.joints.kinds == BALL).tolist():
        column = int(stretch.joints.columns[link])
        q = stretch.positions[:, column : column + 4]
        q = q / np.sqrt((q * q).sum(axis=1))[:, None]
        found[link] = _arcs(q[:-1], q[1:])
    return found


def _arcs(p: np.ndarray, q: np.ndarray) -> Arcs:
    scalar = (p * q).sum(axis=1)
    if (np.abs(scalar) < HALF_TURN).any():
        raise ValueError(int(np.argmin(np.abs(scalar))))
    v = p[:, 3:] * q[:, :3] - q[:, 3:] * p[:, :3] - np.cross(p[:, :3], q[:, :3])
    v = v * np.sign(scalar)[:, None]
    length = np.sqrt((v * v).sum(axis=1))
    still = length == 0.0
    axis = np.where(still[:, None], [0.0, 0.0, 1.0], v / np.where(still, 1.0, length)[:, None])
    return Arcs(_rotation(p), axis, 2.0 * np.arctan2(length, np.abs(scalar)))


def _rotation(q: np.ndarray) -> np.ndarray:
    """(n, 3, 3) of quaternions of length one."""
    x, y, z, w = q.T
    rows = (
        (1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)),
        (2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)),
        (2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)),
    )
    return np.moveaxis(np.array(rows), -1, 0)
