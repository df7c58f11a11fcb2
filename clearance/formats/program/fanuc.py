"""Programs of FANUC's controllers, as listings of the teach pendant (`.ls`). Millimetres and degrees.

Sources: FANUC, R-30iB Operator's manual (motions, W P R about fixed axes, user and tool frames, turns);
visose/Robots, FanucPostProcessor, and a point of onerobotics.com, The perils of six-axis robots (configurations);
ROS-Industrial, fanuc (the world at the height of axis 2 as link `base`, the faceplate as `tool0`).
"""

from __future__ import annotations

import math
import re
from collections.abc import Collection, Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from clearance.errors import BadProgram, at
from clearance.formats.program.controller_program import (
    AxisTarget,
    ControllerMove,
    ControllerProgram,
    PoseTarget,
    ProgramRequest,
    Target,
)
from clearance.formats.program.execution import Execution
from clearance.formats.program.expressions import Call, Constant, Expression, Name, Unknown, number
from clearance.formats.program.fanuc_positions import MM, Position
from clearance.formats.program.fanuc_registers import (
    give_registers,
    known_register,
    value_of_register,
)
from clearance.formats.program.fanuc_text import listing_of
from clearance.formats.program.fanuc_words import (
    ANY_REGISTER,
    DECIDING,
    LARGEST_SPEEDS,
    MOVES,
    OUTPUTS,
    OVERRIDE,
    QUIET,
    WAIT,
    WAITING,
    Motion,
)
from clearance.formats.program.grammar import is_number
from clearance.formats.program.language import Language, entry_of
from clearance.formats.program.remarks import LEFT_OUT, NOT_FOLLOWED, UNSAID
from clearance.formats.program.statements import Assign, Do, For, within
from clearance.formats.program.tokens import Line
from clearance.formats.schema.program_file import ProgramFile

_METRES = {"mm/sec": MM, "cm/min": 0.01 / 60.0, "inch/min": 0.0254 / 60.0}
"""[m/s] One of each unit."""

_SECONDS = {"sec": 1.0, "msec": 1e-3}
"""[s] One of each unit."""

_IDLE = re.compile(r"ACC\d+|PTH|BREAK|PSPD\d+|RT_LD\d+|AP_LD\d+|EV\d+%?|INDEV\d+%?")
"""Options of a motion that change nothing of its way, or only how near to its corner it is rounded."""


UNSET = "is not set before"
"""Why the number of a frame or a tool is not known where no line sets it: that of each point counts."""

_ROUNDING = math.radians(0.1)
"""Of a pose in a listing: axes are known no better."""

BASE = "FANUC's world is at the height of axis 2 on most robots, and the robot has no link 'base' there"


def read_fanuc(asked: ProgramRequest) -> ControllerProgram:
    """The moves of a listing.

    Raises:
        BadInput: with the file and the line.
    """
    with at(asked.shown):
        main, *blocks = listing_of(asked.data)
        others = [one for file, data in asked.beside.items() for one in listing_of(data, file)]
        routines = {one.name: one for one in (*others, *blocks, main)}
        entry = asked.asked.entry
        entry_of("program", [main.name], entry, (entry or "").upper(), main.name)
        language = _Fanuc(asked.asked, routines)
        run = Execution(language, routines, frozenset(name.upper() for name in asked.asked.skip))
        statements = (one for listing in routines.values() for one in within(listing.body))
        counters = {one.name.name for one in statements if isinstance(one, For)}
        run.variables.update({name: Unknown(f"{name} {UNSET}") for name in counters})
        give_registers(asked.asked, run)
        run.run_whole(main.body)
        return language.program_of(run)


