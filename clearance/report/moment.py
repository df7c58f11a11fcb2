"""A moment of a run as data and in words, wherever one is told. Not for: which moment that is (`topics`)."""

from __future__ import annotations

from dataclasses import asdict
from pathlib import Path
from typing import Any

import numpy as np

from clearance.record.moment import Depth, Moment
from clearance.record.record import Record
from clearance.record.wording import depth_text, other_time, seconds
from clearance.report.blocks import At, Inline
from clearance.world.placed_robot import PlacedRobot
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
        "depth": None if moment.depth is None else asdict(moment.depth),
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


def point_of_file(record: Record, moment: Moment) -> str:
    """The point of the robot's own table at a moment, or the last one before it; empty where points are steps."""
    bodies = {moment.link, moment.obstacle}
    for placed in record.case.robots:
        before = record.case.prefix_of(placed)
        is_of = bodies & {before + link for link in placed.robot.link_names}
        if is_of and placed.trajectory_path and not placed.given_trajectory.moves:
            n_points = len(placed.given_trajectory.file_times)
            if n_points == record.rows.n_rows:
                return ""
            point = sample_at(placed, moment.time) + 1
            return f", point {point:,} of {n_points:,} of {Path(placed.trajectory_path).name}"
    return ""


def sample_at(placed: PlacedRobot, time: float) -> int:
    """The last sample of a robot's table at or before a time of the run [s]; the first before all of them."""
    own = own_time(placed, time)
    rounding = max(1e-9, 8.0 * np.spacing(max(abs(own), abs(time) * placed.timing.rate)))
    times = placed.given_trajectory.file_times
    return max(0, int(np.searchsorted(times, own + rounding, side="right")) - 1)


def own_time(placed: PlacedRobot, time: float) -> float:
    """A time of the run [s] as its trajectory counts it."""
    times, timing = placed.given_trajectory.times, placed.timing
    own = timing.table_times(time)
    span = float(times[-1] - times[0])
    if timing.after == "loop" and span > 0.0 and own > times[-1]:
        own = float(times[0]) + (own - float(times[0])) % span
    return own
