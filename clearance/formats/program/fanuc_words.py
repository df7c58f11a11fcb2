"""Words of FANUC's listings, by what they do, motions, and names. Not for: reading them (`fanuc_text`)."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass

from clearance.formats.program.expressions import Expression
from clearance.formats.program.fanuc_positions import Position
from clearance.formats.program.statements import Statement

MOVES = {"J": "ptp", "L": "lin", "C": "circ", "A": "", "S": ""}
"""The motions, and the way of each that is read."""

WAIT = "WAIT sec"

OVERRIDE, LARGEST_SPEEDS = "OVERRIDE", ("JOINT_MAX_SPEED", "LINEAR_MAX_SPEED")
"""Instructions that change speeds: all of them by a share [%], and those that are greater than a value."""

OUTPUTS = ("DO", "RO", "GO", "AO", "F")
"""Instructions that set an output or a flag."""

WAITING = ("UALM", "ARC")
"""Instructions that take time: until a person has reset an alarm, and until an arc burns."""

ANY_REGISTER = "PR[…]"
"""Changed where a line gives a value to a position register by a number that is not read."""

QUIET = frozenset(
    (
        *(*OUTPUTS, "SO", "UO", "M", "TIMER", "SR", "PR", "PAYLOAD", "MESSAGE"),
        *("UALM", "SKIP", "OFFSET", "TOOL_OFFSET", "ARC", "COL", "LOCK", "UNLOCK", "TC_ONLINE"),
        *(OVERRIDE, *LARGEST_SPEEDS),
    )
)
"""Instructions that move nothing. Conditions of offsets and skips count only in motions that name them."""

DECIDING = ("P", "R", "UFRAME", "UTOOL", "UFRAME_NUM", "UTOOL_NUM")
"""What decides where motions go: a line that changes it is never left out. `$MNU…` are frames and tools too."""


@dataclass(frozen=True)
class Motion:
    """A motion instruction.

    Attributes:
        points: where it goes, an arc by way of the first: P or PR, and its number. positions: that the file has.
        unit: of its speed. end: how it ends (FINE, CNT50, CR10). options: words behind that. beside: what is
            done at a time or a place on its way (TB, TA, DB). offsets: OFFSET or TOOL_OFFSET, and the number of
            the position register that has it.
    """

    points: tuple[tuple[str, Expression], ...]
    positions: Mapping[int, Position]
    unit: str
    end: str
    options: tuple[str, ...]
    beside: tuple[Statement, ...] = ()
    offsets: tuple[tuple[str, Expression], ...] = ()


def named(text: str) -> str:
    """The name of a register without remark and leading zeros: `R[1]` for `R[1:count]` and `R[01]`."""
    return re.sub(r":[^\]]*|(?<=[\[,])0+(?=\d)", "", re.sub(r"\s+", "", text)).upper()
