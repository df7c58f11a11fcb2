"""The findings of a run on its page: a table, each row a way to its moment. Not for: finding them."""

from __future__ import annotations

from collections.abc import Sequence

from markupsafe import Markup

from clearance.findings.comparison import ComparedFinding, Comparison
from clearance.findings.finding import Finding
from clearance.findings.finding_text import bodies_text, stretch_text, waived_text, when_text
from clearance.record.wording import count, limit_mm, mm
from clearance.report.comparison_text import comparison_text, doubt_lines, gone_text, since_text
from clearance.report.markup import element, section, table
from clearance.report.rules import name_shown

MOST_ROWS = 200
"""Most findings printed on the page; findings.json has all."""

HEADS = (
    "Status",
    "Rule",
    "Between",
    ">Least, mm",
    ">Fail, mm",
    ">Certified, mm",
    "When",
    "From - until",
)


def findings(found: Sequence[Finding], comparison: Comparison | None = None) -> Markup:
    """The section; with a column of what became of each since a baseline, if there is one."""
    if not found:
        return Markup("")
    since = (
        {} if comparison is None else {row.finding.id: row for row in comparison.rows if row.now}
    )
    heads = [*HEADS, *(["Since baseline"] if comparison else []), "Waived", "Name"]
    rows = [_row(one, since.get(one.id), comparison is not None) for one in found[:MOST_ROWS]]
    notes = [element("p", text, class_="faint") for text in _notes(found)]
    told = [] if comparison is None else _since(comparison)
    return section(
        "Findings", *told, table(heads, rows, class_="clickable findings", tall=True), *notes
    )


def _notes(found: Sequence[Finding]) -> list[str]:
    told = [
        "Of each pair that breaks a rule, every time it does; of a rule that is kept, its nearest pair."
    ]
    more = len(found) - MOST_ROWS
    return told + ([f"{count(more, 'more finding')} in findings.json."] if more > 0 else [])


def _since(comparison: Comparison) -> list[Markup]:
    """What became of the findings of the baseline; those that this run has not, as a list."""
    text = comparison_text(comparison)
    return [element("p", f"{text[0].upper()}{text[1:]}."), *_beside(comparison)]


def _beside(comparison: Comparison) -> list[Markup]:
    """What stands beside the findings, and those that are gone."""
    lines = doubt_lines(comparison)
    lines += [gone_text(row) for row in comparison.rows if row.now is None]
    items = [element("li", line) for line in lines[:MOST_ROWS]]
    return [element("ul", *items, class_="beside")] if items else []


def _row(finding: Finding, since: ComparedFinding | None, compared: bool) -> Markup:
    figures = [_mm(finding.clearance), limit_mm(finding.fail), _mm(finding.proven)]
    who = bodies_text(finding) or finding.text or "no pair is near"
    cells = [
        element("td", element("span", finding.status, class_=f"tag {finding.status}")),
        element(
            "td",
            name_shown(finding.rule) if finding.kind != "profile" else f"profile {finding.rule}",
        ),
        element("td", who if finding.kind != "unproven" else f"not proven {who}"),
        *[element("td", figure, class_="number") for figure in figures],
        element("td", when_text(finding)),
        element("td", stretch_text(finding)),
        *([element("td", since_text(since))] if compared else []),
        element("td", waived_text(finding), class_="wide" if finding.waived else None),
        element("td", element("code", finding.id)),
    ]
    at: dict[str, object] = {}
    if finding.step is not None:
        at = {"data_step": finding.step, "tabindex": 0}
        at |= {"data_time": finding.time} if finding.between and finding.time is not None else {}
    return element("tr", *cells, **at)


def _mm(value: float | None) -> str:
    return "" if value is None else mm(value)
