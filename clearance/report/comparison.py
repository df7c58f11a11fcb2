"""Two runs, or two batches, held against each other: in a terminal, and as a page of two runs side by side.

Not for: comparing (`findings.comparison`), nor its words (`comparison_text`).
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from pathlib import Path

from rich.console import Console
from rich.text import Text

from clearance.errors import shown
from clearance.files import write_file
from clearance.findings.comparison import (
    BatchComparison,
    ComparedCase,
    ComparedFinding,
    Comparison,
    FindingChange,
)
from clearance.record.wording import count
from clearance.report.blocks import (
    Bullets,
    Cell,
    Chart,
    Content,
    Header,
    Inline,
    Paragraph,
    Row,
    Section,
    Table,
    capital,
    faint,
)
from clearance.report.comparison_text import (
    HEADS,
    comparison_cells,
    comparison_text,
    doubt_lines,
)
from clearance.report.curves import AT_SAMPLES, ClearanceCurve, chart_of, curve_in
from clearance.report.rendering import plain_page
from clearance.report.terminal import terminal, terminal_table
from clearance.report.topic import TerminalTable

FILE_NAME = "comparison.html"

MOST_ROWS, MOST_LINES = 1000, 20
"""Most findings in the table of a page, and lines of a kind in a terminal."""


def write_comparison(comparison: Comparison, before: Path, now: Path, folder: Path) -> None:
    """Writes the page into a folder.

    Args:
        before, now: the report folders, for their curves, or their findings.json, which have none.

    Raises:
        BadInput: a damaged table of steps. Unwritable: there is no way to write there.
    """
    found = [curve_in(name, place) for name, place in (("A", before), ("B", now))]
    curves = [curve for curve in found if curve is not None]
    page = comparison_page(comparison, curves, (str(before), str(now)))
    write_file(folder / FILE_NAME, page.encode("utf-8"))


def comparison_page(
    comparison: Comparison, curves: Sequence[ClearanceCurve], names: tuple[str, str]
) -> str:
    """The whole page."""
    lines = [comparison_text(comparison), *doubt_lines(comparison)[:MOST_ROWS]]
    header = Header(
        "Clearance comparison",
        comparison.now,
        *_badge(comparison),
        [Bullets([*map(capital, lines)], "beside")],
    )
    content: list[object] = [
        Chart([(k.lower(), f"{k}: {n}") for k, n in zip("AB", names, strict=True)]),
        faint(AT_SAMPLES),
    ]
    fail = max((row.finding.fail for row in comparison.rows), default=0.0)
    chart = chart_of(curves, fail) if len(curves) == 2 else None
    if chart is None:
        without = (
            "Curves need two report folders, with their steps.parquet; findings.json has none."
        )
        content = [
            Bullets([f"{k}: {n}" for k, n in zip("AB", names, strict=True)]),
            Paragraph(without),
        ]
    sections = [Section("Clearance over time", content), Section("Findings", [*_table(comparison)])]
    return plain_page(f"{comparison.now}: compared", header, sections, chart)


def _badge(comparison: Comparison) -> tuple[str, str]:
    """The outcome in a few words, and the status whose colour it has: nothing is green that is worse."""
    if not comparison.passed:
        return "new, worse or less known", "violated"
    watched = (FindingChange.NEW, FindingChange.WORSE, FindingChange.NOT_COMPARABLE)
    counts = [f"{n} {what}" for what, n in comparison.counts.items() if what in watched]
    if counts:
        return f"passed: {', '.join(counts)}", "near"
    return "nothing is new or worse", "clear"


def _table(comparison: Comparison) -> Iterator[Table | Paragraph]:
    if not comparison.rows:
        yield Paragraph("Neither run has a finding that the other could have.")
        return
    heads = [f">{capital(head)}" if head.endswith("mm") else head.capitalize() for head in HEADS]
    yield Table(heads, [*map(_row, comparison.rows[:MOST_ROWS])], "findings")
    if len(comparison.rows) > MOST_ROWS:
        yield faint(f"{len(comparison.rows) - MOST_ROWS} more are not listed.")


def _row(row: ComparedFinding) -> Row:
    change, *statuses, least, is_now, rule, who, why = comparison_cells(row)
    first: Content = Inline(change, element="strong") if row.alarms else change
    tags = [
        Inline(status, f"tag {status.partition(',')[0]}") if status else "" for status in statuses
    ]
    figures = [Cell(text, "number") for text in (least, is_now)]
    cells = [first, *tags, *figures, rule, who, why]
    return Row(cells, kind="faint" if row.change is FindingChange.GONE else "")


def print_comparison(comparison: Comparison) -> None:
    """What became of the findings of a run, on stdout."""
    console = terminal()
    console.print(Text(f"  {comparison_text(comparison)}"), soft_wrap=True)
    lines = doubt_lines(comparison)
    for line in lines[:MOST_LINES]:
        console.print(Text(f"  {line}"), soft_wrap=True)
    if len(lines) > MOST_LINES:
        console.print(Text(f"  and {len(lines) - MOST_LINES} more lines"))
    rows = [row for row in comparison.rows if row.change is not FindingChange.UNCHANGED]
    if rows:
        heads = [f">{head}" if head.endswith("mm") else head for head in HEADS]
        console.print(
            terminal_table(TerminalTable(heads, [*map(comparison_cells, rows[:MOST_LINES])]))
        )
    if len(rows) > MOST_LINES:
        console.print(Text(f"  and {len(rows) - MOST_LINES} more"))


def print_batch_comparison(found: BatchComparison) -> None:
    """What became of cases and findings of a batch, on stdout: what alarms first."""
    _print([f"since the baseline: {_batch_verdict(found)}"])
    _print([f"waivers: {line}" for line in found.waiver_faults])
    _print(_shared_doubts(found))
    alone = [one for one in found.cases if one.comparison is None]
    _print(f"{one.name}: {one.why}" for one in sorted(alone, key=lambda one: not one.alarms))
    _print(_changed(found))


def _batch_verdict(found: BatchComparison) -> str:
    parts = []
    if found.failing:
        parts.append(f"NEW, WORSE OR LESS KNOWN in {count(len(found.failing), 'case')}")
    if found.waiver_faults:
        parts.append("NEW unused waiver")
    findings = ", ".join(f"{n:,} {change}" for change, n in found.counts.items())
    parts.append(f"{count(len(found.cases), 'case')}: {findings or 'no finding to compare'}")
    return "; ".join(parts)


def _print(lines: Iterable[str]) -> None:
    console: Console = terminal()
    lines = [*lines]
    shown_lines = [shown(f"  {line}") for line in lines[:MOST_LINES]]
    shown_lines += [f"  and {len(lines) - MOST_LINES:,} more"] if len(lines) > MOST_LINES else []
    for line in shown_lines:
        console.print(Text(line), soft_wrap=True, highlight=False)


def _shared_doubts(found: BatchComparison) -> Iterator[str]:
    """What stands beside the findings, once for all cases that share it."""
    whose: dict[str, list[str]] = {}
    for one in found.cases:
        for line in doubt_lines(one.comparison) if one.comparison is not None else ():
            whose.setdefault(line, []).append(one.name)
    for line, names in whose.items():
        more = f" and {len(names) - 1:,} more" if len(names) > 1 else ""
        yield f"{line} ({names[0]}{more})"


def _changed(found: BatchComparison) -> Iterator[str]:
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
    return (_changed_line(one, row) for one, row in rows)


def _changed_line(one: ComparedCase, row: ComparedFinding) -> str:
    change, before, now, was, is_now, rule, who, why = comparison_cells(row, " mm")
    stood, stands = _standing_text(before, was), _standing_text(now, is_now)
    because = f" ({why})" if why else ""
    return f"{change:<14}  {one.name}: {who}: {stood} -> {stands}, {rule}{because}"


def _standing_text(status: str, least: str) -> str:
    """A status and the least clearance; contact is said once."""
    return " ".join(dict.fromkeys(filter(None, (status or "nothing", least))))
