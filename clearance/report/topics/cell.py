"""What moves in a case: actors, who carries what and when, who is not there, clock and paddings."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any, ClassVar, NamedTuple

from clearance.findings.measurement_conditions import paddings_in
from clearance.record.record import Record
from clearance.record.wording import limit_mm, seconds, span_text
from clearance.report.blocks import Section, faint
from clearance.report.model import PageContent, ReportModel
from clearance.report.topic import Line, Topic
from clearance.world.body import Mount
from clearance.world.notice import listed
from clearance.world.placed_robot import PlacedRobot
from clearance.world.plausible_recordings import not_measured
from clearance.world.timing import Timing
from clearance.world.trajectory import Trajectory

STRAIGHT = "straight, turning about one axis at constant speed"
"""How what follows a table of poses moves between its samples."""

MOST_CARRIES, MOST_PADDINGS = 6, 6
"""In a terminal."""

N_COLOURS = 4
"""Tints of robots, on the page and in the replay."""


def data(model: ReportModel) -> dict[str, Any]:
    """All that moves, and how clocks hang together."""
    record = model.record
    moves = moves_of(record)
    moves_row = {"moves": moves} if moves else {}
    return moves_row | {
        "actors": actors_of(record),
        "carries": carried_of(record),
        "clock": clock_of(record),
        "not_measured": [[*span] for span in not_measured(record.case)],
        "paddings": paddings_in(record.case),
    }


def actors_of(record: Record) -> list[dict[str, Any]]:
    """All robots, and the obstacles that move, ride or are carried at some time."""
    case = record.case
    robots, obstacles = absences(record)
    found = [
        _robot(placed) | {"absent": absent}
        for placed, absent in zip(case.robots, robots, strict=True)
    ]
    carried = {carry.part for carry in case.carries}
    for obstacle, absent in zip(case.obstacles, obstacles, strict=True):
        if obstacle.stands and obstacle.name not in carried:
            continue
        kind = "part" if obstacle.name in carried else "obstacle"
        row = {"name": obstacle.name, "kind": kind, "on": _on(obstacle.mount), "absent": absent}
        between = None if obstacle.moves is None else STRAIGHT
        timing = None if obstacle.moves is None else obstacle.moves.timing
        found.append(row | {"between_samples": between, "timing": _timing(timing)})
    return found


def _robot(placed: PlacedRobot) -> dict[str, Any]:
    trajectory = placed.trajectory
    return {
        "name": placed.robot.name,
        "kind": "robot",
        "on": _on(placed.mount),
        "self_clearance": placed.self_clearance is not None,
        "between_samples": None if trajectory is None else _law(trajectory),
        "timing": None if trajectory is None else _timing(placed.timing),
    }


def _law(trajectory: Trajectory) -> str:
    if trajectory.moves:
        return "program"
    if trajectory.path_error:
        return "quintic"
    return "linear" if trajectory.velocities is None else "cubic"


def _on(mount: Mount | None) -> str | None:
    return None if mount is None else mount.on


def _timing(timing: Timing | None) -> dict[str, Any] | None:
    if timing is None:
        return None
    return {"start": timing.start, "rate": timing.rate, "after": timing.after}


def absences(record: Record) -> tuple[list[list[list[float]]], list[list[list[float]]]]:
    """For each robot, and for each obstacle, the stretches [s] in which it is not in the cell."""
    robots: list[list[list[float]]] = [[] for _ in record.case.robots]
    obstacles: list[list[list[float]]] = [[] for _ in record.case.obstacles]
    for phase in record.timeline.phases:
        for i in phase.absent_robots:
            _lengthen(robots[i], phase.span)
        for i in phase.absent_obstacles:
            _lengthen(obstacles[i], phase.span)
    return robots, obstacles


def _lengthen(spans: list[list[float]], span: tuple[float, float]) -> None:
    if spans and spans[-1][1] == span[0]:
        spans[-1][1] = span[1]
    else:
        spans.append([*span])


def carried_of(record: Record) -> list[dict[str, Any]]:
    """Who carries what, from when until when [s], in order of time.

    It ends with the run, and where the part leaves the cell with its carrier and does not come back.
    """
    times, case = record.timeline.times, record.case
    parts = [obstacle.name for obstacle in case.obstacles]
    gone = dict(zip(parts, absences(record)[1], strict=True))
    left = {
        part: spans[-1][0] for part, spans in gone.items() if spans and spans[-1][1] == times[-1]
    }
    found = [
        {
            "part": carry.part,
            "by": carry.by,
            "from": max(carry.window.start, float(times[0])),
            "until": min(carry.window.end, left.get(carry.part, float(times[-1]))),
            "touch": list(carry.touch),
            "grasp": "exact" if carry.exact_grasp else "as driven",
        }
        for carry in case.carries
    ]
    return sorted(found, key=lambda row: (row["from"], row["part"]))


def moves_of(record: Record) -> list[dict[str, Any]]:
    """The moves of programs that take time, from when until when [s], a robot after another."""
    return [
        {"robot": one.robot, "name": name, "from": float(start), "until": float(end)}
        for one in record.moves.robots
        for name, start, end in zip(one.names, one.starts, one.ends, strict=True)
    ]


def clock_of(record: Record) -> dict[str, Any]:
    """How the actors' clocks hang together: "common", within a slack [s], or "unsynchronised"."""
    slack = record.case.clock.slack
    kind = "common" if slack == 0.0 else "unsynchronised" if math.isinf(slack) else "slack"
    return {"kind": kind, "slack": slack if math.isfinite(slack) else None}


