"""The most critical moment: joints, witness points, and what its clearance changes by."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import asdict, dataclass
from typing import Any, ClassVar, NamedTuple

import numpy as np

from clearance.record.moment import Moment
from clearance.record.names import LINK_AND_OBSTACLE
from clearance.record.record import Record
from clearance.record.sensitivity import Sensitivity
from clearance.record.wording import count, joint_value, mm, other_time, padded_mm, seconds
from clearance.report.blocks import Paragraph, Row, Section, Table, faint, number
from clearance.report.model import PageContent, ReportModel
from clearance.report.moment import (
    depth_of,
    moment_link,
    moment_row,
    name_shown,
    point_of_file,
    step_link,
    when_of,
)
from clearance.report.topic import Line, Topic
from clearance.world.motion import Motion

MOST_PAIRS = 8
"""Pairs that are as near, by name."""

_PER = {"rad": (math.radians(0.1) * 1e3, "0.1°"), "m": (1.0, "1 mm")}
"""By the unit of a variable: from metres of clearance a unit to millimetres a step, and that step, a small one."""


def data(model: ReportModel) -> dict[str, Any]:
    """The worst moment of the motion, of the samples, the nearest whatever judges it, and slopes."""
    record, verdict = model.record, model.verdict
    return {
        "worst": _worst(record, verdict.worst),
        "worst_sample": _worst(record, verdict.worst_sample),
        "nearest": moment_row(record, record.nearest),
        "nearest_moving": _nearest_moving(model),
        "sensitivity": sensitivity_data(model.sensitivity),
    }


def _nearest_moving(model: ReportModel) -> str | None:
    """The nearest pair of which a body moves, where the most critical one is of two that stand all the time."""
    record, worst, standing = model.record, model.verdict.worst, model.session.standing_bodies
    if not {worst.link, worst.obstacle} <= standing:
        return None
    for pair in model.session.motion_minima():
        if not {pair.link, pair.obstacle} <= standing:
            where = f"between the steps {pair.step} and {pair.step + 1}"
            where = where if pair.between else f"step {pair.step}"
            at = seconds(pair.time, record.moves.at(pair.time))
            return f"{mm(pair.clearance)} mm, {pair.link} - {pair.obstacle} at {at}, {where}"
    return None


def _worst(record: Record, worst: Moment) -> dict[str, Any]:
    of_robots = zip(record.motions, worst.positions, strict=True)
    joints = [joint for motion, positions in of_robots for joint in _joints(motion, positions)]
    return moment_row(record, worst) | {"joints": joints}


def _joints(motion: Motion, positions: np.ndarray) -> list[dict[str, Any]]:
    """Name, kind, position and limits [rad] or [m] of every moving joint at one moment."""
    return [
        {
            "robot": motion.placed.robot.name,
            "name": joint.name,
            "kind": str(joint.kind),
            "position": float(position),
            "lower": float(joint.lower) if np.isfinite(joint.lower) else None,
            "upper": float(joint.upper) if np.isfinite(joint.upper) else None,
        }
        for joint, position in zip(motion.placed.robot.moving_joints, positions, strict=True)
    ]


def sensitivity_data(found: Sensitivity) -> dict[str, Any]:
    """Slopes in metres of clearance per radian or metre, or why there are none."""
    return {
        "why_not": found.why_not or None,
        "pairs": [list(pair) for pair in found.pairs],
        "rates": [asdict(rate) | {"both_ways": rate.both_ways} for rate in found.rates],
    }


def lines(model: ReportModel) -> Iterator[Line]:
    """Step, time, bodies and witness points."""
    record, worst = model.record, model.verdict.worst
    a, b = ("link", "obstacle") if record.sides[:2] == LINK_AND_OBSTACLE else ("a", "b")
    between = f"between the steps {worst.step} and {worst.step + 1}"
    where = between if worst.between else f"step {worst.step}"
    of_steps = f"of {count(record.rows.n_rows, 'step')}"
    at = f"{seconds(worst.time, record.moves.at(worst.time))}{other_time(worst.obstacle, worst.time_b)}"
    at += point_of_file(record, worst)
    yield "worst", f"{where} {of_steps}, {at}: {worst.link} - {worst.obstacle}"
    if moving := _nearest_moving(model):
        yield (
            "moving",
            f"{worst.link} and {worst.obstacle} never move; nearest of what moves: {moving}",
        )
    yield "points", f"{a} {_point(worst.point_link)}, {b} {_point(worst.point_obstacle)} m"


def _point(point: Sequence[float]) -> str:
    return f"({', '.join(f'{value:z.6f}' for value in point)})"


class JointRow(NamedTuple):
    """A joint: its name and position in words, and its share of its range, or why there is none."""

    name: str
    position: str
    text: str
    share: float | None = None
    kind: str = ""


@dataclass(frozen=True)
class Joints:
    """Where in its limits each joint stands."""

    template: ClassVar[str] = "joints"
    rows: Sequence[JointRow]


def sections(content: PageContent) -> Iterator[Section]:
    """The joint values and witness points of the worst moment."""
    summary = content.summary
    worst = summary["worst"]
    several = len({joint["robot"] for joint in worst["joints"]}) > 1
    joints = Joints([_joint_row(joint, several) for joint in worst["joints"]])
    points = [
        Row([f"on {worst[body]}", *(number(f"{v * 1000:z.3f}") for v in worst[f"point_{body}"])])
        for body in ("link", "obstacle")
    ]
    near = depth_of(worst) if worst["touches"] else padded_mm(content.verdict.worst)
    first = f"{near} between {worst['link']} and {worst['obstacle']} at "
    yield Section(
        "Worst moment",
        [
            Paragraph([first, moment_link(worst, when_of(worst)), "."]),
            *_nearest(summary),
            *_worst_sample(summary),
            *_moving(summary),
            *([joints] if joints.rows else []),
            Table(("Witness point", ">x, mm", ">y, mm", ">z, mm"), points),
            *sensitivity_blocks(summary["sensitivity"], several_robots=several),
        ],
    )


def _nearest(summary: dict[str, Any]) -> list[Paragraph]:
    """The least clearance of all, where something else is more critical."""
    if summary["nearer"] is None:
        return []
    nearest = summary["nearest"]
    text = f"Nearest of all are {nearest['link']} and {nearest['obstacle']}: {mm(nearest['clearance'])} mm at "
    by = f", judged by {name_shown(nearest['rule'])}: {nearest['status']}."
    return [Paragraph([text, moment_link(nearest, when_of(nearest)), by])]


def _worst_sample(summary: dict[str, Any]) -> list[Paragraph]:
    """The least clearance at the steps, where that between them is less."""
    sample = summary["worst_sample"]
    if not summary["worst"]["between"]:
        return []
    least = "least" if len(summary["rules"]) == 1 else "worst"
    text = f"At the steps the {least} is {mm(sample['clearance'])} mm between {sample['link']} and "
    return [Paragraph([text, f"{sample['obstacle']}, ", step_link(sample["step"]), "."])]


def _moving(summary: dict[str, Any]) -> list[Paragraph]:
    """The nearest pair that moves, where these two never do."""
    text = summary["nearest_moving"]
    return [Paragraph(f"These two never move. Nearest of what moves: {text}.")] if text else []


def _joint_row(joint: dict[str, Any], several: bool) -> JointRow:
    name = f"{joint['robot']} / {joint['name']}" if several else joint["name"]
    position = joint_value(joint["kind"], joint["position"])
    lower, upper = joint["lower"], joint["upper"]
    if lower is None or upper is None or upper <= lower:
        return JointRow(name, position, "no limits", kind="faint")
    share = (joint["position"] - lower) / (upper - lower)
    if not 0.0 <= share <= 1.0:
        return JointRow(name, position, "outside its limits", kind="text-violated")
    ends = f"{joint_value(joint['kind'], lower)} to {joint_value(joint['kind'], upper)}"
    return JointRow(name, position, ends, share)


def sensitivity_blocks(given: dict[str, Any], *, several_robots: bool) -> list[Table | Paragraph]:
    """The table under the worst moment, or a line that says why there is none."""
    if given["why_not"]:
        return [faint(f"Its slopes are not computed: {given['why_not']}.")]
    if not given["rates"]:
        return [faint("Nothing that can be moved changes it.")]
    heads = ("Change of this clearance with", ">Moved by", ">Up, mm", ">Down, mm")
    rows = [_rate(rate, several_robots) for rate in given["rates"]]
    return [Table(heads, rows, tall=True), faint(_note(given))]


def _rate(rate: dict[str, Any], several_robots: bool) -> Row:
    factor, step = _PER[rate["unit"]]
    name = f"{rate['kind']} {rate['of']}, {rate['name']}"
    if rate["kind"] == "joint":
        name = f"{rate['of']} / {rate['name']}" if several_robots else rate["name"]
    figures = [step, *(_signed(rate[way] * factor) for way in ("more", "less"))]
    return Row([name, *map(number, figures)])


def _signed(value: float) -> str:
    text = f"{value:+.3f}"
    return "0" if float(text) == 0.0 else text


def _note(given: dict[str, Any]) -> str:
    note = "To first order, near this moment: a large move changes it differently, and other pairs come near."
    if len(given["pairs"]) > 1:
        names = [f"{a} and {b}" for a, b in given["pairs"][:MOST_PAIRS]]
        more = len(given["pairs"]) - len(names)
        names += [f"{more} more"] if more else []
        note = f"As near are {'; '.join(names)}: the least of them counts. {note}"
    if not all(rate["both_ways"] for rate in given["rates"]):
        note = f"Where up and down differ, each figure holds in its direction only. {note}"
    return note


TOPIC: Topic = Topic(data, lines, sections)
