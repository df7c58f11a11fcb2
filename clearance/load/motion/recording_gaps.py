"""Holes in recordings: intervals many times longer than usual, and where the case says that a joint is meanwhile.

Not for: messages (`joint_states`), nor what a verdict says of holes (`world.plausible_recordings`).
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from clearance.errors import BadInput
from clearance.load.motion.trajectory_request import ReadTrajectory
from clearance.world.notice import HOLD
from clearance.world.trajectory import Hole, Trajectory

LONG = 10.0
"""Usual intervals that make a hole. Drivers and recorders lose a few messages in a row; how far a joint can be off
a straight line grows with the square of the interval, here to a hundred times what is usual."""


class Track(NamedTuple):
    """Where a joint was: times (n,) in any unit, increasing, and positions (n,) [rad or m]."""

    times: np.ndarray
    positions: np.ndarray

    @property
    def usual(self) -> float:
        """The median interval, the shorter one of two; infinite for a single sample."""
        lengths = np.sort(np.diff(self.times))
        return float(lengths[(len(lengths) - 1) // 2]) if len(lengths) else np.inf

    @property
    def holes(self) -> np.ndarray:
        """(k,) the samples after which a hole begins."""
        return np.flatnonzero(np.diff(self.times) > LONG * self.usual)

    def held(self) -> Track:
        """The track that stays over each hole until a usual interval before its next sample."""
        after = self.holes + 1
        if not len(after):
            return self
        times = np.insert(self.times, after, self.times[after] - self.times.dtype.type(self.usual))
        return Track(times, np.insert(self.positions, after, self.positions[after - 1]))


def holes_of(
    tracks: Mapping[str, Track], gaps: str | None, span: tuple[float, float], unit: float = 1.0
) -> tuple[Hole, ...]:
    """The holes of all joints in a span of time, in order; those that several joints share are one.

    Args:
        gaps: what the case says. span: from its start times are counted. unit: how many of the tracks' are 1 s.
    """
    found: dict[tuple[float, float], list[str]] = {}
    usual: dict[tuple[float, float], float] = {}
    for name, track in tracks.items():
        for i in track.holes:
            start, end = max(track.times[i], span[0]), min(track.times[i + 1], span[1])
            if start < end:
                key = float((start - span[0]) / unit), float((end - span[0]) / unit)
                found.setdefault(key, []).append(name)
                usual[key] = track.usual / unit
    return tuple(Hole(tuple(names), *key, usual[key], gaps) for key, names in sorted(found.items()))


def as_recorded(read: ReadTrajectory, gaps: str | None) -> ReadTrajectory:
    """A table that was recorded, with its holes as the case says.

    Raises:
        BadInput: joints that are to hold, and velocities by which they go on.
    """
    given, own = read.trajectory, read.trajectory.written
    columns = zip(given.joint_names, own.positions.T, strict=True)
    tracks = {name: Track(own.times, positions) for name, positions in columns}
    first, last = float(own.times[0]), float(own.times[-1])
    holes = tuple(
        replace(hole, start=hole.start + first, end=hole.end + first)
        for hole in holes_of(tracks, gaps, (first, last))
    )
    if not holes:
        return read
    if gaps == HOLD:
        if given.velocities is not None:
            raise BadInput(
                "gaps: hold of a table with velocities",
                valid="gaps: not_measured, or linear for the cubics that it gives",
            )
        tracks = {name: track.held() for name, track in tracks.items()}
        times = next(iter(tracks.values())).times
        positions = np.column_stack([track.positions for track in tracks.values()])
        given = Trajectory(times, given.joint_names, positions)
    return ReadTrajectory(replace(given, holes=holes), read.notes)
