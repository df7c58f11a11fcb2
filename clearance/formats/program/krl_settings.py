"""Settings of a program in KRL: tool, base, speeds and corners, and the instructions that change them; what a
target says of the configuration.

Not for: moves (`krl`).
"""

from __future__ import annotations

import copy
import math
import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np

from clearance.errors import BadProgram
from clearance.formats.program.execution import Execution
from clearance.formats.program.expressions import Expression, Name, Unknown
from clearance.formats.program.krl_expressions import (
    FRAME,
    MM,
    UNIT,
    Aggregate,
    frame_of,
    is_number,
    matrix_of,
    why,
)
from clearance.formats.program.statements import Assign, assigned
from clearance.formats.program.tokens import Line
from clearance.formats.schema.program_file import ProgramFile

_ORIENTATIONS: Mapping[tuple[str, str], Literal["to", "constant", "tangent"]] = {
    ("#VAR", "#BASE"): "to",
    ("#CONSTANT", "#BASE"): "constant",
    ("#CONSTANT", "#PATH"): "tangent",
}
"""How the tool turns on an arc, by `$ORI_TYPE` and `$CIRC_TYPE`."""

_NULL = dict.fromkeys(FRAME, 0.0)

FIRST: Mapping[str, Any] = {
    **{name: _NULL for name in ("$NULLFRAME", "$WORLD", "$ROBROOT")},
    **{"$ORI_TYPE": "#VAR", "$CIRC_TYPE": "#BASE", "$IPO_MODE": "#BASE"},
    **{name: {} for name in ("$VEL", "$ACC", "$APO", "$VEL_AXIS", "TOOL_DATA", "BASE_DATA")},
    **{name: {} for name in ("MACHINE_DEF", "MACHINE_FRAME_DAT")},
    "$OV_PRO": 100,
    "$TECH": {number: {} for number in range(1, 7)},
    **{name: Unknown(f"{name} is not set before") for name in ("$TOOL", "$BASE")},
    **{name: Unknown(f"{name} is not set before") for name in ("FDAT_ACT", "PDAT_ACT", "LDAT_ACT")},
}
"""Variables that every program has."""

SAVED = tuple("$VEL $VEL_AXIS $ACC $TOOL $BASE $IPO_MODE $APO $ORI_TYPE $CIRC_TYPE".split())
"""Variables that `WITH` changes for one move; all others say nothing of its way."""

NEAR_ZERO, FARTHEST = math.radians(2.0), 4.0 * math.pi
"""An axis that is nearer to 0 may have either sign in a turn bit: so controllers take it."""

_COMMANDS = frozenset(
    "#INITMOV #TOOL #BASE #FRAMES #VEL_PTP #VEL_CP #ACC_PTP #ACC_CP #PTP_PARAMS #CP_PARAMS #PTP_DAT "
    "#CP_DAT #ACC_GLUE".split()
)


