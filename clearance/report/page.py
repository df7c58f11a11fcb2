"""The page: one HTML file that needs no network, with meshcat's viewer inside.

This file only puts the parts together; the words are in `topics`, look and behaviour in `templates`. Geometry and
poses go as base64 of float32, what is shown as a figure as float64.
"""

from __future__ import annotations

import base64
from collections.abc import Iterable, Sequence
from dataclasses import asdict, dataclass
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import numpy as np
from markupsafe import Markup

from clearance.errors import Unavailable
from clearance.extras import install
from clearance.record.replay import LINK, EarlierBody, Replay
from clearance.record.status import STATUSES, Status
from clearance.record.wording import contact_text, count
from clearance.report.blocks import Section
from clearance.report.curves import MoreCurve, PairCurves
from clearance.report.model import PageContent
from clearance.report.rendering import inside_script, render
from clearance.report.topic import Topic
from clearance.report.topics import BELOW, FIRST
from clearance.report.topics.pairs import may_come_nearer
from clearance.report.topics.verdict import badge_text, header
from clearance.world.rules import DEFAULT

LEVELS = ("below_warn", "below_fail")
"""Of which the chart shows the times below."""

FINEST = 2000
"""Parts of the time axis that a screen can resolve."""


@dataclass(frozen=True, eq=False)
class PageCurves:
    """What the chart shows beside the least clearance.

    Attributes:
        pairs: each pair's own, if every pair was measured at every step. more: of tolerances, or a recorded run.
    """

    pairs: PairCurves | None = None
    more: Sequence[MoreCurve] = ()


def page_of(
    content: PageContent,
    replay: Replay,
    curves: PageCurves = PageCurves(),
    earlier: Sequence[EarlierBody] = (),
) -> str:
    """The whole page.

    Args:
        earlier: where bodies were before a change.

    Raises:
        Unavailable: meshcat is installed without its viewer.
    """
    summary = content.summary
    data = _data(replay) | _pairs(summary, replay, curves.pairs)
    untied = summary["clock"]["kind"] != "common"
    data |= _more(curves.more) | _earlier(earlier)
    data["sampled"] = untied or summary["basis"] == "samples"
    least, found = (summary["end"] - summary["start"]) / FINEST, summary["intervals"]
    data["intervals"] = {level: _bands(found[level], least) for level in LEVELS}
    return render(
        "report.html",
        title=f"{summary['name']}: {badge_text(content.verdict)}",
        header=header(content),
        drawn=" ".join(filter(None, (_thinned(replay), _at_steps(summary)))),
        columns=[_sections(column, content) for column in FIRST],
        sections=_sections(BELOW, content),
        data=data,
        meshcat=_meshcat(),
    )


def _sections(topics: Iterable[Topic], content: PageContent) -> list[Section]:
    return [
        section
        for topic in topics
        if topic.sections is not None
        for section in topic.sections(content)
    ]


def _data(replay: Replay) -> dict[str, Any]:
    return {
        "statuses": STATUSES,
        "rules": [asdict(rule) for rule in replay.rules],
        "rule": replay.rule.tolist(),
        "default_rule": DEFAULT,
        "carries": [asdict(carry) for carry in replay.carries],
        "bodies": [
            {
                "name": body.name,
                "kind": body.kind,
                "measured": body.measured,
                "shape": body.i_shape,
                "robot": body.i_robot,
                "poses": _floats(poses, "<f4"),
                "shown": _flags(shown),
            }
            for body, poses, shown in zip(replay.bodies, replay.poses, replay.shown, strict=True)
        ],
        "shapes": [
            {"vertices": _floats(vertices, "<f4"), "triangles": _floats(triangles, "<u4")}
            for vertices, triangles in replay.shapes
        ],
        "worst": replay.i_worst,
        "steps": replay.steps.tolist(),
        "between": replay.between.tolist(),
        "times": _floats(replay.times, "<f8"),
        "times_b": [None if np.isnan(time) else time for time in replay.times_b.tolist()],
        "clearances": _floats(replay.clearances, "<f8"),
        "known": replay.known.tolist(),
        "lines": _floats(replay.lines, "<f8"),
        "status": replay.status.tolist(),
        "nearest": replay.nearest.tolist(),
        "move": replay.move.tolist(),
        "moves": replay.moves,
        "unmeasured": replay.unmeasured,
        "contacts": [
            {
                "frame": contact.frame,
                "text": f"{contact.link} in {contact.obstacle}: {contact_text(asdict(contact))}",
                "start": contact.start,
                "direction": contact.direction,
                "vertices": _floats(vertices, "<f4"),
                "triangles": _floats(triangles, "<u4"),
            }
            for contact, (vertices, triangles) in zip(replay.contacts, replay.regions, strict=True)
        ],
    }


