"""A run in a line, and in the few lines that a notebook shows. Not for: the page (`page`)."""

from __future__ import annotations

from clearance.record.record import Record
from clearance.record.wording import depth_text, limits_text, mm, moment_text
from clearance.report.blocks import Bullets, Row, Table
from clearance.report.model import ReportModel
from clearance.report.moment import BODIES
from clearance.report.topics.pairs import MOST_LINES, pair_figures


def run_text(model: ReportModel) -> str:
    """Name, verdict, least clearance, who and when, in one line."""
    return f"{model.record.case.name}: {model.verdict.text()}, {_worst(model.record)}"


def run_html(model: ReportModel) -> str:
    """The same with what must be known beside it, and the closest pairs as a table."""
    from clearance.report.rendering import render

    record, verdict = model.record, model.verdict
    limits = record.rule(record.worst.rule).limits
    beside = [
        *([f"nearest of all {verdict.nearest}"] if verdict.nearest else []),
        *verdict.unproven_motion,
        *verdict.with_tolerances,
        *verdict.scope,
        *(f"suspect {one.kind}: {one.line}" for one in verdict.suspects),
        *verdict.warnings,
    ]
    several = bool(record.case.limits.rules)
    rows = [
        Row([pair.link, pair.obstacle, *pair_figures(pair), *([pair.rule] * several)])
        for pair in model.session.motion_minima(MOST_LINES)
    ]
    return render(
        "notebook.html",
        title=f"{record.case.name}: {verdict.text()}",
        worst=f", {_worst(record)} ({limits_text(limits.fail, limits.warn)})",
        beside=Bullets(beside),
        nearest=Table(
            (*BODIES[record.sides[0]], ">mm", ">Step", ">s", *(["Rule"] * several)), rows
        ),
    )


def _worst(record: Record) -> str:
    worst = record.worst
    by = f" (rule {worst.rule!r})" if record.case.limits.rules else ""
    near = depth_text(worst.depth) if worst.touches else f"{mm(worst.clearance)} mm"
    return f"{near}{by}, {worst.link} - {worst.obstacle} at {moment_text(record, worst)}"
