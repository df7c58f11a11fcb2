"""Joint motion through samples with accelerations: the quintics that ROS's joint trajectory controller follows, as
cubics between more samples, and a bound of how far these are off.

In units of the interval a quintic is q0 + v0 s + a0 s^2 / 2 + c3 s^3 + c4 s^4 + c5 s^5. A cubic that has its
positions and velocities at both ends of a part of length h is off by d4(x) h^4 t^2 (1 - t)^2 / 24 at the share t
of it, so by h^4 max |d4| / 384 at most; the fourth derivative d4 is linear. Source: the error of Hermite
interpolation, e.g. Stoer and Bulirsch 1980, 2.1.5. Not for: what that does to a clearance (`path_error`).
"""

from __future__ import annotations

from dataclasses import replace
from typing import NamedTuple

import numpy as np

from clearance.errors import BadDimension, BadShape, BadTime
from clearance.tolerance import LARGEST, PATH_ERROR
from clearance.world.trajectory import Points, Trajectory

MOST_SAMPLES = 1_000_000
"""Most samples of a trajectory: an acceleration in the wrong unit needs more."""

ROUNDING = 2.0**-42
"""The effect on the path of rounding a sample's position and velocity, relative to the sum of a quintic's terms:
each coefficient is at most 15 of it and right to 5 roundings, Horner's rule needs 10 more: some 1,300 in sum."""


class Quintics(NamedTuple):
    """(n - 1, k) each: the coefficients by powers of the share of an interval [rad or m]."""

    c0: np.ndarray
    c1: np.ndarray
    c2: np.ndarray
    c3: np.ndarray
    c4: np.ndarray
    c5: np.ndarray

    @property
    def fourth(self) -> np.ndarray:
        """(n - 1, k) the greatest fourth derivative by the share."""
        return np.maximum(np.abs(24.0 * self.c4), np.abs(24.0 * self.c4 + 120.0 * self.c5))


def quintics_of(
    times: np.ndarray, positions: np.ndarray, velocities: np.ndarray, accelerations: np.ndarray
) -> Quintics:
    """The quintics between n samples; shapes (n,) [s], and (n, k) each."""
    length = np.diff(times)[:, None]
    v0, v1 = length * velocities[:-1], length * velocities[1:]
    a0, a1 = length**2 * accelerations[:-1], length**2 * accelerations[1:]
    e, f, g = np.diff(positions, axis=0) - v0 - 0.5 * a0, v1 - v0 - a0, a1 - a0
    return Quintics(
        positions[:-1], v0, 0.5 * a0,
        10.0 * e - 4.0 * f + 0.5 * g, 7.0 * f - 15.0 * e - g, 6.0 * e - 3.0 * f + 0.5 * g,
    )  # fmt: skip


def with_accelerations(asked: Trajectory, accelerations: np.ndarray) -> Trajectory:
    """A trajectory with enough samples that its cubics are within `PATH_ERROR` of the quintics.

    Args:
        asked: with velocities; its samples stay. accelerations: (n, k) [rad/s^2] or [m/s^2].

    Exactness: `path_error` is proven, rounding of samples included.
    Raises:
        BadShape: more than `MOST_SAMPLES`. BadDimension: an acceleration that moves its joint out of all bounds.
            BadTime: the samples round to the same double.
    """
    assert asked.velocities is not None
    _refuse_large(asked, accelerations)
    points = Points(asked.times, asked.positions, asked.velocities, accelerations)
    if asked.n_steps < 2:
        return replace(asked, points=points)
    quintics = quintics_of(asked.times, asked.positions, asked.velocities, accelerations)
    fourth = quintics.fourth.max(axis=1, initial=0.0)
    times, interval = _parted(asked.times, np.ceil((fourth / (384.0 * PATH_ERROR)) ** 0.25))
    length = np.diff(asked.times)[interval]
    share = (times[:-1] - asked.times[interval]) / length
    positions, velocities = _at(quintics, interval, share[:, None], length[:, None])
    off = (np.diff(times) / length) ** 4 * fourth[interval] / 384.0
    return replace(
        asked,
        times=times,
        positions=np.vstack([positions, asked.positions[-1:]]),
        velocities=np.vstack([velocities, asked.velocities[-1:]]),
        path_error=float(off.max() * (1.0 + 1e-9) + ROUNDING * _size(asked, accelerations)),
        points=points,
    )


