"""Waivers that cases share, all of a batch or those of one cell: which of them should go.

Not for: what they waive in a case (`findings.judgement`).
"""

from __future__ import annotations

from collections.abc import Collection, Iterable, Sequence
from dataclasses import replace
from datetime import date

from clearance.batch.item import Item
from clearance.errors import nearest_name
from clearance.load.case_file import waivers_of_cell
from clearance.world.rules import matches
from clearance.world.waiver import Waiver


def as_shared(waivers: Iterable[Waiver]) -> tuple[Waiver, ...]:
    """The waivers, such that no case fails because only others need them."""
    return tuple(replace(waiver, shared=True) for waiver in waivers)


def stale_waivers_of_cells(items: Sequence[Item], needed: Sequence[Collection[str]]) -> list[str]:
    """Why the waivers that cells name fail a batch of which all cases are answered, as `stale_waivers` tells.

    Args:
        needed: of each item, the shared waivers that it needs, as texts.
    """
    of_cell: dict[str, list[int]] = {}
    for i, item in enumerate(items):
        if item.trajectory is not None:
            of_cell.setdefault(item.file, []).append(i)
    told: list[str] = []
    for file, own in of_cell.items():
        given = as_shared(waivers_of_cell(file))
        among = {waiver for i in own for waiver in needed[i]}
        told += stale_waivers([items[i] for i in own], given, among, items[own[0]].options.day)
    return list(dict.fromkeys(told))


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
