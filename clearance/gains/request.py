"""What may be changed, and what must stay as it is: checked as it is request.

Not for: whether a case has what is named (`answer`).
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Any, TypedDict

import numpy as np

from clearance.errors import BadDimension, BadInput, UnknownKey, nearest_name
from clearance.gains.tool_poses import ToolKeep
from clearance.gains.turn import Turn

KINDS = ("waypoints", "obstacle", "base", "timing")

OWN = {
    "robot": ("waypoints", "base", "timing"),
    "obstacle": ("obstacle",),
    "keep": ("waypoints",),
    "within": ("obstacle", "base"),
    "turn": ("obstacle", "base"),
    "keep_tool": ("waypoints",),
    "tool": ("waypoints", "base"),
    "tool_path": ("base",),
    "slow_down": ("timing",),
}
"""Which kinds what is named is of; of others it would be passed over."""

TOOL_PATHS = ("moved", "kept")
"""Joints as they are, so that the tool moves along with the base; or joints that make up for the base."""

Range = tuple[float, float]
"""The least and the greatest that something may be."""

MOST_DELAY = 60.0
"""[s] That is looked at, if nothing is given."""


@dataclass(frozen=True)
class Request:
    """What may be changed.

    Attributes:
        kind: one of `KINDS`. margin: [m] above the fail limits.
        robot, obstacle: names; where there is one, it need not be given. Of waypoints several robots.
        keep: (start, end) of the run [s] in which a path stays as it is. keep_ends: its ends stay.
        most_delay: [s].
        within: how far a shift may go along x, y and z, ends of both signs or 0 [m]; None for anywhere.
        turn: that is allowed beside a shift.
        keep_tool: moments at which the tool stays about where it is. tool: the link that it is.
        tool_path: of `TOOL_PATHS`, what a base that is moved does to the path of its tool; None as "moved".
        slow_down: a robot goes slower in place of beginning later.
    """

    kind: str
    margin: float = 0.0
    robot: str | tuple[str, ...] | None = None
    obstacle: str | None = None
    keep: tuple[tuple[float, float], ...] = ()
    keep_ends: bool = True
    most_delay: float = MOST_DELAY
    within: tuple[Range, ...] | None = None
    turn: Turn | None = None
    keep_tool: tuple[ToolKeep, ...] = ()
    tool: str | None = None
    tool_path: str | None = None
    slow_down: bool = False

    @property
    def robots(self) -> tuple[str, ...]:
        """The robots that are named."""
        if self.robot is None:
            return ()
        return self.robot if isinstance(self.robot, tuple) else (self.robot,)

    @property
    def one_robot(self) -> str | None:
        """The robot that is named, of kinds that know of one only."""
        assert not isinstance(self.robot, tuple)
        return self.robot

    def __post_init__(self) -> None:
        if self.kind not in KINDS:
            raise BadInput(f"unknown kind {self.kind!r:.60}", valid=f"one of {', '.join(KINDS)}")
        _require_sorts(self)
        for name, kinds in OWN.items():
            if getattr(self, name) and self.kind not in kinds:
                raise BadInput(
                    f"{name} is given, of which a change of kind {self.kind} knows nothing",
                    valid=f"{name} with kind {' or '.join(kinds)}",
                )
        _require_one_robot(self)
        if not 0.0 <= self.margin < np.inf:
            raise BadDimension(f"a margin of {self.margin!r:.60} m", valid="a length, 0 or more")
        if not 0.0 <= self.most_delay < np.inf:
            raise BadInput(f"a delay of {self.most_delay!r:.60} s", valid="a time, 0 or more")
        if self.tool_path not in (None, *TOOL_PATHS):
            valid = f"one of {', '.join(TOOL_PATHS)}"
            raise BadInput(f"a tool path that is {self.tool_path!r:.60}", valid=valid)
        if self.tool is not None and not self.keep_tool and self.tool_path != "kept":
            raise BadInput(
                "a tool is named of which nothing is to be kept",
                valid="kind waypoints with keep_tool, or base with a tool path that is kept",
            )
        if self.within is not None:
            _require_room(self.within, self.turn)
        for start, end in self.keep:
            if not start <= end:
                raise BadInput(
                    f"from {start:g} s to {end:g} s is kept", valid="a start before its end"
                )


NAMES, FIGURES, SWITCHES = (
    ("obstacle", "tool", "tool_path"), ("margin", "most_delay"), ("keep_ends", "slow_down"),
)  # fmt: skip


def _require_sorts(request: Request) -> None:
    """Nothing, if names are text, lengths and times numbers, a turn a turn, and the rest true or false.

    Raises:
        BadInput: which is not.
    """
    sorts: list[tuple[tuple[str, ...], tuple[type, ...], str]] = [
        (NAMES, (str, type(None)), "a name"),
        (FIGURES, (int, float, np.integer, np.floating), "a number"),
        (SWITCHES, (bool, np.bool_), "True or False"),
        (("turn",), (Turn, type(None)), "'x', 'y', 'z' or a Turn"),
    ]
    if not all(isinstance(name, str) for name in request.robots):
        raise BadInput(f"robot is {request.robot!r:.60}", valid="a name, or several")
    for names, sort, valid in sorts:
        for name in names:
            given = getattr(request, name)
            if not isinstance(given, sort) or (valid == "a number" and isinstance(given, bool)):
                raise BadInput(f"{name} is {given!r:.60}", valid=valid)


def _require_one_robot(request: Request) -> None:
    """Nothing, if several robots are named only where their paths may be changed together, each once.

    Raises:
        BadInput: they are not.
    """
    if not isinstance(request.robot, tuple):
        return
    if request.kind != "waypoints" or request.keep_tool or request.tool:
        raise BadInput(
            f"{len(request.robot)} robots are named, of which one is changed",
            valid="one; several with kind waypoints, without a tool",
        )
    if len({*request.robot}) < len(request.robot):
        raise BadInput("a robot is named twice", valid="each once")


class Options(TypedDict, total=False):
    """What a change may be given by name; each has the value of `Request` where it is not given.

    Attributes:
        margin: [m] above the fail limits.
        robot, obstacle: what is changed; where there is one, it need not be named. Of waypoints several robots,
            whose paths are changed together.
        keep: (start, end) of the run [s] in which a path stays as it is. keep_ends: its ends stay.
        most_delay: [s] that is looked at.
        within: [m] how far a shift may go along x, y and z: a number for either way, or both ends.
        turn: that is allowed beside a shift: an axis of the world through the origin of what is moved, "x", "y" or
            "z", or a `Turn`.
        keep_tool: (time [s of the run], [m], [rad]): how far the tool may move and turn then.
        tool: the link that it is; else the first that all joints of the path move.
        tool_path: of a base that is moved: "moved", joints as they are, or "kept", the tool where it was.
        slow_down: of timing: the robot goes slower in place of beginning later.
    """

    margin: float
    robot: str | Sequence[str] | None
    obstacle: str | None
    keep: Sequence[Range]
    keep_ends: bool
    most_delay: float
    within: Sequence[float | Range] | None
    turn: Turn | str | None
    keep_tool: Sequence[ToolKeep | tuple[float, float, float]]
    tool: str | None
    tool_path: str | None
    slow_down: bool


def request_of(kind: str, options: Options) -> Request:
    """What is asked for by name.

    Raises:
        BadInput: as `Request`; an option that there is not, or that is none of its sort.
    """
    given: dict[str, Any] = dict(options)
    unknown = sorted(given.keys() - Options.__annotations__.keys())
    if unknown:
        raise UnknownKey(
            f"there is no option {unknown[0]!r}",
            valid=nearest_name(unknown[0], [*Options.__annotations__]),
        )
    robot = options.get("robot")
    if isinstance(robot, list | tuple):
        given["robot"] = robot[0] if len(robot) == 1 else tuple(robot) or None
    given["keep"] = stretches_of(options.get("keep", ()))
    given["keep_tool"] = keeps_of(options.get("keep_tool", ()))
    within, turn = options.get("within"), options.get("turn")
    given["within"] = None if within is None else ranges_of(within)
    given["turn"] = Turn(turn) if isinstance(turn, str) else turn
    return Request(kind, **given)


def stretches_of(keep: Sequence[Range]) -> tuple[Range, ...]:
    """Each stretch by its start and its end.

    Raises:
        BadInput: no pairs of numbers.
    """
    try:
        return tuple((float(start), float(end)) for start, end in keep)
    except (TypeError, ValueError):
        raise BadInput(
            f"{keep!r:.60} is to be kept", valid="(start, end) of each stretch [s of the run]"
        ) from None


def ranges_of(within: Sequence[float | Range]) -> tuple[Range, ...]:
    """Each range by its ends; a number is as far either way.

    Raises:
        BadDimension: neither numbers nor pairs of them.
    """
    try:
        pairs = [(-one, one) if isinstance(one, int | float) else one for one in within]
        return tuple((float(low), float(high)) for low, high in pairs)
    except (TypeError, ValueError):
        raise BadDimension(
            f"{within!r:.60} is no room for a shift", valid="a number or two for each of x, y and z"
        ) from None


def keeps_of(given: Iterable[ToolKeep | tuple[float, float, float]]) -> tuple[ToolKeep, ...]:
    """Moments at which a tool is kept, from three numbers each.

    Raises:
        BadInput: as `ToolKeep`; not three numbers.
    """
    if not isinstance(given, Iterable):
        raise BadInput(f"{given!r:.60} is given for keep_tool", valid="a tuple for each moment")
    return tuple(one if isinstance(one, ToolKeep) else _keep(one) for one in given)


def _keep(given: Sequence[float]) -> ToolKeep:
    try:
        time, far, turn = map(float, given)
    except (TypeError, ValueError):
        raise BadInput(
            f"{given!r:.60} is no tolerance of a tool", valid="(time [s], way [m], angle [rad])"
        ) from None
    return ToolKeep(time, far, turn)


def _require_room(within: Sequence[Range], turn: Turn | None) -> None:
    """Nothing, if a shift within these ranges can be none, and can be another.

    Raises:
        BadDimension: there are not three, or one that leaves out no shift. BadInput: nothing can be moved.
    """
    if len(within) != 3:
        raise BadDimension(f"{len(within)} ranges of a shift are given", valid="those of x, y, z")
    for axis, (low, high) in zip("xyz", within, strict=True):
        if not low <= 0.0 <= high:
            raise BadDimension(
                f"a shift along {axis} from {low * 1e3:g} to {high * 1e3:g} mm leaves out where it is",
                valid="a range that 0 is in",
            )
    if turn is None and not any(low < high for low, high in within):
        raise BadInput("a box of zero leaves nothing to move", valid="a range that is not 0")
