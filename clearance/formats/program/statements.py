"""Statements of controllers' languages, as all of them are read, and what is in them. Not for: running them."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field

from clearance.formats.program.expressions import Call, Expression, Name, Part
from clearance.formats.program.tokens import Line


@dataclass(frozen=True)
class Assign:
    """A value for a variable or a part of one; `is_own` to its routine, or `is_of_all` of them."""

    line: Line
    target: Expression
    value: Expression
    is_own: bool = False
    is_of_all: bool = False


@dataclass(frozen=True)
class Do:
    """An instruction, or a call of a routine."""

    line: Line
    call: Call


@dataclass(frozen=True)
class If:
    """The first branch whose condition is true; a condition of None always is."""

    line: Line
    word: str
    branches: tuple[tuple[Expression | None, tuple[Statement, ...]], ...]


@dataclass(frozen=True)
class While:
    """A body for as long as a condition is true; `at_end`: it is looked at after the body."""

    line: Line
    word: str
    condition: Expression
    body: tuple[Statement, ...]
    at_end: bool = False


@dataclass(frozen=True)
class For:
    """A body for each value of a variable from the first to the last; without a step by 1, towards the last if
    `turns_back`. The loop alone has a variable that `is_own`.
    """

    line: Line
    word: str
    name: Name
    first: Expression
    last: Expression
    step: Expression | None
    body: tuple[Statement, ...]
    turns_back: bool = False
    is_own: bool = False


@dataclass(frozen=True)
class Leave:
    """The end of a routine with its value, of a loop, or of one pass of it; or a jump to the label of a value."""

    line: Line
    word: str
    what: str
    value: Expression | None = None


@dataclass(frozen=True)
class Label:
    """A place that jumps go to, by its number or its name."""

    line: Line
    name: float | str


@dataclass(frozen=True)
class Unreadable:
    """A statement whose effect is not known; `word` is its first. One that `jumps` is never left out."""

    line: Line
    word: str
    jumps: bool = False


Statement = Assign | Do | If | While | For | Leave | Label | Unreadable

RETURN, BREAK, CONTINUE, STOP, JUMP = "return", "break", "continue", "stop", "jump"
"""What a `Leave` leaves: a routine, a loop, a pass of one, or the program; a jump, all blocks around it."""


@dataclass(frozen=True)
class Routine:
    """A procedure or a function.

    Attributes:
        parameters: their names, in order. body: its statements. is_thread: it runs beside the others.
        returned: parameters that are the caller's own variables. defaults: values of those that are not given.
        handlers: what runs in its place when something goes wrong, by the word for it.
    """

    name: str
    line: Line
    parameters: tuple[str, ...]
    body: tuple[Statement, ...]
    is_thread: bool = False
    returned: frozenset[str] = frozenset()
    defaults: Mapping[str, Expression] = field(default_factory=dict)
    handlers: tuple[tuple[str, tuple[Statement, ...]], ...] = ()


def within(body: tuple[Statement, ...]) -> Iterator[Statement]:
    """All statements of a body, at any depth."""
    for one in body:
        yield one
        match one:
            case If():
                for _, branch in one.branches:
                    yield from within(branch)
            case While() | For():
                yield from within(one.body)


def expressions_of(one: Statement) -> list[Expression]:
    """The expressions of a statement itself."""
    match one:
        case Assign():
            return [one.value, one.target]
        case Do():
            return [one.call]
        case If():
            return [condition for condition, _ in one.branches if condition is not None]
        case While():
            return [one.condition]
        case For():
            return [part for part in (one.first, one.last, one.step) if part is not None]
        case Leave():
            return [] if one.value is None else [one.value]
        case _:
            return []


def assigned(one: Expression) -> Name | None:
    """The variable that is changed where an expression is given a value."""
    while isinstance(one, Part):
        one = one.of
    return one if isinstance(one, Name) else None
