"""What may be changed, and what must stay as it is: the options of a gain, each declared once, checked when made.

Not for: whether a case has what is named (`answer`).
"""

from __future__ import annotations

import math
import re
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

from clearance.errors import BadChange, BadDimension
from clearance.options import (
    LENGTH,
    NAME,
    SWITCH,
    Sort,
    check_values,
    finite,
    not_negative,
    one_of,
    option,
    options_in,
)

if TYPE_CHECKING:
    from clearance.gains.tool_poses import ToolKeep
    from clearance.gains.turn import Turn

KINDS = ("waypoints", "obstacle", "base", "timing")

TOOL_PATHS = ("moved", "kept")
"""Joints as they are, so that the tool moves along with the base; or joints that make up for the base."""

Range = tuple[float, float]
"""The least and the greatest that something may be."""

MOST_DELAY = 60.0
"""[s] Of a delay, if nothing is given."""

_KEEP = re.compile(r"([^=]+?)s?=([^,]+)mm,([^,]+)deg")


def _stretch(given: Any) -> Range:
    start, end = map(finite, given)
    if start > end:
        raise ValueError(given)
    return start, end


def _numbers(text: str) -> list[float]:
    return [float(part) for part in text.split(":")]


def _ranges(given: Any) -> tuple[Range, ...]:
    """Three ranges; a number is as far either way."""
    pairs = [one if isinstance(one, Sequence) else (-not_negative(one), one) for one in given]
    if len(pairs) != 3:
        raise ValueError(given)
    return tuple((finite(low), finite(high)) for low, high in pairs)


def _ranges_of_text(text: str) -> list[float | list[float]]:
    parts = [[number / 1000.0 for number in _numbers(part)] for part in text.split(",")]
    return [part[0] if len(part) == 1 else part for part in parts]


def _point(given: Any) -> tuple[float, float, float]:
    x, y, z = map(finite, given)
    return x, y, z


def _turn(given: Any) -> Turn:
    from clearance.gains.turn import Turn

    if not isinstance(given, str | Turn):
        raise TypeError(given)
    return Turn(given) if isinstance(given, str) else given


def _tool_keep(given: Any) -> ToolKeep:
    from clearance.gains.tool_poses import ToolKeep

    if isinstance(given, ToolKeep):
        return given
    time, far, turn = map(float, given)
    return ToolKeep(time, far, turn)


def _tool_keep_of_text(text: str) -> tuple[float, float, float]:
    form = _KEEP.fullmatch(text)
    if form is None:
        raise ValueError(text)
    time, far, turn = map(finite, map(float, form.groups()))
    return time, far / 1000.0, math.radians(turn)


STRETCH = Sort(
    "START:END", "start and end of a stretch [s of the run], as 1.2:1.5", _stretch, _numbers
)
SPAN = Sort("S", "a time, 0 or more [s]", not_negative, float)
RANGES = Sort(
    "X,Y,Z", "ranges of x, y and z, each a number for either way or LOW:HIGH, as 50,0:100,0",
    _ranges, _ranges_of_text, suffix="mm", fault=BadDimension,
)  # fmt: skip
POINT = Sort(
    "X,Y,Z", "x, y and z of a point", _point,
    lambda text: [float(part) / 1000.0 for part in text.split(",")], suffix="mm",
)  # fmt: skip
ANGLE = Sort(
    "DEG", "an angle", finite, lambda text: math.radians(float(text)), suffix="deg"
)  # fmt: skip
TURN = Sort("x|y|z", "'x', 'y', 'z' or a Turn", _turn, choices=("x", "y", "z"))
TOOL_KEEP = Sort(
    "TIME=MM,DEG", "time [s], way [m] and angle [rad] of a tool; on the command line as 12.0=2mm,1deg",
    _tool_keep, _tool_keep_of_text,
)  # fmt: skip


