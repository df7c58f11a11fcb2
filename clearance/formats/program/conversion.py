"""From a controller's program to moves of a robot: its axes are joints, its poses are seen from the robot's root.

One conversion for all languages. Not for: how joints follow (room `programs`).
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from itertools import islice
from typing import Any

import numpy as np

from clearance.errors import BadProgram, MissingKey, at
from clearance.formats.program.arc_turns import turn_on_path
from clearance.formats.program.controlled_arm import ControlledArm, pose_written
from clearance.formats.program.controller_program import (
    AxisTarget,
    ControllerMove,
    ControllerProgram,
    ControllerWait,
    PoseTarget,
    Target,
)
from clearance.formats.program.stops import Stops
from clearance.formats.schema import program as schema
from clearance.formats.schema.program_file import ProgramFile
from clearance.formats.schema.strict_model import validated
from clearance.world.notice import listed
from clearance.world.robot import Robot

FARTHEST_OFF, MOST_TURNED = 0.01, 0.035
"""[m] and [rad] Where a file gives a pose and its axes: robots differ from their nominal sizes by less."""

FAR_OFF, FAR_TURNED = 0.1, 0.35
"""[m] and [rad] A point of its own axes is not taught so far from them, nor is a frame that was taught again."""

STANDS = 0.01
"""[degrees or mm] An external axis that moves by less stands: teaching leaves so much."""

FARTHEST = 1e3
"""[m] A point that is farther away is a mistake."""

UNTIMED = "the speed of joint moves that no file gives for joints"
"""What the times of a program lack, beside what its reader names."""

CONTROLLER = "controller"
"""The frame of the moves: the controller's base."""


@dataclass(frozen=True, eq=False)
class ConvertedProgram:
    """A program of a robot.

    Attributes:
        places: where each of its moves stands. names: of the moves, in reports. notes: a line each on what was
            assumed.
        assumed: what a verdict rests on, where nothing in the files confirms it, one line each. contradicted: the
            points whose own axes are far from them, where no point confirms axes, one line each.
        starts_anywhere: nobody says where the joints are before its first move, and it begins at that one's end.
        left_out: what its times lack: instructions that the case leaves out, and what no file says.
        is_rough: they rest on accelerations that no file says.
        own: the program, if it is written in our form. skips_overlaps: as of a `ControllerProgram`.
    """

    program: schema.Program
    places: tuple[str, ...]
    names: tuple[str, ...]
    notes: tuple[str, ...] = ()
    starts_anywhere: bool = False
    assumed: tuple[str, ...] = ()
    left_out: tuple[str, ...] = ()
    contradicted: tuple[str, ...] = ()
    is_rough: bool = False
    own: schema.Program | None = None
    skips_overlaps: bool = False


def converted(
    read: ControllerProgram,
    asked: ProgramFile,
    robot: Robot,
    start: Mapping[str, float],
    root_from_world: np.ndarray | None = None,
) -> ConvertedProgram:
    """The moves of a robot that a controller's program makes.

    Args:
        start: the joints at its beginning that the case gives [rad or m]. root_from_world: (4, 4) [m] where the
            world is, seen from the robot's root; None if that may change.

    Raises:
        BadInput: with the line, or the key of the case.
    """
    moving = [one for one in read.moves if isinstance(one, ControllerMove)]
    has_poses = any(isinstance(one.to, PoseTarget) for one in moving)
    arm = ControlledArm(asked, robot, read.base if has_poses else "", read.maker, root_from_world)
    made = _Conversion(read, arm)
    assert made.arm.link  # a fault of the case, and of no line
    own, starts_anywhere = made.start(start)
    made.begins_at_first = starts_anywhere
    # before flags of configurations are held against them
    on_axes = [*arm.doubts_on_axes()] if made.names_axes else []
    named = list(made.moves())
    tool = {"link": made.arm.link, **pose_written(made.first_tool)}
    program = {
        "tool": tool,
        "frames": {CONTROLLER: made.arm.base(), **made.arm.units()},
        "start": own,
        "step": asked.step,
    }
    moves, places, names = zip(*named, strict=True)
    checked = validated(schema.Program, {**program, "moves": [*moves]}, asked.file)
    rests_on = (made.arm.assumed,) if made.arm.assumed and has_poses else ()
    unproven = (*rests_on, *on_axes, *made.seeds)
    contradicted = tuple(made.far_off)
    notes = (*read.notes, *dict.fromkeys((*made.arm.notes, *made.notes)), *made.assumed())
    if made.compared[0] >= 0.0:  # the file itself says that it is so
        notes, unproven, contradicted = (*notes, *unproven, *contradicted), (), ()
    rests_on = (*unproven, *made.doubts())
    left_out = (*read.left_out, *([UNTIMED] if made.has_untimed_moves else []))
    return ConvertedProgram(
        *(checked, places, names, notes, starts_anywhere, rests_on, left_out, contradicted),
        is_rough=any(one.is_rough for one in moving),
        skips_overlaps=read.skips_overlaps,
    )


