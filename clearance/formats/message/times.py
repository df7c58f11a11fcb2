"""Times in messages of ROS 1 and ROS 2. Not for: where they stand (`joint_points`, `pose_messages`)."""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from typing import Any, NamedTuple

from clearance.errors import BadTime
from clearance.formats.message.documents import Fields

NANO = 10**9

_CLOCKS = (("sec", "nanosec"), ("secs", "nsecs"))


def nanoseconds_in(given: Any) -> int | None:
    """A time [ns] of whole seconds and nanoseconds; without nanoseconds these are 0, as for ROS's own commands.
    None for anything else.
    """
    for keys in _CLOCKS:
        if isinstance(given, Fields) and keys[0] in given and set(given) <= set(keys):
            seconds, nanoseconds = (_whole(given.get(key, 0)) for key in keys)
            if seconds is not None and nanoseconds is not None and 0 <= nanoseconds < NANO:
                return seconds * NANO + nanoseconds
    return None


def split_time(time: float) -> tuple[int, int]:
    """Whole seconds and nanoseconds of a time [s], to the nearest."""
    return divmod(round(Fraction(time) * NANO), NANO)


class WholeTimes(NamedTuple):
    """Times [ns] as messages keep them, and how many were no nearest doubles of such."""

    nanoseconds: list[int]
    n_rounded: int

    def note(self) -> str:
        """That some are not as they were."""
        n = len(self.nanoseconds)
        return f"{self.n_rounded} of {n} times are rounded to nanoseconds, as ROS keeps them"


def whole_times(times: Sequence[float]) -> WholeTimes:
    """Times [s] to the nearest nanosecond.

    Raises:
        BadTime: two of them are the same then.
    """
    wholes = [round(Fraction(time) * NANO) for time in times]
    for before, after, time in zip(wholes, wholes[1:], times[1:], strict=False):
        if before == after:
            raise BadTime(
                f"the sample at {time} s is less than a nanosecond after the one before",
                valid="a CSV file keeps such times",
            )
    n_rounded = sum(whole / NANO != time for whole, time in zip(wholes, times, strict=True))
    return WholeTimes(wholes, n_rounded)


def _whole(given: Any) -> int | None:
    """A whole number, which people write as 2.0 too; None for anything else."""
    if type(given) is float and given.is_integer():
        return int(given)
    return given if type(given) is int else None
