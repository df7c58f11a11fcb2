"""The variables of a program that runs, and which of them lines read. Not for: running it (`execution`)."""

from __future__ import annotations

import copy
from collections.abc import Iterable
from dataclasses import dataclass, field
from typing import Any

from clearance.errors import nearest_name
from clearance.formats.program.expressions import Call, Name, Unknown
from clearance.formats.program.language import Language
from clearance.formats.program.remarks import Remarks
from clearance.formats.program.tokens import Line


@dataclass(eq=False)
class Variables(Remarks):
    """The variables of a run.

    Attributes:
        variables: of all; `frames`: of these, and of routines in use; `concurrent`: that threads change; `given`:
            names of those of the case.
    """

    language: Language
    variables: dict[str, Any] = field(init=False, default_factory=dict)
    frames: list[dict[str, Any]] = field(init=False)
    concurrent: dict[str, Unknown] = field(init=False, default_factory=dict)
    given: set[str] = field(init=False, default_factory=set)
    _read: set[str] = field(init=False, default_factory=set)
    _next: str = field(init=False, default="")

    def __post_init__(self) -> None:
        self.frames = [self.variables]

    def value_of(self, name: Name) -> Any:
        """The value of a variable; `Unknown` where no file that is given has it."""
        if name.name != self._next:
            self._read.add(name.name)
        for place in (self.concurrent, self.frames[-1], self.variables):
            if name.name in place:
                return place[name.name]
        if (own := self.language.value_of(name.name, self)) is not None:
            return own
        text = f"{name.name!r} is in no file that is given"
        return Unknown(text, lambda: self._misspelt(name.name), self.language.remedy(name.name))

    def _misspelt(self, name: str) -> str:
        """The variable that is perhaps meant; empty if none is near."""
        known = (*self.frames[-1], *self.variables)
        hint = nearest_name(name, {one for one in known if str(one) != str(name)})
        return hint if hint.startswith("did") else ""

    def read_ones(self) -> tuple[Any, ...]:
        """All variables, with the values of those that lines read for more than their own next value."""
        frames = [
            {name: one if name in self._read else None for name, one in own.items()}
            for own in self.frames
        ]
        return copy.deepcopy((frames[0], self.concurrent, frames[1:]))

    def place(self, name: str, is_own: bool = False) -> dict[str, Any]:
        """Where a variable is, or begins to be."""
        own, shared = self.frames[-1], self.language.shares_variables or name in self.variables
        return own if is_own or name in own or not shared else self.variables

    def given_back(self, name: str, value: Any, call: Call) -> Any:
        """What a variable holds that a routine gives a value; other lines may set an output, too."""
        if name.partition("[")[0] not in self.language.signals or name in self.given:
            return value
        why = f"{name!r} is given a value by {call.name} at {call.line}"
        return Unknown(why, remedy=self.language.remedy(name))

    def forget(self, changed: Iterable[tuple[str, Line]], by: str = "", remedy: str = "") -> None:
        """Makes variables unknown that lines may have changed; a remedy is as of an `Unknown`."""
        for name, line in changed:
            why = f"{name!r} is given a value{by} at {line}"
            self.place(name)[name] = Unknown(why, remedy=remedy)
