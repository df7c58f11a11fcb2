"""System variables of KRL that change where a move goes. Not for: tool, base, speeds and corners (`krl_settings`).

Source: KUKA, System Variables 8.x ($ROBROOT: the robot's foot seen from $WORLD, from which bases are seen; $TECH:
functions that move the tool beside its path).
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from clearance.errors import BadProgram, MissingKey
from clearance.formats.program.execution import Execution
from clearance.formats.program.expressions import Unknown
from clearance.formats.program.given import give, remedy
from clearance.formats.program.krl_expressions import (
    GRAMMAR,
    MM,
    NUMBERED,
    frame_of,
    matrix_of,
    why,
)
from clearance.formats.program.krl_settings import FIRST, SAVED, Settings
from clearance.formats.program.remarks import NOT_FOLLOWED, Remarks
from clearance.formats.program.statements import Assign, Statement, assigned, within
from clearance.formats.schema.program_file import ProgramFile
from clearance.geometry.pose import inverse
from clearance.world.notice import listed

QUIET = frozenset(
    "$ACT_BASE $ACT_TOOL $ADVANCE $ANIN $ANOUT $BWDSTART $CURR_RED $CYCFLAG $ERR $FLAG $H_POS $IN $LOAD "
    "$LOAD_A1 $LOAD_A2 $LOAD_A3 $LOOP_MSG $MSG_T $OUT $OV_PRO $PRO_MODE $SOFTN_END $SOFTP_END $TIMER "
    "$TIMER_STOP $TORQMON $ACC_AXIS".split()
)
"""Those that say nothing of the way of a move."""

STATES = frozenset(
    "$IN $OUT $ANIN $ANOUT $DIGIN1 $DIGIN2 $FLAG $CYCFLAG $TIMER $TIMER_FLAG $STOPMESS $MODE_OP".split()
)
"""Those that no file has: inputs, and how the controller is just then."""

_NULL = np.eye(4)


def state_of(name: str) -> Unknown | None:
    """What is known of a variable that no file has; None of those that a file may have."""
    root, _, number = name.partition("[")
    if root not in STATES:
        return None
    return Unknown(f"only the controller knows {name}", remedy=remedy_of(name) if number else "")


def remedy_of(name: str) -> str:
    """How a case gives a signal or a variable, as of an `Unknown`; empty of other system variables."""
    is_one = not name.startswith("$") or name.partition("[")[0] in NUMBERED
    return remedy(str(name)) if is_one else ""


def give_variables(asked: ProgramFile, run: Execution, of_module: str) -> None:
    """Gives signals, and variables that no file gives a value, those that a case says.

    Args:
        of_module: behind the names that the program's own files have alone.

    Raises:
        BadProgram: another value than a signal has.
    """
    for given, value in asked.variables.items():
        name = GRAMMAR.folded(re.sub(r"\s", "", given))
        own = GRAMMAR.folded(f"{name}{of_module}")
        others = [one for one in run.variables if f"{one}" == name and one not in (own, name)]
        places = [own, name, *(others if len(others) == 1 else ())]
        unknown = (one for one in places if isinstance(run.variables.get(one), Unknown))
        place = next(unknown, name)
        if isinstance(run.variables.get(place, Unknown("")), Unknown):
            give(run, place, value)


def require_followed(settings: Settings) -> None:
    """Checks that no system variable has a move go elsewhere than its instruction says.

    Raises:
        BadProgram: one does, or it is not known.
    """
    mode = settings.value("$IPO_MODE")
    if mode != "#BASE":
        fault = f"$IPO_MODE is {mode}: the tool may stand, and the robot bring the part"
        raise BadProgram(fault, valid="$IPO_MODE = #BASE")
    if not np.array_equal(_frame(settings, "$WORLD"), _NULL):
        raise BadProgram("$WORLD is set", valid="leave $WORLD as it is, and set $ROBROOT")
    functions = settings.value("$TECH")
    if not isinstance(functions, Mapping):
        valid = "set $TECH[…].MODE = #OFF, or take the line out"
        raise BadProgram(f"$TECH is not known: {why(functions)}", valid=valid)
    for number, one in functions.items():
        if not isinstance(one, Mapping) or one.get("MODE", "#OFF") != "#OFF":
            fault = f"$TECH[{number}] is on: it moves the tool beside its path, which is not read"
            raise BadProgram(fault, valid=f"$TECH[{number}].MODE = #OFF")


def _frame(settings: Settings, name: str) -> np.ndarray:
    value = settings.value(name)
    if not isinstance(value, Mapping):
        valid = "give it a value that the files decide"
        raise BadProgram(f"{name} is not known: {why(value)}", valid=valid)
    return matrix_of(value, name)


@dataclass(eq=False)
class RobotRoot:
    """Where the robot's foot is, seen from $WORLD; `pose` (4, 4) [m] is None before a pose is used."""

    pose: np.ndarray | None = None

    def use(self, settings: Settings) -> None:
        """Keeps it for a move to a pose.

        Raises:
            BadProgram: it is elsewhere than at moves before.
        """
        pose = _frame(settings, "$ROBROOT")
        if self.pose is not None and not np.array_equal(pose, self.pose):
            raise BadProgram("$ROBROOT changes between moves", valid="set $ROBROOT once")
        self.pose = pose

    def doubts(self, asked: ProgramFile) -> Iterator[str]:
        """A line where the case's base has to be $WORLD.

        Raises:
            MissingKey: it is not said.
        """
        if self.pose is None or np.array_equal(self.pose, _NULL):
            return
        text = "$ROBROOT is not null: poses are seen from $WORLD, and not from the robot's foot"
        if asked.base is None:
            x, y, z, a, b, c = frame_of(inverse(self.pose)).values()
            xyz = ", ".join(f"{one * MM + 0.0:.6g}" for one in (x, y, z))
            rpy = ", ".join(f"{math.radians(one) + 0.0:.6g}" for one in (c, b, a))
            world = f"program: {{base: {{on: base, xyz: [{xyz}], rpy: [{rpy}]}}}}"
            valid = f"where $WORLD is; if the robot's root is its foot, {world}"
            raise MissingKey(text, where="base", valid=valid)
        yield f"{text}; base in the program is taken for $WORLD"


LIMITS = frozenset(
    "$RED_VEL $RED_ACC $OV_APPL $OV_ROB $VEL_EXTAX $ACC_EXTAX $JERK $GEAR_JERK $CP_VEL_TYPE".split()
)
"""Those that limit speeds and accelerations, and so change how long moves take."""


def not_followed(bodies: Iterable[tuple[Statement, ...]], remarks: Remarks) -> Iterator[str]:
    """A line on system variables that procedures set and that are not read, if there are any.

    Args:
        remarks: takes those that change how long moves take.
    """
    found: dict[str, Any] = {}
    for body in bodies:
        for one in within(body):
            name = assigned(one.target) if isinstance(one, Assign) else None
            if name is not None and name.name.startswith("$"):
                found.setdefault(name.name, one.line)
    for limit in sorted(found.keys() & LIMITS):
        remarks.note(NOT_FOLLOWED, f"{limit} ({found[limit]})")
    unread = [
        f"{name} ({line})"
        for name, line in found.items()
        if name not in KNOWN and name not in LIMITS
    ]
    if unread:
        yield f"system variables that are set, and not followed: {listed(unread, 6)}"


KNOWN = QUIET | {*FIRST, *SAVED}
