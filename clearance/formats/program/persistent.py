"""Values that a controller keeps between runs (PERS of RAPID, data lists of KRL), and what rests on them.

Not for: running a program (`execution`).
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field
from typing import Any

from clearance.formats.program.effects import Effects
from clearance.formats.program.expressions import Expression
from clearance.formats.program.statements import For, If, While


@dataclass(eq=False)
class PersistentValues:
    """Which variables of a run rest on kept values.

    Attributes:
        frames: the run's variables of the whole program, then of each routine that is entered.
        origins: for each of these, by variable, the kept value that it rests on.
    """

    effects: Effects
    frames: list[dict[str, Any]]
    origins: list[dict[str, str]] = field(default_factory=lambda: [{}])

    def origin_of(self, parts: Iterable[Expression]) -> str:
        """The kept value that expressions rest on; empty where none is."""
        for name in self.effects.read_by(parts) if any(self.origins) else ():
            origins = self.origins[-1 if name in self.frames[-1] else 0]
            if name in origins:
                return origins[name]
        return ""

    def put(self, name: str, origin: str, place: dict[str, Any], is_part: bool = False) -> None:
        """Keeps what a variable rests on that is given a value, or a part of one."""
        origins = self.origins[0 if place is self.frames[0] else -1]
        if origin:
            origins[name] = origin
        elif not is_part:
            origins.pop(name, None)

    def doubts_on(self, one: If | While | For, origin: str) -> dict[str, None]:
        """A line on a branch or a loop that a kept value decided, if the robot moves; variables that it changes
        rest on the value too.
        """
        bodies = [body for _, body in one.branches] if isinstance(one, If) else [one.body]
        for name, _ in self.effects.changed_in(bodies):
            self.origins[-1 if name in self.frames[-1] else 0][name] = origin
        other = "the way not taken is" if isinstance(one, If) else "other numbers of passes are"
        text = f"{one.line}: {other} not measured; {origin} decides"
        moves = any(True for body in bodies for _ in self.effects.deciding(body))
        return {f"{text}, which the controller keeps between runs": None} if moves else {}
