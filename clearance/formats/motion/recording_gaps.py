"""Holes in recordings, many times longer than usual or without a number, and how joints move in them, as the case
says.

Not for: messages (`joint_states`), nor what a verdict says of holes (`world.plausible_recordings`).
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from clearance.errors import BadMotion
from clearance.formats.motion.requests import ReadTrajectory
from clearance.world.notice import HOLD, NOT_MEASURED
from clearance.world.trajectory import Hole

LONG = 10.0
"""Usual intervals that make a hole. Drivers and recorders lose a few messages in a row; how far a joint can be off
a straight line grows with the square of the interval, here to a hundred times what is usual."""

BRIEF = 0.15
"""[s] No shorter interval is a hole: fast drivers pause for some tens of milliseconds, and send messages
in bursts. A recording of 10 Hz has such intervals throughout."""

LATE = 2.0
"""Usual intervals by which a joint may begin after the others, or end before them: one is by chance."""

MOVED = 0.01
"""[rad] or [m] A joint that moves farther before all are known, or after, does not do so by chance."""

FEW = 10
"""A joint of so few messages has no usual interval of its own; that of more frequent joints is used."""


class Track(NamedTuple):
    """Where a joint was: times (n,) in any unit, increasing, positions (n,) [rad or m], and the usual interval.

    Attributes:
        brief: `BRIEF` in that unit. lost: samples after which a message said that the position is unknown.
    """

    times: np.ndarray
    positions: np.ndarray
    usual: float
    brief: float
    lost: Sequence[int] = ()

    @property
    def holes(self) -> np.ndarray:
        """(k,) the samples after which a hole begins."""
        begins = np.diff(self.times) > self.at_most(LONG)
        begins[[i for i in self.lost if 0 <= i < len(begins)]] = True
        return np.flatnonzero(begins)

    def at_most(self, n_usual: float) -> float:
        """So many usual intervals, or a brief one if that is longer."""
        return max(n_usual * self.usual, self.brief)

    def moves_beyond(self, time: float, way: int) -> bool:
        """True if it is farther than `MOVED` from where it is at a time, before it (`way` -1) or after it (1)."""
        beyond = self.positions[way * self.times > way * time]
        at_time = np.interp(time, self.times, self.positions)
        return bool((np.abs(beyond - at_time) > MOVED).any())

    def held(self) -> Track:
        """The track that holds its position in each hole until one usual interval before its next sample."""
        after = self.holes + 1
        if not len(after):
            return self
        half = np.diff(self.times)[after - 1] / 2.0
        late = np.minimum(self.usual, half).astype(self.times.dtype)
        times = np.insert(self.times, after, self.times[after] - late)
        positions = np.insert(self.positions, after, self.positions[after - 1])
        return self._replace(times=times, positions=positions)


def tracks_of(
    samples: Mapping[str, tuple[np.ndarray, np.ndarray]], unit: float = 1.0
) -> dict[str, Track]:
    """The tracks of joints, from times and positions (n,) each, with the median interval as the usual one.

    A joint with few messages has the usual interval of the others, if that is shorter.

    Args:
        unit: as in `holes_of`.
    """
    own = {name: _median(np.diff(times)) for name, (times, _) in samples.items()}
    often = (own[name] for name, (times, _) in samples.items() if len(times) > FEW)
    least = min(often, default=np.inf)
    found = {}
    for name, (times, positions) in samples.items():
        usual = own[name] if len(times) > FEW else min(own[name], least)
        found[name] = Track(times, positions, usual, BRIEF * unit)
    return found


def _median(lengths: np.ndarray) -> float:
    """The lower median; infinite for none."""
    return float(np.sort(lengths)[(len(lengths) - 1) // 2]) if len(lengths) else np.inf


def unknown_ends(tracks: Mapping[str, Track], span: tuple[float, float], unit: float) -> list[Hole]:
    """Where messages name some joints, and others not yet or no more: nothing is measured there.

    A few intervals in which no joint moves far are by chance, and no hole.

    Args:
        span: in which all are. unit: as in `holes_of`.
    """
    first = min(track.times[0] for track in tracks.values())
    last = max(track.times[-1] for track in tracks.values())
    moves = [
        any(track.moves_beyond(time, way) for track in tracks.values())
        for time, way in zip(span, (-1, 1), strict=True)
    ]
    most = {
        n: [0.0 if moved else track.at_most(LATE) for moved in moves] for n, track in tracks.items()
    }
    late = {n: t.usual for n, t in tracks.items() if t.times[0] - first > most[n][0]}
    early = {n: t.usual for n, t in tracks.items() if last - t.times[-1] > most[n][1]}
    found = []
    for unknown, start, end in ((late, first, span[0]), (early, span[1], last)):
        if unknown and start < end:
            since, until = (float((time - span[0]) / unit) for time in (start, end))
            usual = min(unknown.values()) / unit
            found.append(Hole(tuple(unknown), since, until, usual, NOT_MEASURED))
    return found


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
    """A recorded table, with its holes read as the case says.

    Raises:
        BadInput: `gaps: hold` for a table with velocities.
    """
    given, own = replace(read.trajectory, is_recorded=True), read.trajectory.written
    columns = zip(given.joint_names, own.positions.T, strict=True)
    tracks = tracks_of({name: (own.times, positions) for name, positions in columns})
    first, last = float(own.times[0]), float(own.times[-1])
    holes = tuple(
        replace(hole, start=hole.start + first, end=hole.end + first)
        for hole in holes_of(tracks, gaps, (first, last))
    )
    if not holes:
        return ReadTrajectory(given, read.notes)
    if gaps == HOLD:
        if given.velocities is not None:
            raise BadMotion(
                "gaps: hold of a table with velocities",
                valid="gaps: not_measured, or linear for the cubics that it gives",
            )
        tracks = {name: track.held() for name, track in tracks.items()}
        times = next(iter(tracks.values())).times
        positions = np.column_stack([track.positions for track in tracks.values()])
        given = replace(given, times=times, positions=positions, points=None)
    return ReadTrajectory(replace(given, holes=holes), read.notes)
