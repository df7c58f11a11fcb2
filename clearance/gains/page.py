"""A gain as a page: both curves, what moved by how much, both worst moments, what is proven.

Not for: the sentences (`sentences`), nor the replays, which are in the reports beside it.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from clearance.gains.change_parts import (
    ChangePart,
    change_parts,
    joint_parts,
    proven_after,
    proven_bound,
)
from clearance.gains.result import Gain
from clearance.gains.sentences import is_hopeless, lines_of, signed_text, size_text
from clearance.record.wording import count, limit_mm, mm, moment_text, seconds
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
    number,
)
from clearance.report.curves import ClearanceCurve, chart_of, curve_of
from clearance.report.rendering import plain_page
from clearance.run import Run

NAMES = ("before", "after")


def page_of(gain: Gain, notes: Sequence[str] = (), *, with_reports: bool) -> str:
    """The whole page.

    Args:
        notes: on how the case was written. with_reports: those of before and after lie beside it.
    """
    sections = [
        Section("Clearance over time", _curves(gain)),
        Section("Changes", _moved(gain)),
        Section("Worst moments", [_worst_moments(gain)]),
        Section("Both motions", [_reports(gain) if with_reports else Paragraph(_NO_REPORTS)]),
        Section("Basis", [*map(faint, _notes(gain, notes))]),
    ]
    return plain_page(f"{gain.case.name}: {_badge(gain)}", _header(gain), sections, _chart(gain))


def _chart(gain: Gain) -> dict[str, Any]:
    runs = (gain.before, gain.after)
    curves = [motion_curve(name, run) for name, run in zip(NAMES, runs, strict=True)]
    fail = max(run.record.rule(run.verdict.worst.rule).limits.fail for run in runs)
    called = "with margin" if gain.request.margin else "fail"
    return chart_of(curves, fail + gain.request.margin, called)


def _header(gain: Gain) -> Header:
    lines = [
        f"{capital(label)}: {line}"
        for label, line in lines_of(gain)
        if label not in ("before", "after", "reached")
    ]
    return Header(
        f"Change of kind {gain.request.kind}",
        gain.case.name,
        _badge(gain),
        "clear" if gain.kept else "violated",
        [Bullets(lines, "beside")],
    )


def _badge(gain: Gain) -> str:
    if not gain.kept:
        return "not kept"
    if not gain.size:
        return "kept as it is"
    if gain.request.kind == "waypoints":
        return f"kept, {count(len(change_parts(gain)), 'joint')} changed"
    return f"kept, changed by {size_text(gain)}"


def _curves(gain: Gain) -> list[object]:
    margin = gain.request.margin
    line = f"the limit with the margin of {limit_mm(margin)} mm" if margin else "the limit"
    what = (
        "Least clearance at each step, and between steps where it is lower or steps are far apart in time; "
        f"the line is {line}."
    )
    return [Chart([*zip("ab", NAMES, strict=True)]), faint(what)]


def motion_curve(name: str, run: Run) -> ClearanceCurve:
    """The curve of a run, with the moments between its steps that are known."""
    steps, moments = curve_of(name, run.record.rows.columns), run.session.curve_moments()
    times = np.append(steps.times, [moment.time for moment in moments])
    clearances = np.append(steps.clearances, [moment.clearance for moment in moments])
    order = np.argsort(times, kind="stable")
    return ClearanceCurve(name, times[order], clearances[order])


def _moved(gain: Gain) -> list[object]:
    parts = change_parts(gain)
    if not parts or gain.size == 0.0:
        return [Paragraph("Nothing is changed.")]
    if gain.request.kind == "waypoints":
        return [_joints(parts)]
    rows = [Row([_what(gain, part), number(signed_text(part))]) for part in parts]
    if gain.request.kind != "timing":
        what = "length" if gain.request.turn is None else "size"
        rows.append(Row([what, number(size_text(gain))]))
    shifted = Table((f"{gain.who}", ">By"), rows)
    return [shifted] if gain.tool_path is None else [shifted, _joints(joint_parts(gain))]


def _joints(parts: Sequence[ChangePart]) -> Table:
    heads = ("Joint", ">Greatest offset", ">At", ">From", ">Until")
    return Table(heads, [_joint(part) for part in parts])


def _what(gain: Gain, part: ChangePart) -> str:
    if part.unit == "rad":
        return part.name
    if gain.request.slow_down:
        return "takes longer"
    return "begins later" if gain.request.kind == "timing" else f"along {part.name}"


def _joint(part: ChangePart) -> Row:
    times = [part.time, part.start, part.end]
    cells = [number(seconds(time)) for time in times if time is not None]
    return Row([part.name, number(signed_text(part)), *cells])


def _worst_moments(gain: Gain) -> Table:
    proven = (proven_bound(gain.before), proven_after(gain))
    runs = (gain.before, gain.after)
    rows = [_worst(*one) for one in zip(NAMES, runs, proven, strict=True)]
    heads = (
        "Run", ">Clearance, mm", ">Fail below, mm", "Between", "When", "Verdict", ">Proven, mm"
    )  # fmt: skip
    return Table(heads, rows, "findings")


def _worst(name: str, run: Run, proven: float | None) -> Row:
    worst = run.verdict.worst
    fail = run.record.rule(worst.rule).limits.fail
    cells: list[Content | Cell] = [
        name,
        number("contact" if worst.touches else mm(worst.clearance)),
        number(limit_mm(fail)),
        Cell(f"{worst.link} and {worst.obstacle}", "wide"),
        Cell(moment_text(run.record, worst), "wide"),
        Inline(run.status, f"tag {run.status}"),
        number("" if proven is None else mm(proven)),
    ]
    return Row(cells)


def _reports(gain: Gain) -> Bullets:
    both = " of both motions" if gain.size > 0.0 else ""
    links = [
        Inline(f"the report {name}, with its replay{what}", href=f"{name}/report.html")
        for name, what in zip(NAMES, ("", both), strict=True)
    ]
    return Bullets(links, "beside")


_NO_REPORTS = "The reports with the replays are left out: what draws them is not installed here."


def _of_bound(gain: Gain) -> str:
    if is_hopeless(gain):
        return "Proven: no change of this kind is enough."
    if gain.clearances_kept and gain.size == 0.0:
        return f"Proven: every {'rule' if gain.kept else 'clearance'} holds without a change."
    if gain.lower_bound <= 0.0:
        return "The search is local: smaller changes are not excluded."
    return "The bound is proven. The search is local: smaller changes, down to the bound, are not excluded."


def _notes(gain: Gain, notes: Sequence[str]) -> list[str]:
    named = "the best that was reached, which does not keep every rule"
    if gain.clearances_kept:
        named = "the changed case" if gain.kept else "the changed case, which is not passed"
    files = f"case.yaml is {named}, with the limits of the one that it is from; gain.json has all figures."
    return [_of_bound(gain), files, *notes]
