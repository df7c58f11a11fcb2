"""A run as Markdown, for the summary of a step or a comment on a change. Not for: the page (`page`).

What comes from files is written so that it stays text: each sign that Markdown or HTML could read is its number.
"""

from __future__ import annotations

import re
import string
from collections.abc import Sequence

from clearance.findings.comparison import Comparison
from clearance.findings.finding import Finding
from clearance.findings.finding_text import bodies_text, finding_line, waived_text, when_text
from clearance.findings.verdict import Verdict
from clearance.record.record import Record
from clearance.record.wording import count, limit_mm, mm
from clearance.report.comparison_text import comparison_text, doubt_lines, gone_text, since_text
from clearance.report.rules import name_shown

MOST_ROWS = 50
"""Most findings in the table."""

_SIGNS = {ord(sign): f"&#{ord(sign)};" for sign in string.punctuation if sign not in ",-/()'.:;%"}

_LINK_OR_LIST = re.compile(r"^[-+](?=\s)|(?<=^\d)[.)](?=\s)|:(?=\S)|(?i:(?<=www)\.)")
"""What is read as a link, an icon or a list only where it stands so."""


def plain(text: str) -> str:
    """A text that Markdown shows as it is, in one line."""
    shown = " ".join("".join(letter if letter.isprintable() else " " for letter in text).split())
    return _LINK_OR_LIST.sub(lambda sign: f"&#{ord(sign[0])};", shown.translate(_SIGNS))


def markdown(
    record: Record,
    verdict: Verdict,
    findings: Sequence[Finding],
    comparison: Comparison | None = None,
) -> str:
    """The verdict, why, and the findings that are not clear; with what became of them since a baseline."""
    lines = [f"### {plain(record.case.name)}: {plain(verdict.text(str.upper))}", ""]
    lines += [f"- {plain(text)}" for text in _told(verdict)]
    if comparison is not None:
        lines += [f"- {plain(comparison_text(comparison))}"]
        lines += [f"- {plain(text)}" for text in doubt_lines(comparison)[:MOST_ROWS]]
        lines += [f"- {plain(gone_text(row))}" for row in comparison.rows if row.now is None][
            :MOST_ROWS
        ]
    shown = [finding for finding in findings if finding.status != "clear"]
    if shown:
        lines += ["", *_table(shown[:MOST_ROWS], comparison)]
    if len(shown) > MOST_ROWS:
        lines += ["", f"{count(len(shown) - MOST_ROWS, 'more finding')}."]
    if not shown:
        lines += [f"- kept: {plain(finding_line(finding))}" for finding in findings[:MOST_ROWS]]
    return "\n".join([*lines, ""]) + "\n"


def _told(verdict: Verdict) -> list[str]:
    """What stands beside the verdict: reasons, warnings, what is not checked."""
    told = [
        *verdict.reasons,
        *verdict.with_tolerances,
        *(f"warning: {text}" for text in verdict.warnings),
    ]
    return [*told, *verdict.scope]


def _table(findings: Sequence[Finding], comparison: Comparison | None) -> list[str]:
    since = (
        {} if comparison is None else {row.finding.id: row for row in comparison.rows if row.now}
    )
    heads = [
        "status",
        "rule",
        "between",
        "least, mm",
        "fail, mm",
        "certified, mm",
        "when",
        "waived",
    ]
    heads += ["since baseline"] if comparison else []
    rows = [heads, ["---"] * len(heads)]
    for one in findings:
        cells = [
            f"{one.status}, waived" if one.waived else one.status,
            name_shown(one.rule),
            bodies_text(one) or one.text or one.kind,
            _mm(one.clearance),
            limit_mm(one.fail),
            _mm(one.proven),
            when_text(one),
            waived_text(one),
        ]
        cells += [since_text(since.get(one.id))] if comparison else []
        rows.append([plain(cell) for cell in cells])
    return [f"| {' | '.join(row)} |" for row in rows]


def _mm(value: float | None) -> str:
    return "" if value is None else mm(value)
