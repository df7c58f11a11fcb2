"""Values of ROS messages in YAML, of which there are two dialects: mappings (`{x: 1, y: 2, z: 3}`), and
robowflex's lists (`[1, 2, 3]`); and times in messages of ROS 1 and ROS 2.

Not for: which fields there are (`moveit.objects`, `planning_scene`, `joint_points`, `pose_messages`).
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from fractions import Fraction
from typing import Any, NamedTuple

import numpy as np

from clearance.errors import (
    BadInput,
    BadPose,
    BadShape,
    BadTime,
    MissingKey,
    NotFinite,
    UnknownKey,
    at,
    meant_name,
    nearest_name,
)
from clearance.formats.message.documents import Fields
from clearance.formats.text.notes import counted, note_on_rounded
from clearance.formats.text.numbers import is_double
from clearance.geometry.pose import pose_from_quaternion
from clearance.geometry.quaternions import of_unit_length
from clearance.world.names import checked_name

Message = dict[str, Any]


def require_fields(given: Message, *fields: str) -> None:
    """Refuses a field that a message does not have.

    Raises:
        UnknownKey: such a field.
    """
    for key in given:
        if key not in fields:
            raise UnknownKey(f"unknown field {key!r:.60}", valid=nearest_name(str(key), fields))


def require_spelt(given: Message, *fields: str) -> None:
    """Refuses a field whose name resembles one that is read, in a message that may be of several kinds.

    Raises:
        UnknownKey: such a field.
    """
    for key in given:
        meant = meant_name(str(key), fields)
        if meant:
            raise UnknownKey(f"unknown field {key!r:.60}", valid=f"did you mean {meant!r}?")


def header_of(given: Message) -> Message:
    """The header of a message; an empty one where there is none.

    Raises:
        UnknownKey: a field that no header has.
    """
    header = message(given, "header")
    with at("header"):
        require_fields(header, "seq", "stamp", "frame_id")
    return header


def frame_of(given: Message, default: str = "") -> str:
    """The frame in which a message is given, without a leading slash."""
    return text(header_of(given), "frame_id", default).lstrip("/")


def message(given: object, key: str) -> Message:
    """The message in a field; an empty one where there is none."""
    value = given.get(key) if isinstance(given, dict) else None
    if value is None:
        return {}
    if not isinstance(value, dict):
        raise BadInput(f"{value!r:.60} is given", where=key, valid="a mapping is needed")
    return value


def items(given: Message, key: str) -> list[Any]:
    """The list in a field; an empty one where there is none."""
    value = given.get(key)
    if value is None:
        return []
    if not isinstance(value, list):
        raise BadInput(f"{value!r:.60} is given", where=key, valid="a list is needed")
    return value


def messages(given: Message, key: str) -> Iterator[tuple[str, Message]]:
    """The messages of a list, each behind its place."""
    for i, value in enumerate(items(given, key)):
        if not isinstance(value, dict):
            where = f"{key}[{i}]"
            raise BadInput(f"{value!r:.60} is given", where=where, valid="a mapping is needed")
        yield f"{key}[{i}]", value


def text(given: Message, key: str, default: str | None = None) -> str:
    """The name in a field.

    Raises:
        MissingKey: there is none, and no default. BadInput: it is no text on one line.
    """
    value = given.get(key)
    if value is None or value == "":
        if default is None:
            raise MissingKey(f"{key!r} is missing", valid="a name is needed")
        return default
    if isinstance(value, bool) or not isinstance(value, str | int):
        raise BadInput(f"{value!r:.60} is given", where=key, valid="text is needed")
    return checked_name(f"{value}")


def numbers(value: object, keys: str, where: str) -> list[float]:
    """The numbers of a vector: a list, or a mapping."""
    if isinstance(value, dict) and set(value) == set(keys):
        value = [value[key] for key in keys]
    if not isinstance(value, list) or len(value) != len(keys):
        raise BadShape(
            f"{value!r:.60} is given", where=where, valid=f"{', '.join(keys)} are needed"
        )
    return [number(part, where) for part in value]


def number(value: object, where: str) -> float:
    """A finite number."""
    if isinstance(value, bool) or not isinstance(value, int | float):
        raise BadInput(f"{value!r:.60} is given", where=where, valid="a number is needed")
    if not is_double(value):
        raise NotFinite(f"{value!r:.60} is given", where=where, valid="a finite number is needed")
    return float(value)


class Poses:
    """Reads poses, and counts quaternions that are rounded, whose lengths are made 1, and those of zeros."""

    def __init__(self) -> None:
        self.n_rounded = 0
        self.n_unset = 0

    def notes(self) -> list[str]:
        """What was made of quaternions that are no rotation as they are written."""
        were = counted(self.n_unset, "quaternion of zeros is", "quaternions of zeros are")
        unset = [f"{were} taken for no rotation, as in MoveIt"]
        return note_on_rounded(self.n_rounded) + unset * (self.n_unset > 0)

    def read(
        self, given: Message, place: str = "position", turn: str = "orientation"
    ) -> np.ndarray:
        """The (4, 4) pose [m] of a Pose or Transform; a quaternion of zeros is no rotation, as in MoveIt.

        Source: MoveIt, planning_scene.cpp (poseMsgToEigen).

        Raises:
            UnknownKey, MissingKey: another field, or a rotation without a place.
            BadPose: a quaternion whose length is not 1 within `tolerance.ROUNDED_ROTATION`.
        """
        require_fields(given, place, turn)
        if given and given.get(place) is None:
            raise MissingKey(f"{place!r} is missing", valid="x, y, z")
        xyz = numbers(given[place], "xyz", place) if given else [0.0] * 3
        turned = [0.0] * 4
        if given.get(turn) is not None:
            turned = numbers(_whole(given[turn]), "xyzw", turn)
            self.n_unset += not any(turned)
        if not any(turned):
            return pose_from_quaternion(xyz, [0.0, 0.0, 0.0, 1.0])
        unit, n_rounded = of_unit_length(np.array([turned]))
        self.n_rounded += n_rounded
        try:
            return pose_from_quaternion(xyz, unit[0])
        except BadPose as error:
            raise BadPose(error.problem, where=turn, valid=error.valid) from None


def _whole(quaternion: object) -> object:
    """A quaternion with 0 for what is not given of it, as `{w: 1}`: its length shows what was forgotten."""
    if isinstance(quaternion, dict) and {*quaternion} <= {*"xyzw"}:
        return dict.fromkeys("xyzw", 0.0) | quaternion
    return quaternion


NANO = 10**9

_CLOCKS = (("sec", "nanosec"), ("secs", "nsecs"))


def nanoseconds_in(given: Any) -> int | None:
    """A time [ns] of whole seconds and nanoseconds; without nanoseconds these are 0, as for ROS's own commands.
    None for anything else.
    """
    for keys in _CLOCKS:
        if isinstance(given, Fields) and keys[0] in given and set(given) <= set(keys):
            seconds, nanoseconds = (_whole_number(given.get(key, 0)) for key in keys)
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


def _whole_number(given: Any) -> int | None:
    """A whole number, which people write as 2.0 too; None for anything else."""
    if type(given) is float and given.is_integer():
        return int(given)
    return given if type(given) is int else None
