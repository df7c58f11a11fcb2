"""Waivers that all cases of a batch share: which of them should go.

Not for: what they waive in a case (`findings.judgement`).
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from datetime import date

from clearance.batch.item import Item
from clearance.errors import nearest_name
from clearance.world.rules import matches
from clearance.world.waiver import Waiver


def stale_waivers(
    items: Sequence[Item], given: Iterable[Waiver], needed: set[str], today: date | None
) -> tuple[str, ...]:
    """Why waivers fail a batch of which all cases are answered, one line each: expired, or no case needs them.

    Args:
        needed: those that a case needs, as texts.
        today: the day that they are held against; None where none is given.
    """
    told = []
    for waiver in given:
        if today is not None and waiver.is_expired(today):
            told.append(f"{waiver} has expired on {waiver.until}")
        elif str(waiver) not in needed:
            told.append(f"{waiver} is not needed: {_why_not(items, waiver)}")
    return tuple(told)


def _why_not(items: Sequence[Item], waiver: Waiver) -> str:
    names = [item.name for item in items]
    if all(item.trajectory for item in items) and not any(matches(n, waiver.case) for n in names):
        return f"no case is called {waiver.case!r}; {nearest_name(waiver.case, names)}"
    return (
        "what it is of keeps to its rule in all cases, or is not there, or a later waiver is of it"
    )
