"""What a program's run has to tell beside its moves. Not for: running it (`execution`)."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

from clearance.errors import BadProgram
from clearance.formats.program.expressions import Call, Unknown, number
from clearance.world.notice import listed
from clearance.world.trajectory import FURTHER_PASSES

LEFT_OUT = "left out as asked"
WAITS = "instructions that take a time which no file says are taken to take none"
STILL = "instructions that move nothing"
UNSAID = "speeds that no file says are assumed"
ENDLESS = "endless loops: each pass that is not measured repeats one that is"
NOT_FOLLOWED = "limits of speeds and accelerations that the program sets are not followed"


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
        """What the times of the moves lack, and where: what the case leaves out, and what no file says."""
        speeds = (f"the speed of {where}" for where in self._passed.get(UNSAID, ()))
        limits = (f"what {where} sets" for where in self._passed.get(NOT_FOLLOWED, ()))
        passes = (f"{FURTHER_PASSES} {where}" for where in self._passed.get(ENDLESS, ()))
        known = (*self._passed.get(LEFT_OUT, ()), *self._passed.get(WAITS, ()))
        return (*known, *speeds, *limits, *passes)

    @property
    def notes(self) -> list[str]:
        """A line each on what was passed over, and where: what times lack first, and what moves nothing last."""
        order = {LEFT_OUT: 0, WAITS: 0, UNSAID: 0, NOT_FOLLOWED: 0, STILL: 2}
        passed = sorted(self._passed.items(), key=lambda one: order.get(one[0], 1))
        return [f"{what}: {listed([*where], 6)}" for what, where in passed]

    def note(self, what: str, where: str) -> None:
        """Keeps something to tell, each place once."""
        self._passed.setdefault(what, {})[where] = None

    def share_of_speeds(self, value: Any, call: Call, whole: float) -> float:
        """The share of all speeds that an instruction asks for; where it is not known it is 1, and is told.

        Raises:
            BadProgram: it is no such share.
        """
        if isinstance(value, Unknown):
            self.note(UNSAID, f"{call.name} ({call.line})")
            return 1.0
        share = number(value, call.name) / whole
        if not 0.0 < share <= 1.0:
            valid = f"more than 0, at most {whole:g}"
            raise BadProgram(f"{call.name} is {value:g}", valid=valid)
        if share < 1.0:
            self.note("shares of all speeds are followed", f"{call.name} {value:g} ({call.line})")
        return share
