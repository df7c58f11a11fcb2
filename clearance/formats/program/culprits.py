"""What may move the robot, and what is valid where no file says what it does. Not for: finding it (`effects`)."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import NamedTuple

from clearance.errors import BadProgram
from clearance.formats.program.expressions import Unknown
from clearance.formats.program.statements import If


class Culprit(NamedTuple):
    """What may move the robot, and where; `unknown`: its name, if nobody knows what it does."""

    text: str
    unknown: str = ""

    def __str__(self) -> str:
        return self.text


def unknown_word(name: str, suffix: str, moves: bool | None = None) -> BadProgram:
    """The error for an instruction or a function that may do anything, or that moves and has no value.

    Args:
        suffix: of the file that may have it.
    """
    if moves:
        fault = f"{name} moves the robot, and its value is not read"
        return BadProgram(fault, valid="write the move as a statement of its own")
    fault = f"{name!r} is no known instruction, and may move the robot"
    return BadProgram(fault, valid=way_past([Culprit("", name)], suffix))


def way_past(culprits: Iterable[Culprit], suffix: str) -> str:
    """What is valid where nobody knows what some instructions do; empty where one moves the robot."""
    names = [*dict.fromkeys(one.unknown for one in culprits)]
    if "" in names:
        return ""
    files = ", ".join(f"{name}{suffix}" for name in names)
    if not suffix:
        file = "a file beside that has it" if len(names) == 1 else "files beside that have them"
    else:
        file = f"program: {{beside: [{files}]}}"
    does = "it neither moves nor sets" if len(names) == 1 else "they neither move nor set"
    return f"{file}, or skip: [{', '.join(names)}] if {does} tool, frame or variables"


def undecided_branch(one: If, culprits: Sequence[Culprit], why: Unknown, suffix: str) -> BadProgram:
    """The error for a branch that moves the robot, or may, and that only the controller decides."""
    fault = f"{one.word} decides on {culprits[0]}, and is not known: {why.why}"
    past = way_past(culprits, suffix)
    valid = why.valid("let the file decide it")
    return BadProgram(fault, valid=f"{valid}{past and ', or '}{past}")
