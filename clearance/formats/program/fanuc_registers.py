"""Registers, position registers and inputs of FANUC's controllers: what is known of them, and what a case gives.

Not for: how lines change them (`fanuc_text`).
"""

from __future__ import annotations

import re
from typing import Any

from clearance.errors import BadProgram
from clearance.formats.program.execution import Execution
from clearance.formats.program.expressions import Name, Unknown
from clearance.formats.program.fanuc_positions import Position, position_of
from clearance.formats.program.fanuc_words import ANY_REGISTER, OUTPUTS, QUIET, WAIT, named
from clearance.formats.program.given import ALWAYS, AT_START, UNTIL_SET, give, remedy
from clearance.formats.program.remarks import LEFT_OUT
from clearance.formats.program.tokens import Line
from clearance.formats.schema.program_file import ProgramFile
from clearance.world.notice import listed

_GIVEN = re.compile(r"(R\[\d+\]|U(?:FRAME|TOOL)_NUM)|(?:([DRUS]I|[DR]O|F)|[GA][IO])\[\d+\]")
"""Registers, and inputs and outputs, among them those that are on or off: a case may give what they hold."""


def give_registers(asked: ProgramFile, run: Execution) -> None:
    """Gives registers and inputs the values that a case says.

    Raises:
        BadProgram: another name or value.
    """
    for given, value in asked.variables.items():
        name, found = named(given), _GIVEN.fullmatch(named(given))
        if found is None or isinstance(value, bool) != bool(found[2]):
            valid = "a number for R[1], UFRAME_NUM or GI[1], true or false for DI[1], DO[1] or F[1]"
            raise BadProgram(f"{value} is given", where=f"variables: {given}", valid=valid)
        give(run, name, value, _lasting(name))
    for given, frame in asked.frames.items():
        if re.fullmatch(r"PR\[\d+\]", named(given)):
            run.variables[named(given)] = position_of(frame.matrix())


def _lasting(name: str) -> str:
    """How long the value that a case gives holds."""
    if name.partition("[")[0] in OUTPUTS:
        return UNTIL_SET
    return ALWAYS if "I[" in name else AT_START


def value_of_register(name: str, run: Execution) -> Any:
    """What is known of a register or an input that no line gives a value; None where nothing is to be said."""
    if element := re.fullmatch(r"PR\[(\d+),([1-6])\]", name):
        one = _position_register(f"PR[{int(element[1])}]", run)
        return one if isinstance(one, Unknown) else one.element(int(element[2]))
    if re.fullmatch(r"PR\[\d+\]", name):
        key = f'program: {{frames: {{"{name}": {{xyz: […], rpy: […]}}}}}} in m and rad'
        return Unknown(f"{name} is in no listing", remedy=key)
    if found := _GIVEN.fullmatch(name):
        key = remedy(name, "true" if found[2] else "0", _lasting(name))
        text = f"{name!r} is in no file that is given"
        return Unknown(text if found[1] else f"only the controller knows {name}", remedy=key)
    is_own = name.startswith(("R[", "U", "AR["))
    return None if is_own else Unknown(f"only the controller knows {name}")


def known_register(name: str, run: Execution) -> Position:
    """A position register.

    Raises:
        BadProgram: it is not known.
    """
    one = _position_register(name, run)
    if isinstance(one, Position):
        words, left_out = {*QUIET, WAIT, "WAIT"}, run.noted(LEFT_OUT)
        programs = [place for place in left_out if place.partition(" (")[0] not in words]
        if programs:
            text = f"{name} is taken not to be changed by what is left out"
            run.doubts[f"{text}: {listed(programs, 6)}"] = None
        return one
    if name in run.variables or name in run.concurrent or not one.remedy:
        fault = f"{name}, a position register, is not known: {one.why}"
        raise BadProgram(fault, valid=one.valid("use P[…] with a position in the file"))
    seen = ", as seen from the user frame in force"
    pose = run.lack(f"{name}: a position register is not in a listing", "frames", name, more=seen)
    return position_of(pose)


def _position_register(name: str, run: Execution) -> Position | Unknown:
    if ANY_REGISTER in run.variables or ANY_REGISTER in run.concurrent:
        return run.value_of(Name(ANY_REGISTER, Line(0)))
    one = run.value_of(Name(name, Line(0)))
    return one if isinstance(one, Position | Unknown) else Unknown(f"{name} is no position")
