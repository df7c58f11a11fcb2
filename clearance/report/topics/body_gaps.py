"""Gaps between what moves and what else there is, held against the widths that parts of a person need: no verdict.

In a gap as wide as its width here a part of a person is not caught, nor in one that it cannot enter. Who can get
where is not known here, so no verdict follows. Not for: limits of the case (`rules`).

Source: ISO 13854, minimum gaps, as the page of AUVA (app.auva.at) gives them; the standard itself was not read.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any

from clearance.record.record import PairMinimum
from clearance.record.wording import count, limit_mm, mm
from clearance.report.blocks import At, Paragraph, Row, Section, Table, faint, number
from clearance.report.model import PageContent, ReportModel
from clearance.report.moment import step_link, time_of
from clearance.report.topic import Line, Topic, labelled

WIDTHS = {
    "body": 0.5,
    "head": 0.3,
    "leg": 0.18,
    "foot": 0.12,
    "arm": 0.12,
    "hand": 0.1,
    "toes": 0.05,
    "finger": 0.025,
}
"""[m] The least gap in which each part of a person is not caught, the greatest first."""

SOURCE = "widths of ISO 13854 as AUVA (app.auva.at) gives them"

MOST_LINES, MOST_ROWS = 4, 200


def data(model: ReportModel) -> dict[str, Any]:
    """The gaps, where they are asked for."""
    return {"body_gaps": _found(model)} if model.record.body_gaps else {}


def _found(model: ReportModel) -> list[dict[str, Any]]:
    return body_gaps_of(model.session.motion_minima(), model.session.standing_bodies)


def body_gaps_of(minima: Sequence[PairMinimum], standing: frozenset[str]) -> list[dict[str, Any]]:
    """The least gap [m] of each pair that is below the widest of `WIDTHS`, the narrowest first, and which parts it
    is too narrow for. Pairs of which neither body moves are left out.
    """
    return [
        {
            "body_a": one.link,
            "body_b": one.obstacle,
            "gap": one.clearance,
            "step": one.step,
            "time": one.time,
            "may_catch": [part for part, width in WIDTHS.items() if one.clearance < width],
        }
        for one in minima
        if one.clearance < max(WIDTHS.values())
        and not (one.link in standing and one.obstacle in standing)
    ]


def lines(model: ReportModel) -> Iterator[Line]:
    """The narrowest of them, and where the widths are from."""
    if model.record.body_gaps:
        yield from labelled("body gaps", gap_lines(_found(model)))


def gap_lines(found: Sequence[dict[str, Any]]) -> Iterator[str]:
    """The narrowest of some gaps, and where the widths are from."""
    for one in found[:MOST_LINES]:
        where = f"{one['body_a']} - {one['body_b']} at step {one['step']}"
        yield f"{mm(one['gap'])} mm may catch {_parts(one)}: {where}"
    more = len(found) - MOST_LINES
    before = f"{count(more, 'more pair')}; " if more > 0 else ""
    before += "" if found else f"none below {limit_mm(max(WIDTHS.values()))} mm; "
    yield f"{before}{SOURCE}; no verdict depends on it"


def _parts(gap: dict[str, Any]) -> str:
    caught = gap["may_catch"]
    return "any part" if len(caught) == len(WIDTHS) else ", ".join(caught)


def sections(content: PageContent) -> Iterator[Section]:
    """The gaps as a table; nothing where they were not asked for."""
    found = content.summary.get("body_gaps")
    if found is None:
        return
    widths = ", ".join(f"{part} {limit_mm(width)} mm" for part, width in WIDTHS.items())
    note = (
        "Information, no verdict: it is not known who can get there, nor which gaps are too narrow to enter. "
        "One body of each pair moves at least. The gap is the least at the steps, less padding. "
        f"Widths by the {SOURCE}: {widths}."
    )
    rows = [_row(one) for one in found[:MOST_ROWS]]
    heads = ("Between", ">Gap, mm", "When", "May catch")
    none = Paragraph(f"No such gap is below {limit_mm(max(WIDTHS.values()))} mm.")
    body = Table(heads, rows, "clickable bodies", tall=len(rows) > 24) if rows else none
    more = len(found) - len(rows)
    notes = [f"{count(more, 'more pair')} in summary.json."] if more else []
    yield Section("Gaps that people may be caught in", [body, *map(faint, [*notes, note])])


def _row(gap: dict[str, Any]) -> Row:
    when = (f"{time_of(gap)}, ", step_link(gap["step"]))
    between = f"{gap['body_a']} - {gap['body_b']}"
    return Row([between, number(mm(gap["gap"])), when, _parts(gap)], At(gap["step"]))


TOPIC: Topic = Topic(data, lines, sections)
