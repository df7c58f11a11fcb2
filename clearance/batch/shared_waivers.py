"""Waivers that cases share, all of a batch or those of one cell: which of them should go.

Not for: what they waive in a case (`findings.judgement`).
"""

from __future__ import annotations

from collections.abc import Collection, Iterable, Sequence
from contextlib import suppress
from dataclasses import replace
from datetime import date

from clearance.batch.item import Item
from clearance.case.case_file import load_cell, waivers_of_cell
from clearance.errors import ClearanceError, nearest_name
from clearance.findings.judgement import unknown_among
from clearance.world.rules import Waiver, matches


def as_shared(waivers: Iterable[Waiver]) -> tuple[Waiver, ...]:
    """The waivers, such that no case fails because only others need them."""
    return tuple(replace(waiver, shared=True) for waiver in waivers)


def any_of_cells(items: Sequence[Item]) -> bool:
    """True if a cell names waivers, which its motions share."""
    return any(waivers_of_cell(file) for file in _cells(items))


def _cells(items: Iterable[Item]) -> list[str]:
    """The files of cells, in the order in which the cases come to them."""
    return list(dict.fromkeys(item.file for item in items if item.trajectory is not None))


def _of_cell(items: Iterable[Item], file: str) -> list[Item]:
    """The motions in a cell."""
    return [item for item in items if item.trajectory is not None and item.file == file]


def failing_waivers_of_cells(
    items: Sequence[Item], needed: Iterable[Collection[str]]
) -> tuple[set[str], list[str]]:
    """The shared waivers that some case needs, as texts, and why those that cells name fail a batch of which all
    cases are answered, by `failing_waivers`.

    Args:
        needed: of each item, the shared waivers that it needs, as texts.
    """
    among: dict[str | None, set[str]] = {}
    for item, own in zip(items, needed, strict=True):
        cell = None if item.trajectory is None else item.file
        among.setdefault(cell, set()).update(own)
    complaints: list[str] = []
    for file in _cells(items):
        given = as_shared(waivers_of_cell(file))
        if given:
            own_items = _of_cell(items, file)
            complaints += failing_waivers(own_items, given, among[file], own_items[0].options.day)
    return set().union(*among.values()), list(dict.fromkeys(complaints))


def failing_waivers(
    items: Sequence[Item], given: Iterable[Waiver], needed: set[str], today: date | None
) -> tuple[str, ...]:
    """Why waivers fail a batch of which all cases are answered, one line each: expired, or no case needs them.

    Args:
        needed: those that a case needs, as texts.
        today: the day that they are held against; None where none is given.
    """
    complaints = []
    for waiver in given:
        if expired := _expired(waiver, today):
            complaints.append(expired)
        elif str(waiver) not in needed:
            complaints.append(f"{waiver} is not needed: {_why_not(items, waiver)}")
    return tuple(complaints)


def expired_waivers(items: Sequence[Item], given: Iterable[Waiver]) -> tuple[str, ...]:
    """Of the waivers that cells name, and of those given beside, why the expired ones fail a batch, one line each;
    a cell that cannot be read fails its cases by itself.
    """
    complaints = []
    for file in _cells(items):
        with suppress(ClearanceError):
            day = _of_cell(items, file)[0].options.day
            complaints += [_expired(waiver, day) for waiver in waivers_of_cell(file)]
    last = items[0].options.day if items else None
    complaints += [_expired(waiver, last) for waiver in given]
    return tuple(dict.fromkeys(line for line in complaints if line))


def _expired(waiver: Waiver, today: date | None) -> str:
    gone = today is not None and waiver.is_expired(today)
    return f"{waiver} has expired on {waiver.until}" if gone else ""


def _why_not(items: Sequence[Item], waiver: Waiver) -> str:
    names = [item.name for item in items]
    if all(item.trajectory for item in items) and not any(matches(n, waiver.case) for n in names):
        return f"no case is called {waiver.case!r}; {nearest_name(waiver.case, names)}"
    return _unknown_name(items, waiver) or (
        "in every case its pairs keep their limits without it, are not there, or a later waiver covers them"
    )


def _unknown_name(items: Sequence[Item], waiver: Waiver) -> str:
    """What a waiver names that no cell has, with the nearest name; empty where one has all, and where a case is a
    file of its own, whose names are not asked for.
    """
    if not all(item.trajectory for item in items):
        return ""
    try:
        cells = [load_cell(file).case for file in dict.fromkeys(item.file for item in items)]
    except ClearanceError:  # it was changed since its cases were measured
        return ""
    rules = dict.fromkeys(name for cell in cells for name in cell.limits.rule_names)
    return unknown_among(cells, [*rules], waiver)