def _pairs(summary: dict[str, Any], replay: Replay, curves: PairCurves | None) -> dict[str, Any]:
    """The least clearance of each pair with its line, and its curve if there is one."""
    links, others = (
        {body.name: i for i, body in enumerate(replay.bodies) if (body.kind == LINK) == is_link}
        for is_link in (True, False)
    )
    first, second = others | links, links | others  # where a name is both, as in `replay`
    pairs = [
        {
            "bodies": [first[pair["link"]], second[pair["obstacle"]]],
            "step": pair["step"],
            "time": pair["time"],
            "between": pair["between"],
            "clearance": pair["clearance"],
            "status": STATUSES.index(Status(pair["status"])),
            "rule": pair["rule"],
            "line": [*pair["point_link"], *pair["point_obstacle"]],
        }
        for pair in summary["pairs"]
    ]
    content = {"pairs": pairs, "worst_pair": _worst_pair(summary), "curves": None}
    if curves is None:
        return content
    rows = [_floats(row, "<f4") for row in curves.clearances]
    return content | {"curves": {"times": _floats(curves.times, "<f8"), "clearances": rows}}


def _worst_pair(summary: dict[str, Any]) -> int | None:
    """The place of the pair of the most critical moment, where a waived pair hides it on the curve."""
    if not summary["waived"] or summary["nearer"] is None:
        return None
    worst = [summary["worst"][key] for key in ("link", "obstacle", "rule")]
    named = [[pair[key] for key in ("link", "obstacle", "rule")] for pair in summary["pairs"]]
    return named.index(worst) if worst in named else None


def _more(curves: Sequence[MoreCurve]) -> dict[str, Any]:
    """Curves beside that of the clearance; nothing where there are none."""
    lines = [
        {
            "name": one.name,
            "times": _floats(one.times, "<f8"),
            "values": _floats(one.values, "<f8"),
            "kind": one.kind,
            "filled": one.filled,
        }
        for one in curves
    ]
    return {"more": lines} if lines else {}


def _earlier(bodies: Sequence[EarlierBody]) -> dict[str, Any]:
    """Where bodies were before a change; nothing where there is none."""
    runs = [
        {"body": one.i_body, "poses": _floats(one.poses, "<f4"), "shown": _flags(one.shown)}
        for one in bodies
    ]
    return {"earlier": runs} if runs else {}


def _bands(intervals: list[dict[str, Any]], least: float) -> list[list[float]]:
    """Start and end [s] of each interval; those that no screen can resolve are one."""
    bands: list[list[float]] = []
    for item in intervals:
        if bands and item["start"] - bands[-1][1] < least:
            bands[-1][1] = item["end"]
        else:
            bands.append([item["start"], item["end"]])
    return bands


def _thinned(replay: Replay) -> str:
    """How many of the steps are drawn, where that is not all; else nothing."""
    n_drawn = int((replay.between == 0).sum())
    if n_drawn == replay.n_steps:
        return ""
    return (
        f"Drawn are {n_drawn:,} of {count(replay.n_steps, 'step')}, chosen so that the "
        "least clearance of every stretch is kept; all steps are in steps.csv and steps.parquet."
    )


def _at_steps(summary: dict[str, Any]) -> str:
    """A caution on chart and replay where clocks are not one, and a proof covers more than they show."""
    if summary["clock"]["kind"] == "common" or summary["certified"] is None:
        return ""
    nearer = may_come_nearer(summary["certified"])
    return (
        f"Drawn is the least of each step of the first clock over the steps of the other. {nearer}"
    )


def _flags(shown: np.ndarray) -> list[int] | None:
    """Where a body is in the cell, 0 or 1 for each frame; None where it always is."""
    return None if shown.all() else shown.tolist()


def _floats(array: np.ndarray, kind: str) -> str:
    return base64.b64encode(np.ascontiguousarray(array, dtype=kind).tobytes()).decode()


def _meshcat() -> Markup:
    """The script of meshcat's viewer, read as a file: driving meshcat is the business of room
    `view`."""
    found = find_spec("meshcat")
    bundle = (
        Path(found.origin).parent / "viewer" / "dist" / "main.min.js"
        if found and found.origin
        else None
    )
    if bundle is None or not bundle.is_file():
        raise Unavailable("meshcat's viewer is not installed", valid=install("report"))
    return inside_script(bundle.read_text(encoding="utf-8"))
