"""A record in a line, and in the few lines that a notebook shows. Not for: the page (`page`)."""

from __future__ import annotations

from markupsafe import Markup

from clearance.report.markup import element, table
from clearance.report.verdict import verdict_of
from clearance.report.wording import limit_mm, mm, moment_text
from clearance.simulate.record import PairMinimum, Record

MOST_PAIRS = 5


def run_text(record: Record) -> str:
    """Name, verdict, least clearance, who and when, in one line."""
    return f"{record.case.name}: {verdict_of(record).text()}, {_worst(record)}"


def run_html(record: Record) -> str:
    """The same with what must be known beside it, and the closest pairs as a table."""
    verdict, limits = verdict_of(record), record.case.limits
    told = f"fail below {limit_mm(limits.fail)} mm, warn below {limit_mm(limits.warn)} mm"
    beside = [f"{name} not checked" for name in verdict.not_checked]
    beside += [f"suspect {one.kind}: {one.text}" for one in verdict.suspects] + list(
        verdict.warnings
    )
    return element(
        "div",
        element(
            "p",
            element("strong", f"{record.case.name}: {verdict.text()}"),
            f", {_worst(record)} ({told})",
        ),
        element("ul", *[element("li", line) for line in beside]),
        table(
            ("Link", "Obstacle", ">mm", ">Step", ">s"),
            [_row(p) for p in record.pair_minima[:MOST_PAIRS]],
        ),
    )


def _worst(record: Record) -> str:
    worst = record.worst
    return f"{mm(worst.clearance)} mm, {worst.link} - {worst.obstacle} at {moment_text(worst)}"


def _row(pair: PairMinimum) -> Markup:
    cells = (pair.link, pair.obstacle, mm(pair.clearance), pair.step, f"{pair.time:.3f}")
    return element("tr", *[element("td", cell) for cell in cells])
