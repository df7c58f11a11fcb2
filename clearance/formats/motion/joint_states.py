"""Recorded joint states to a trajectory: what a robot did, as its drivers told it, each of its own joints.

Not for: bags (`rosbag_file`).
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import NamedTuple

import numpy as np

from clearance.errors import BadMotion, BadShape, BadTime, NotFinite
from clearance.formats.message.values import NANO
from clearance.formats.motion.recording_gaps import Track, holes_of, tracks_of, unknown_ends
from clearance.formats.motion.requests import ReadTrajectory
from clearance.world.names import checked_name
from clearance.world.notice import HOLD, listed, naming
from clearance.world.trajectory import SHORTEST, Trajectory
from clearance.world.wrap import whole_turns

MOST_LEFT_OUT = 0.1
"""Share of the recording in which some joint may be unknown."""


class JointState(NamedTuple):
    """A message: when, which joints, where; whether velocities came along, and whether it is stamped.

    Attributes:
        nanoseconds: of its stamp, or when it was received.
    """

    nanoseconds: int
    names: tuple[str, ...]
    positions: list[float]
    has_velocities: bool = False
    is_stamped: bool = True


class _Joint(NamedTuple):
    """Where a joint was at times [ns].

    Attributes:
        unknown: numbers of the messages, from 1, that say no number of it. lost: the samples before these.
    """

    times: list[int]
    positions: list[float]
    unknown: list[int]
    lost: list[int]

    @property
    def samples(self) -> tuple[np.ndarray, np.ndarray]:
        return np.array(self.times), np.array(self.positions)


def trajectory_of_states(
    states: Sequence[JointState],
    turns: Mapping[str, bool],
    gaps: str | None = None,
    wrapping: frozenset[str] | None = None,
) -> ReadTrajectory:
    """What the robot did, in seconds from when all of its joints were known.

    Where several drivers tell of different joints, there is a sample at each time of each, and the other joints
    are between their own samples.

    Args:
        turns: names the joints that the robot can move; empty if the robot is not known.
        gaps: what joints do where they have no message for long, one of `GAPS`; with "hold", after their last
            message too.
        wrapping: joints of which whole turns may have been taken off; any where it is not known.

    Raises:
        BadInput: no joint that can be moved, or joints that are not known at one time. BadShape, BadTime: with the
            message.
    """
    joints = _joints(states)
    settable = [name for name in joints if name in turns or not turns]
    if not settable:
        raise BadMotion(
            f"none of the joints {listed([*joints], 8)} can be moved",
            valid=f"the robot moves {listed([*turns], 8)}",
        )
    for name in settable:
        if not joints[name].times:
            raise NotFinite(
                f"no message has a finite position of joint {name!r}", valid="one at least"
            )
    start, end = _known_span(
        {name: joints[name] for name in settable}, stays_after_end=gaps == HOLD
    )
    tracks = tracks_of({name: joints[name].samples for name in settable}, NANO)
    tracks = {name: track._replace(lost=joints[name].lost) for name, track in tracks.items()}
    holes = holes_of(tracks, gaps, (start, end), NANO)
    holes += tuple(unknown_ends(tracks, (start, end), NANO))
    if gaps == HOLD:
        tracks = {name: track.held() for name, track in tracks.items()}
    every = np.unique(np.concatenate([track.times for track in tracks.values()]))
    times = every[(every >= start) & (every <= end)]
    positions = [
        _positions_at(track, times, wrapping is None or name in wrapping)
        for name, track in tracks.items()
    ]
    trajectory = Trajectory(
        (times - start) / NANO, tuple(settable), np.column_stack(positions), holes=holes, wrap=SHORTEST,
        began=start / NANO,
    )  # fmt: skip
    return ReadTrajectory(trajectory, tuple(_notes(states, joints, settable, (start, end))))


def _positions_at(track: Track, times: np.ndarray, wraps: bool) -> np.ndarray:
    """(n,) where a joint is at some times: straight between its own samples, the shortest way where it wraps.

    Whole turns that were taken off stay off: each is in the step to the sample that is without it.
    """
    turns = whole_turns(track.positions) if wraps else np.zeros(len(track.times))
    since = track.times - times[0]
    found = np.interp(times - times[0], since, track.positions - 2.0 * np.pi * turns)
    if not turns.any():
        return found
    before = np.searchsorted(track.times, times, side="right") - 1
    return found + 2.0 * np.pi * turns[before]


def _joints(states: Sequence[JointState]) -> dict[str, _Joint]:
    """By name, in the order of their first messages."""
    joints: dict[str, _Joint] = {}
    for i, state in enumerate(states):
        where = f"message {i + 1}"
        if len(state.names) != len(state.positions) or len(set(state.names)) != len(state.names):
            raise BadShape(
                f"{len(state.positions)} positions of {listed([*state.names], 4)}",
                where=where,
                valid="a position of each joint, each once",
            )
        for name, position in zip(state.names, state.positions, strict=True):
            one = joints.setdefault(checked_name(name), _Joint([], [], [], []))
            if one.times and state.nanoseconds <= one.times[-1]:
                raise _not_later(name, where, is_same=state.nanoseconds == one.times[-1])
            if not math.isfinite(position):
                one.unknown.append(i + 1)
                one.lost.append(len(one.times) - 1)
                continue
            one.times.append(state.nanoseconds)
            one.positions.append(position)
    return joints


def _not_later(name: str, where: str, *, is_same: bool) -> BadTime:
    """The error of a message that is not later than the one before with a joint."""
    why = "a message was recorded twice" if is_same else "the clock was set back"
    remedy = "leave out one of the two" if is_same else "cut the bag there"
    return BadTime(
        f"its time is not later than that of the message before with {name!r}",
        where=where,
        valid=f"times that increase: if {why}, {remedy} (rosbag filter, ros2 bag convert), or give a CSV of time "
        "and joints",
    )


def _known_span(joints: Mapping[str, _Joint], *, stays_after_end: bool) -> tuple[int, int]:
    """From when until when [ns] all joints are known.

    Args:
        stays_after_end: True where a joint is known after its last message, which may then be long before others.

    Raises:
        BadInput: that is never, or too little of the recording.
    """
    last_to_begin = max(joints, key=lambda name: joints[name].times[0])
    first_to_end = (max if stays_after_end else min)(
        joints, key=lambda name: joints[name].times[-1]
    )
    start, end = joints[last_to_begin].times[0], joints[first_to_end].times[-1]
    times = [time for joint in joints.values() for time in (joint.times[0], joint.times[-1])]
    whole = max(times) - min(times)
    most = whole if stays_after_end else MOST_LEFT_OUT * whole
    if end < start or whole - (end - start) > most:
        raise BadMotion(
            f"joint {last_to_begin!r} is known from {(start - min(times)) / NANO:g} s on, {first_to_end!r} until "
            f"{(end - min(times)) / NANO:g} s of {whole / NANO:g} s",
            valid="states of all joints from begin to end, or a robot without those joints",
        )
    return start, end


def _notes(
    states: Sequence[JointState],
    joints: Mapping[str, _Joint],
    settable: Sequence[str],
    span: tuple[int, int],
) -> list[str]:
    notes = ["recorded joint states: joints move linearly between them, from the first at 0 s"]
    n_received = sum(not state.is_stamped for state in states)
    if n_received:
        notes.append(
            f"{n_received} of {len(states)} messages have no stamp: the time of receipt is used"
        )
    unknown = [
        f"{name!r} in message {listed([*map(str, joints[name].unknown)])}"
        for name in settable
        if joints[name].unknown
    ]
    notes += naming("positions that are NaN or infinite are left out", unknown, 8)
    if any(state.has_velocities for state in states):
        notes.append("recorded velocities are not followed: they are as measured, noise and all")
    if len({tuple(joints[name].times) for name in settable}) > 1:
        notes.append("messages have different joints: each joint has a sample at the times of all")
    n_out = sum(not span[0] <= state.nanoseconds <= span[1] for state in states)
    if n_out:
        notes.append(f"{n_out} messages at the ends are left out, where not all joints are known")
    others = [name for name in joints if name not in settable]
    return [*notes, *naming("joints that cannot be set are left out", others, 8)]
