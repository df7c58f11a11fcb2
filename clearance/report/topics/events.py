"""When limits are entered and left, and for how long a run is below each."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import asdict
from typing import Any

from clearance.record.row_status import status_counts
from clearance.record.wording import count, mm, seconds, span_text
from clearance.report.blocks import Cell, Content, Paragraph, Row, Section, Table, faint, number
from clearance.report.model import PageContent, ReportModel
from clearance.report.moment import at_moment, name_shown
from clearance.report.topic import Line, Topic

MOST_ROWS, MOST_INTERVALS = 200, 4
"""Most events on the page, all of which are in `summary.json`, and most intervals of a level in a terminal."""

LEVELS = {"contact": "contact", "below_fail": "below fail", "below_warn": "below warn"}


def data(model: ReportModel) -> dict[str, Any]:
    """Steps of each status, intervals and events."""
    session = model.session
    return {
        "status_counts": status_counts(model.record),
        "intervals": {
            level: [asdict(one) for one in found] for level, found in session.intervals.items()
        },
        "events": [asdict(event) for event in session.events],
        "not_listed": session.not_listed,
    }


def lines(model: ReportModel) -> Iterator[Line]:
    """The stretches below each level."""
    if model.record.need == "minimum":
        return
    for level, label in LEVELS.items():
        yield label, _intervals(model, level)


def _intervals(model: ReportModel, level: str) -> str:
    found, moves = model.session.intervals[level], model.record.moves
    if not found:
        n_samples = count(model.record.rows.n_rows, "sample")
        return f"not at the {n_samples}" if model.record.basis == "samples" else "never"
    n_intervals, n_steps = model.session.extent(level)
    times = [
        span_text(part.start, part.end, moves.over(part.start, part.end))
        for part in found[:MOST_INTERVALS]
    ]
    more = n_intervals - len(times)
    what = count(n_steps, "step") if n_steps else "between the steps"
    return f"{what}: {', '.join(times)}{f' and {more} more' if more else ''}"


def sections(content: PageContent) -> Iterator[Section]:
    """The events, as a table."""
    summary = content.summary
    alike = [*_alike(summary)]
    found = [event for event in summary["events"] if event["what"] not in alike]
    if not found:
        where = "at any moment" if summary["certified"] else "at any step"
        yield Section("Events", [Paragraph(f"No limit was entered {where}.")])
        return
    several = len(summary["rules"]) > 1
    rows = [Row([*_cells(event, several=several)], at_moment(event)) for event in found[:MOST_ROWS]]
    heads = [
        ">Time",
        ">Step",
        *(["Move"] * ("move" in found[0])),
        "What",
        ">mm",
        ">Least, mm",
        "Between",
        *(["Rule"] * several),
    ]
    notes = [faint(text) for text in _notes(summary, len(found) - len(rows))]
    yield Section("Events", [Table(heads, rows, "clickable", tall=True), *notes])


def _alike(summary: dict[str, Any]) -> Iterator[str]:
    """What enters or leaves a limit that nobody gave: warn as fail, or fail as contact."""
    limits, spans = summary["limits"], summary["intervals"]
    if limits["warn"] == limits["fail"] and spans["below_warn"] == spans["below_fail"]:
        yield from ("warn limit entered", "warn limit left")
    if limits["fail"] == 0.0 and spans["below_fail"] == spans["contact"]:
        yield from ("fail limit entered", "fail limit left")


def _notes(summary: dict[str, Any], more: int) -> Iterator[str]:
    unlisted = summary["not_listed"]["events"]
    if more:
        yield f"{count(more, 'more event')} in summary.json."
    if unlisted:
        yield f"{count(unlisted, 'more event')} follow from the status in steps.csv."
    if any(event["between"] for event in summary["events"]):
        yield (
            "A step with + is the one before a moment between two steps. A limit is proven not to be entered "
            "before that time, but may be entered a little later; mm is the clearance at the time shown."
        )


def _cells(event: dict[str, Any], *, several: bool) -> Iterator[Content | Cell]:
    yield number(seconds(event["time"]))
    yield number(f"{event['step']:,}{'+' if event['between'] else ''}")
    if "move" in event:
        yield event["move"]
    yield event["what"]
    unknown = event["clearance"] is None
    yield number("" if unknown else mm(event["clearance"]))
    yield number("" if event["least"] is None else mm(event["least"]))
    yield "not measured further" if unknown else f"{event['link']} - {event['obstacle']}"
    if several:
        yield name_shown(event["rule"])


TOPIC: Topic = Topic(data, lines, sections)
