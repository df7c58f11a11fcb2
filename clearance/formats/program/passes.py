"""Loops that may not end, and jumps back: they are run until a pass repeats one. Not for: running statements
(`execution`).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any

from clearance.errors import BadProgram, DuplicateName
from clearance.formats.program.controller_program import ControllerMove
from clearance.formats.program.expressions import number
from clearance.formats.program.remarks import ENDLESS
from clearance.formats.program.statements import (
    JUMP,
    STOP,
    Label,
    Leave,
    Statement,
    While,
    expressions_of,
    within,
)
from clearance.formats.program.tokens import Line
from clearance.world.notice import listed

MOST_PASSES = 100
"""Passes of an endless loop after which it has to repeat one."""

MOST_JUMPS = 1_000
"""As `MOST_PASSES`, of jumps to one label: they may be a loop that ends."""


@dataclass(eq=False)
class Passes:
    """The states of a program after the passes of a loop, the variables first."""

    what: str
    most: int
    states: list[Any] = field(default_factory=list)
    n_moves: list[int] = field(default_factory=list)

    def end(self, one: While | Leave, body: Sequence[Statement], run: Any) -> Leave | None:
        """The end of the program, if a pass ends as one before.

        Raises:
            BadProgram: as of `repeats`; the passes make no move, and rest on a value that may be another one.
        """
        state = run.state()
        if not self.repeats(state):
            self.n_moves.append(len(run.moves))
            return None
        made = run.moves[self.n_moves[self.states.index(state)] :]
        parts = (part for inner in within(tuple(body)) for part in expressions_of(inner))
        origin = run.persistent.origin_of(parts)
        if origin and not any(isinstance(move, ControllerMove) for move in made):
            fault = (
                f"{one.word} repeats itself without a move, and what lies behind it is not measured"
            )
            valid = "a value with which it ends, or a copy of the program without it"
            raise BadProgram(f"{fault}: {origin}", where=f"{one.line}", valid=valid)
        n_passes = len(self.states) + 1
        run.note(ENDLESS, f"{one.word} ({one.line}), of which {n_passes} are measured")
        return Leave(one.line, one.word, STOP)

    def repeats(self, state: Sequence[Any]) -> bool:
        """Whether a pass ends as one before, so that all further ones repeat those between.

        Raises:
            BadProgram: the loop has had its passes.
        """
        if state in self.states:
            return True
        self.states.append(state)
        if len(self.states) == self.most:
            (before, *_), (now, *_) = self.states[-2:]
            changed = [repr(name) for name in now if now[name] != before.get(name)]
            fault = f"{self.what} that repeats none of its first {self.most:,} passes"
            valid = (
                f"write a loop that ends, or set {listed(changed) or 'its variables'} back in it"
            )
            raise BadProgram(fault, valid=valid)
        return False


def require_one_each(body: tuple[Statement, ...]) -> None:
    """Nothing, if each label of a routine stands in one line.

    Raises:
        DuplicateName: one does not.
    """
    lines = dict[float | str, Line]()
    for one in (one for one in within(body) if isinstance(one, Label)):
        if lines.setdefault(one.name, one.line) != one.line:
            valid = f"one of them: the other is at {lines[one.name]}"
            fault = f"label {one.name} is there twice"
            raise DuplicateName(fault, where=str(one.line), valid=valid)


@dataclass(eq=False)
class Jumps:
    """The jumps to labels of a body that runs."""

    body: Sequence[Statement]
    run: Any
    _passes: dict[int, Passes] = field(default_factory=dict)

    def followed(self, left: Leave | None, at: int) -> tuple[Leave | None, int]:
        """What the body is left by, if it is, and the place where it goes on.

        Args:
            left: what its statement before a place was left by.
        """
        if left is None or left.what != JUMP:
            return left, at
        label, places = _label_of(left, self.run), enumerate(self.body)
        labels = (i for i, one in places if isinstance(one, Label) and one.name == label)
        place = next(labels, None)
        if place is None:
            return left, at
        passes = self._passes.setdefault(place, Passes(f"a loop by {left.word}", MOST_JUMPS))
        end = passes.end(left, self.body[place:at], self.run) if place < at else None
        return end, at if end else place


def without_jump(left: Leave | None, run: Any) -> Leave | None:
    """What a routine is left by.

    Raises:
        BadProgram: a jump.
    """
    if left is not None and left.what == JUMP:
        fault = f"{left.word} goes to label {_label_of(left, run)}, which is in no block around it"
        valid = "a label of the same program that stands in no other IF or FOR"
        raise BadProgram(fault, where=str(left.line), valid=valid)
    return left


def _label_of(one: Leave, run: Any) -> float | str:
    assert one.value is not None
    label = run.evaluated(one.value)
    return label if isinstance(label, int | str) else number(label, f"the label of {one.word}")
