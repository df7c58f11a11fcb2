"""A recorded run beside what was asked: joints off their course, and both clearances. Not for: measuring them."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import asdict
from typing import Any

from markupsafe import Markup

from clearance.record.record import Record
from clearance.record.wording import mm, seconds
from clearance.report.markup import element, section, table
from clearance.world.joint_positions import turns
from clearance.world.recording import SHARE


def recordings_of(record: Record) -> dict[str, Any] | None:
    """What `summary.json` holds of recorded runs; None where nothing was recorded."""
    if record.commanded is None:
        return None
    worst = record.commanded.worst
    return {
        "asked": {
            "clearance": worst.clearance,
            "step": worst.step,
            "time": worst.time,
            "body_a": worst.link,
            "body_b": worst.obstacle,
        },
        "runs": list(_runs(record)),
    }


def _runs(record: Record) -> Iterator[dict[str, Any]]:
    for placed in record.case.robots:
        found = placed.recording
        if found is None:
            continue
        units = {joint.name: "rad" if turns(joint) else "m" for joint in placed.robot.joints}
        yield {
            "robot": placed.robot.name,
            "path": found.path,
            "offset": found.offset,
            "start": found.start,
            "end": found.end,
            "joints": [asdict(one) | {"unit": units[one.joint]} for one in found.joints],
        }


def recording_lines(record: Record) -> Iterator[str]:
    """How near what was asked comes, and how far joints were off, the farthest first."""
    told = recordings_of(record)
    if told is None:
        return
    asked = told["asked"]
    where = (
        f"{asked['body_a']} - {asked['body_b']} at {seconds(asked['time'])}, step {asked['step']}"
    )
    yield f"as asked {mm(asked['clearance'])} mm at the steps: {where}"
    for run in told["runs"]:
        joints = sorted(run["joints"], key=lambda one: -one["greatest"])[:4]
        off = ", ".join(
            f"{one['joint']} {_size(one, 'greatest')} ({_size(one, 'usual')})" for one in joints
        )
        yield f"{run['path']} is off by at most (99 % of samples): {off}"


def _size(joint: dict[str, Any], which: str) -> str:
    value = joint[which]
    return f"{value * 1000:.3g} mm" if joint["unit"] == "m" else f"{value:.3g} rad"


def recordings(summary: dict[str, Any]) -> Markup:
    """The page's section; nothing where nothing was recorded."""
    told = summary.get("recordings")
    if told is None:
        return Markup("")
    asked, driven = told["asked"], summary["worst"]
    line = (
        f"As driven {mm(driven['clearance'])} mm at least, {driven['body_a']} and {driven['body_b']} at "
        f"{seconds(driven['time'])}; as asked {mm(asked['clearance'])} mm at the steps, {asked['body_a']} and "
        f"{asked['body_b']} at {seconds(asked['time'])}. The dashed curve is what was asked."
    )
    parts = [part for run in told["runs"] for part in _run(run)]
    return section("As driven", element("p", line), *parts)


def _run(run: dict[str, Any]) -> list[Markup]:
    heads = ("Joint", ">Greatest error", f">{SHARE:g} % of samples", ">At")
    rows = [
        element(
            "tr",
            element("td", one["joint"]),
            element("td", _size(one, "greatest"), class_="number"),
            element("td", _size(one, "usual"), class_="number"),
            element("td", seconds(one["time"]), class_="number"),
            data_time=one["time"],
            tabindex=0,
        )
        for one in run["joints"]
    ]
    offset = f", {run['offset']:g} s added to its times" if run["offset"] else ""
    span = f"{run['start']:.3f} to {seconds(run['end'])}"
    told = (
        f"{run['path']}, of robot {run['robot']}, held against what was asked from {span}{offset}."
    )
    return [element("p", told), table(heads, rows, class_="clickable bodies")]
