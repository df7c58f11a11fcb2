"""A moment of a run as data and in words, wherever one is told. Not for: which moment that is (`topics`)."""

from __future__ import annotations

from typing import Any

from clearance.record.moment import Depth, Moment
from clearance.record.record import Record
from clearance.record.wording import depth_text, other_time, seconds
from clearance.report.blocks import At, Inline
from clearance.world.rules import DEFAULT

BODIES = {"link": ("Link", "Obstacle"), "body_a": ("Body", "Other body")}
"""What the two bodies of a pair are called, by the first of `sides`."""


def moment_row(record: Record, moment: Moment) -> dict[str, Any]:
    """A moment as plain data; its bodies and points under both names that tables have for them."""
    points = list(moment.point_link), list(moment.point_obstacle)
    return {
        "step": moment.step,
        "time": moment.time,
        "time_b": moment.time_b,
        "between": moment.between,
        "clearance": moment.clearance,
        "touches": moment.touches,
        "depth": None if moment.depth is None else moment.depth._asdict(),
        "status": record.status_of(moment),
        "rule": moment.rule,
        "link": moment.link,
        "obstacle": moment.obstacle,
        "point_link": points[0],
        "point_obstacle": points[1],
        "body_a": moment.link,
        "body_b": moment.obstacle,
        "point_a": points[0],
        "point_b": points[1],
    }


def at_moment(moment: dict[str, Any]) -> At:
    """What the replay shows of a moment that is told."""
    return At(moment["step"], moment["time"] if moment["between"] else None)


def moment_link(moment: dict[str, Any], text: str) -> Inline:
    """Words that move the replay to a step, or to a moment between two."""
    at = At(None, moment["time"]) if moment["between"] else At(moment["step"])
    return Inline(text, at=at)


def step_link(step: int) -> Inline:
    """Words that move the replay to a step."""
    return Inline(f"step {step:,}", at=At(step))


def depth_of(moment: dict[str, Any]) -> str:
    """How deep bodies are in each other at a moment that is told."""
    return depth_text(None if moment["depth"] is None else Depth(**moment["depth"]))


def when_of(moment: dict[str, Any]) -> str:
    """When a moment is that is told."""
    step = f"step {moment['step']:,}"
    if moment["between"]:
        step = f"between the steps {moment['step']:,} and {moment['step'] + 1:,}"
    return f"{time_of(moment)}, {step}{other_time(moment['obstacle'], moment['time_b'])}"


def time_of(row: dict[str, Any]) -> str:
    """The time of a row that is told, and its move where there is a program."""
    return seconds(row["time"], row.get("move", ""))


def name_shown(rule: str) -> str:
    """A rule's name where it stands beside others."""
    return "default limits" if rule == DEFAULT else rule