@dataclass(eq=False)
class _Conversion:
    """What the moves ask of an arm, and notes on what is assumed.

    Attributes:
        compared: [m] and [rad] how far poses are at most from where their axes have the tool; below 0 before any.
        others: where external axes are that no joint follows. begins_at_first: the tool begins where the first
            move ends. seeds: a line each on axes that are not those of the pose beside them; far_off: on those of
            one pose alone that are far from it.
    """

    read: ControllerProgram
    arm: ControlledArm
    notes: list[str] = field(default_factory=list)
    compared: tuple[float, float] = (-1.0, 0.0)
    others: dict[str, float] = field(default_factory=dict)
    begins_at_first: bool = False
    seeds: list[str] = field(default_factory=list)
    far_off: list[str] = field(default_factory=list)
    _before: ControllerMove | None = None

    @cached_property
    def _stops(self) -> Stops:
        """Corners where the controller stops."""
        return Stops(self.arm, self._moves[0] if self.begins_at_first else None, self.notes)

    @cached_property
    def first_tool(self) -> np.ndarray:
        """(4, 4) `flange_from_tool` of the first move that a tool matters to [m]."""
        return next((one.tool for one in self._moves if one.uses_tool), self._moves[0].tool)

    def moves(self) -> Iterator[tuple[schema.Move, str, str]]:
        """The moves, and changes of the tool before them; where each stands, and its name in reports.

        Raises:
            BadInput: with the line.
        """
        tool, names = self.first_tool, self.read.names()
        for one, name in zip(self._stops.applied(self.read.moves), names, strict=True):
            place = str(one.line)
            if isinstance(one, ControllerMove) and one.uses_tool:
                if not np.array_equal(one.tool, tool):
                    change = {"tool": pose_written(one.tool)}
                    yield validated(schema.Move, change, place), place, f"TOOL {place}"
                tool = one.tool
            yield self._move(one), place, name

    def start(self, given: Mapping[str, float]) -> tuple[dict[str, float], bool]:
        """The joints at the beginning, and whether they are but where the first move ends.

        Raises:
            MissingKey: the first move ends at a pose, without axes beside it that have the tool there, and nobody
                says where it begins.
        """
        if given:
            return dict(given), False
        first, far = self._moves[0], ""
        with at(str(first.line)):
            to = first.to
            if first.kind == "ptp" and isinstance(to, AxisTarget):
                return self.arm.axes.joints_of(to), True
            if first.kind == "ptp" and isinstance(to, PoseTarget) and to.near is not None:
                joints = self.arm.axes.joints_of(AxisTarget(to.near, to.external))
                off = self.arm.off(to, joints, first.tool)
                if off is not None and _is_there(*off):
                    return joints, True
                far = (
                    f", and the axes beside it have the tool {_shown(*off)} from it" if off else ""
                )
            raise MissingKey(
                f"the first move ends at a pose{far}, and the joints at its beginning are unknown",
                valid="trajectory: {program: …, start_state: {joint: …}}",
            )

    def _move(self, one: ControllerMove | ControllerWait) -> schema.Move:
        """A move, as `schema.program.Move` has it.

        Raises:
            BadInput: with the line.
        """
        place = str(one.line)
        with at(place):
            self._require_still(one)
            if isinstance(one, ControllerWait):
                made: dict[str, Any] = {"wait": one.seconds}
            elif one.kind == "ptp":
                made = {"ptp": self._joint_move(one)}
            else:
                made = {one.kind: self._path_move(one)}
            if isinstance(one, ControllerMove):
                self._before = one
        return validated(schema.Move, made, place)

    def _require_still(self, one: ControllerMove | ControllerWait) -> None:
        """Nothing, if external axes that no joint follows stay where they are.

        Raises:
            BadProgram: one moves.
        """
        for axis, value in one.to.external.items() if isinstance(one, ControllerMove) else ():
            off = value - self.others.setdefault(axis, value)
            if axis not in self.arm.axes.external.values() and abs(off) > STANDS:
                raise BadProgram(
                    f"external axis {axis} moves, and no joint follows it",
                    valid=f"program: {{axes: {{a joint: {{axis: {axis}}}}}}}",
                )

    def _joint_move(self, one: ControllerMove) -> dict[str, Any]:
        made: dict[str, Any] = {"zone": one.zone, **_joint_speed(one)}
        if isinstance(one.to, AxisTarget):
            return {**made, "joints": self.arm.axes.joints_of(one.to)}
        made["within"] = self.arm.ranges_of(one.to, one.tool)
        if one.to.near is not None:
            made["near"] = self.arm.axes.joints_of(AxisTarget(one.to.near, one.to.external))
            self._compare(str(one.line), one.to, made["near"], one.tool)
        return {**made, "to": self._target(one, one.to)}

    def _compare(
        self, place: str, to: PoseTarget, joints: Mapping[str, float], tool: np.ndarray
    ) -> None:
        """Keeps how far a pose is from where the axes beside it have the tool; too far, they are a seed alone."""
        off = self.arm.off(to, joints, tool)
        if off is None:
            return
        if not _is_there(*off):
            way, turn = off
            text = f"{place}: the axes beside {to.name or 'its pose'} have the tool {_shown(*off)} from it"
            if (way > FAR_OFF or turn > FAR_TURNED) and self._ends_by_axes[to.near] == 1:
                self.far_off.append(f"{text}, and no point confirms axes, base, link and tools")
            else:
                self.seeds.append(f"{text}: they are taken for a seed, and confirm no axes or base")
            return
        self.compared = max(self.compared, off)

    def _path_move(self, one: ControllerMove) -> dict[str, Any]:
        given = {
            "speed": one.speed if one.time is None else None,
            "acceleration": one.acceleration,
            "turn_speed": one.turn_speed if one.time is None else None,
            "time": one.time,
            "hold": self.arm.axes.external_values(one.to) or None,
            "zone": one.zone,
        }
        made = {key: value for key, value in given.items() if value is not None}
        to = self._target(one, one.to)
        if one.kind == "lin":
            left_out = "quat_xyzw" if one.orientation == "constant" else ""
            return {**made, "to": {key: to[key] for key in to if key != left_out}}
        assert one.via is not None
        via = self._target(one, one.via)
        point = {"frame": via["frame"], "xyz": via["xyz"]}
        return {**made, "to": to, "via": point, "orientation": self._turn(one)}

    def _turn(self, one: ControllerMove) -> str:
        """How the tool turns on an arc.

        Raises:
            BadProgram: otherwise than is read, or nobody knows how.
        """
        if one.orientation != "path":
            return one.orientation
        last = one if one.via is None else replace(one, to=one.via)
        ends = [self.arm.base_from_flange(end, one.to.unit) for end in (self._before, one)]
        via = self.arm.base_from_flange(last, one.to.unit)
        if ends[0] is None or ends[1] is None or via is None:
            raise BadProgram(
                "where the tool is before the arc is not known", valid="write a line before it"
            )
        start, middle, end = (pose @ one.tool for pose in (ends[0], via, ends[1]))
        return turn_on_path(start, middle[:3, 3], end)

    def _target(self, one: ControllerMove, to: Target) -> dict[str, Any]:
        """A pose of the tool; where axes are given, theirs."""
        name = {"name": to.name} if to.name else {}
        if isinstance(to, PoseTarget):
            return {"frame": to.unit or CONTROLLER, **pose_written(to.pose), **name}
        pose = self.arm.tool_at(self.arm.axes.joints_of(to), one.tool)
        return {"frame": schema.BASE, **pose_written(pose), **name}

    def doubts(self) -> Iterator[str]:
        """A line each on what controllers may do otherwise, whatever confirms axes and base."""
        yield from self.arm.doubts_on_configurations(self._poses)
        yield from dict.fromkeys(self._stops.cut)
        yield from self._doubts_on_others()
        yield from self.read.doubts

    def _doubts_on_others(self) -> Iterator[str]:
        """A line each on external axes that stand away from 0, and that no joint follows."""
        for axis, value in self.others.items():
            if axis not in self.arm.axes.external.values() and abs(value) > STANDS:
                says = [axis in one.to.external for one in self._moves]
                some = "" if all(says) else f" in {sum(says)} of {len(says)} targets alone"
                text = f"external axis {axis} is at {value:g}{some}, and no joint follows it: it is taken to "
                yield f"{text}stand, and to carry neither the robot nor the work"

    @cached_property
    def _poses(self) -> list[PoseTarget]:
        """The ends of moves that are poses."""
        return [one.to for one in self._moves if isinstance(one.to, PoseTarget)]

    @cached_property
    def _ends_by_axes(self) -> Counter[tuple[float, ...] | None]:
        """How many targets there are of axes, or poses with such beside them: of a seed there are several."""
        poses = {(one.near, one.pose.tobytes()) for one in self._poses if one.near is not None}
        axes = {one.to.axes for one in self._moves if isinstance(one.to, AxisTarget)}
        return Counter([*(near for near, _ in poses), *axes])

    @cached_property
    def names_axes(self) -> bool:
        """Whether a move says where axes are."""
        ends = [one.to for one in self._moves]
        return any(isinstance(to, AxisTarget) or to.ranges or to.near is not None for to in ends)

    def assumed(self) -> Iterator[str]:
        """A line each on what the moves leave open, and how that is taken."""
        if self.has_untimed_moves:
            yield "joint moves whose speed is the tool's go at the joints' full speeds"
        needed = {"base": bool(self._poses), "axes": self.names_axes, "axes_as": self.names_axes}
        idle = [key for key in needed if not needed[key] and getattr(self.arm.asked, key)]
        if idle:
            yield f"no move needs {listed(idle)}"
        if self.compared[0] >= 0.0:
            way, turn = self.compared[0] * 1e3, np.degrees(self.compared[1])
            yield f"poses with axes beside them agree with the robot within {way:.2g} mm and {turn:.2g} degrees"

    @property
    def has_untimed_moves(self) -> bool:
        """Whether a joint move has the speed of the tool, which says no time."""
        return any(one.kind == "ptp" and not _joint_speed(one) for one in self._moves)

    @cached_property
    def _moves(self) -> list[ControllerMove]:
        """All but waits.

        Raises:
            BadInput: there are none, or a point is farther away than any robot reaches.
        """
        found = [move for move in self.read.moves if isinstance(move, ControllerMove)]
        if not found:
            raise BadProgram("nothing moves", valid="a program with moves")
        for one in found:
            ends = (to.pose for to in (one.to, one.via) if isinstance(to, PoseTarget))
            for pose in (one.tool, *ends):
                away = np.abs(pose[:3, 3]).max()
                if not away <= FARTHEST:
                    text = f"a point {away:.3g} m away"
                    raise BadProgram(text, where=str(one.line), valid=f"{FARTHEST:g} m or less")
        return found


def _is_there(way: float, turn: float) -> bool:
    """True where axes [m] and [rad] off a pose are taken for its own."""
    return way <= FARTHEST_OFF and turn <= MOST_TURNED


def _shown(way: float, turn: float) -> str:
    return f"{round(way * 1e3, 3):.4g} mm and {np.degrees(turn):.3g} degrees"


def _joint_speed(one: ControllerMove) -> dict[str, float]:
    """How fast a joint move goes, by the fields of `schema.program.JointMove`; nothing where no file says it."""
    given = {"time": one.time, "joint_speed": one.axis_speed, "speed": one.share}
    said = {key: value for key, value in given.items() if value is not None}
    found = dict(islice(said.items(), 1))
    if "joint_speed" in found and one.axis_acceleration is not None:
        found["joint_acceleration"] = one.axis_acceleration
    return found
