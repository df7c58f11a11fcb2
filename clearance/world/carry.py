"""A part that is carried for a while: picked up where it is, one body all the time, let go where it then is."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

from clearance.errors import BadTime, Contradiction
from clearance.world.field_types import require_types
from clearance.world.timing import Window


@dataclass(frozen=True)
class Carry:
    """From when until when a part rides on a body.

    Its pose there is that of the moment at which it is picked up; after the end it stays where it was let go.

    Attributes:
        part: name of an obstacle.
        by: name of what carries it, as in `Mount.on`.
        window: with a start; without an end it is carried until the run ends.
        touch: patterns of bodies that it may touch while it is carried. What carries it moves with it, so that
            pair is not measured.
        exact_grasp: True where the gripper itself puts the part in its place, as a nest does. Then the part has
            none of the errors that the carrier has when it grips, nor of those that it had before.

    Raises:
        BadTime: no start. BadInput: a part that carries itself.
    """

    part: str
    by: str
    window: Window
    touch: tuple[str, ...] = ()
    exact_grasp: bool = False

    def __post_init__(self) -> None:
        require_types(self, part=str, by=str, window=Window, touch=[str])
        if not math.isfinite(self.window.start):
            raise BadTime(f"part {self.part!r} is carried from no time", valid="from: seconds")
        if self.part == self.by:
            raise Contradiction(f"part {self.part!r} carries itself", valid="by: what carries it")

    def excuse(self, pattern: str) -> str:
        """Why a body that one of `touch` is of is not measured against the part."""
        return f"touch: {pattern}, while {self.part} is carried {self.window}"


def require_one_carrier(carries: Sequence[Carry]) -> None:
    """Nothing, if each part is carried by one body at a time.

    Raises:
        BadInput: two windows of one part that overlap.
    """
    for i, one in enumerate(carries):
        for other in carries[:i]:
            if one.part != other.part:
                continue
            if one.window.start < other.window.end and other.window.start < one.window.end:
                raise Contradiction(
                    f"part {one.part!r} is carried by {other.by!r} ({other.window}) and by {one.by!r} "
                    f"({one.window}) at once",
                    where=f"carry[{i}]",
                    valid="windows of one part that do not overlap; one may begin where another ends",
                )