def _parted(times: np.ndarray, n_parts: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """(m,) [s] the times with each interval split into its parts, and (m - 1,) the interval of each part.

    Raises:
        BadShape, BadTime: as `with_accelerations`.
    """
    n_parts = np.maximum(n_parts, 1.0)
    if n_parts.sum() >= MOST_SAMPLES:
        raise BadShape(
            f"cubics would need {n_parts.sum():.3g} samples to follow its quintics",
            valid=f"{MOST_SAMPLES:,} or fewer; accelerations are in rad/s² and m/s²",
        )
    interval = np.repeat(np.arange(len(n_parts)), n_parts.astype(np.int64))
    nth = np.arange(len(interval)) - np.concatenate([[0.0], np.cumsum(n_parts)])[interval]
    starts = times[interval] + nth / n_parts[interval] * np.diff(times)[interval]
    found = np.append(starts, times[-1])
    if not (np.diff(found) > 0.0).all():
        raise BadTime("samples are too near in time to follow their quintics")
    return found, interval


def _at(
    quintics: Quintics, interval: np.ndarray, s: np.ndarray, length: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """(m, k) positions and velocities at shares of intervals."""
    c0, c1, c2, c3, c4, c5 = (part[interval] for part in quintics)
    positions = c0 + s * (c1 + s * (c2 + s * (c3 + s * (c4 + s * c5))))
    slopes = c1 + s * (2.0 * c2 + s * (3.0 * c3 + s * (4.0 * c4 + s * 5.0 * c5)))
    return positions, slopes / length


def _size(asked: Trajectory, accelerations: np.ndarray) -> float:
    """[rad or m] The greatest sum of the terms that a quintic is made of."""
    length = np.diff(asked.times)[:, None]
    parts = asked.positions, asked.velocities, accelerations
    ends = [np.abs(part) for part in parts if part is not None]
    sums = [(part[:-1] + part[1:]) * length**i for i, part in enumerate(ends)]
    return float(sum(sums).max(initial=0.0))


def _refuse_large(asked: Trajectory, accelerations: np.ndarray) -> None:
    longest = np.diff(asked.times).max(initial=0.0)
    with np.errstate(over="ignore"):
        farthest = np.abs(accelerations).max(axis=0, initial=0.0) * max(1.0, longest) ** 2
    if not (farthest <= LARGEST).all():
        raise BadDimension(
            f"joint {asked.joint_names[int(np.argmax(farthest))]!r} has an acceleration that takes it "
            f"{farthest.max():g} rad or m before the next sample",
            valid=f"{LARGEST:g} or less",
        )


def started(
    asked: Trajectory, positions: np.ndarray, velocities: np.ndarray | None = None
) -> Trajectory:
    """The trajectory with a sample at 0 s added; joints go to its first sample as between samples.

    Args:
        positions: (k,) [rad] or [m]. velocities: (k,) where it has some; at rest if not given.

    Raises:
        BadTime: it begins at 0 s or before.
    """
    own, at_rest = asked.written, np.zeros_like(positions)
    rates = own.velocities
    if rates is not None:
        rates = np.vstack([at_rest if velocities is None else velocities, rates])
    times = np.concatenate(([0.0], own.times))
    made = replace(
        asked, times=times, positions=np.vstack([positions, own.positions]), velocities=rates,
        path_error=0.0, points=None, has_way_in=False, start_off="",
        starts_before_file=True,
    )  # fmt: skip
    if not isinstance(own, Points):
        return made
    return with_accelerations(made, np.vstack([at_rest, own.accelerations]))
