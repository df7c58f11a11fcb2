"""Parts that touch something as they are picked up or let go: hints, with the line that would excuse it.

A part stands on something before it is picked up, and fingers hold it before they carry it. That contact is real,
and it is meant. Not for: pairs that touch all the time (`standing`).
"""

from __future__ import annotations

import json
from dataclasses import dataclass

import numpy as np

from clearance.simulate.contact_phases import ContactsOfPhases
from clearance.simulate.contact_rows import ContactRows
from clearance.simulate.record import Record
from clearance.world.carry import Carry


@dataclass(frozen=True)
class HandlingHint:
    """A part that touches a body as it changes hands.

    Attributes:
        when: in words. start, end: [s] of the nearest steps around at which they do not touch; None where there is
            none.
    """

    part: str
    mate: str
    when: str
    start: float | None
    end: float | None

    @property
    def pair(self) -> frozenset[str]:
        """The names of the two."""
        return frozenset((self.part, self.mate))

    @property
    def line(self) -> str:
        """The line of the case file that excuses it."""
        told = [f"between: {json.dumps([self.part, self.mate], ensure_ascii=False)}"]
        told += [] if self.start is None else [f"from: {self.start!r}"]
        told += [] if self.end is None else [f"until: {self.end!r}"]
        return f"allow: [{{{', '.join(told)}}}]"

    def __str__(self) -> str:
        told = f"{self.part} touches {self.mate} when it is {self.when}"
        return f"{told}; where that is meant, add to the case: {self.line}"


def handling_hints(record: Record) -> list[HandlingHint]:
    """One hint for each stretch of contact of a part that it is picked up in or let go in, in order of time."""
    rows = record.contacts
    if not record.case.carries or not isinstance(rows, ContactRows | ContactsOfPhases):
        return []
    times = record.timeline.times
    found: dict[tuple[int, int], HandlingHint] = {}
    for time, carry, what in _changes(record):
        step = int(np.searchsorted(times, time))
        low, high = np.searchsorted(rows.steps, [step, step + 1])
        for i in range(low, high):
            names = rows[i].link, rows[i].obstacle
            if carry.part in names:
                touching = rows.steps[rows.pairs == rows.pairs[i]]
                first, last = _stretch(touching, step)
                mate = names[0] if names[1] == carry.part else names[1]
                start = float(times[first - 1]) if first > 0 else None
                end = float(times[last + 1]) if last + 1 < len(times) else None
                hint = HandlingHint(carry.part, mate, f"{what} at {time:g} s", start, end)
                found.setdefault((int(rows.pairs[i]), first), hint)
    return list(found.values())


def _changes(record: Record) -> list[tuple[float, Carry, str]]:
    """When [s] a part is picked up or let go within the run."""
    times = record.timeline.times
    found = [(c.window.start, c, f"picked up by {c.by}") for c in record.case.carries]
    found += [(c.window.end, c, f"let go by {c.by}") for c in record.case.carries]
    inside = [one for one in found if times[0] <= one[0] <= times[-1]]
    return sorted(inside, key=lambda one: one[0])


def _stretch(touching: np.ndarray, step: int) -> tuple[int, int]:
    """The first and the last of the steps in a row at which a pair touches, around one of them."""
    place = int(np.searchsorted(touching, step))
    breaks = np.flatnonzero(np.diff(touching) > 1)
    first = int(breaks[breaks < place][-1]) + 1 if (breaks < place).any() else 0
    last = int(breaks[breaks >= place][0]) if (breaks >= place).any() else len(touching) - 1
    return int(touching[first]), int(touching[last])
