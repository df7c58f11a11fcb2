"""Overlaps in the summary and on the page: the deepest of the run, and the deepest of every pair.

Not for: finding them (`simulate.answers.contact.contacts`).
"""

from __future__ import annotations

from collections import Counter
from typing import Any

from markupsafe import Markup

from clearance.record.contact import StepContact
from clearance.record.record import Record
from clearance.record.wording import contact_text, depth_mm, least_cm3, mm, seconds, volume_cm3
from clearance.report.markup import element, section, step_link, table


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
    pairs = [_told(row) | {"n_steps": n_steps[row.link, row.obstacle]} for row in deepest]
    return {"deepest": _told(record.deepest), "pairs": pairs}


def _told(row: StepContact) -> dict[str, Any]:
    found = row.known
    assert found is not None, "only overlaps that are worked out are told"
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


def _not_worked_out() -> Markup:
    told = (
        "Depth, volume and way out were not worked out: the run did not ask for them (--contact none), or bodies "
        "meet between the samples only."
    )
    return section("Contact", element("p", told))


def contacts(summary: dict[str, Any]) -> Markup:
    """The section on overlaps; nothing where there are none, one line where none was worked out."""
    found = summary["contact"]
    if found is None:
        return _not_worked_out() if summary["status_counts"]["contact"] else Markup("")
    deepest = found["deepest"]
    way = ", ".join(f"{value:.4f}" for value in deepest["direction"])
    first = element(
        "p",
        f"Deepest at {seconds(deepest['time'])}, ",
        step_link(deepest["step"]),
        f": {deepest['link']} in {deepest['obstacle']}, {contact_text(deepest)}. The shortest way out "
        f"found moves {_mover(deepest, summary)} by {depth_mm(deepest['penetration'])} mm along ({way}).",
    )
    heads = (
        *HEADS[summary["sides"][0]],
        ">Steps",
        ">Deep, mm",
        ">At least",
        ">Shared, cm³",
        ">At least",
        ">Time",
    )
    return section(
        "Contact",
        first,
        table(heads, [_row(pair) for pair in found["pairs"]], class_="clickable"),
        element("p", *_meaning(found["pairs"]), class_="faint"),
    )


HEADS = {"link": ("Link", "Obstacle"), "body_a": ("Body", "Other body")}
"""What the page calls the two bodies of a pair."""


def _mover(contact: dict[str, Any], summary: dict[str, Any]) -> str:
    """What the way out moves."""
    return "the link" if summary["sides"][0] == "link" else str(contact["link"])


def _row(pair: dict[str, Any]) -> Markup:
    depth, volume = pair["penetration_at_least"], pair["volume_at_least"]
    cells = (
        pair["n_steps"],
        depth_mm(pair["penetration"]),
        "exact" if pair["exact"] else mm(depth),
        volume_cm3(pair["volume"]),
        "exact" if pair["volume_exact"] else least_cm3(volume),
        seconds(pair["time"]),
    )
    return element(
        "tr",
        element("td", pair["link"]),
        element("td", pair["obstacle"]),
        *[element("td", cell, class_="number") for cell in cells],
        data_step=pair["step"],
        tabindex=0,
    )


def _meaning(pairs: list[dict[str, Any]]) -> list[str]:
    told = [
        "Of each pair the deepest of the steps that are worked out: one of every event, its deepest as far as "
        "hulls or shared volumes tell, unless more was asked for. At these the replay shows the common region in "
        "red and the way out of the first body as an arrow of fixed length. "
    ]
    if all(pair["exact"] and pair["volume_exact"] for pair in pairs):
        return [*told, "Depth and volume are exact to the rounding of float64."]
    return [
        *told,
        "Depth and volume that are not exact are upper bounds, with the lower bound beside them: what stands "
        "for bodies that are not convex is told in How sure, and a way out of closed bodies is confirmed by their "
        "own distance after it.",
    ]
