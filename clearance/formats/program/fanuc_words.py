"""The words of FANUC's listings that are known, by what they do. Not for: doing it (`fanuc`)."""

from __future__ import annotations

MOVES = {"J": "ptp", "L": "lin", "C": "circ", "A": "", "S": ""}
"""The motions, and the way of each that is read."""

WAIT = "WAIT sec"

OVERRIDE, LARGEST_SPEEDS = "OVERRIDE", ("JOINT_MAX_SPEED", "LINEAR_MAX_SPEED")
"""Instructions that change speeds: all of them by a share [%], and those that are greater than a value."""

WAITING = ("UALM", "ARC")
"""Instructions that take time: until a person has reset an alarm, and until an arc burns."""

QUIET = frozenset(
    (
        *("DO", "RO", "GO", "AO", "SO", "UO", "F", "M", "TIMER", "SR", "PR", "PAYLOAD", "MESSAGE"),
        *("UALM", "SKIP", "OFFSET", "TOOL_OFFSET", "ARC", "COL", "LOCK", "UNLOCK", "TC_ONLINE"),
        *(OVERRIDE, *LARGEST_SPEEDS),
    )
)
"""Instructions that move nothing. Conditions of offsets and skips count only in motions that name them."""

DECIDING = ("P", "R", "UFRAME", "UTOOL", "UFRAME_NUM", "UTOOL_NUM")
"""What decides where motions go: a line that changes it is never left out. `$MNU…` are frames and tools too."""
