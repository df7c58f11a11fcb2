"""A run as Markdown, for the summary of a step or a comment on a change. Not for: the page (`page`).

What comes from files is written so that it stays text, and that it can be read where nobody renders it.
"""

from __future__ import annotations

import re
from collections.abc import Sequence

from clearance.findings.comparison import Comparison
from clearance.findings.finding import Finding
from clearance.findings.finding_text import finding_line, waived_text, when_text, who_text
from clearance.findings.verdict import Verdict
from clearance.record.wording import count
from clearance.report.comparison_text import comparison_text, doubt_lines, gone_text, since_text
from clearance.report.model import ReportModel
from clearance.report.moment import name_shown
from clearance.report.topics.findings import figures, rows_of_now

MOST_ROWS = 50
"""Most findings in the table."""

_MEANING = re.compile(
    r"""[\\`*~$<>|@]                                   # anywhere
    | (?<![^\W_])_ | _(?![^\W_])                       # but for those inside a word
    | \[(?!CL\d{3}\](?![(:\[])) | (?<!\[CL\d{3})\]      # but for codes, which are no links
    | \](?=[(:\[]) | &(?=\#?\w+;) | :(?=//) | (?i:(?<=www)\.)
    | ^(?:[-+](?=\s|$|-) | \#(?=\#*(?:\s|$)))""",
    re.VERBOSE,
)
"""The signs that Markdown, as GitHub reads it, or HTML would not show as they are."""


_NUMBER = re.compile(r"^(\d+)([.)])(?=\s|$)")
"""What begins an item of a list."""


def plain(text: str) -> str:
    """A text that Markdown shows as it is, in one line; each sign with a meaning has a backslash before it."""
    shown = " ".join("".join(letter if letter.isprintable() else " " for letter in text).split())
    return _NUMBER.sub(r"\1\\\2", _MEANING.sub(r"\\\g<0>", shown))


def refusal_markdown(name: str, text: str) -> str:
    """An error in place of a verdict."""
    return f"### {plain(name)}: ERROR\n\n- {plain(text)}\n"


def markdown(model: ReportModel, comparison: Comparison | None = None) -> str:
    """The verdict, why, and the findings that are not clear; with what became of them since a baseline."""
    verdict, findings = model.verdict, model.findings
    points = [*_verdict_lines(verdict)]
    if model.may_lack:
        points.append(f"other pairs may break their limits too: {model.may_lack}")
    if comparison is not None:
        gone = [gone_text(row) for row in comparison.rows if row.now is None]
        points += [
            comparison_text(comparison),
            *doubt_lines(comparison)[:MOST_ROWS],
            *gone[:MOST_ROWS],
        ]
    shown = [finding for finding in findings if finding.status != "clear"]
    if not shown:
        points += [f"limits kept: {finding_line(finding)}" for finding in findings[:MOST_ROWS]]
    lines = [f"### {plain(model.record.case.name)}: {plain(verdict.headline(str.upper))}", ""]
    lines += [f"- {plain(text)}" for text in points]
    if shown:
        lines += ["", *_table(shown[:MOST_ROWS], comparison)]
    if len(shown) > MOST_ROWS:
        lines += ["", f"{count(len(shown) - MOST_ROWS, 'more finding')}."]
    return "\n".join([*lines, ""]) + "\n"


def _verdict_lines(verdict: Verdict) -> list[str]:
    """What stands beside the verdict: reasons, other warnings, what is not checked."""
    lines = [
        *verdict.reasons,
        *verdict.with_tolerances,
        *(f"warning: {text}" for text in verdict.warnings if text not in verdict.warned),
    ]
    return [*lines, *verdict.scope]


HEADS = (
    "status", "rule", "between", "least, mm", "fail, mm", "certified, mm", "when", "waived"
)  # fmt: skip


def _table(findings: Sequence[Finding], comparison: Comparison | None) -> list[str]:
    since = rows_of_now(comparison)
    heads = [*HEADS, *(["since baseline"] if comparison else [])]
    rows = [heads, ["---"] * len(heads)]
    for one in findings:
        cells = [
            f"{one.status}, waived" if one.waived else one.status,
            name_shown(one.rule),
            who_text(one),
            *figures(one),
            when_text(one),
            waived_text(one),
            *([since_text(since.get(one.id))] if comparison else []),
        ]
        rows.append([plain(cell) for cell in cells])
    return [f"| {' | '.join(row)} |" for row in rows]
