"""What statements may do, whether they are run or not: move the robot, leave a routine, give variables values.

Not for: running them (`execution`).
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass

from clearance.errors import BadProgram
from clearance.formats.program.expressions import Call, names_in
from clearance.formats.program.statements import (
    STOP,
    Assign,
    Leave,
    Routine,
    Statement,
    Unreadable,
    assigned,
    expressions_of,
    within,
)
from clearance.formats.program.tokens import Line


@dataclass(frozen=True, eq=False)
class Effects:
    """What the statements of a program may do.

    Attributes:
        moves: whether a word of the language can move the robot; None where it is not known. skip: words that are
            left out.
    """

    moves: Callable[[str], bool | None]
    routines: Mapping[str, Routine]
    skip: frozenset[str]

    def deciding(self, body: tuple[Statement, ...], entered: tuple[str, ...] = ()) -> Iterator[str]:
        """What in a body moves the robot, leaves the body, or may do so, in words."""
        for one in within(body):
            leaves = isinstance(one, Leave) and one.what != STOP and not entered
            if leaves or (isinstance(one, Unreadable) and one.word not in self.skip):
                yield f"{one.word} at {one.line}"  # type: ignore[union-attr]
            for name in called_in(one):
                if name in self.skip or name in entered:
                    continue
                if name in self.routines:
                    yield from self.deciding(self.routines[name].body, (*entered, name))
                elif self.moves(name) is not False:
                    yield f"{name} at {one.line}"

    def is_still(self, routine: Routine) -> bool:
        """True if nothing in a routine moves the robot."""
        return next(self.deciding(routine.body, (routine.name,)), None) is None

    def assigned_in(
        self, bodies: Sequence[tuple[Statement, ...]], entered: tuple[str, ...] = ()
    ) -> Iterator[tuple[str, Line]]:
        """The variables that bodies may give a value, and where."""
        for one in (one for body in bodies for one in within(body)):
            name = assigned(one.target) if isinstance(one, Assign) else None
            if name is not None:
                yield name.name, one.line
            for called in called_in(one):
                if called in self.routines and called not in entered:
                    yield from self.assigned_in([self.routines[called].body], (*entered, called))


def called_in(one: Statement) -> list[str]:
    """The functions and instructions that a statement itself names, in order."""
    return sorted({name for part in expressions_of(one) for name in names_in(part)})


def unknown_word(call: Call) -> BadProgram:
    """The error for an instruction or a function that may do anything."""
    return BadProgram(
        f"{call.name!r} is no known instruction, and may move the robot",
        where=str(call.line),
        valid=f"a file beside that has it, or skip: [{call.name}] if it neither moves nor sets tool or frame",
    )


def unreadable_word(one: Unreadable) -> BadProgram:
    """The error for a statement that may do anything."""
    return BadProgram(
        f"{one.word!r} is not understood, and may decide where the robot goes",
        where=str(one.line),
        valid=f"a program without it, or skip: [{one.word}] if it does not",
    )