@dataclass(frozen=True, eq=False)
class Settings:
    """The settings in force at a line."""

    run: Execution
    line: Line

    def value(self, name: str) -> Any:
        """The value of a variable."""
        return self.run.value_of(Name(name, self.line))

    def part(self, name: str, by: Any) -> Any:
        """A part of one."""
        return _part(self.value(name), by)

    @property
    def unit(self) -> str:
        """The machine that carries the base in force; empty where the robot's foot does."""
        base = self.value("$BASE")
        return str(base.get(UNIT, "")) if isinstance(base, Mapping) else ""

    def set(self, name: str, value: Any, by: Any = None) -> None:
        """Sets a variable that all routines share, or a part of it."""
        value = copy.deepcopy(value)
        if by is None:
            self.run.variables[name] = value
        else:
            whole = self.run.variables.get(name)
            self.run.variables[name] = {**(whole if isinstance(whole, Mapping) else {}), by: value}

    def assign(self, target: Expression, value: Expression) -> None:
        """Sets what `WITH` says of a move."""
        name = assigned(target)
        if name is not None and name.name == "$VEL_AXIS":
            self.share(self.run.evaluated(value))
        elif name is None or name.name in SAVED:
            self.run.run([Assign(self.line, target, value, is_of_all=True)])

    def share(self, value: Any) -> None:
        """Sets the speed of all axes [%]."""
        self.set("$VEL_AXIS", dict.fromkeys(range(1, 7), value))

    def frame(self, name: str, key: str) -> np.ndarray:
        """(4, 4) [m] The tool or base in force."""
        value = self.value(name)
        if isinstance(value, Mapping):
            return matrix_of(value, name)
        index = re.match(r"(?:(?:TOOL|BASE)_DATA\[)?(\d+)(?:\]| of it )", why(value))
        named = f"{name[1:]}_DATA[{index[1]}]" if index else name
        fault = f"{name} is not known: {why(value)}"
        return np.asarray(self.run.lack(fault, key, named, "a file beside that sets it, or "))

    def numbered(self, array: str, index: Any, none: str) -> Any:
        """The tool or base of a number; 0 is none."""
        if not is_number(index):
            return index if isinstance(index, Unknown) else Unknown(why(index))
        if index == 0:
            return self.value(none)
        found = self.part(array, int(index))
        missing = Unknown(f"{array}[{int(index)}] is not in the files")
        return missing if isinstance(found, Unknown) else found

    def tool(self, index: Any) -> Any:
        return self.numbered("TOOL_DATA", index, "$NULLFRAME")

    def base(self, index: Any) -> Any:
        """The base of a number; on another machine than the robot it is seen from the frame that the case gives.

        Raises:
            BadProgram: the case gives none.
        """
        found = self.numbered("BASE_DATA", index, "$WORLD")
        machine = _part(self.part("MACHINE_FRAME_DAT", index), "MACH_DEF_INDEX")
        if is_number(machine) and machine > 0:
            kind = _part(self.part("MACHINE_DEF", int(machine)), "MECH_TYPE")
            unit = f"MACHINE_DEF[{int(machine)}]"
            if kind != "#ROBOT" and unit not in self.run.language.asked.units:  # type: ignore[attr-defined]
                fault = f"base {index} is on machine {int(machine)}, which may move it"
                on = f'program: {{units: {{"{unit}": {{on: turntable/plate}}}}}}'
                raise BadProgram(fault, valid=f"what carries it, as {on}, or a base that stands")
            if kind != "#ROBOT" and isinstance(found, Mapping):
                return {**found, UNIT: unit}
        return found

    def bas(self, command: Any, value: Any) -> None:
        """Does as KUKA's `BAS` does for a command.

        Raises:
            BadInput: another command.
        """
        if command not in _COMMANDS:
            raise BadProgram(f"BAS({why(command)}) is not read", valid=", ".join(sorted(_COMMANDS)))
        if command == "#INITMOV":
            self.set("$BASE", self.base(0))
            self.set("$TOOL", self.tool(1))
            self.set("$ORI_TYPE", "#VAR")
            self.set("$CIRC_TYPE", "#BASE")
            self.set("$VEL", self.value("DEF_VEL_CP"), "CP")
            self.set("$APO", self.value("DEF_APO_CDIS"), "CDIS")
            self.share(100.0)
        elif command in ("#TOOL", "#BASE"):
            found = self.tool(value) if command == "#TOOL" else self.base(value)
            self.set(f"${command[1:]}", found)
        elif command in ("#VEL_PTP", "#PTP_PARAMS", "#PTP_DAT"):
            self._of_joints(command, value)
        elif command in ("#VEL_CP", "#CP_PARAMS", "#CP_DAT"):
            self._of_path(command, value)
        if command in ("#FRAMES", "#PTP_PARAMS", "#CP_PARAMS"):
            self.set("$TOOL", self.tool(self.part("FDAT_ACT", "TOOL_NO")))
            self.set("$BASE", self.base(self.part("FDAT_ACT", "BASE_NO")))
            mode = self.part("FDAT_ACT", "IPO_FRAME")
            self.set("$IPO_MODE", "#BASE" if isinstance(mode, Unknown) else mode)

    def _of_joints(self, command: str, value: Any) -> None:
        self.share(self.part("PDAT_ACT", "VEL") if command == "#PTP_DAT" else value)
        if command != "#VEL_PTP":
            for part, size in _corner_of_joints(self.value("PDAT_ACT")).items():
                self.set("$APO", size, part)

    def _of_path(self, command: str, value: Any) -> None:
        self.set("$VEL", self.part("LDAT_ACT", "VEL") if command == "#CP_DAT" else value, "CP")
        if command == "#VEL_CP":
            return
        self.set("$APO", self.part("LDAT_ACT", "APO_DIST"), "CDIS")
        for key, name, usual in (
            ("ORI_TYP", "$ORI_TYPE", "#VAR"),
            ("CIRC_TYP", "$CIRC_TYPE", "#BASE"),
        ):
            said = self.part("LDAT_ACT", key)
            self.set(name, usual if isinstance(said, Unknown) else said)

    def orientation(self, kind: str) -> Literal["to", "constant", "tangent"]:
        """How the tool turns on a line or an arc.

        Raises:
            BadInput: as no line and no arc of ours does.
        """
        if kind == "ptp":
            return "to"
        turn, circle = self.value("$ORI_TYPE"), self.value("$CIRC_TYPE")
        found = _ORIENTATIONS.get((str(turn), "#BASE" if kind == "lin" else str(circle)))
        if found is None:
            valid = "#VAR and #BASE, #CONSTANT and #BASE, or #CONSTANT and #PATH"
            raise BadProgram(f"$ORI_TYPE is {turn} and $CIRC_TYPE {circle}", valid=valid)
        return found

    def speeds(self, kind: str) -> dict[str, Any]:
        """The speeds of a move, by the fields of a `ControllerMove`."""
        if kind == "ptp":
            shares = [self._positive("$VEL_AXIS", i) for i in range(1, 7)]
            known = [share for share in shares if share is not None]
            return {"share": min(1.0, min(known) / 100.0) if known else None}
        turns = [self._positive("$VEL", part) for part in ("ORI1", "ORI2")]
        slowest = min((turn for turn in turns if turn is not None), default=None)
        return {
            "speed": self._positive("$VEL", "CP"),
            "acceleration": self._positive("$ACC", "CP"),
            "turn_speed": None if slowest is None else math.radians(slowest),
        }

    def _positive(self, name: str, by: Any) -> float | None:
        """A speed; None where it is not known.

        Raises:
            BadInput: it is 0 or less.
        """
        value = self.part(name, by)
        if not is_number(value):
            return None
        if value <= 0:
            raise BadProgram(f"{name}.{by} is {value:g}", valid="more than 0")
        return float(value)

    def zone(self, kind: str, words: list[str], zones: Mapping[str, float]) -> float:
        """[m] The radius of the corner at a move's end."""
        if not words:
            return 0.0
        if kind == "ptp" and {"C_PTP", "C_DIS"} <= {*words}:  # one ends the corner, one begins it
            return max(self.zone(kind, [word], zones) for word in ("C_PTP", "C_DIS"))
        by_length = "C_DIS" in words or ("C_SPL" in words and kind != "ptp")
        distance = self.part("$APO", "CDIS")
        if by_length and is_number(distance):
            return float(distance) * MM
        word = "C_DIS" if by_length else words[0]
        if word in zones:
            return zones[word]
        lacks = "$APO.CDIS, its length, is not in the files" if by_length else "is no length"
        return float(self.run.lack(f"{word}: {lacks}", "zones", word))


