"""The limits of joints that follow a base: of their places, speeds and accelerations. Not for: offsets
(`joint_rows`).
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from clearance.gains.joint_ranges import ACCELERATION, OWN_SPEED, SPEED, joint_ranges
from clearance.gains.shortfalls import Rows
from clearance.gains.turn import ARM
from clearance.world.joint_positions import extremes_of, joint_courses, turns
from clearance.world.placed_robot import PlacedRobot

NEAR = 0.2
"""[rad], [m] or that a second: limits that are farther off are no rows."""


WEIGHT = 100.0
"""[-] Where not all can be kept, a joint a millimetre beyond its limit counts as bodies so many times too near."""


def limit_rows(
    before: PlacedRobot, after: PlacedRobot, followed: np.ndarray, beyond: float
) -> Rows:
    """How far joints are beyond their limits, a radian as `ARM`, times `WEIGHT`, and by how much less each
    variable makes it.

    What was beyond a limit before is to go no farther. Speeds and accelerations on cubics are measured as they
    are, and foretold as those of lines.

    Args:
        followed: (n, k, m) of the table's joints. beyond: [m] that is to cover rounding.
    """
    missing, gradients = [np.empty(0)], [np.empty((0, followed.shape[2]))]
    parts = [(*_places(one, followed), *_rates(one, followed)) for one in (before, after)]
    for (arm, was, _), (_, headroom, by_unit) in zip(*parts, strict=True):
        short = arm * (np.minimum(was, 0.0) - headroom)
        near = short > -arm * NEAR
        missing.append(short[near] + beyond)
        gradients.append(arm * by_unit[near])
    return Rows(np.concatenate(missing), np.concatenate(gradients))


_Headroom = tuple[float, np.ndarray, np.ndarray]
"""Metres for a unit, (n,) what is left, and (n, m) what that grows by."""


def _places(placed: PlacedRobot, followed: np.ndarray) -> Iterator[_Headroom]:
    """Of joints that a table moves, and of those that follow them, with what is between the samples."""
    for course in joint_courses(placed):
        if course.i_column is None or course.factor == 0.0:
            continue
        low, high = course.at_samples.copy(), course.at_samples.copy()
        reached = extremes_of(course, placed.trajectory)
        if reached is not None:
            low[:-1], high[:-1] = (
                np.minimum(low[:-1], reached[0]),
                np.maximum(high[:-1], reached[1]),
            )
        by_unit = course.factor * followed[:, course.i_column]
        arm = WEIGHT * (ARM if turns(course.joint) else 1.0)
        if np.isfinite(course.joint.upper):
            yield arm, course.joint.upper - high, -by_unit
        if np.isfinite(course.joint.lower):
            yield arm, low - course.joint.lower, by_unit


def _rates(placed: PlacedRobot, followed: np.ndarray) -> Iterator[_Headroom]:
    asked, rate = placed.given_trajectory, placed.timing.rate
    lengths = np.diff(asked.times)[:, None]
    for one in joint_ranges(placed):
        if one.what not in (SPEED, OWN_SPEED, ACCELERATION):
            continue
        column = asked.joint_names.index(one.joint)
        signs = np.sign(np.diff(asked.positions[:, column]))[:, None]
        by_unit = -signs * np.diff(followed[:, column], axis=0) / lengths * rate
        if one.what == ACCELERATION:
            by_unit = 0.0 * by_unit
        yield WEIGHT * (ARM if one.unit.startswith("rad") else 1.0), one.headroom, by_unit
