"""A record in a line, and in the few lines that a notebook shows. Not for: the page (`page`)."""

from __future__ import annotations

from collections.abc import Sequence

from markupsafe import Markup

from clearance.findings.verdict import Verdict
from clearance.record.record import PairMinimum, Record
from clearance.record.wording import depth_text, limits_text, mm, moment_text, step_text
from clearance.report.contact import HEADS
from clearance.report.markup import element, table

MOST_PAIRS = 5
"""Nearest pairs that a notebook shows."""


def run_text(record: Record, verdict: Verdict) -> str:
    """Name, verdict, least clearance, who and when, in one line."""
    return f"{record.case.name}: {verdict.text()}, {_worst(record)}"


def run_html(record: Record, verdict: Verdict, nearest: Sequence[PairMinimum]) -> str:
    """The same with what must be known beside it, and the closest pairs as a table."""
    limits = record.rule(record.worst.rule).limits
    told = limits_text(limits.fail, limits.warn)
    beside = [f"nearest of all {verdict.nearest}"] if verdict.nearest else []
    beside += verdict.with_tolerances
    beside += verdict.scope
    beside += [f"suspect {one.kind}: {one.text}" for one in verdict.suspects] + list(
        verdict.warnings
    )
    several = bool(record.case.limits.rules)
    return element(
        "div",
        element(
            "p",
            element("strong", f"{record.case.name}: {verdict.text()}"),
            f", {_worst(record)} ({told})",
        ),
        element("ul", *[element("li", line) for line in beside]),
        table(
            (*HEADS[record.sides[0]], ">mm", ">Step", ">s", *(["Rule"] if several else [])),
            [_row(p, several=several) for p in nearest],
        ),
    )


def _worst(record: Record) -> str:
    worst = record.worst
    by = f" (rule {worst.rule!r})" if record.case.limits.rules else ""
    near = depth_text(worst.depth) if worst.touches else f"{mm(worst.clearance)} mm"
    return f"{near}{by}, {worst.link} - {worst.obstacle} at {moment_text(worst)}"


def _row(pair: PairMinimum, *, several: bool) -> Markup:
    cells = [pair.link, pair.obstacle, mm(pair.clearance), step_text(pair), f"{pair.time:.3f}"]
    cells += [pair.rule] if several else []
    return element("tr", *[element("td", cell) for cell in cells])
