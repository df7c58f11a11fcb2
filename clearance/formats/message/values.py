"""Values of ROS messages in YAML, of which there are two dialects: mappings (`{x: 1, y: 2, z: 3}`), and
robowflex's lists (`[1, 2, 3]`). Not for: which fields there are (`moveit.objects`, `planning_scene`).
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Any

import numpy as np

from clearance.errors import (
    BadInput,
    BadPose,
    BadShape,
    MissingKey,
    NotFinite,
    UnknownKey,
    meant_name,
)
from clearance.geometry.pose import pose_from_quaternion
from clearance.geometry.quaternions import of_unit_length
from clearance.world.names import checked_name

Message = dict[str, Any]


def require_spelt(given: Message, *fields: str) -> None:
    """Refuses a field whose name resembles one that is read.

    Raises:
        UnknownKey: such a field.
    """
    for key in given:
        meant = meant_name(str(key), fields)
        if meant:
            raise UnknownKey(f"unknown field {key!r:.60}", valid=f"did you mean {meant!r}?")


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
    """The numbers of a vector: a list, or a mapping in which a missing one is 0."""
    if isinstance(value, dict) and set(value) <= set(keys):
        value = [value.get(key, 0.0) for key in keys]
    if not isinstance(value, list) or len(value) != len(keys):
        raise BadShape(
            f"{value!r:.60} is given", where=where, valid=f"{', '.join(keys)} are needed"
        )
    return [number(part, where) for part in value]


def number(value: object, where: str) -> float:
    """A finite number."""
    if isinstance(value, bool) or not isinstance(value, int | float):
        raise BadInput(f"{value!r:.60} is given", where=where, valid="a number is needed")
    if not (isinstance(value, int) and abs(value) < 2**62) and not math.isfinite(_float(value)):
        raise NotFinite(f"{value!r:.60} is given", where=where, valid="a finite number is needed")
    return float(value)


class Poses:
    """Reads poses, and counts quaternions that are rounded, whose lengths are made 1."""

    def __init__(self) -> None:
        self.n_rounded = 0

    def read(
        self, given: Message, place: str = "position", turn: str = "orientation"
    ) -> np.ndarray:
        """The (4, 4) pose [m] of a Pose or Transform; a quaternion of zeros is no rotation, as in MoveIt.

        Raises:
            BadPose: a quaternion whose length is not 1 within `tolerance.ROUNDED_ROTATION`.
        """
        require_spelt(given, place, turn)
        xyz = numbers(given[place], "xyz", place) if given.get(place) is not None else [0.0] * 3
        turned = numbers(given[turn], "xyzw", turn) if given.get(turn) is not None else [0.0] * 4
        if not any(turned):
            return pose_from_quaternion(xyz, [0.0, 0.0, 0.0, 1.0])
        unit, n_rounded = of_unit_length(np.array([turned]))
        self.n_rounded += n_rounded
        try:
            return pose_from_quaternion(xyz, unit[0])
        except BadPose as error:
            raise BadPose(error.problem, where=turn, valid=error.valid) from None


def _float(value: float) -> float:
    try:
        return float(value)
    except OverflowError:
        return math.inf
