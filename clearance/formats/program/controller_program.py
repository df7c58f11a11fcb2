"""A program as a controller has it: moves of axes and tool, as numbers, each with its line.

Readers of all controllers' languages make this one; `conversion` makes it moves of a robot. Metres, radians and
seconds. Not for: names, loops and calls, which a language's reader resolves.
"""

from __future__ import annotations

import json
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass, field, replace
from typing import Any, ClassVar, Literal

import numpy as np

from clearance.formats.program.tokens import Line
from clearance.formats.schema.program_file import ProgramFile


@dataclass(frozen=True)
class AxisTarget:
    """Positions of axes.

    Attributes:
        axes: with the controller's sign and zero [rad or m]. external: by name (`E1`), in degrees or mm, as the
            joint turns or slides. name: of the point.
    """

    axes: tuple[float, ...]
    external: Mapping[str, float] = field(default_factory=dict)
    name: str = ""
    unit: ClassVar[str] = ""


@dataclass(frozen=True, eq=False)
class PoseTarget:
    """A pose of the tool.

    Attributes:
        pose: (4, 4) `base_from_tool`: work frame times target [m]. external, name: as of an `AxisTarget`.
        unit: the mechanical unit whose frame is the pose's base; the controller's base if empty.
        ranges: from where to where axes are in the configuration that is asked for [rad], by number from 1.
        near: axes from which the nearest configuration is meant [rad]; None for those before the move.
        is_behind, is_back: the wrist is behind axis 1, and behind the line from axis 2 to 3; None if nobody
            says it.
        unchecked: flags of the configuration that are not read, as text.
    """

    pose: np.ndarray
    external: Mapping[str, float] = field(default_factory=dict)
    ranges: Mapping[int, tuple[float, float]] = field(default_factory=dict)
    near: tuple[float, ...] | None = None
    is_behind: bool | None = None
    is_back: bool | None = None
    unchecked: str = ""
    name: str = ""
    unit: str = ""


Target = AxisTarget | PoseTarget


@dataclass(frozen=True, eq=False)
class ControllerMove:
    """One move of a controller.

    Attributes:
        line: where it stands. kind: of the way. to: its end. tool: (4, 4) `flange_from_tool` [m].
        via: a point of the arc, for `circ`.
        orientation: as in `schema.program.ArcMove`, or from the start to the end, seen from the path; on a line it
            stays where it is constant.
        speed: of the tool's point [m/s]; acceleration [m/s^2]; turn_speed [rad/s]; None for the default.
        time: from standstill to standstill, whatever the speeds [s]; None if no time is asked for.
        share: for `ptp`, of the joints' greatest speeds. axis_speed, axis_acceleration: for `ptp`, of the axis
            that goes farthest [rad/s] and [rad/s^2].
        zone: radius of the corner at the end [m]; 0 stops there.
    """

    line: Line
    kind: Literal["ptp", "lin", "circ"]
    to: Target
    tool: np.ndarray
    via: Target | None = None
    orientation: Literal["to", "constant", "tangent", "path"] = "to"
    speed: float | None = None
    acceleration: float | None = None
    turn_speed: float | None = None
    share: float | None = None
    axis_speed: float | None = None
    axis_acceleration: float | None = None
    time: float | None = None
    zone: float = 0.0

    @property
    def uses_tool(self) -> bool:
        """True where it matters which tool is on the flange."""
        return self.kind != "ptp" or isinstance(self.to, PoseTarget) or self.zone > 0.0

    @property
    def is_rough(self) -> bool:
        """True where nobody says its time, nor its acceleration."""
        own = self.axis_acceleration if self.kind == "ptp" else self.acceleration
        return self.time is None and own is None

    def slowed(self, share: float) -> ControllerMove:
        """The same move at a share of all its speeds."""
        names = ("speed", "turn_speed", "share", "axis_speed")
        speeds = {name: getattr(self, name) for name in names}
        slower = {name: share * one for name, one in speeds.items() if one is not None}
        time = None if self.time is None else self.time / share
        return replace(self, time=time, **slower)


@dataclass(frozen=True)
class ControllerWait:
    """Nothing moves for some time [s]; a controller that `reads_on` may begin to wait while the robot moves."""

    line: Line
    seconds: float
    reads_on: bool = False


def digits_of(*values: Any) -> str:
    """Moves and targets to their last digit: the same for what is the same."""
    return json.dumps([asdict(one) for one in values], default=np.ndarray.tolist)


def end_of(moves: Sequence[ControllerMove | ControllerWait]) -> tuple[str, list[Any]]:
    """Where the robot is after moves, with the way there if a corner may follow; nowhere where there are none."""
    own = (one for one in reversed(moves) if isinstance(one, ControllerMove))
    last, before = next(own, None), next(own, None)
    if last is None:
        return "", []
    way = (last, before.to) if last.zone and before else (last.to,)
    return digits_of(*way), last.tool.tolist()


@dataclass(frozen=True, eq=False)
class ControllerProgram:
    """A whole program.

    Attributes:
        moves: in the order in which they are made: loops and calls are resolved. notes: a line each on what was
            assumed or passed over. base: why a robot's root link may not be the controller's base; empty where it
            is. doubts: a line each on what the controller may move otherwise, for the headline. maker: the preset
            of `axes_as` that its language has. left_out: what the times of the moves lack, and where.
        skips_overlaps: the controller skips a move where two corner zones overlap.
    """

    moves: tuple[ControllerMove | ControllerWait, ...]
    notes: tuple[str, ...] = ()
    base: str = ""
    doubts: tuple[str, ...] = ()
    maker: str = "plain"
    left_out: tuple[str, ...] = ()
    skips_overlaps: bool = False

    def names(self) -> Iterator[str]:
        """The name of each move in reports: "LIN 14 → P23"; where a line is run again, with the time."""
        times = Counter[str]()
        for one in self.moves:
            kind = one.kind.upper() if isinstance(one, ControllerMove) else "WAIT"
            name = f"{kind} {one.line.file} {one.line.own or one.line.number}".replace("  ", " ")
            times[name] += 1
            again = f" ({times[name]})" if times[name] > 1 else ""
            to = one.to.name if isinstance(one, ControllerMove) else ""
            yield f"{name}{again} → {to}" if to else f"{name}{again}"


@dataclass(frozen=True, eq=False)
class ProgramRequest:
    """What a reader of programs gets.

    Attributes:
        data: the file's content. shown: its name in messages. asked: as the case says.
        beside: content of the further files, by their names in messages.
    """

    data: bytes
    shown: str
    asked: ProgramFile
    beside: Mapping[str, bytes] = field(default_factory=dict)
