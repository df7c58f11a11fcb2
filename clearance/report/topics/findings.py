"""The findings of a run as tables, each row a way to its moment, with what became of each since a baseline.

Not for: finding them (room `findings`), nor the file that holds all (`findings.findings_file`).
"""

from __future__ import annotations

from collections.abc import Iterator

from clearance.findings.comparison import ComparedFinding, Comparison
from clearance.findings.finding import Finding
from clearance.findings.finding_text import stretch_text, waived_text, when_text, who_text
from clearance.record.wording import count, limit_mm, mm, near_mm
from clearance.report.blocks import (
    At,
    Bullets,
    Cell,
    Content,
    Inline,
    Paragraph,
    Row,
    Section,
    Table,
    capital,
    faint,
    number,
)
from clearance.report.comparison_text import comparison_text, doubt_lines, gone_text, since_text
from clearance.report.model import PageContent
from clearance.report.moment import name_shown
from clearance.report.topic import Topic

MOST_ROWS = 200
"""Most findings printed on the page; findings.json has all."""

HEADS = (
    "Status", "Rule", "Between", ">Least, mm", ">Fail, mm", ">Certified, mm", "When", "From - until",
)  # fmt: skip


def sections(content: PageContent) -> Iterator[Section]:
    """The findings; with a column of what became of each since a baseline, if there is one."""
    found, comparison = content.findings, content.comparison
    if not found:
        return
    since = rows_of_now(comparison)
    compared = ["Since baseline"] if comparison else []
    rows = [_row(one, since.get(one.id), bool(compared)) for one in found[:MOST_ROWS]]
    table = Table((*HEADS, *compared, "Waived", "Name"), rows, "clickable findings", tall=True)
    before = [] if comparison is None else [*_since(comparison)]
    yield Section("Findings", [*before, table, *map(faint, _notes(content))])


def rows_of_now(comparison: Comparison | None) -> dict[str, ComparedFinding]:
    """What became of each finding of now, by its name; nothing without a comparison."""
    rows = () if comparison is None else comparison.rows
    return {row.finding.id: row for row in rows if row.now}


def _notes(content: PageContent) -> Iterator[str]:
    found = content.findings
    yield (
        "A pair that breaks a rule has a row for every time it does; a rule that is kept has its nearest pair."
    )
    if content.may_lack:
        yield f"Other pairs may break their limits too: {content.may_lack}."
    if len(found) > MOST_ROWS:
        yield f"{count(len(found) - MOST_ROWS, 'more finding')} in findings.json."


def _since(comparison: Comparison) -> Iterator[Paragraph | Bullets]:
    """What became of the findings of the baseline; those that this run has not, as a list."""
    yield Paragraph(f"{capital(comparison_text(comparison))}.")
    lines = doubt_lines(comparison)
    lines += [gone_text(row) for row in comparison.rows if row.now is None]
    if lines:
        yield Bullets(lines[:MOST_ROWS], "beside")


def _row(finding: Finding, since: ComparedFinding | None, compared: bool) -> Row:
    rule = f"profile {finding.rule}" if finding.kind == "profile" else name_shown(finding.rule)
    who = who_text(finding)
    cells: list[Content | Cell] = [
        Inline(finding.status, f"tag {finding.status}"),
        rule,
        f"not proven {who}" if finding.kind == "unproven" else who,
        *map(number, figures(finding)),
        when_text(finding),
        stretch_text(finding),
        *([since_text(since)] if compared else []),
        Cell(waived_text(finding), "wide" if finding.waived else ""),
        Inline(f"{finding.id} {finding.code}", element="code"),
    ]
    if finding.step is None:
        return Row(cells)
    return Row(cells, At(finding.step, finding.time if finding.between else None))


def figures(finding: Finding) -> list[str]:
    """The clearance, the fail limit and what is proven, in millimetres."""
    near = "" if finding.clearance is None else near_mm(finding.clearance, finding.status)
    proven = "" if finding.proven is None else mm(finding.proven)
    return [near, limit_mm(finding.fail), proven]


TOPIC: Topic = Topic(sections=sections)