def lines(model: ReportModel) -> Iterator[Line]:
    """Who carries what from when until when, and what clearances are less by."""
    for row in carried_of(model.record)[:MOST_CARRIES]:
        yield "carried", f"{row['part']} by {row['by']}, {span_text(row['from'], row['until'])}"
    paddings = paddings_in(model.record.case).items()
    padded = [f"{name} {limit_mm(padding)} mm" for name, padding in paddings]
    if padded:
        yield "padding", f"clearances are less that of both bodies: {listed(padded, MOST_PADDINGS)}"


class Bar(NamedTuple):
    """A stretch of time: where it begins [%] and how long it is, what it is, and its beginning [s]."""

    left: float
    width: float
    kind: str
    text: str
    title: str
    time: float


class Lane(NamedTuple):
    """The bars of what has a name."""

    name: str
    bars: Sequence[Bar]


@dataclass(frozen=True)
class Lanes:
    """Bars over the time of the run, from its start to its end."""

    template: ClassVar[str] = "lanes"
    lanes: Sequence[Lane]
    start: str
    end: str


def sections(content: PageContent) -> Iterator[Section]:
    """The moves of programs, and who holds what from when to when; nothing where no program is followed, nothing
    changes hands, comes or goes and no rule has a window."""
    summary = content.summary
    moves = summary.get("moves", [])
    lanes = [
        Lane(name, _made(summary, name)) for name in dict.fromkeys(one["robot"] for one in moves)
    ]
    title = "Moves, and who holds what when" if lanes else "Who holds what, and when"
    parts = dict.fromkeys(carry["part"] for carry in summary["carries"])
    lanes += [Lane(part, _hands(summary, part)) for part in parts]
    lanes += [
        Lane(actor["name"], _absences(summary, actor))
        for actor in summary["actors"]
        if actor["absent"] and actor["name"] not in parts
    ]
    lanes += [
        Lane(f"rule {rule['name']}", [_window(summary, rule)])
        for rule in summary["rules"]
        if rule["from"] is not None or rule["until"] is not None
    ]
    if lanes:
        drawn = Lanes(lanes, seconds(summary["start"]), seconds(summary["end"]))
        note = faint("A click moves the replay to where a bar begins.")
        yield Section(title, [drawn, note])


def _made(summary: dict[str, Any], robot: str) -> list[Bar]:
    """The bars of a robot's moves."""
    return [
        _bar(summary, one["from"], one["until"], "window", one["name"])
        for one in summary["moves"]
        if one["robot"] == robot
    ]


def _hands(summary: dict[str, Any], part: str) -> list[Bar]:
    """The bars of a part: one for each that carries it, and where it is not in the cell."""
    robots = [robot["name"] for robot in summary["robots"]]
    things = {obstacle["name"] for obstacle in summary["obstacles"]}
    bars = []
    for carry in summary["carries"]:
        if carry["part"] == part:
            owner = carry["by"].split("/")[0]
            colour = robots.index(owner) % N_COLOURS if owner in robots else 0
            kind = "thing" if carry["by"] in things else f"hand{colour}"
            bars.append(_bar(summary, carry["from"], carry["until"], kind, carry["by"]))
    own = next(actor for actor in summary["actors"] if actor["name"] == part)
    return bars + _absences(summary, own)


def _absences(summary: dict[str, Any], actor: dict[str, Any]) -> list[Bar]:
    """The bars of an actor while it is not in the cell, or not measured."""
    return [
        _bar(summary, start, end, "absent", _why(summary, start, end))
        for start, end in actor["absent"]
    ]


def _why(summary: dict[str, Any], start: float, end: float) -> str:
    unmeasured = any(start < until and since < end for since, until in summary["not_measured"])
    return "not measured" if unmeasured else "not in the cell"


def _window(summary: dict[str, Any], rule: dict[str, Any]) -> Bar:
    start = summary["start"] if rule["from"] is None else rule["from"]
    end = summary["end"] if rule["until"] is None else rule["until"]
    return _bar(summary, start, end, "window", "holds")


def _bar(summary: dict[str, Any], start: float, end: float, kind: str, text: str) -> Bar:
    """A bar from a time to another [s], as far as they are in the run."""
    first, whole = summary["start"], max(summary["end"] - summary["start"], 1e-300)
    left, right = (min(max((time - first) / whole, 0.0), 1.0) * 100.0 for time in (start, end))
    title = f"{text}: {seconds(start)} to {seconds(end)}"
    return Bar(left, max(right - left, 0.2), kind, text, title, start)


TOPIC: Topic = Topic(data, lines, sections)
