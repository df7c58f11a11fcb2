"""From a controller's program to moves of a robot: its axes are joints, its poses are seen from the robot's root.

One conversion for all languages. Not for: how joints follow (room `programs`).
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any

import numpy as np

from clearance.errors import BadProgram, MissingKey, UnknownLink, at, nearest_name
from clearance.formats.program.axes import AxisMap
from clearance.formats.program.controller_program import (
    AxisTarget,
    ControllerMove,
    ControllerProgram,
    ControllerWait,
    PoseTarget,
    Target,
)
from clearance.formats.schema import program as schema
from clearance.formats.schema.program_file import ProgramFile
from clearance.formats.schema.strict_model import validated
from clearance.geometry.pose import inverse
from clearance.geometry.quaternions import quaternions_of
from clearance.world.kinematic_chain import KinematicChain, chain_between
from clearance.world.notice import listed
from clearance.world.robot import Robot

FLANGE, BASE_LINK = "tool0", "base"
"""The links whose frames are the controller's flange and base, where a robot's file keeps to the convention of
ROS-Industrial."""

FARTHEST_OFF, MOST_TURNED = 0.01, 0.035
"""[m] and [rad] Where a file gives a pose and its axes: robots differ from their nominal sizes by less."""

STANDS = 0.01
"""[degrees or mm] An external axis that moves by less stands: teaching leaves so much."""

CONTROLLER = "controller"
"""The frame of the moves: the controller's base."""


@dataclass(frozen=True, eq=False)
class ConvertedProgram:
    """A program of a robot.

    Attributes:
        places: where each of its moves stands. names: of the moves, in reports. notes: a line each on what was
            assumed.
        starts_anywhere: nobody says where the joints are before its first move, and it begins at that one's end.
    """

    program: schema.Program
    places: tuple[str, ...]
    names: tuple[str, ...]
    notes: tuple[str, ...] = ()
    starts_anywhere: bool = False


def converted(
    read: ControllerProgram, asked: ProgramFile, robot: Robot, start: Mapping[str, float]
) -> ConvertedProgram:
    """The moves of a robot that a controller's program makes.

    Args:
        start: the joints at its beginning that the case gives [rad or m].

    Raises:
        BadInput: with the line, or the key of the case.
    """
    made = _Conversion(read, asked, robot)
    moves = [made.move(one) for one in made.stopping_moves()]
    own, starts_anywhere = made.start(start)
    program = {"tool": made.tool(), "frames": {CONTROLLER: made.base()}, "start": own}
    checked = validated(schema.Program, {**program, "step": asked.step, "moves": moves}, asked.file)
    places = tuple(place_of(one) for one in read.moves)
    notes = (*read.notes, *made.notes, *made.assumed())
    return ConvertedProgram(checked, places, tuple(_names(read)), notes, starts_anywhere)


