"""Two batches side by side, for a person at a terminal. Not for: comparing (`batch.compared`)."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

import click

from clearance.batch.compared import BatchComparison, ComparedCase
from clearance.errors import shown
from clearance.findings.comparison import ComparedFinding, FindingChange
from clearance.record.wording import count
from clearance.report.comparison_text import comparison_cells, doubt_lines

MOST_ROWS = 20
"""Lines of a kind that are told in a terminal."""


def print_batch_comparison(found: BatchComparison) -> None:
    """What became of cases and findings, on stdout: what alarms first."""
    click.echo(f"  since the baseline: {_headline(found)}")
    _print([f"waivers: {line}" for line in found.stale])
    _print(_doubts(found))
    alone = [one for one in found.cases if one.comparison is None]
    _print(f"{one.name}: {one.why}" for one in sorted(alone, key=lambda one: not one.alarms))
    _print(_rows(found))


def _headline(found: BatchComparison) -> str:
    told = []
    if found.failing:
        told.append(f"NEW, WORSE OR LESS KNOWN in {count(len(found.failing), 'case')}")
    if found.stale:
        told.append("NEW stale waiver")
    findings = ", ".join(f"{n:,} {change}" for change, n in found.counts.items())
    told.append(f"{count(len(found.cases), 'case')}: {findings or 'no finding to compare'}")
    return "; ".join(told)


def _print(lines: Iterable[str]) -> None:
    lines = [*lines]
    for line in lines[:MOST_ROWS]:
        click.echo(shown(f"  {line}"))
    if len(lines) > MOST_ROWS:
        click.echo(f"  and {len(lines) - MOST_ROWS:,} more")


def _doubts(found: BatchComparison) -> Iterator[str]:
    """What stands beside the findings, once for all cases that share it."""
    whose: dict[str, list[str]] = {}
    for one in found.cases:
        for line in doubt_lines(one.comparison) if one.comparison is not None else ():
            whose.setdefault(line, []).append(one.name)
    for line, names in whose.items():
        more = f" and {len(names) - 1:,} more" if len(names) > 1 else ""
        yield f"{line} ({names[0]}{more})"


def _rows(found: BatchComparison) -> Iterator[str]:
    """The findings that changed: those that alarm, then by change, then in the order of cases."""
    order = list(FindingChange)
    rows = [
        (one, row)
        for one in found.cases
        if one.comparison is not None
        for row in one.comparison.rows
        if row.change is not FindingChange.UNCHANGED
    ]
    rows.sort(key=lambda pair: (not pair[1].alarms, order.index(pair[1].change)))
    return (_row(one, row) for one, row in rows)


def _row(one: ComparedCase, row: ComparedFinding) -> str:
    change, before, now, was, is_now, rule, who, why = comparison_cells(row)
    stood = f"{before or 'nothing'}{f' {was} mm' if was else ''}"
    stands = f"{now or 'nothing'}{f' {is_now} mm' if is_now else ''}"
    because = f" ({why})" if why else ""
    return f"{change:<14}  {one.name}: {who}: {stood} -> {stands}, {rule}{because}"
