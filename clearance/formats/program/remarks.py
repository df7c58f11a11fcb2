"""What a program's run has to tell beside its moves. Not for: running it (`execution`)."""

from __future__ import annotations

from dataclasses import dataclass, field

from clearance.world.notice import listed

LEFT_OUT = "left out as asked"


@dataclass(eq=False)
class Remarks:
    """What was passed over, and what a verdict leaves out.

    Attributes:
        doubts: for the headline, one line each.
    """

    doubts: dict[str, None] = field(init=False, default_factory=dict)
    _passed: dict[str, dict[str, None]] = field(init=False, default_factory=dict)

    @property
    def left_out(self) -> tuple[str, ...]:
        """What is left out as the case asks, and where."""
        return tuple(self._passed.get(LEFT_OUT, ()))

    @property
    def notes(self) -> list[str]:
        """A line each on what was passed over, and where."""
        return [f"{what}: {listed([*where], 6)}" for what, where in self._passed.items()]

    def note(self, what: str, where: str) -> None:
        """Keeps something to tell, each place once."""
        self._passed.setdefault(what, {})[where] = None
