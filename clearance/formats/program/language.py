"""What the words of a controller's language do, as a run asks for it. Not for: running a program (`execution`)."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any, Protocol

from clearance.formats.program.expressions import Call, Expression


class Language(Protocol):
    """What the words of a language do.

    Attributes:
        suffix: of the file that has a called program by its name; empty where its name says nothing of the file.
        retiming: words that change how long moves take also from a thread, a trap or an interrupt.
    """

    suffix: str
    retiming: frozenset[str]

    def moves(self, name: str) -> bool | None:
        """Whether an instruction or a function can move the robot; None where it is not known."""

    def waits(self, call: Call) -> bool:
        """Whether an instruction or a function takes a time that counts; its file may not say how long."""

    def writes(self, call: Call) -> Iterable[Expression]:
        """The arguments of an instruction or a function that it gives a value."""

    def instruct(self, call: Call, run: Any) -> None:
        """Does what an instruction does: a move, a setting, or a wait."""

    def result_of(self, call: Call, run: Any) -> Any:
        """The value of a function of the language; `Unknown` where only the controller knows it."""

    def value_of(self, name: str, run: Any) -> Any:
        """The value of a name that the language itself knows; None where it knows none."""

    def items(self, values: list[Any], kind: str) -> Any:
        """Values in brackets."""

    def part_of(self, value: Any, by: Any) -> Any:
        """A part of a value."""

    def with_part(self, value: Any, by: Any, new: Any) -> None:
        """Changes a part of a value."""

    @property
    def state(self) -> Any:
        """What settings are in force: a loop repeats itself where it is the same."""
