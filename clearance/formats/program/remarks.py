"""What a program's run has to tell beside its moves. Not for: running it (`execution`)."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from clearance.errors import BadProgram, MissingKey
from clearance.formats.program.expressions import Call, Unknown, number
from clearance.formats.program.tokens import Line
from clearance.world.notice import listed
from clearance.world.trajectory import FURTHER_PASSES

MOST_LACKING = 20
"""Values by name that an error asks for at once."""

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
        doubts: for the headline, one line each. line: that runs.
    """

    doubts: dict[str, None] = field(init=False, default_factory=dict)
    line: Line = field(init=False, default=Line(0))
    _lacking: dict[tuple[str, str], MissingKey] = field(init=False, default_factory=dict)
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

    def noted(self, what: str) -> list[str]:
        """The places that are kept with something to tell."""
        return [*self._passed.get(what, ())]

    def lack(self, fault: str, key: str, name: str, before: str = "", more: str = "") -> Any:
        """Any tool, frame or radius, for one of a name that no file has: `require_all` then refuses the program.

        Args:
            key: of the case's program. before, more: beside what it may have.
        """
        unit = ", the radius of such corners [m]" if key == "zones" else " in m and rad"
        valid = f"{before}program: {{{_written([(key, name)])}}}{unit}{more}"
        error = MissingKey(fault, where=str(self.line), valid=valid)
        self._lacking.setdefault((key, name), error)
        return 0.05 if key == "zones" else np.eye(4)

    def require_all(self) -> None:
        """Nothing, if nothing lacks.

        Raises:
            MissingKey: something does; with all of it.
        """
        if self._lacking:
            first = next(iter(self._lacking.values()))
            if len(self._lacking) > 1:
                asked = _written([*self._lacking][:MOST_LACKING])
                first.valid = f"program: {{{asked}}} in m and rad"
            raise first from None

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


def _written(lacking: Iterable[tuple[str, str]]) -> str:
    """The keys of values by name, as a case has them."""
    parts = dict[str, list[str]]()
    for key, name in lacking:
        shown = f'"{name}"' if "[" in name else name
        value = "0.05" if key == "zones" else "{xyz: […], rpy: […]}"
        parts.setdefault(key, []).append(f"{shown}: {value}")
    return ", ".join(f"{key}: {{{', '.join(own)}}}" for key, own in parts.items())
