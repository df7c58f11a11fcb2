"""Files of waivers: a YAML list of who lets which bodies come how near. Not for: judging by them (`findings`)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from datetime import date, datetime
from pathlib import Path
from typing import Annotated

from pydantic import BeforeValidator, Field

from clearance.errors import BadWaiver, at
from clearance.formats.files.input_files import InputFiles
from clearance.formats.schema.case import TwoPatterns
from clearance.formats.schema.strict_model import Level, Name, StrictModel, validated
from clearance.plain_yaml import parse_yaml
from clearance.world.case import Case
from clearance.world.rules import Waiver

MOST_WAIVERS = 10_000
"""In one file."""

Line = Annotated[str, Field(min_length=1, max_length=500)]


def day_of(given: object) -> date:
    """The day that a date, or its text as 2027-03-31, is.

    Raises:
        BadInput: no day.
    """
    if isinstance(given, date) and not isinstance(given, datetime):
        return given
    try:
        return date.fromisoformat(given if isinstance(given, str) else "")
    except ValueError:
        raise BadWaiver(f"{given!s:.40} is given", valid="a day, as 2027-03-31") from None


class _Row(StrictModel):
    """One waiver."""

    case: Name = "*"
    between: TwoPatterns
    rule: Name = "*"
    at_least: Level
    reason: Line
    by: Line
    until: Annotated[date, BeforeValidator(day_of)]


class _Rows(StrictModel):
    waivers: Annotated[list[_Row], Field(max_length=MOST_WAIVERS)]


def load_waivers(path: str | Path) -> tuple[Waiver, ...]:
    """The waivers in a file.

    Raises:
        BadInput: what was wrong, in which file and row, and what would be valid.
    """
    path = Path(path)
    return waivers_of(InputFiles(path.parent), path)


def waivers_of(files: InputFiles, path: Path) -> tuple[Waiver, ...]:
    """The waivers in one of the files of a case."""
    shown = files.shown(path)
    raw = parse_yaml(files.read(path), shown)
    if not isinstance(raw, list):
        raise BadWaiver(
            "no list of waivers", where=shown, valid="- {between: [a, b], at_least: 0.002, …}"
        )
    rows = validated(_Rows, {"waivers": raw}, shown).waivers
    return tuple(_waiver(row, shown, i) for i, row in enumerate(rows))


def with_waivers(case: Case, paths: Sequence[Path]) -> Case:
    """The case with the waivers of more files, which are then among its inputs.

    Raises:
        BadInput: with the file and the row.
    """
    if not paths:
        return case
    found, sources = list(case.waivers), case.sources
    for path in paths:
        files = InputFiles(path.parent)
        found += waivers_of(files, path)
        sources = files.sources_beside(sources)
    return replace(case, waivers=tuple(found), sources=sources)


def _waiver(row: _Row, shown: str, place: int) -> Waiver:
    one, other = row.between
    where = f"{shown}: waivers[{place}]"
    with at(where):
        return Waiver(
            (one, other),
            at_least=row.at_least,
            reason=" ".join(row.reason.split()),
            by=" ".join(row.by.split()),
            until=row.until,
            case=row.case,
            rule=row.rule,
            where=where,
        )
