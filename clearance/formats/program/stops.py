"""Corner zones at which controllers stop all the same. Not for: corners that are passed (room `programs`)."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from clearance.formats.program.controlled_arm import ControlledArm
from clearance.formats.program.controller_program import ControllerMove, ControllerWait

NO_WAY = 1e-9
"""[m] and sine of a turn: a move that is shorter is none."""

ONLY_TURNS = "the tool only turns before or after"
"""Why a corner zone is none where a controller may turn the tool on the way all the same."""

OTHER_TOOL = " has another tool"
"""Ends why a corner zone is none where a controller may cut the corner all the same."""


@dataclass(eq=False)
class Stops:
    """Where a controller stops in spite of a corner zone.

    Attributes:
        first: the move at whose end the tool begins; None where it begins elsewhere. notes: a line each on such
            corners is added. cut: a line each on those that the controller may cut.
    """

    arm: ControlledArm
    first: ControllerMove | None
    notes: list[str]
    cut: list[str] = field(default_factory=list)

    def applied(
        self, moves: Sequence[ControllerMove | ControllerWait]
    ) -> Iterator[ControllerMove | ControllerWait]:
        """The moves, without corner zones where controllers stop all the same."""
        before: ControllerMove | None = None
        after = [*moves, None][1:]
        for one, other in zip(moves, after, strict=True):
            if isinstance(one, ControllerMove):
                why = self._why_it_stops(before, one, other) if one.zone else ""
                waits = isinstance(other, ControllerWait) and other.reads_on
                if why and (waits or why == ONLY_TURNS or why.endswith(OTHER_TOOL)):
                    text = "a wait follows a corner zone" if waits else f"a corner zone, and {why}"
                    text = f"{one.line}: {text}: the tool is taken to stop"
                    self.cut.append(f"{text}, and the controller may cut the corner")
                elif why:
                    self.notes.append(f"{one.line}: the tool stops, since {why}")
                before = replace(one, zone=0.0) if why else one
            yield before if isinstance(one, ControllerMove) and before else one

    def _why_it_stops(
        self,
        before: ControllerMove | None,
        one: ControllerMove,
        other: ControllerMove | ControllerWait | None,
    ) -> str:
        """Why a corner zone is none; empty where it is one."""
        if not isinstance(other, ControllerMove):
            return "no move follows at once"
        if one is self.first:
            return "it begins there"
        if not np.array_equal(one.tool, other.tool):
            return f"{other.line}{OTHER_TOOL}"
        moved = self._moved(before, one), self._moved(one, other)
        if "" in moved:
            return "it does not move before or after"
        return ONLY_TURNS if "turns" in moved else ""

    def _moved(self, before: ControllerMove | None, one: ControllerMove) -> str:
        """What a move does to the tool: nothing, or it "turns" on a line without its point, or it "moves"."""
        ends = [self.arm.base_from_flange(end, one.to.unit) for end in (before, one)]
        if ends[0] is None or ends[1] is None:
            return "moves"
        off = np.abs((ends[1] - ends[0]) @ one.tool)
        if off.max() < NO_WAY:
            return ""
        return "turns" if one.kind == "lin" and off[:3, 3].max() < NO_WAY else "moves"
