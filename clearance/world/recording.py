"""A robot's measured motion, compared with the commanded one. Not for: reading one (`case.recorded_run`)."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from clearance.errors import BadMotion, BadTime, MissingKey
from clearance.world.cubic import positions_along
from clearance.world.notice import listed
from clearance.world.timing import Timing, time_text
from clearance.world.trajectory import Trajectory

SHARE = 99.0
"""[%] The share of samples within the error that is reported besides the greatest."""


@dataclass(frozen=True)
class JointError:
    """How far a joint was off its course.

    Attributes:
        greatest: [rad or m] at `time` [s]. usual: `SHARE` of the samples are no farther off.
    """

    joint: str
    greatest: float
    usual: float
    time: float


@dataclass(frozen=True, eq=False)
class Recording:
    """A run of one robot.

    Attributes:
        path: as it is shown. offset: [s] added to its times to have the run's.
        commanded, timing: what the robot was to do. start, end: [s] both are known between.
        joints: how far each was off.
    """

    path: str
    offset: float
    commanded: Trajectory
    timing: Timing
    start: float
    end: float
    joints: tuple[JointError, ...]


def recording_of(
    path: str,
    offset: float,
    driven: Trajectory,
    commanded: Trajectory,
    timing: Timing,
    resting: Mapping[str, float],
) -> Recording:
    """A recording compared with the commanded motion, at the samples of both while both are known.

    Where joints move linearly between samples in both, the greatest error is at one of these.

    Args:
        driven: at the run's times. commanded: at its own. resting: [rad] or [m] where joints were to stay.

    Raises:
        MissingKey: a joint that was to move is not recorded. BadTime: both are never known at one time.
        BadInput: what was commanded has no end.
    """
    _require_joints(driven, commanded)
    if timing.after == "loop":
        raise BadMotion("the commanded motion begins again and again", valid="after: hold")
    times = _times_of_both(driven, timing.run_times(commanded.times))
    was = dict(zip(driven.joint_names, positions_along(driven, times).T, strict=True))
    own = positions_along(commanded, timing.table_times(times)).T
    wanted = dict(zip(commanded.joint_names, own, strict=True))
    errors = tuple(
        _error(joint, np.abs(was[joint] - wanted.get(joint, resting.get(joint, 0.0))), times)
        for joint in driven.joint_names
    )
    return Recording(path, offset, commanded, timing, float(times[0]), float(times[-1]), errors)


def motion_left_out(found: Recording) -> tuple[JointError, ...]:
    """How far each joint was commanded to move before a recording begins and after it ends; those that do not are
    left out. `time` is when it is farthest from where it was to be at that end of the recording.
    """
    commanded, timing = found.commanded, found.timing
    times = timing.run_times(commanded.times)
    ends = positions_along(commanded, timing.table_times(np.array([found.start, found.end])))
    before = np.abs(commanded.positions - ends[0]) * (times < found.start)[:, None]
    after = np.abs(commanded.positions - ends[1]) * (times > found.end)[:, None]
    far = np.maximum(before, after)
    errors = (_error(*row, times) for row in zip(commanded.joint_names, far.T, strict=True))
    return tuple(one for one in errors if one.greatest > 0.0)


def _require_joints(driven: Trajectory, commanded: Trajectory) -> None:
    missing = [name for name in commanded.joint_names if name not in driven.joint_names]
    if missing:
        raise MissingKey(
            f"it does not have joints {listed(missing, 8)} of the commanded motion",
            valid=f"it has {listed([*driven.joint_names], 8)}",
        )


def _times_of_both(driven: Trajectory, commanded: np.ndarray) -> np.ndarray:
    """(n,) [s] the samples of both, from when both are known until one ends, but for what is not measured."""
    start, end = max(driven.times[0], commanded[0]), min(driven.times[-1], commanded[-1])
    if not start < end:
        spans = [
            f"{time_text(times[0])} to {time_text(times[-1])} s"
            for times in (driven.times, commanded)
        ]
        raise BadTime(
            f"it covers {spans[0]}, and the commanded motion {spans[1]}",
            valid=f"--recorded-offset {commanded[0] - driven.times[0]:.12g} if both begin at one moment",
        )
    times = np.union1d(driven.times, commanded)
    times = times[(times >= start) & (times <= end)]
    for hole in driven.not_measured:
        times = times[(times <= hole.start) | (times >= hole.end)]
    if not len(times):
        raise BadTime(
            f"a hole covers all of {time_text(start)} to {time_text(end)} s",
            valid="gaps: hold or linear",
        )
    return times


def _error(joint: str, off: np.ndarray, times: np.ndarray) -> JointError:
    worst = int(np.argmax(off))
    usual = float(np.percentile(off, SHARE, method="higher"))
    return JointError(joint, float(off[worst]), usual, float(times[worst]))
