"""Programs in KRL: `.src` files, with the `.dat` files that declare their points. Millimetres and degrees.

Sources: KUKA, System Software 8.3, Operating and programming instructions for system integrators (moves,
aggregates, approximation, status and turn); KUKA's own `bas.src` 8.3 (what `BAS` and inline forms set).
"""

from __future__ import annotations

import copy
import math
import re
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import PurePosixPath
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
from clearance.formats.program.effects import KEPT
from clearance.formats.program.execution import Execution
from clearance.formats.program.expressions import (
    Call,
    Constant,
    Expression,
    Name,
    Unknown,
    number,
)
from clearance.formats.program.krl_expressions import (
    AGGREGATE,
    FRAME,
    GRAMMAR,
    MM,
    MOVES,
    OF,
    PACKAGES,
    PAUSES,
    QUIET,
    REFUSED,
    SIGNALS,
    SYSTEM,
    WAIT,
    Aggregate,
    as_real,
    frame_of,
    is_real,
    matrix_of,
    why,
)
from clearance.formats.program.krl_settings import (
    FUNCTIONS,
    SAVED,
    Settings,
    configuration_of,
    first_variables,
    key_of,
)
from clearance.formats.program.krl_system import (
    RobotRoot,
    give_variables,
    not_followed,
    remedy_of,
    require_followed,
    state_of,
)
from clearance.formats.program.krl_text import files_of
from clearance.formats.program.language import Language, entry_of
from clearance.formats.program.remarks import UNSAID
from clearance.formats.program.statements import Assign
from clearance.formats.program.tokens import Line
from clearance.formats.schema.program_file import ProgramFile
from clearance.geometry.pose import inverse

AXES = ("A1", "A2", "A3", "A4", "A5", "A6")

STANDS = ("$POS_ACT", "$AXIS_ACT", "$AXIS_ACT_MEAS")
"""Targets at which the robot is already."""

GIMBAL = 1.0 - 1e-9
"""The sine of B from which A and C turn about one axis."""


def read_krl(asked: ProgramRequest) -> ControllerProgram:
    """The moves of a program in KRL.

    Raises:
        BadInput: with the file and the line.
    """
    with at(asked.shown):
        files = files_of(asked)
        language = _Krl(asked.asked)
        of_module = f"{OF}{PurePosixPath(asked.shown).stem}"
        names = (name for one in asked.asked.skip for name in (one, one + of_module))
        skip = frozenset(GRAMMAR.folded(name) for name in names)
        run = Execution(language, files.routines, skip)
        run.variables |= first_variables(asked.asked, run)
        run.run(files.declared)
        places = dict[str, Line]()
        for one in files.declared:
            if isinstance(one, Assign) and isinstance(one.target, Name):
                name, line = one.target.name, places.setdefault(one.target.name, one.line)
                run.persistent.put(name, KEPT.format(f"{name} ({one.line})"), run.variables)
                if line.file != one.line.file and not name.startswith("$"):
                    both = f"{name} is declared at {line} and at {one.line}"
                    run.variables[name] = Unknown(both)
        give_variables(asked.asked, run, of_module)
        for name, routine in files.routines.items():
            file = routine.line.file
            if file.lower().endswith(".sub"):  # the controller runs it all the time
                run.concurrent |= run.effects.changed_concurrently(file, name)
        entry, own = asked.asked.entry, {str(name): name for name in files.public}
        entry = entry_of("procedure", [*own], entry, (entry or "").upper(), files.public[0])
        run.enter(files.routines[own[entry]])
        run.require_all()
        bodies = [routine.body for routine in files.routines.values()]
        unread = [*not_followed(bodies, run), *run.effects.doubts_on_packages(bodies)]
        doubts = (*language.root.doubts(asked.asked), *unread)
        return language.program_of(run, doubts=doubts)


