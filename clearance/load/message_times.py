"""Times in messages of ROS 1 and ROS 2. Not for: where they stand (`joint_points`, `pose_messages`)."""

from __future__ import annotations

from fractions import Fraction
from typing import Any

from clearance.load.message_documents import Fields

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


def _whole(given: Any) -> int | None:
    """A whole number, which people write as 2.0 too; None for anything else."""
    if type(given) is float and given.is_integer():
        return int(given)
    return given if type(given) is int else None