@dataclass(eq=False)
class _Fanuc(Language):
    """The instructions of a listing.

    Attributes:
        asked: what the case says. listings: the programs that the files have. share: of all speeds, which
            `OVERRIDE` says.
    """

    asked: ProgramFile
    listings: Collection[str]
    share: float = 1.0
    maker, base, suffix = "fanuc", BASE, ".LS"
    keeps_counter = shares_variables = True
    moving = (*MOVES, *DECIDING)
    still = (*QUIET, WAIT)
    timed, signals = (WAIT, *WAITING), OUTPUTS
    retiming = (OVERRIDE, *LARGEST_SPEEDS)

    @property
    def state(self) -> Any:
        """The share of all speeds."""
        return self.share

    def moves(self, name: str) -> bool | None:
        """Whether an instruction moves the robot, or changes points, frames or registers."""
        return True if name.startswith("$MNU") else super().moves(name)

    def beside(self, call: Call) -> str:
        """The program that RUN has run, if a file has it."""
        name = (
            call.args[0].value if call.name == "RUN" and isinstance(call.args[0], Constant) else ""
        )
        return name if name in self.listings else ""

    def value_of(self, name: str, run: Execution) -> Any:
        """None, or what is known of an input, which only the controller has."""
        return value_of_register(name, run)

    def instruct(self, call: Call, run: Execution) -> None:
        """A motion or a wait; all else moves nothing.

        Raises:
            BadProgram: a motion that is not read.
        """
        if call.name in MOVES:
            run.add(self._move(call, run).slowed(self.share))
            self._do_on_the_way(call, run)
        elif call.name == OVERRIDE and call.args:
            self.share = run.share_of_speeds(run.evaluated(call.args[0]), call, 100.0)
        elif call.name in LARGEST_SPEEDS:
            run.note(UNSAID, f"{call.name} ({call.line})")
        elif call.name == WAIT:
            self.wait(call, run)
        else:
            run.pass_over(call)

    def _move(self, call: Call, run: Execution) -> ControllerMove:
        (constant, speed), kind = call.args, MOVES[call.name]
        assert isinstance(constant, Constant)
        motion: Motion = constant.value
        for word in motion.options:
            if not _IDLE.fullmatch(word):
                fault = f"{word} is not read, and may move the target or the way"
                valid = "a motion whose target and way the file decides"
                raise BadProgram(fault, valid=valid)
            if re.fullmatch(r"ACC(?!100$)\d+", word):
                run.note(NOT_FOLLOWED, f"{word} ({call.line})")
            elif word.startswith("PSPD"):  # a share of the speed in a process
                run.note(UNSAID, f"{call.line}")
        if not kind or len(motion.points) != (2 if kind == "circ" else 1):
            fault = f"{call.name} with {len(motion.points)} points is not read"
            raise BadProgram(fault, valid="J and L with one, C with two")
        ends = [self._target(point, motion, kind, run) for point in motion.points]
        to, tool = ends[-1]
        return ControllerMove(
            line=call.line,
            kind=kind,  # type: ignore[arg-type]
            to=to,
            tool=tool,
            via=ends[0][0] if kind == "circ" else None,
            zone=self._zone(motion.end, run),
            **_speed(kind, motion.unit, run.evaluated(speed), call, run),
        )

    def _do_on_the_way(self, call: Call, run: Execution) -> None:
        """What a motion does at a time or a place on its way: no line behind it knows whether it is done.

        Raises:
            BadProgram: it moves the robot, or may.
        """
        motion: Motion = call.args[0].value  # type: ignore[union-attr]
        for one in motion.beside:
            if not isinstance(one, Assign | Do):
                raise BadProgram("what it does on its way is not read", valid="CALL, or an output")
            if isinstance(one, Assign) or self.moves(one.call.name) is False:
                text = "is given a value on the way of a motion"
                for name, line in run.effects.changed_in([(one,)]):
                    run.concurrent[name] = Unknown(f"{name!r} {text} at {line}")
            if isinstance(one, Do) and self.moves(one.call.name) is False:
                run.pass_over(one.call)
            elif isinstance(one, Do):
                name, what = one.call.name, "programs that motions call on their way (TB, TA, DB)"
                run.run_concurrently("program", name)
                for remark, where in run.effects.timing([(one,)]):
                    run.note(LEFT_OUT if name in run.skip else remark, where)
                run.note(f"{what}: they move nothing", f"{name} ({call.line})")

    def _target(
        self,
        point: tuple[str, Expression],
        motion: Motion,
        kind: str,
        run: Execution,
    ) -> tuple[Target, np.ndarray]:
        """The end of a motion, and the tool on the flange.

        Raises:
            BadProgram: no position, or one of other frames than those in force.
        """
        word, by = point
        index = number(run.evaluated(by), f"the number of {word}[…]")
        name, is_own = f"{word}[{index:.17g}]", word == "P" and index.is_integer()
        one = motion.positions.get(int(index)) if is_own else None
        if word == "PR":
            one = known_register(name, run)
            numbers = (self._chosen("UFRAME", run), self._chosen("UTOOL", run))
            if None in numbers:  # it has none of its own
                one = replace(one, frame=None, tool=None)
        elif name in run.variables or name in run.concurrent:
            raise BadProgram(
                f"{name} is given a value before", valid="a point that no line changes"
            )
        if one is None:
            valid = "use P[…] with a position in the file"
            raise BadProgram(f"{name}: no position of it under /POS", valid=valid)
        untaught = [key for key, value in one.values.items() if value is None]
        is_joints = one.is_joints
        missing = [key for key in one.keys if key not in one.values]
        if untaught or missing:
            fault = f"{name} has no {', '.join(untaught or missing)}"
            raise BadProgram(fault, valid="a taught position")
        taught, needed = one.tool, kind != "ptp" or not is_joints
        if not needed and motion.end != "FINE":  # the corner is where the tool is, whichever it is
            taught, needed = taught if self._chosen("UTOOL", run) is None else None, True
        tool = self._frame(name, "UTOOL", taught, run, needed)
        if is_joints:
            self._shifts(motion, kind, True, run)
            axes = tuple(math.radians(one.element(i)) for i in range(1, 7))
            return AxisTarget(axes, one.external, name), tool
        frame = self._frame(name, "UFRAME", one.frame, run, True)
        shifts = self._shifts(motion, kind, False, run)
        pose = frame @ shifts["OFFSET"] @ one.pose() @ shifts["TOOL_OFFSET"]
        asked = _configuration(one.configuration) if kind == "ptp" else {}
        if word == "PR" and kind == "ptp" and not one.configuration:
            asked = {"unchecked": f"the configuration of {name}"}
        return PoseTarget(pose, one.external, name=name, **asked), tool

    def _shifts(
        self, motion: Motion, kind: str, is_joints: bool, run: Execution
    ) -> Mapping[str, np.ndarray]:
        """(4, 4) [m] How far offsets move the end of a motion: along the user frame, and along the tool.

        Raises:
            BadProgram: an offset that turns, or of a point that has axes.
        """
        found = {word: np.eye(4) for word in ("OFFSET", "TOOL_OFFSET")}
        for word, by in motion.offsets:
            name = f"PR[{number(run.evaluated(by), f'the number of {word},PR[…]'):.17g}]"
            one = known_register(name, run)
            turns = one.is_joints or any(one.element(i) for i in (4, 5, 6))
            if turns or one.external or kind == "circ" or is_joints:
                fault = (
                    f"{word},{name} is read for lengths along X, Y and Z alone, of J and L to poses"
                )
                raise BadProgram(fault, valid="a point that has the offset in it")
            found[word][:3, 3] += one.pose()[:3, 3]
        return found

    def _frame(
        self, name: str, kind: str, taught: int | None, run: Execution, needed: bool
    ) -> np.ndarray:
        """(4, 4) [m] A frame or a tool by its number, which the program sets or the point has; 0 is none.

        Raises:
            BadProgram: they differ, as no controller accepts.
        """
        current = self._chosen(kind, run)
        index = taught if current is None else current
        if taught is not None and index != taught and needed:
            fault = f"{name} was taught in {kind} {taught}, and {kind}_NUM is {current:g}"
            raise BadProgram(fault, valid=f"write {kind}_NUM={taught} before it")
        set_to = run.value_of(_number_of(kind))
        if needed and isinstance(set_to, Unknown) and not set_to.what.endswith(UNSET):
            text = f"{name} is taken in the {kind} that it was taught in: {set_to.why}"
            run.doubts[f"{run.line}: {text}"] = None
        if index == 0:
            return np.eye(4)
        key, word = f"{kind}[{index or 0:g}]", "frames" if kind == "UFRAME" else "tools"
        given: Mapping[str, Any] = getattr(self.asked, word)
        is_changed = key in run.variables or key in run.concurrent
        if index is not None and key in given and not is_changed:
            return np.asarray(given[key].matrix())
        value = run.value_of(Name(key, Line(0))) if is_changed else None
        if (
            isinstance(value, Position)
            and not value.is_joints
            and ANY_REGISTER not in run.variables
        ):
            return value.pose()
        if not needed:
            return np.eye(4)
        if index is None:
            fault, unset = f"{name}: no {kind}_NUM is set before", run.value_of(_number_of(kind))
            raise BadProgram(fault, valid=unset.valid(f"write {kind}_NUM=1 before it"))
        if is_changed:
            why = value.why if isinstance(value, Unknown) else "it is no pose"
            valid = "a frame that the file decides"
            raise BadProgram(
                f"{name}: {key} is set in the program, and is not known: {why}",
                valid=value.valid(valid) if isinstance(value, Unknown) else valid,
            )
        return np.asarray(run.lack(f"{name}: {key} is not in a listing", word, key))

    def _chosen(self, kind: str, run: Execution) -> float | None:
        """The number of the frame or the tool in force; None where it is not known."""
        chosen = run.value_of(_number_of(kind))
        return None if isinstance(chosen, Unknown) else number(chosen, f"{kind}_NUM")

    def _zone(self, end: str, run: Execution) -> float:
        """[m] The radius of the corner at a motion's end.

        The file does not have it: what CNT cuts depends on speed and load, and CR may be the radius of the arc.
        """
        if end == "FINE":
            return 0.0
        kind = end[: len("CNT")] if end.startswith("CNT") else end[: len("CR")]
        for key in (end, kind):
            if key in self.asked.zones:
                return self.asked.zones[key]
        fault = f"{end} does not say where the corner begins"
        return float(run.lack(fault, "zones", end, more=f", or {kind} of all"))