@dataclass(eq=False)
class _Conversion:
    """What is known of robot and controller, and notes on what is assumed.

    Attributes:
        compared: [m] and [rad] how far poses are at most from where their axes have the tool; below 0 before any.
        others: where external axes are that no joint follows.
    """

    read: ControllerProgram
    asked: ProgramFile
    robot: Robot
    notes: list[str] = field(default_factory=list)
    compared: tuple[float, float] = (-1.0, 0.0)
    others: dict[str, float] = field(default_factory=dict)

    @cached_property
    def link(self) -> str:
        """The flange's link.

        Raises:
            UnknownLink, MissingKey: nobody says it.
        """
        links = self.robot.link_names
        if self.asked.link is None and FLANGE not in links:
            valid = f"the link whose frame is the controller's flange, one of {', '.join(links)}"
            raise MissingKey(f"there is no link {FLANGE!r}", where="link", valid=valid)
        link = self.asked.link or FLANGE
        if link not in links:
            valid = nearest_name(link, links)
            raise UnknownLink(f"there is no link {link!r}", where="link", valid=valid)
        if self.asked.link is None:
            self.notes.append(f"link {FLANGE!r} is taken for the flange")
        return link

    @cached_property
    def chain(self) -> KinematicChain:
        """From the robot's root to the flange."""
        return chain_between(self.robot, self.robot.link_names[0], self.link)

    @cached_property
    def axes(self) -> AxisMap:
        """How joints follow axes."""
        with at("axes"):
            return AxisMap.of(self.chain.masters, self.asked.axes)

    def base(self) -> dict[str, Any]:
        """The controller's base, as a frame of a program."""
        if self.root_from_base is None or self.asked.base is not None:
            assert self.asked.base is not None
            return self.asked.base.model_dump(exclude_unset=True)
        return {"on": schema.BASE, **_written(self.root_from_base)}

    @cached_property
    def root_from_base(self) -> np.ndarray | None:
        """(4, 4) the controller's base, seen from the robot's root [m]; None where only the cell says it."""
        if self.asked.base is not None:
            return self.asked.base.matrix() if self.asked.base.on == schema.BASE else None
        root = self.robot.link_names[0]
        link = BASE_LINK if BASE_LINK in self.robot.link_names else root
        if chain_between(self.robot, root, link).masters:
            link = root
        if self.read.base and link != BASE_LINK and self._has_poses:
            valid = "where it is, as base: {on: base, xyz: [0, 0, …]}, seen from the robot's root"
            raise MissingKey(self.read.base, where="base", valid=valid)
        self.notes.append(f"poses are seen from link {link!r}, taken for the controller's base")
        return chain_between(self.robot, root, link).end

    @property
    def _has_poses(self) -> bool:
        return any(isinstance(one.to, PoseTarget) for one in self._moves)

    def tool(self) -> dict[str, Any]:
        """The tool on the flange.

        Raises:
            BadInput: another one later.
        """
        using = [move for move in self._moves if _uses_tool(move)] or self._moves
        for move in using:
            if not np.array_equal(move.tool, using[0].tool):
                with at(place_of(move)):
                    raise BadProgram("another tool than before", valid="a program of one tool")
        return {"link": self.link, **_written(using[0].tool)}

    def start(self, given: Mapping[str, float]) -> tuple[dict[str, float], bool]:
        """The joints at the beginning, and whether they are but where the first move ends.

        Raises:
            MissingKey: the first move ends at a pose, and nobody says where it begins.
        """
        if given:
            return dict(given), False
        first = self._moves[0]
        if first.kind == "ptp" and isinstance(first.to, AxisTarget):
            return self.axes.joints_of(first.to), True
        with at(place_of(first)):
            raise MissingKey(
                "the first move ends at a pose, and the joints at its beginning are unknown",
                valid="trajectory: {program: …, start_state: {joint: …}}",
            )

    def stopping_moves(self) -> Iterator[ControllerMove | ControllerWait]:
        """The moves, without corner zones where no move follows at once: controllers stop there."""
        after = [*self.read.moves, None][1:]
        for one, other in zip(self.read.moves, after, strict=True):
            follows = isinstance(other, ControllerMove)
            if isinstance(one, ControllerMove) and one.zone and not follows:
                self.notes.append(f"{place_of(one)}: the tool stops, since no move follows at once")
                one = replace(one, zone=0.0)
            yield one

    def move(self, one: ControllerMove | ControllerWait) -> schema.Move:
        """A move, as `schema.program.Move` has it.

        Raises:
            BadInput: with the line.
        """
        place = place_of(one)
        with at(place):
            self._require_still(one)
            if isinstance(one, ControllerWait):
                made: dict[str, Any] = {"wait": one.seconds}
            elif one.kind == "ptp":
                made = {"ptp": self._joint_move(one)}
            else:
                made = {one.kind: self._path_move(one)}
        return validated(schema.Move, made, place)

    def _require_still(self, one: ControllerMove | ControllerWait) -> None:
        """Nothing, if external axes that no joint follows stay where they are.

        Raises:
            BadProgram: one moves.
        """
        for axis, value in one.to.external.items() if isinstance(one, ControllerMove) else ():
            off = value - self.others.setdefault(axis, value)
            if axis not in self.axes.external.values() and abs(off) > STANDS:
                raise BadProgram(
                    f"external axis {axis} moves, and no joint follows it",
                    valid=f"program: {{axes: {{a joint: {{axis: {axis}}}}}}}",
                )

    def _joint_move(self, one: ControllerMove) -> dict[str, Any]:
        made: dict[str, Any] = {"speed": self._share(one), "zone": one.zone}
        if isinstance(one.to, AxisTarget):
            return {**made, "joints": self.axes.joints_of(one.to)}
        held = {name: [value, value] for name, value in self.axes.held(one.to).items()}
        made["within"] = {**self.axes.ranges_of(one.to), **held}
        if one.to.near is not None:
            made["near"] = self.axes.joints_of(AxisTarget(one.to.near, one.to.external))
            self._compare(one.to, made["near"], one.tool)
        return {**made, "to": self._target(one, one.to)}

    def _compare(self, to: PoseTarget, joints: Mapping[str, float], tool: np.ndarray) -> None:
        """Keeps how far a pose is from where its axes have the tool, where the file has both.

        Raises:
            BadProgram: too far.
        """
        if self.root_from_base is None:
            return
        off = inverse(self._tool_at(joints, tool)) @ self.root_from_base @ to.pose
        way, turn = (
            float(np.linalg.norm(off[:3, 3])),
            float(np.arccos(np.clip(0.5 * np.trace(off[:3, :3]) - 0.5, -1.0, 1.0))),
        )
        if way > FARTHEST_OFF or turn > MOST_TURNED:
            raise BadProgram(
                f"{to.name or 'its pose'} and its axes are {way * 1e3:.3g} mm and {np.degrees(turn):.3g} degrees "
                "apart on this robot",
                valid="axes, base, link and tools as the controller has them",
            )
        self.compared = max(self.compared, (way, turn))

    def _path_move(self, one: ControllerMove) -> dict[str, Any]:
        given = {
            "speed": one.speed,
            "acceleration": one.acceleration,
            "turn_speed": one.turn_speed,
            "hold": self.axes.held(one.to) or None,
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
        return {**made, "to": to, "via": point, "orientation": one.orientation}

    def _target(self, one: ControllerMove, to: Target) -> dict[str, Any]:
        """A pose of the tool; where axes are given, theirs."""
        name = {"name": to.name} if to.name else {}
        if isinstance(to, PoseTarget):
            return {"frame": CONTROLLER, **_written(to.pose), **name}
        pose = self._tool_at(self.axes.joints_of(to), one.tool)
        return {"frame": schema.BASE, **_written(pose), **name}

    def _tool_at(self, joints: Mapping[str, float], tool: np.ndarray) -> np.ndarray:
        """(4, 4) `root_from_tool` [m]."""
        row = np.array([[joints[joint.name] for joint in self.chain.masters]])
        return np.asarray(self.chain.frames(row)[0, -1] @ tool)

    def _share(self, one: ControllerMove) -> float:
        """The share of the joints' greatest speeds with which a joint move goes."""
        if one.axis_speed is None:
            return 1.0 if one.share is None else one.share
        limits = [joint.velocity for joint in self.chain.masters if joint.velocity > 0.0]
        return min(1.0, one.axis_speed / min(limits)) if np.isfinite(min(limits)) else 1.0

    def assumed(self) -> Iterator[str]:
        """A line each on what the moves leave open, and how that is taken."""
        joint_moves = [one for one in self._moves if one.kind == "ptp"]
        if any(one.share is None and one.axis_speed is None for one in joint_moves):
            yield "joint moves whose speed is the tool's go at the joints' full speeds"
        if any(one.axis_speed is not None for one in joint_moves):
            yield "speeds of axes are shares of the slowest joint's greatest speed"
        ends = [one.to for one in self._moves if isinstance(one.to, PoseTarget)]
        if unchecked := dict.fromkeys(one.unchecked for one in ends if one.unchecked):
            yield f"of configurations not checked: {listed([*unchecked])}"
        if self.compared[0] >= 0.0:
            way, turn = self.compared[0] * 1e3, np.degrees(self.compared[1])
            yield f"poses with axes beside them agree with the robot within {way:.2g} mm and {turn:.2g} degrees"

    @cached_property
    def _moves(self) -> list[ControllerMove]:
        """All but waits.

        Raises:
            BadInput: there are none.
        """
        found = [move for move in self.read.moves if isinstance(move, ControllerMove)]
        if not found:
            raise BadProgram("nothing moves", valid="a program with moves")
        return found


def place_of(one: ControllerMove | ControllerWait) -> str:
    """Where a move stands."""
    return f"{one.file} line {one.line}".lstrip()


def _uses_tool(move: ControllerMove) -> bool:
    """True where it matters which tool is on the flange."""
    return move.kind != "ptp" or isinstance(move.to, PoseTarget)


def _written(pose: np.ndarray) -> dict[str, Any]:
    """A (4, 4) pose as the schema has it."""
    quaternion = quaternions_of(pose[None, :3, :3])[0]
    return {"xyz": pose[:3, 3].tolist(), "quat_xyzw": quaternion.tolist()}


def _names(read: ControllerProgram) -> Iterator[str]:
    """The name of each move in reports: "LIN 14 → P23"; where a line is run again, with the time."""
    times = Counter[str]()
    for one in read.moves:
        kind = one.kind.upper() if isinstance(one, ControllerMove) else "WAIT"
        name = f"{kind} {place_of(one).replace('line ', '')}"
        times[name] += 1
        again = f" ({times[name]})" if times[name] > 1 else ""
        to = one.to.name if isinstance(one, ControllerMove) else ""
        yield f"{name}{again} → {to}" if to else f"{name}{again}"
