"""Overlaps: the deepest of the run, and the deepest of every pair.

Not for: finding them (`simulate.answers.contact.contacts`).
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Sequence
from typing import Any

from clearance.record.contact import StepContact
from clearance.record.names import LINK_AND_OBSTACLE
from clearance.record.record import Record
from clearance.record.wording import contact_text, depth_mm, least_cm3, mm, volume_cm3
from clearance.report.blocks import At, Paragraph, Row, Section, Table, faint, number
from clearance.report.model import PageContent, ReportModel
from clearance.report.moment import BODIES, step_link, time_of
from clearance.report.topic import Line, Topic


def data(model: ReportModel) -> dict[str, Any]:
    """The deepest overlaps that are worked out."""
    return {"contact": contact_of(model.record)}


def contact_of(record: Record) -> dict[str, Any] | None:
    """The deepest overlap worked out of the run and of every pair, deepest first; None if there is none."""
    if record.deepest is None:
        return None
    by_pair: dict[tuple[str, str], StepContact] = {}
    n_steps = Counter((row.link, row.obstacle) for row in record.contacts)
    for row in record.worked_out:
        pair = (row.link, row.obstacle)
        if pair not in by_pair or row.penetration > by_pair[pair].penetration:
            by_pair[pair] = row
    deepest = sorted(by_pair.values(), key=lambda row: -row.penetration)
    pairs = [_contact_row(row) | {"n_steps": n_steps[row.link, row.obstacle]} for row in deepest]
    return {"deepest": _contact_row(record.deepest), "pairs": pairs}


def _contact_row(row: StepContact) -> dict[str, Any]:
    found = row.known
    assert found is not None, "only overlaps with a depth are listed"
    return {
        "step": row.step,
        "time": row.time,
        "link": row.link,
        "obstacle": row.obstacle,
        "penetration": found.penetration,
        "penetration_at_least": found.penetration_at_least,
        "exact": bool(found.exact[0]),
        "direction": found.direction.tolist(),
        "volume": found.volume,
        "volume_at_least": found.volume_at_least,
        "volume_exact": bool(found.exact[1]),
        "centroid": found.centroid.tolist(),
        "notes": list(found.notes),
    }


def lines(model: ReportModel) -> Iterator[Line]:
    """The deepest overlap: where, how deep, and the separation vector of the link."""
    found = contact_of(model.record)
    if found is None:
        return
    deepest = found["deepest"]
    pair = f"{deepest['link']} in {deepest['obstacle']}"
    text = f"at the steps: step {deepest['step']}, {pair}: {contact_text(deepest)}"
    of_link = model.record.sides[:2] == LINK_AND_OBSTACLE
    whose = "the link" if of_link else deepest["link"]
    yield "deepest", f"{text}; separation vector of {whose} ({_vector(deepest)}) mm"


def _vector(contact: dict[str, Any]) -> str:
    """The separation vector [mm]."""
    length = contact["penetration"] * 1000.0
    return ", ".join(f"{round(value * length, 2) + 0.0:.2f}" for value in contact["direction"])


def sections(content: PageContent) -> Iterator[Section]:
    """The deepest of every pair; nothing where there is no contact, one line where none was worked out."""
    summary = content.summary
    found = summary["contact"]
    if found is None:
        if summary["status_counts"]["contact"]:
            yield Section("Contact", [Paragraph(_NOT_WORKED_OUT)])
        return
    deepest = found["deepest"]
    moved = "the link" if summary["sides"][0] == "link" else deepest["link"]
    after = (
        f": {deepest['link']} in {deepest['obstacle']}, {contact_text(deepest)}. The shortest separation "
        f"vector found moves {moved} by ({_vector(deepest)}) mm, {depth_mm(deepest['penetration'])} mm in all."
    )
    at = f"Deepest at {time_of(deepest)}, "
    first = Paragraph([at, step_link(deepest["step"]), after])
    heads = (
        *BODIES[summary["sides"][0]], ">Steps", ">Deep, mm", ">At least", ">Shared, cm³", ">At least", ">Time",
    )  # fmt: skip
    rows = [_row(pair) for pair in found["pairs"]]
    yield Section(
        "Contact", [first, Table(heads, rows, "clickable"), faint(_meaning(found["pairs"]))]
    )


_NOT_WORKED_OUT = (
    "Depth, volume and separation vector were not computed: the run did not ask for them (--contact none), or "
    "bodies meet between the samples only."
)


def _row(pair: dict[str, Any]) -> Row:
    depth, volume = pair["penetration_at_least"], pair["volume_at_least"]
    figures = (
        str(pair["n_steps"]),
        depth_mm(pair["penetration"]),
        "exact" if pair["exact"] else mm(depth),
        volume_cm3(pair["volume"]),
        "exact" if pair["volume_exact"] else least_cm3(volume),
        time_of(pair),
    )
    return Row([pair["link"], pair["obstacle"], *map(number, figures)], At(pair["step"]))


def _meaning(pairs: Sequence[dict[str, Any]]) -> str:
    shown = (
        "Each pair has the deepest of its computed steps: one for every event, its deepest by hulls or "
        "shared volumes, unless more was asked for. At these the replay shows the common region in "
        "red and the separation vector of the first body as an arrow of fixed length. "
    )
    if all(pair["exact"] and pair["volume_exact"] for pair in pairs):
        return f"{shown}Depth and volume are exact to the rounding of float64."
    return (
        f"{shown}Depth and volume that are not exact are upper bounds, with the lower bound beside them. "
        '"How sure" names the substitute of bodies that are not convex. A separation vector of closed bodies '
        "is confirmed by their own distance after it."
    )


TOPIC: Topic = Topic(data, lines, sections)
