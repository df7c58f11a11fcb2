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
from clearance.formats.program.fanuc_words import ANY_REGISTER, QUIET, WAIT, named
from clearance.formats.program.given import give, kind_of, remedy
from clearance.formats.program.remarks import LEFT_OUT
from clearance.formats.program.tokens import Line
from clearance.formats.schema.program_file import ProgramFile
from clearance.world.notice import listed


def give_registers(asked: ProgramFile, run: Execution) -> None:
    """Gives registers and inputs the values that a case says.

    Raises:
        BadProgram: another name or value.
    """
    for given, value in asked.variables.items():
        if kind_of(named(given))[0] == "…":
            valid = "a register or a signal, as R[1], UFRAME_NUM, DI[1], DO[1] or F[1]"
            raise BadProgram(f"{given!r} is given", where="variables", valid=valid)
        give(run, named(given), value)
    for given, frame in asked.frames.items():
        if re.fullmatch(r"PR\[\d+\]", named(given)):
            run.variables[named(given)] = position_of(frame.matrix())


def value_of_register(name: str, run: Execution) -> Any:
    """What is known of a register or an input that no line gives a value; None where nothing is to be said."""
    if element := re.fullmatch(r"PR\[(\d+),([1-6])\]", name):
        one = _position_register(f"PR[{int(element[1])}]", run)
        return one if isinstance(one, Unknown) else one.element(int(element[2]))
    if re.fullmatch(r"PR\[\d+\]", name):
        key = f'program: {{frames: {{"{name}": {{xyz: […], rpy: […]}}}}}} in m and rad'
        return Unknown(f"{name} is in no listing", remedy=key)
    key = "" if kind_of(name)[0] == "…" else remedy(name)
    is_own = name.startswith(("R[", "UF", "UT", "AR["))
    text = (
        f"{name!r} is in no file that is given" if is_own else f"only the controller knows {name}"
    )
    return Unknown(text, remedy=key) if key or not is_own else None


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
