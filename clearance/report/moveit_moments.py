"""`worst_moments.yaml`: the worst moments of a run in MoveIt's words: bodies as links, world objects and attached
objects, nearest points, and the states of the robots then.

There is an entry for each pair and rule that comes near or below a limit, the worst first, and the overall worst
in any case. Pairs are at the samples; the worst moment of a rule is of the motion. Where the run asks for
less than every step, pairs are not known, and `need` says so. Not for: ROS messages,
of which none holds all of it.
"""

from __future__ import annotations

import json
from collections.abc import Iterator
from typing import Any

from clearance.findings.measurement_conditions import paddings_in
from clearance.formats.message.values import split_time
from clearance.record.moment import Moment
from clearance.record.record import PairMinimum, Record
from clearance.record.status import STATUSES, Status
from clearance.report.model import ReportModel
from clearance.report.topics.pairs import PairJudge
from clearance.world.case import Case

FORMAT = "clearance-moments-2"

MOST = 200
"""Entries; those that stand best are left out and counted."""

ROBOT_LINK, WORLD_OBJECT, ROBOT_ATTACHED = "ROBOT_LINK", "WORLD_OBJECT", "ROBOT_ATTACHED"
"""Kinds of bodies, as `moveit_msgs/ContactInformation` names them."""


def moments_of(model: ReportModel) -> dict[str, Any]:
    """The file's content."""
    record = model.record
    entries, names = _entries(model), _Names(record.case)
    return {
        "format": FORMAT,
        "name": record.case.name,
        "verdict": model.verdict.status,
        "need": record.need,
        "header": {"frame_id": "world"},
        "n_left_out": max(0, len(entries) - MOST),
        "moments": [_moment_row(record, names, *entry) for entry in entries[:MOST]],
    }


def _entries(model: ReportModel) -> list[tuple[Moment, str]]:
    """The overall worst of what decides, then all that is not clear, the worst first; each with its status."""
    record, judge = model.record, PairJudge.of(model.record)
    worst = model.verdict.worst
    found: dict[tuple[str, str, str], tuple[Moment, str]] = {}
    for moment in (worst, *(rule.worst for rule in record.rules)):
        if moment is not None:
            found.setdefault(_key(moment), (moment, record.status_of(moment)))
    for minimum in model.session.motion_minima():
        moment = _of_pair(record, minimum)
        found.setdefault(_key(moment), (moment, judge.status_of(minimum)))
    limits = {rule.name: rule.limits.fail for rule in record.rules}

    def standing(entry: tuple[Moment, str]) -> tuple[int, float, tuple[str, str, str]]:
        moment, status = entry
        above = moment.clearance - limits[moment.rule]
        return -STATUSES.index(Status(status)), above, _key(moment)

    first = found.pop(_key(worst))
    rest = [entry for entry in found.values() if entry[1] != Status.CLEAR]
    return [first, *sorted(rest, key=standing)]


def _key(moment: Moment) -> tuple[str, str, str]:
    """What there is one entry of."""
    return moment.rule, moment.link, moment.obstacle


def _of_pair(record: Record, minimum: PairMinimum) -> Moment:
    positions = tuple(motion.positions_at(minimum.time) for motion in record.motions)
    names = (
        "step",
        "time",
        "between",
        "clearance",
        "link",
        "obstacle",
        "point_link",
        "point_obstacle",
    )
    given = {name: getattr(minimum, name) for name in names}
    return Moment(**given, positions=positions, rule=minimum.rule)


def _moment_row(record: Record, names: _Names, moment: Moment, status: str) -> dict[str, Any]:
    bodies, paddings = (moment.link, moment.obstacle), paddings_in(record.case)
    padding = sum(paddings.get(name, 0.0) for name in bodies)
    row: dict[str, Any] = {"rule": moment.rule, "status": status, "clearance": moment.clearance}
    if padding:
        row |= {"padding": padding, "distance": max(0.0, moment.clearance + padding)}
    row |= {
        "time_from_start": time_of(moment.time),
        "step": moment.step,
        "between": moment.between,
        "bodies": [names.keys_of(name, moment.time) for name in bodies],
        "nearest_points": [_vector(moment.point_link), _vector(moment.point_obstacle)],
        **_overlap(record, moment),
        "robot_states": [*_states(record, names, moment)],
    }
    if moment.time_b is not None:
        row["time_from_start_of_second"] = time_of(moment.time_b)
    return row


def time_of(seconds: float) -> dict[str, int]:
    """A time as a duration of ROS 2."""
    return dict(zip(("sec", "nanosec"), split_time(seconds), strict=True))