def _number_of(kind: str) -> Name:
    """The variable that has the number of the frame or the tool in force."""
    return Name(f"{kind}_NUM", Line(0))


def _speed(kind: str, unit: str, value: Any, call: Call, run: Execution) -> dict[str, Any]:
    """The speed or the time of a motion, by the field of a `ControllerMove`.

    Raises:
        BadProgram: it is 0 or less.
    """
    is_known = is_number(value)
    if is_known and value <= 0.0:
        raise BadProgram(f"a speed of {value:g} {unit}", valid="more than 0")
    if is_known and unit in _SECONDS:
        return {"time": value * _SECONDS[unit]}
    if is_known and unit == "%" and kind == "ptp":
        return {"share": min(1.0, value / 100.0)}
    if is_known and unit in _METRES and kind != "ptp":
        return {"speed": value * _METRES[unit]}
    if is_known and unit == "deg/sec" and kind != "ptp":
        return {"turn_speed": math.radians(value)}
    run.note(UNSAID, f"{call.line}")
    return {}


def _configuration(text: str) -> dict[str, Any]:
    """A configuration (`N U T, 0, 0, 0`), by the field of a `PoseTarget`.

    N has axis 5 below 0, U the wrist before the line from axis 2 to 3, T before axis 1. Turns of 0 have axes 4
    and 6 within half a turn of 0; which axes others count is the robot's.
    """
    found = re.fullmatch(r"\s*([NF])\s*([UD])\s*([TB])\s*((?:,\s*-?\d+\s*){3})?", text)
    if found is None:
        return {"unchecked": f"CONFIG {text}"} if text else {}
    ranges = {5: (-math.pi, _ROUNDING) if found[1] == "N" else (-_ROUNDING, math.pi)}
    asked: dict[str, Any] = {"is_back": found[2] == "D", "is_behind": found[3] == "B"}
    turns = re.findall(r"-?\d+", found[4] or "")
    if turns and not any(map(int, turns)):
        ranges |= dict.fromkeys((4, 6), (-math.pi - _ROUNDING, math.pi + _ROUNDING))
    else:
        asked["unchecked"] = f"turns of CONFIG {text}"
    return {**asked, "ranges": ranges}
