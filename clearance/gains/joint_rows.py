"""The limits of joints as linear rows of a path's offsets: places, speeds, accelerations, between samples too.

On the cubics of a table with velocities each lies between the least and the greatest of its Bernstein
coefficients, and these are linear in the offsets. Where those of a path reach beyond a limit that the path
itself keeps, no offset may take them farther. Joints that follow another count with it. Not for: what a path
leaves of its limits (`joint_ranges`).
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from clearance.gains.basis import Basis
from clearance.gains.programme import Inequalities
from clearance.world.joint_positions import joint_courses
from clearance.world.joint_speeds import motion_limit
from clearance.world.placed_robot import PlacedRobot
from clearance.world.trajectory import Trajectory


class Controls(NamedTuple):
    """What bounds a quantity of a joint's path on each interval between samples.

    Attributes:
        values: (c, n - 1, joints) Bernstein coefficients, by column of the table.
        splines: (c, n - 1, m) what each spline of a column adds to them.
    """

    values: np.ndarray
    splines: np.ndarray


def joint_rows(placed: PlacedRobot, basis: Basis) -> Inequalities:
    """What offsets of all columns of a robot's table keep, by splines, those of a column together."""
    from scipy.sparse import csr_array, kron, vstack

    n_joints = len(placed.given_trajectory.joint_names)
    parts, most = [], []
    for column, rows, levels in _rows(placed, basis):
        one = np.zeros((1, n_joints))
        one[0, column] = 1.0
        parts.append(kron(csr_array(one), csr_array(rows)))
        most.append(levels)
    if not parts:
        size = n_joints * len(basis.free)
        return Inequalities(csr_array((0, size)), np.zeros(0))
    return Inequalities(vstack(parts, format="csr"), np.concatenate(most))


def _rows(placed: PlacedRobot, basis: Basis) -> Iterator[tuple[int, np.ndarray, np.ndarray]]:
    """(column, (k, m) what the splines add, (k,) how much they may) for each limit of each joint, either way."""
    places, *rates = _quantities(placed.given_trajectory, basis)
    rate = placed.timing.rate
    for course in joint_courses(placed):
        if course.i_column is None or course.factor == 0.0:
            continue
        joint, limit = course.joint, motion_limit(placed, course.joint)
        levels = [(places, joint.upper - course.offset, course.offset - joint.lower)]
        most = (limit.velocity / rate, limit.acceleration / rate**2)
        levels += [(one, far, far) for one, far in zip(rates, most, strict=False)]
        for controls, upper, lower in levels:
            for sign, level in ((1.0, upper), (-1.0, lower)):
                if np.isfinite(level):
                    yield (
                        course.i_column,
                        *_below(controls, course.i_column, sign * course.factor, level),
                    )


def _below(
    controls: Controls, column: int, factor: float, level: float
) -> tuple[np.ndarray, np.ndarray]:
    """Rows that keep factor times a quantity below a level, or where it is, and what is left for each."""
    values = factor * controls.values[:, :, column]
    beyond = values.max(axis=0) > level
    slack = np.where(beyond, 0.0, level - values)
    rows = factor * controls.splines.reshape(-1, controls.splines.shape[-1])
    return _once(rows, slack.ravel())


def _once(rows: np.ndarray, slack: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The rows that splines change at all, of equal ones the tighter: a sample stands in two intervals."""
    moved = np.flatnonzero(rows.any(axis=1))
    order = moved[np.argsort(slack[moved], kind="stable")]
    _, first = np.unique(rows[order], axis=0, return_index=True)
    chosen = order[first]
    return rows[chosen], slack[chosen]


def _quantities(asked: Trajectory, basis: Basis) -> tuple[Controls, ...]:
    """Places and speeds between the samples of a table; on cubics accelerations as well."""
    samples, length = basis.at(asked.times), np.diff(asked.times)[:, None]
    pairs = [_between(asked.positions, length), _between(samples, length)]
    if asked.velocities is None:
        return (
            Controls(*(np.stack([start, end]) for start, end, _ in pairs)),
            Controls(*(mean[None] for _, _, mean in pairs)),
        )
    slopes = (asked.velocities, basis.at(asked.times, 1))
    found = [_of_cubics(*pair, slope, length) for pair, slope in zip(pairs, slopes, strict=True)]
    return tuple(Controls(*one) for one in zip(*found, strict=True))


def _between(at: np.ndarray, length: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """What is at the start and the end of each interval, and the mean rate."""
    return at[:-1], at[1:], np.diff(at, axis=0) / length


def _of_cubics(
    start: np.ndarray, end: np.ndarray, mean: np.ndarray, slopes: np.ndarray, length: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Bernstein coefficients of a cubic's places, speeds and accelerations on each interval."""
    before, after = slopes[:-1], slopes[1:]
    middle = 3.0 * mean - before - after
    return (
        np.stack([start, start + length / 3.0 * before, end - length / 3.0 * after, end]),
        np.stack([before, middle, after]),
        np.stack([2.0 * (middle - before) / length, 2.0 * (after - middle) / length]),
    )
