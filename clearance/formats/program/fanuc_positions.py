"""Points of FANUC's listings, as they stand under `/POS`. Not for: frames that they are seen from (`fanuc`)."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from clearance.errors import BadProgram
from clearance.formats.program.grammar import is_number
from clearance.geometry.pose import pose_from_rpy, rpy_from_pose

MM = 1e-3

POSE, JOINTS = ("X", "Y", "Z", "W", "P", "R"), ("J1", "J2", "J3", "J4", "J5", "J6")

_POSITION = re.compile(r"P\[\s*(\d{1,9})\s*(?::[^\]]*)?\]\s*\{([^{}]*)\}\s*;")
_VALUE = re.compile(r"\b([A-Z]\d?)\s*=\s*(\*+|[-+]?[0-9]{0,9}\.?[0-9]{1,9})\s*(?:mm|deg)\b")


@dataclass(frozen=True)
class Position:
    """A point of a listing.

    Attributes:
        frame, tool: the numbers that it was taught with; None for those in force.
        values: of the first group by name, in mm and degrees; None where it is not taught. external: of external
            axes and other groups.
        configuration: as the file has it.
    """

    frame: int | None
    tool: int | None
    values: Mapping[str, float | None]
    external: Mapping[str, float]
    configuration: str = ""

    @property
    def is_joints(self) -> bool:
        """Whether it has axes, and no pose."""
        return "J1" in self.values

    @property
    def keys(self) -> tuple[str, ...]:
        """The names of its values in their order."""
        return JOINTS if self.is_joints else POSE

    def pose(self) -> np.ndarray:
        """(4, 4) [m] Of the tool, seen from its frame.

        Raises:
            TypeError: it is not taught.
        """
        x, y, z, *turns = (self.element(number) for number in range(1, 7))
        return pose_from_rpy([x * MM, y * MM, z * MM], [math.radians(turn) for turn in turns])

    def element(self, number: int) -> float:
        """One of its values, by a number from 1.

        Raises:
            TypeError: it is not taught.
        """
        return float(self.values[self.keys[number - 1]])  # type: ignore[arg-type]

    def with_element(self, number: int, value: Any) -> Position:
        """The same with another value.

        Raises:
            TypeError: no number is given.
        """
        if not is_number(value):
            raise TypeError
        return replace(self, values={**self.values, self.keys[number - 1]: float(value)})


def positions_of(text: str) -> dict[int, Position]:
    """The points that stand under /POS.

    Raises:
        BadProgram: something that is none.
    """
    rest = _POSITION.sub("", text).strip()
    if rest:
        raise BadProgram(
            f"{' '.join(rest.split())!r:.60} under /POS is no position", valid="P[1]{ … };"
        )
    return {int(one[1]): _position(one[2]) for one in _POSITION.finditer(text)}


def _position(text: str) -> Position:
    groups = re.split(r"\bGP(\d)\s*:", text)
    by_group = dict(zip(groups[1::2], groups[2::2], strict=True)) or {"1": text}
    own = by_group.pop("1", "")
    values = {one[1]: None if "*" in one[2] else float(one[2]) for one in _VALUE.finditer(own)}
    taught = {name: value for name, value in values.items() if value is not None}
    external = {name: value for name, value in taught.items() if name.startswith("E")}
    for group, part in by_group.items():
        found = {
            f"GP{group}{one[1]}": float(one[2])
            for one in _VALUE.finditer(part)
            if "*" not in one[2]
        }
        external |= found
    frame, tool = (re.search(rf"\b{key}\s*:\s*(\d{{1,4}})\b", own) for key in ("UF", "UT"))
    configuration = re.search(r"CONFIG\s*:\s*'([^']*)'", own)
    return Position(
        None if frame is None else int(frame[1]),
        None if tool is None else int(tool[1]),
        values,
        external,
        "" if configuration is None else configuration[1],
    )


def position_of(pose: np.ndarray) -> Position:
    """The point of a (4, 4) pose [m], in any frame."""
    values = (*(pose[:3, 3] / MM).tolist(), *(math.degrees(turn) for turn in rpy_from_pose(pose)))
    return Position(None, None, dict(zip(POSE, values, strict=True)), {})