def _vector(values: Any) -> dict[str, float]:
    return {key: float(value) for key, value in zip("xyz", values, strict=True)}


class _Names:
    """What MoveIt calls the bodies of a case."""

    def __init__(self, case: Case) -> None:
        self._links: dict[str, dict[str, str]] = {}
        self._carries = case.carries
        self._on = {one.name: one.mount.on for one in case.obstacles if one.mount is not None}
        for placed in case.robots:
            own = {"robot": placed.robot.name} if len(case.robots) > 1 else {}
            for link in placed.robot.link_names:
                keys = {"link_name": link, **own}
                for name in (case.prefix_of(placed) + link, f"{placed.robot.name}/{link}"):
                    self._links[name] = keys

    def keys_of(self, name: str, time: float) -> dict[str, str]:
        """A body: a link of a robot, an object that a link holds or bears then, or one of the world."""
        if name in self._links:
            return {"type": ROBOT_LINK, **self._links[name]}
        by = self._bearer(name, time)
        if by in self._links:
            return {"type": ROBOT_ATTACHED, "id": name, **self._links[by]}
        return {"type": WORLD_OBJECT, "id": name}

    def attached(self, time: float) -> Iterator[dict[str, str]]:
        """The bodies that links hold or bear then."""
        for name in dict.fromkeys([*self._on, *(carry.part for carry in self._carries)]):
            keys = self.keys_of(name, time)
            if keys["type"] == ROBOT_ATTACHED:
                yield keys

    def _bearer(self, name: str, time: float) -> str:
        """What carries an obstacle then, or what it is on; nothing if it depends on no other body."""
        for carry in self._carries:
            if carry.part == name and carry.window.start <= time < carry.window.end:
                return carry.by
        return self._on.get(name, "")


def _overlap(record: Record, moment: Moment) -> dict[str, Any]:
    """Penetration depth of two bodies, where it is computed, and the separation vector of the first."""
    asked = (moment.step, moment.link, moment.obstacle)
    for row in record.worked_out:
        found, pair = row.known, (row.step, row.link, row.obstacle)
        if found is not None and pair == asked and not moment.between:
            vector = found.penetration * found.direction
            return {"depth": found.penetration, "separation_vector": _vector(vector)}
    return {}


def _states(record: Record, names: _Names, moment: Moment) -> Iterator[dict[str, Any]]:
    """The state of each robot, as `moveit_msgs/RobotState` has it; of the joints that do not follow others."""
    attached = [*names.attached(moment.time)]
    for motion, positions in zip(record.motions, moment.positions, strict=True):
        robot = motion.placed.robot.name
        parts = [
            {"link_name": one["link_name"], "object": {"id": one["id"]}}
            for one in attached
            if one.get("robot", robot) == robot
        ]
        yield {
            "robot": robot,
            "joint_state": {"name": [*motion.joint_names], "position": positions.tolist()},
            "attached_collision_objects": parts,
            "is_diff": False,
        }


FILE_NAME = "worst_moments.yaml"

_HEAD = """\
# The worst moments of a run: metres, radians, seconds, points in the world of the case; bodies and states as
# MoveIt names them. First the most critical moment, then each pair and rule that comes near or below a limit,
# as many as a file holds: n_left_out are not listed.
"""


def moments_text(model: ReportModel) -> str:
    """The file's text; the same data give the same."""
    return _HEAD + "\n".join(_lines(moments_of(model))) + "\n"


def _lines(given: dict[str, Any]) -> Iterator[str]:
    """The lines of a mapping: what is flat in one line, lists of mappings item by item."""
    for key, value in given.items():
        if not (isinstance(value, list) and value and isinstance(value[0], dict)) or _is_points(
            value
        ):
            yield f"{key}: {_flow(value)}"
            continue
        yield f"{key}:"
        for one in value:
            for i, line in enumerate(_lines(one)):
                yield f"{'  ' if i else '- '}{line}"


def _is_points(value: list[dict[str, Any]]) -> bool:
    return set(value[0]) == set("xyz")


def _flow(value: Any) -> str:
    """A value as YAML on one line, which YAML 1.1 and 1.2 read alike; doubles come back bit for bit."""
    if isinstance(value, dict):
        return "{" + ", ".join(f"{key}: {_flow(one)}" for key, one in value.items()) + "}"
    if isinstance(value, list):
        return "[" + ", ".join(map(_flow, value)) + "]"
    if isinstance(value, float):
        text = repr(value)
        return text if "." in text else text.replace("e", ".0e")
    return json.dumps(value, ensure_ascii=False)