def _corner_of_joints(data: Any) -> Aggregate:
    """The corner that the data of a joint move say: a share [%], or by its mode a distance [mm]."""
    part = "CDIS" if _part(data, "APO_MODE") == "#CDIS" else "CPTP"
    return {part: _part(data, "APO_DIST")}


def configuration_of(given: Aggregate, settings: Settings) -> dict[str, Any]:
    """The configuration of a target, by the field of a `PoseTarget`.

    Bit n of T is 1 where axis n + 1 is below 0. Bits of S are 1 where the wrist is behind axis 1, where it is
    before the line from axis 2 to 3, and where axis 5 is below 0; robots of five axes have another third bit.
    """
    status, turn = (int(given[key]) if is_number(given.get(key)) else None for key in "ST")
    signs = {} if turn is None else {axis: bool(turn >> (axis - 1) & 1) for axis in range(1, 7)}
    found: dict[str, Any] = {}
    if status is not None:
        is_below, is_behind = bool(status & 4), bool(status & 1)
        if signs.setdefault(5, is_below) != is_below:
            text = f"S {status} and T {turn} do not agree on the sign of A5: that of T is taken"
            settings.run.doubts[f"{settings.line}: {text}"] = None
        found = {"is_behind": is_behind, "is_back": None if is_behind else not status & 2}
        if is_behind:
            found["unchecked"] = f"bit 1 of S {status}"
    ends = {True: (-FARTHEST, NEAR_ZERO), False: (-NEAR_ZERO, FARTHEST)}
    return {**found, "ranges": {axis: ends[below] for axis, below in signs.items()}}