@dataclass(eq=False)
class _Krl(Language):
    """The instructions of KRL, and where the robot is.

    Attributes:
        asked: what the case says. pose: (4, 4) `base_from_flange` [m] where the robot is; None where its axes say
            it. unit: the machine that its pose is seen from; the robot's base if empty. axes: [degrees] by name;
            None where its pose says it. root: where its foot is.
    """

    asked: ProgramFile
    pose: np.ndarray | None = None
    unit: str = ""
    axes: Mapping[str, float] | None = None
    root: RobotRoot = field(default_factory=RobotRoot)
    maker, suffix = "kuka", ".src"
    moving = frozenset((*MOVES, *REFUSED, "BAS"))
    still = frozenset((*QUIET, *SIGNALS, *FUNCTIONS, AGGREGATE, WAIT))
    timed = retiming = (WAIT, *PAUSES)
    stopping = ("BRAKE",)
    packages, signals = PACKAGES, SIGNALS
    remedy = staticmethod(remedy_of)

    @property
    def state(self) -> Any:
        """Where the robot is."""
        return (None if self.pose is None else self.pose.tolist(), self.unit, self.axes)

    def beside(self, call: Call) -> str:
        """What an interrupt or a trigger calls; nothing where that is known to move nothing."""
        (one,) = call.args if call.name in QUIET and call.args else (Constant(""),)
        assert isinstance(one, Constant)
        return "" if one.value == SYSTEM else one.value

    def initialises(self, call: Call) -> bool:
        """Whether a technology package is called as in an INI."""
        first = (str(getattr(one, "name", getattr(one, "value", ""))) for one in call.args)
        return next(first, "") == PACKAGES.get(call.name)

    def writes(self, call: Call) -> tuple[Expression, ...]:
        """All arguments of a procedure that is in no file; instructions change no variables but signals."""
        return call.args if self.moves(call.name) is None else (*super().writes(call),)

    def value_of(self, name: str, run: Execution) -> Any:
        """The controller is assumed to run the program by itself; where the robot is then is not worked out."""
        if name in ("$T1", "$T2"):
            run.note("automatic operation is assumed", "$T1 and $T2 are FALSE")
            return False
        if name in STANDS:
            return Unknown(f"{name}, where the robot is, is not read")
        return state_of(name)

    def part_of(self, value: Any, by: Any) -> Any:
        """A part of an aggregate, or an element of an array; texts of pendants have none."""
        if not isinstance(value, Mapping):
            raise TypeError
        return value.get(key_of(by), Unknown(f"{key_of(by)} of it is not given"))

    def with_part(self, value: Any, by: Any, new: Any) -> None:
        if not isinstance(value, dict):
            raise TypeError
        key = key_of(by)
        value[key] = as_real(new) if is_real(str(key)) else new

    def result_of(self, call: Call, run: Execution) -> Any:
        """The value of an aggregate, or of a function that inline forms call."""
        if call.name == AGGREGATE:
            found = {name: run.evaluated(one) for name, one in call.named.items()}
            return {key: as_real(one) if is_real(key) else one for key, one in found.items()}
        if call.name not in FUNCTIONS:
            return Unknown(f"{call.name}() at {call.line}")
        args = [run.evaluated(one) for one in call.args]
        return FUNCTIONS[call.name](Settings(run, call.line), *args)

    def instruct(self, call: Call, run: Execution) -> None:
        """A move, a wait, or a setting; all else moves nothing.

        Raises:
            BadInput: a move that is not read.
        """
        if call.name in MOVES:
            self._move(call, run)
        elif call.name == WAIT:
            self.wait(call, run, reads_on=False)
        elif call.name == "BAS":
            command, *value = [run.evaluated(one) for one in call.args] or [Unknown("nothing")]
            Settings(run, call.line).bas(command, value[0] if value else 0)
        elif call.name in REFUSED:
            raise BadProgram(REFUSED[call.name], valid="PTP, LIN and CIRC")
        elif call.name == "BRAKE":
            fault = "BRAKE stands outside of what an interrupt calls"
            raise BadProgram(fault, valid="BRAKE in a procedure that an interrupt calls")
        elif call.args and call.name not in SIGNALS:  # an interrupt or a trigger, and what it calls
            if called := self.beside(call):
                run.run_concurrently(call.name, called)
            what = "interrupts and triggers that move nothing"
            run.note(what, f"{called or SYSTEM} ({call.line})")
        else:
            run.pass_over(call)

    def _move(self, call: Call, run: Execution) -> None:
        first = call.args[0]
        if isinstance(first, Name) and first.name in STANDS and len(call.args) == 1:
            return
        saved = {name: copy.deepcopy(run.variables[name]) for name in SAVED}
        settings = Settings(run, call.line)
        for name, word_value in call.named.items():
            if name.startswith("WITH"):
                settings.assign(*word_value.value)  # type: ignore[union-attr]
        kind = MOVES[call.name]
        targets = [_aggregate(run.evaluated(one)) for one in call.args]
        if len(targets) != (2 if kind == "circ" else 1) or call.name.endswith("CIRC_REL"):
            fault = f"{call.name} with {len(targets)} targets is not read"
            raise BadProgram(fault, valid="CIRC with two, LIN, PTP")
        if call.name.endswith("_REL"):
            targets = [self._absolute(targets[0], "#TOOL" in call.named, settings)]
        require_followed(settings)
        to = self._target(kind, targets[-1], _name_of(call.args[-1]), settings)
        via = None
        if kind == "circ":
            point = {**dict.fromkeys("ABC", 0.0), **targets[0]}
            if call.name == "SCIRC" and settings.orientation(kind) == "to":
                _doubt_the_way_round(targets[0], targets[1], settings)
            via = self._target("via", point, "", settings)
        move = self._made(call, kind, to, via, settings)
        run.add(move)
        self._reached(move, settings)
        run.variables.update(saved)

    def _made(
        self, call: Call, kind: str, to: Target, via: Target | None, settings: Settings
    ) -> ControllerMove:
        speeds = settings.speeds(kind)
        if kind != "ptp" and speeds["speed"] is None:
            settings.run.note(UNSAID, f"{call.line}")
        is_free = isinstance(to, AxisTarget) and isinstance(settings.value("$TOOL"), Unknown)
        words = [name for name in call.named if name.startswith("C_")]
        moved = ControllerMove(
            line=call.line,
            kind=kind,  # type: ignore[arg-type]
            to=to,
            tool=np.eye(4) if is_free else settings.frame("$TOOL", "tools"),
            via=via,
            orientation=settings.orientation(kind),
            zone=settings.zone(kind, words, self.asked.zones),
            **speeds,
        )
        override = Call("$OV_PRO", (), {}, call.line)
        share = settings.run.share_of_speeds(settings.value("$OV_PRO"), override, 100.0)
        return moved.slowed(share)

    def _absolute(self, way: Aggregate, in_tool: bool, settings: Settings) -> Aggregate:
        """The target of a relative move.

        Raises:
            BadInput: where the robot is before is not known, or the tool is to turn.
        """
        if any(re.fullmatch("E[1-6]", key) and value != 0.0 for key, value in way.items()):
            fault = "a relative move of external axes is not read"
            raise BadProgram(fault, valid="write a move to them")
        if any(key in AXES for key in way):
            if self.axes is None:
                fault = f"the axes before this move are not known{_ended('a pose', self.pose)}"
                raise BadProgram(fault, valid="write PTP to axes before it")
            return {key: self.axes[key] + number(way.get(key, 0.0), "a position") for key in AXES}
        if any(way.get(key, 0.0) != 0.0 for key in "ABC"):
            fault = "a relative move that turns the tool is not read"
            raise BadProgram(fault, valid="write a move to a pose")
        step = np.array([number(way.get(key, 0.0), "a position") * MM for key in "XYZ"])
        pose = self._now(settings)
        pose[:3, 3] += pose[:3, :3] @ step if in_tool else step
        return frame_of(pose)

    def _now(self, settings: Settings) -> np.ndarray:
        """(4, 4) `base_from_tool` [m] before a move, in the frames that hold for it."""
        if self.pose is None or self.unit != settings.unit:
            fault = f"the tool's pose before this move is not known{_ended('axes', self.axes)}"
            raise BadProgram(fault, valid="X, Y, Z, A, B and C, or a move to a pose before it")
        base, tool = settings.frame("$BASE", "frames"), settings.frame("$TOOL", "tools")
        return np.asarray(inverse(base) @ self.pose @ tool)

    def _target(self, kind: str, given: Aggregate, name: str, settings: Settings) -> Target:
        """The axes or the pose that an aggregate says."""
        external = {
            key: number(value, "a position")
            for key, value in given.items()
            if re.fullmatch("E[1-6]", key)
        }
        if not any(key in AXES for key in given):
            asked = configuration_of(given, settings) if kind == "ptp" else {}
            pose = settings.frame("$BASE", "frames") @ self._pose(given, settings)
            if not settings.unit:
                self.root.use(settings)
            return PoseTarget(pose, external, name=name, unit=settings.unit, **asked)
        if kind != "ptp":
            raise BadProgram("axes are given", valid="X, Y, Z, A, B and C")
        full = {
            **(self.axes or {}),
            **{key: number(given[key], "a position") for key in AXES if key in given},
        }
        missing = [key for key in AXES if key not in full]
        if missing:
            fault = f"no {', '.join(missing)}, and where it is before is not known{_ended('a pose', self.pose)}"
            raise BadProgram(fault, valid="all six axes")
        return AxisTarget(tuple(math.radians(full[key]) for key in AXES), external, name)

    def _pose(self, given: Aggregate, settings: Settings) -> np.ndarray:
        """(4, 4) `base_from_tool` [m]; what is not given stays as it is."""
        if all(key in given for key in FRAME):
            return matrix_of(given, "the target")
        pose = self._now(settings)
        placed = matrix_of({**frame_of(pose), **given}, "the target")
        turns = [key for key in "ABC" if key in given]
        if not turns:
            placed[:3, :3] = pose[:3, :3]
        elif len(turns) < 3 and abs(pose[2, 0]) > GIMBAL:
            fault = f"only {', '.join(turns)} of the angles is given, where B is 90 degrees and the others are any"
            raise BadProgram(fault, valid="A, B and C, or none of them")
        return placed

    def _reached(self, move: ControllerMove, settings: Settings) -> None:
        """Keeps where a move ends; on an arc that takes the tool along, its rotation is not known."""
        before = self.pose if self.unit == move.to.unit else None
        self.pose, self.axes, self.unit = None, None, move.to.unit
        if isinstance(move.to, AxisTarget):
            self.axes = dict(zip(AXES, np.degrees(move.to.axes).tolist(), strict=True))
        elif move.orientation == "to":
            self.pose = move.to.pose @ inverse(move.tool)
        elif move.orientation == "constant" and before is not None:
            pose = before @ move.tool
            pose[:3, 3] = move.to.pose[:3, 3]
            self.pose = pose @ inverse(move.tool)


def _doubt_the_way_round(via: Aggregate, end: Aggregate, settings: Settings) -> None:
    """Names for the headline a spline circle whose auxiliary point is turned otherwise than its end."""
    if any(key in via and via[key] != end.get(key) for key in "ABC"):
        text = "SCIRC turns the tool the shorter way; the auxiliary point's orientation is not read"
        settings.run.doubts[f"{settings.line}: {text}"] = None


def _aggregate(value: Any) -> Aggregate:
    """A target.

    Raises:
        BadInput: it is not known, or none.
    """
    if not isinstance(value, Mapping):
        valid = "a target that this file, or one beside it, gives as numbers"
        raise BadProgram(f"the target is not known: {why(value)}", valid=valid)
    return value


def _ended(form: str, known: object) -> str:
    """Why it is not known where the robot is; empty if nobody knows it in the other form either."""
    return "" if known is None else f": the one before ends at {form}, not converted here"


def _name_of(one: Expression) -> str:
    return str(one.name) if isinstance(one, Name) else ""