@dataclass(frozen=True)
class Request:
    """What may be changed.

    Attributes:
        kind: one of `KINDS`. margin: [m] above the fail limits.
        robot, obstacle: names; where there is one, it need not be given. Paths of several robots can be changed
            together.
        keep: (start, end) of the run [s] in which a path stays as it is. keep_ends: its ends stay.
        most_delay: [s] the longest delay to try.
        within: [m] how far a shift may go along x, y and z: a number for either way, or both ends; None for
            anywhere.
        turn: that is allowed beside a shift: an axis of the world through the origin of what is moved, "x", "y" or
            "z", or a `Turn`. about: [m] another point of the axis. most_turn: [rad] either way.
        keep_tool: (time [s of the run], [m], [rad]): how far the tool may move and turn then.
        tool: the link that it is; else the first that all joints of the path move.
        tool_path: of a base that is moved: "moved", joints as they are, or "kept", the tool where it was.
        slow_down: the robot goes slower in place of beginning later.

    Raises:
        BadInput: a value that is none, or of which a change of this kind knows nothing.
    """

    kind: str
    margin: float = option(0.0, LENGTH, "Margin above the fail limits.")
    robot: tuple[str, ...] = option(
        (), NAME, "Robot to change; needed if there are several. Paths of several can be changed together.",
        many=True, of=("waypoints", "base", "timing"),
    )  # fmt: skip
    obstacle: str | None = option(
        None, NAME, "Obstacle to move; needed if there are several.", of=("obstacle",)
    )
    keep: tuple[Range, ...] = option(
        (), STRETCH, "Stretch of the run in which the path stays as it is [s], with the samples next to it.",
        many=True, of=("waypoints",),
    )  # fmt: skip
    keep_ends: bool = option(
        True, SWITCH, "Keep the ends of a path, or free them.", off="free_ends"
    )
    keep_tool: tuple[ToolKeep, ...] = option(
        (), TOOL_KEEP, "Limit how far the tool moves and turns at a time of the run, as 12.0=2mm,1deg.",
        many=True, of=("waypoints",),
    )  # fmt: skip
    tool: str | None = option(
        None, NAME, "Link that is the tool; if not given, the first link that all joints of the path move.",
        of=("waypoints", "base"),
    )  # fmt: skip
    most_delay: float = option(MOST_DELAY, SPAN, "Largest delay to try [s].")
    within: tuple[Range, ...] | None = option(
        None, RANGES, "Greatest shift along x, y and z: either way, or LOW:HIGH, as 50,0:100,0.",
        of=("obstacle", "base"),
    )  # fmt: skip
    turn: Turn | None = option(
        None,
        TURN,
        "Allow a turn about this axis of the world too.",
        of=("obstacle", "base"),
    )
    about: tuple[float, float, float] | None = option(
        None,
        POINT,
        "Point on the axis of --turn; if not given, the origin of the moved body.",
        needs=("turn", None),
    )
    most_turn: float | None = option(
        None, ANGLE, "Largest turn either way; if not given, half a turn.", needs=("turn", None)
    )
    tool_path: str | None = option(
        None, one_of(TOOL_PATHS),
        "moved: the tool moves with the base. kept: the joints change so that the tool stays where it was.",
        of=("base",),
    )  # fmt: skip
    slow_down: bool = option(
        False, SWITCH, "Slow the robot down instead of starting it later.", of=("timing",)
    )

    @property
    def one_robot(self) -> str | None:
        """The robot that is named, of kinds that know of one only."""
        assert len(self.robot) <= 1
        return next(iter(self.robot), None)

    def __post_init__(self) -> None:
        if self.kind not in KINDS:
            raise BadChange(f"unknown kind {self.kind!r:.60}", valid=f"one of {', '.join(KINDS)}")
        check_values(self)
        for name, one in options_in(Request).items():
            if getattr(self, name) and one.of and self.kind not in one.of:
                fault = f"{name} says nothing with kind {self.kind}"
                raise BadChange(fault, valid=f"kind {' or '.join(one.of)}")
        _require_robots(self)
        if self.tool is not None and not self.keep_tool and self.tool_path != "kept":
            raise BadChange(
                "a tool is named, and nothing says that it is kept",
                valid="kind waypoints with keep_tool, or base with a tool path that is kept",
            )
        if (turn := self.turn) is not None:  # what is said of it beside its axis is the turn's
            most = turn.most if self.most_turn is None else self.most_turn
            whole = replace(turn, about=self.about or turn.about, most=most)
            for name, value in {"turn": whole, "about": None, "most_turn": None}.items():
                object.__setattr__(self, name, value)
        if self.within is not None:
            _require_freedom(self.within, self.turn)


def kinds_of(name: str) -> tuple[str, ...]:
    """The kinds of change that an option is of."""
    return options_in(Request)[name].of or KINDS


def _require_robots(request: Request) -> None:
    """Nothing, if several robots are named only where their paths may be changed together, each once.

    Raises:
        BadInput: they are not.
    """
    names = request.robot
    if len(names) > 1 and (request.kind != "waypoints" or request.keep_tool or request.tool):
        raise BadChange(
            f"{len(names)} robots are named, and only one can be changed",
            valid="one; several with kind waypoints, without a tool",
        )
    if len({*names}) < len(names):
        raise BadChange("a robot is named twice", valid="each once")


def _require_freedom(within: Sequence[Range], turn: Turn | None) -> None:
    """Nothing, if a shift within these ranges can be none, and can be another.

    Raises:
        BadDimension: one that leaves out no shift. BadInput: nothing can be moved.
    """
    for axis, (low, high) in zip("xyz", within, strict=True):
        if not low <= 0.0 <= high:
            raise BadDimension(
                f"a shift along {axis} from {low * 1e3:g} to {high * 1e3:g} mm leaves out where it is",
                valid="a range that 0 is in",
            )
    if turn is None and not any(low < high for low, high in within):
        raise BadChange("a box of zero leaves nothing to move", valid="a range that is not 0")
