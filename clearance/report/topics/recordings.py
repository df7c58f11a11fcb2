"""A recorded run beside what was asked: joints off their course, and both clearances. Not for: measuring them."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import asdict
from typing import Any

from clearance.record.record import Record
from clearance.record.wording import mm, seconds
from clearance.report.blocks import At, Paragraph, Row, Section, Table, number
from clearance.report.model import PageContent, ReportModel
from clearance.report.topic import Line, Topic, labelled
from clearance.world.joint_positions import turns
from clearance.world.recording import SHARE
from clearance.world.timing import time_text


def data(model: ReportModel) -> dict[str, Any]:
    """Recorded runs; nothing where nothing was recorded."""
    recordings = recordings_of(model.record)
    return {} if recordings is None else {"recordings": recordings}


def recordings_of(record: Record) -> dict[str, Any] | None:
    """What `summary.json` holds of recorded runs; None where nothing was recorded."""
    if record.commanded is None:
        return None
    worst = record.commanded.worst
    asked = {
        "clearance": worst.clearance,
        "step": worst.step,
        "time": worst.time,
        "body_a": worst.link,
        "body_b": worst.obstacle,
    }
    return {"asked": asked, "runs": list(_runs(record))}


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


def lines(model: ReportModel) -> Iterator[Line]:
    """How near what was asked comes, and how far joints were off, the farthest first."""
    recordings = recordings_of(model.record)
    yield from labelled("recorded", () if recordings is None else _lines(recordings))


def _lines(recordings: dict[str, Any]) -> Iterator[str]:
    asked = recordings["asked"]
    at = f"{seconds(asked['time'])}, step {asked['step']}"
    where = f"{asked['body_a']} - {asked['body_b']} at {at}"
    yield f"as commanded {mm(asked['clearance'])} mm at the steps: {where}"
    for run in recordings["runs"]:
        joints = sorted(run["joints"], key=lambda one: -one["greatest"])[:4]
        off = ", ".join(
            f"{one['joint']} {_size(one, 'greatest')} ({_size(one, 'usual')})" for one in joints
        )
        yield f"{run['path']} is off by at most (99 % of samples): {off}"


def _size(joint: dict[str, Any], which: str) -> str:
    value = joint[which]
    return f"{value * 1000:.3g} mm" if joint["unit"] == "m" else f"{value:.3g} rad"


def sections(content: PageContent) -> Iterator[Section]:
    """Both clearances, and a table a robot; nothing where nothing was recorded."""
    recordings = content.summary.get("recordings")
    if recordings is None:
        return
    asked, driven = recordings["asked"], content.summary["worst"]
    line = (
        f"As driven {mm(driven['clearance'])} mm at least, {driven['body_a']} and {driven['body_b']} at "
        f"{seconds(driven['time'])}; as commanded {mm(asked['clearance'])} mm at the steps, {asked['body_a']} and "
        f"{asked['body_b']} at {seconds(asked['time'])}. The dashed curve is the commanded motion."
    )
    parts = [part for run in recordings["runs"] for part in _run(run)]
    yield Section("As driven", [Paragraph(line), *parts])


def _run(run: dict[str, Any]) -> list[Paragraph | Table]:
    heads = ("Joint", ">Greatest error", f">{SHARE:g} % of samples", ">At")
    rows = [
        Row([one["joint"], *map(number, _figures(one))], At(None, one["time"]))
        for one in run["joints"]
    ]
    offset = f", {time_text(run['offset'])} s added to its times" if run["offset"] else ""
    span = f"{run['start']:.3f} to {seconds(run['end'])}"
    heading = f"{run['path']}, of robot {run['robot']}, compared with the commanded motion from {span}{offset}."
    return [Paragraph(heading), Table(heads, rows, "clickable bodies")]


def _figures(joint: dict[str, Any]) -> list[str]:
    return [_size(joint, "greatest"), _size(joint, "usual"), seconds(joint["time"])]


TOPIC: Topic = Topic(data, lines, sections)