def _of_number(
    act: Callable[[float], float], before: Callable[[float], float] = float
) -> Callable[..., Any]:
    """A function of one number."""
    return lambda settings, value: act(before(value)) if is_number(value) else Unknown(why(value))


FUNCTIONS: Mapping[str, Callable[..., Any]] = {
    "STOOL": lambda settings, index: settings.tool(index),
    "STOOL2": lambda settings, data: settings.tool(_part(data, "TOOL_NO")),
    "SBASE": lambda settings, index: settings.base(index),
    "SIPO_MODE": lambda settings, mode="#BASE": mode,
    "SVEL_CP": lambda settings, speed, *_: {"CP": speed},
    "SVEL_JOINT": lambda settings, share: share,
    "SAPO": lambda settings, data: {"CDIS": _part(data, "APO_DIST")},
    "SAPO_PTP": lambda settings, data: _corner_of_joints(data),
    "SORI_TYP": lambda settings, data: _part(data, "ORI_TYP"),
    **{
        name: lambda settings, *_: Unknown("only the controller knows it")
        for name in "VARSTATE SLOAD SACC_CP SACC_JOINT SJERK STRLEN CAST_FROM CAST_TO".split()
    },
    **{name: _of_number(act) for name, act in (("ABS", abs), ("SQRT", math.sqrt))},
    **{
        name: _of_number(act, math.radians)
        for name, act in (("SIN", math.sin), ("COS", math.cos), ("TAN", math.tan))
    },
    "ACOS": _of_number(lambda value: math.degrees(math.acos(value))),
    "ATAN2": lambda settings, *_: Unknown("ATAN2 is not read"),
}


def key_of(by: Any) -> Any:
    """The key of an element or a part."""
    if isinstance(by, str):
        return by
    if by != int(by):
        raise LookupError(by)
    return int(by)


def _part(data: Any, key: Any) -> Any:
    """A part of an aggregate."""
    if not isinstance(data, Mapping):
        return data if isinstance(data, Unknown) else Unknown(f"{why(data)} for {key}")
    return data.get(key, Unknown(f"no {key} is given"))


def first_variables(asked: ProgramFile, run: Execution) -> dict[str, Any]:
    """The variables that a program begins with: those of the controller, tools and frames of the case, and those
    that routines give values to and do not declare, which all have in common."""
    changed = (one for own in run.routines.values() for one in run.effects.changed_by(own))
    found: dict[str, Any] = {
        name: run.language.value_of(name, run)
        or Unknown(f"{name} is in no file that is given", remedy=run.language.remedy(name))
        for name, _ in changed
    }
    found |= {name: copy.deepcopy(one) for name, one in FIRST.items()}
    for name, pose in (*asked.tools.items(), *asked.frames.items()):
        root, _, index = name.upper().rstrip("]").partition("[")
        if index.isdigit():
            found.setdefault(root, {})[int(index)] = frame_of(pose.matrix())
        else:
            found[root] = frame_of(pose.matrix())
    return found
