"""Programs in RAPID: from files to moves. Not for: its text (`rapid_text`), its data and its words.

Source: ABB, Technical reference manual, RAPID instructions, functions and data types.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, replace
from typing import Any

from clearance.errors import BadProgram, at
from clearance.formats.program import rapid_words as words
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
    known,
    number,
)
from clearance.formats.program.language import Language, entry_of
from clearance.formats.program.rapid_data import (
    NO_AXIS,
    RECORDS,
    STANDARD,
    VALUES,
    Work,
    array_of,
    configuration_of,
    external_of,
    flange_from_tool,
    pose_of,
    speed_of,
    tool_record,
    work_object_record,
    work_of,
    zone_of,
)
from clearance.formats.program.rapid_moves import name_of, on_cycles, require_plain, with_zones
from clearance.formats.program.rapid_text import FIRST, Declaration, Modules
from clearance.formats.program.rapid_words import GRAMMAR, MOVES, MoveRule
from clearance.formats.program.remarks import NOT_FOLLOWED, UNSAID
from clearance.formats.program.remarks import WAITS as TAKES_TIME
from clearance.formats.program.statements import assigned
from clearance.formats.program.tokens import on, text_of
from clearance.formats.schema.program_file import ProgramFile

_KEYS = {"tool": "tools", "work object": "frames"}
"""Of the case, for what a move needs."""


def read_rapid(asked: ProgramRequest) -> ControllerProgram:
    """The moves of a procedure of a program: `main`, if no other is asked for.

    Raises:
        BadInput: with the file and the line.
    """
    given, modules = asked.asked, Modules()
    with at(asked.shown):
        modules.read(text_of(asked.data))
        for file, data in asked.beside.items():
            modules.read(text_of(data, file), file)
        tools, frames = (
            {name.lower(): record(one.matrix()) for name, one in poses.items()}
            for poses, record in ((given.tools, tool_record), (given.frames, work_object_record))
        )
        language = Rapid(modules, tools | frames, {name.lower(): name for name in given.units})
        run = Execution(language, modules.routines, frozenset(map(GRAMMAR.folded, given.skip)))
        language.declare(run)
        own = modules.routines.items()
        names = [name for name, one in own if not one.parameters and not one.is_thread]
        asked_name = (given.entry or "").lower()
        entry = entry_of("procedure", names, given.entry, asked_name, "main")
        run.enter(modules.routines[entry])
        run.moves = with_zones(run.moves, language.zones)
        notes = (*language.assumed, *on_cycles(run.moves))
        return language.program_of(run, notes, _replaced(modules, given))


@dataclass(eq=False)
class Rapid(Language):
    """What RAPID's instructions do.

    Attributes:
        known_data: tools and work objects that the case says. units: mechanical units of which it says the frame.
        checks: whether joint moves keep to configurations. share: of all speeds, by `VelSet`. fastest: by it, the
            greatest speed of the tool's point [mm/s].
        zones: by the index of a move, the radii of its zone for point and orientation [m].
    """

    modules: Modules
    known_data: dict[str, Any]
    units: Mapping[str, str] = field(default_factory=dict)
    checks: bool = True
    share: float = 1.0
    fastest: float = math.inf
    zones: dict[int, tuple[float, float]] = field(default_factory=dict)
    maker = "abb"
    moving = frozenset((*MOVES, *words.OTHER_MOVES, "ConfJ"))
    still = frozenset(words.WORDS.values())
    timed = words.WAITS | words.PAUSES
    retiming = words.LIMITS | words.WAITS | words.PAUSES | {"VelSet"}
    stopping = ("StopMove",)
    values = VALUES

    @property
    def state(self) -> Any:
        """Whether configurations are kept, and what limits speeds."""
        return self.checks, self.share, self.fastest

    @property
    def assumed(self) -> list[str]:
        """A line each on what was taken for granted."""
        found = []
        if any(one.kind == "PERS" for one in self.modules.declared.values()):
            found.append("PERS data have the values that are in the file")
        return found

    def declare(self, run: Execution) -> None:
        """Gives all data of modules their first values, and says which of them are kept between runs, unless the
        case says them."""
        for name, one in self.modules.declared.items():
            if name not in run.variables:
                run.value_of(Name(name, one.line))
        for name, one in self.modules.declared.items():
            if one.kind == "PERS" and name not in self.known_data:
                run.persistent.put(name, KEPT.format(f"{name} ({one.line})"), run.variables)

    def value_of(self, name: str, run: Execution) -> Any:
        """The value of a datum of a module, of the case, or of the controller."""
        one = self.modules.declared.get(name)
        if name in self.known_data:
            return self.known_data[name]
        if one is None:
            return STANDARD.get(name)
        run.variables[name] = Unknown(f"{name!r} is declared by itself at {one.line}")
        with on(one.line):
            run.variables[name] = self._first_value(one, run)
        return run.variables[name]

    def _first_value(self, one: Declaration, run: Execution) -> Any:
        if one.value is not None:
            return run.evaluated(one.value)
        usual = FIRST.get(one.type_name)
        if one.sizes:
            return array_of(usual, *(number(run.evaluated(size), "a size") for size in one.sizes))
        return Unknown(f"{one.name!r} has no value at {one.line}") if usual is None else usual

    def part_of(self, value: Any, by: Any) -> Any:
        """A field of a record, or an item of an array."""
        return value[self._place(value, by)]

    def with_part(self, value: Any, by: Any, new: Any) -> None:
        """Changes a field or an item."""
        value[self._place(value, by)] = new

    def _place(self, value: Any, by: Any) -> int:
        if not isinstance(value, list):
            raise TypeError
        if isinstance(by, str):
            own = [one for one in self.modules.records.values() if len(one) == len(value)]
            (place,) = {one.index(by) for one in (*own, *RECORDS.get(len(value), [])) if by in one}
            return place
        if by != int(by) or by < 1:
            raise IndexError(by)
        return int(by) - 1

    def instruct(self, call: Call, run: Execution) -> None:
        """A move, a wait, a setting; all else moves nothing.

        Raises:
            BadProgram: a move of another kind, or a wait for a signal.
        """
        name = call.name
        if name in MOVES:
            self._move(call, MOVES[name], run)
        elif name == "WaitTime":
            self.wait(call, run, "inpos" not in call.named)
        elif name in words.WAITS:
            fault = f"{name} waits for what only the controller knows"
            raise BadProgram(fault, valid=f"skip: [{name}] to leave such waits out")
        elif name == "CONNECT":
            trap = call.args[0].value if isinstance(call.args[0], Constant) else ""
            run.run_concurrently("trap", trap)
            run.note("traps that move nothing", f"{trap} ({call.line})")
        elif name in ("SingArea", "CirPathMode") and {*call.named} <= {"off", "pathframe"}:
            run.pass_over(call)
        elif name in words.OTHER_MOVES:
            off = "SingArea\\Off, so that the tool keeps its orientation"
            valid = off if name == "SingArea" else "take it out of the program"
            fault = f"{name} changes where the robot goes, in a way that is not read"
            raise BadProgram(fault, valid=valid)
        else:
            self._set(call, run)

    def _set(self, call: Call, run: Execution) -> None:
        """What an instruction that moves nothing changes."""
        run.pass_over(call)
        if call.name in words.LIMITS and call.args:
            run.note(NOT_FOLLOWED, f"{call.name} ({call.line})")
        if call.name == "ConfJ":
            self.checks = "off" not in call.named
        elif call.name == "VelSet" and len(call.args) == 2:
            share, fastest = (run.evaluated(one) for one in call.args)
            self.share = run.share_of_speeds(share, call, 100.0)
            is_known = not isinstance(fastest, Unknown)
            self.fastest = number(fastest, call.name) if is_known else math.inf
            if not is_known:
                run.note(UNSAID, f"{call.name} ({call.line})")
        run.forget_written(call)

    def writes(self, call: Call) -> list[Expression]:
        """The arguments of an instruction or a function that it gives a value; of one that is in no file all that
        are no constants."""
        if self.moves(call.name) is None:
            found = ((one, assigned(one)) for one in (*call.args, *call.named.values()))
            return [one for one, name in found if name is not None and not self._is_constant(name)]
        if call.name in words.WRITES:
            return [*call.args, *call.named.values()]
        return [
            *(call.args[i] for i in words.WRITES_ONE.get(call.name, ()) if i < len(call.args)),
            *(one for key, one in call.named.items() if key in words.RESULTS),
        ]

    def _is_constant(self, name: Name) -> bool:
        one = self.modules.declared.get(name.name)
        return one is not None and one.kind == "CONST"

    def result_of(self, call: Call, run: Execution) -> Any:
        """The value of a function."""
        if call.name == "Present":
            (one,) = call.args
            return isinstance(one, Name) and one.name in run.frames[-1]
        return super().result_of(call, run)

    def _move(self, call: Call, rule: MoveRule, run: Execution) -> None:
        require_plain(call, rule)
        asked = {
            "target": call.args[rule.to],
            "speed": call.args[rule.speed],
            "zone": call.args[rule.zone],
            "tool": call.args[rule.tool],
            "work object": call.named.get("wobj", Name("wobj0", call.line)),
            **({"point on the arc": call.args[0]} if rule.to == 1 else {}),
        }
        given = {what: self._given(what, one, run) for what, one in asked.items()}
        options = {
            key: number(run.evaluated(call.named[key]), key.upper())
            for key in ("v", "t", "z")
            if key in call.named
        }
        move, zone = self._made(call, rule, given, options, run)
        if call.name.startswith("Arc"):
            run.note(UNSAID, f"{call.name} ({call.line})")
        if "conc" in call.named or call.name.endswith("Sync"):  # something goes on beside the move
            word = "\\Conc" if "conc" in call.named else call.name
            run.note(TAKES_TIME, f"{word} ({call.line})")
        if max(zone) > 0.0:
            self.zones[len(run.moves)] = zone
        run.add(replace(move, zone=max(0.0, *zone)).slowed(self.share))
        if call.name.endswith("Sync"):
            self._run_beside(call, rule, run)

    def _given(self, what: str, one: Expression, run: Execution) -> Any:
        """The value of an argument; any, for a tool or a work object that no file has: the case then has to."""
        value, usual = run.evaluated(one), {"tool": "tool0", "work object": "wobj0"}.get(what)
        if isinstance(value, Unknown) and isinstance(one, Name) and usual:
            if one.name not in {*self.modules.declared, *run.frames[-1], *run.variables}:
                fault, key = f"the {what} is not known: {value.why}", _KEYS[what]
                run.lack(fault, key, str(one.name), "a file beside that has it, or ")
                return STANDARD[usual]
        return known(value, f"the {what}")

    def _run_beside(self, call: Call, rule: MoveRule, run: Execution) -> None:
        """The procedure that a move calls at its end: no line behind it knows whether it is done.

        Raises:
            BadProgram: it moves the robot, or may, or its name is not known.
        """
        name, *_ = [*map(run.evaluated, call.args[rule.tool + 1 :]), ""]
        if not isinstance(known(name, "the procedure"), str) or not name:
            fault = f"{call.name} names no procedure"
            raise BadProgram(fault, valid='its name behind the tool, as in "glue_on"')
        own = name.rpartition(":")[2].strip().lower()  # a module may stand before it
        named = [one for one in self.modules.routines if one.lower().rpartition(".")[2] == own]
        for one in named or [GRAMMAR.folded(own)]:
            run.run_concurrently("procedure", one)
        run.note("procedures that moves call at their end and that move nothing", name)

    def _made(
        self,
        call: Call,
        rule: MoveRule,
        given: Mapping[str, Any],
        options: Mapping[str, float],
        run: Execution,
    ) -> tuple[ControllerMove, tuple[float, float]]:
        """The move of an instruction, and the radii of its zone."""
        work = work_of(given["work object"], self.units)
        speed, turn_speed, time = speed_of(given["speed"], options)
        via = None
        if rule.to == 1:
            via = self._target(call, given["point on the arc"], call.args[0], work, run)
        to = self._target(call, given["target"], call.args[rule.to], work, run)
        zone = zone_of(given["zone"], options)
        tool = flange_from_tool(given["tool"])
        move = ControllerMove(call.line, rule.kind, to, tool, via, time=time)
        if rule.kind != "ptp":
            speed = min(speed, 1e-3 * self.fastest / self.share)
            move = replace(move, speed=speed, turn_speed=turn_speed, orientation="path")
        return move, zone

    def _target(
        self, call: Call, value: Any, one: Expression, work: Work, run: Execution
    ) -> Target:
        name = name_of(one, run)
        if call.name == "MoveAbsJ":
            axes, external = value
            own = tuple(math.radians(one) for one in axes if abs(one) < NO_AXIS)
            return AxisTarget(own, external_of(external), name)
        trans, rot, flags, external = value
        pose, more = work.pose @ pose_of([trans, rot]), external_of(external)
        found = PoseTarget(pose, more, name=name, unit=work.unit)
        if MOVES[call.name].kind != "ptp" or not self.checks:
            return found
        return replace(found, **configuration_of(flags, bool(more)))


def _replaced(modules: Modules, given: ProgramFile) -> Iterator[str]:
    """A line on each tool and work object of the case whose data the files have too."""
    for key, poses in (("tools", given.tools), ("frames", given.frames)):
        for name in poses:
            own = modules.declared.get(name.lower())
            if own is not None:
                text = f"replaces {own.name} at {own.line}, which the file gives"
                yield f"{key}.{name} of the case {text}"
