"""The joint trajectories in messages of ROS and MoveIt, found by their keys: JointTrajectory, RobotTrajectory,
DisplayTrajectory, and the goals and results that hold one of them.

Not for: files (`message.documents`), nor the points of a trajectory (`joint_points`).
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any, NamedTuple

from clearance.errors import BadInput, BadMotion, BadShape, MissingKey, nearest_name
from clearance.formats.message.documents import (
    DEPTH,
    Fields,
    described,
)

_HOLDERS = (
    "joint_trajectory",
    "trajectory",
    "goal",
    "request",
    "result",
    "motion_plan_response",
    "planned_trajectory",
    "solution",
)
"""Keys under which a message holds another one, or a list of them, that may be a trajectory."""

_OF_BASES = ("multi_dof_joint_trajectory", "multi_dof_trajectory")
"""Keys of what joints with several degrees of freedom do, beside what the others do."""

READ = (*_HOLDERS, *_OF_BASES)
"""Keys around a trajectory that are looked into."""

_SHOWN = 8
"""Trajectories listed where one must be chosen."""


class JointMessage(NamedTuple):
    """A trajectory in a file.

    Attributes:
        place: the keys that lead to it. trajectory: its keys and values.
        around: the messages that hold it, from the outermost in, each with the keys that lead to it.
        left_out: the keys that lead to other segments of the same message, where one is chosen.
        moved: the joints of those segments.
        n_others: how many trajectories the file holds beside it and them.
    """

    place: str
    trajectory: Fields
    around: tuple[tuple[str, Fields], ...] = ()
    left_out: tuple[str, ...] = ()
    moved: tuple[str, ...] = ()
    n_others: int = 0

    @property
    def n_points(self) -> int:
        """Its points."""
        return _n_points(self.trajectory)

    @property
    def others(self) -> dict[str, int]:
        """How many points of joints with several degrees of freedom are beside it, by the keys that lead there."""
        return {
            f"{place}.{key}".lstrip("."): _n_points(holder[key])
            for place, holder in self.around
            for key in _OF_BASES
            if isinstance(holder.get(key), Fields) and _n_points(holder[key])
        }


def messages_in(documents: Sequence[Any], most: int) -> list[JointMessage]:
    """The trajectories with points, in the order of the file.

    Args:
        most: how many values may be looked at, so that aliases do not make more of a file than it holds.

    Raises:
        MissingKey: there is none. BadShape: none has points, or too much is repeated.
    """
    found = []
    for i, document in enumerate(documents):
        has_line = isinstance(document, Fields) and document.line
        before = f"document {i + 1}" if len(documents) > 1 and not has_line else ""
        for n_visited, message in enumerate(_within(document, before)):
            if message is not None:
                found.append(message)
            if n_visited > most:
                raise BadShape("aliases repeat more than the file holds")
    if not found:
        raise _nothing_found(documents)
    moving = [one for one in found if one.n_points or one.others]
    if not moving:
        raise BadShape("the trajectory has no points", valid="at least one point is needed")
    return moving


def chosen(messages: Sequence[JointMessage], which: int | None) -> JointMessage:
    """The trajectory that is meant.

    Raises:
        BadInput: there are several and none is chosen, or not so many.
    """
    if which is None:
        if len(messages) > 1:
            raise BadMotion(
                f"the file holds {len(messages)} trajectories: {_listed(messages)}",
                valid="trajectory: {file: …, which: 1} takes the first",
            )
        which = 1
    if which > len(messages):
        raise BadMotion(
            f"which is {which}, the file holds {len(messages)}: {_listed(messages)}",
            valid=f"a number from 1 to {len(messages)}",
        )
    one = messages[which - 1]
    others = [other for other in messages if other is not one and _are_segments(one, other)]
    return one._replace(
        left_out=tuple(other.place for other in others),
        moved=tuple(name for other in others for name in _names_in(other)),
        n_others=len(messages) - 1 - len(others),
    )


def _names_in(message: JointMessage) -> list[str]:
    names = message.trajectory["joint_names"]
    return [one for one in names if isinstance(one, str)] if isinstance(names, list) else []


def _are_segments(one: JointMessage, other: JointMessage) -> bool:
    """True if the same message holds both."""
    return bool(one.around and other.around) and one.around[0][1] is other.around[0][1]


def _within(
    given: Any, place: str, around: tuple[tuple[str, Fields], ...] = (), level: int = 0
) -> Iterator[JointMessage | None]:
    """Every trajectory in a message, and nothing for each list, mapping or value looked at on the way."""
    yield None
    if level > DEPTH:
        raise BadShape("aliases nest deeper than the file")
    if isinstance(given, list):
        for i, one in enumerate(given):
            yield from _within(one, f"{place}[{i}]", around, level + 1)
    if not isinstance(given, Fields):
        return
    if {"joint_names", "points"} <= set(given):
        yield JointMessage(place, given, around)
        return
    around = (*around, (place, given))
    for key in _HOLDERS:
        if key in given:
            yield from _within(given[key], f"{place}.{key}".lstrip("."), around, level + 1)


def _n_points(message: Fields) -> int:
    """Its points; what is no list, and is refused later, counts as one."""
    points = message.get("points") or []
    return len(points) if isinstance(points, list) else 1


def _listed(messages: Sequence[JointMessage]) -> str:
    rows = [f"{i + 1}: {_described(message)}" for i, message in enumerate(messages[:_SHOWN])]
    more = len(messages) - _SHOWN
    return "; ".join([*rows, f"and {more} more"] if more > 0 else rows)


def _described(message: JointMessage) -> str:
    names = message.trajectory.get("joint_names")
    n_joints = len(names) if isinstance(names, list) else 0
    line = message.trajectory.line
    parts = [f"line {line}" if line else "", message.place]
    where = " ".join(part for part in parts if part)
    return f"{where}, {message.n_points} points of {n_joints} joints".lstrip(", ")


def _nothing_found(documents: Sequence[Any]) -> BadInput:
    if not documents:
        return BadShape("the file is empty", valid="a JointTrajectory message is needed")
    first = documents[0]
    if not isinstance(first, Fields):
        return MissingKey(f"{described(first)} is not a message", valid=_NEEDED)
    if "joint_names" in first or "points" in first:
        lacks = "points" if "joint_names" in first else "joint_names"
        others = [key for key in first if key not in ("joint_names", "points")]
        near = nearest_name(lacks, others) if others else ""
        return MissingKey(
            f"there is no {lacks!r}", valid=near if near.startswith("did") else _NEEDED
        )
    if {"name", "position"} <= set(first):
        return MissingKey(
            "this is a JointState, as a robot reports its joints",
            valid="a bag of them (ros2 bag record), or a CSV of time and joints; "
            "in YAML and JSON a JointTrajectory",
        )
    keys = f"under the keys {', '.join(map(repr, first)):.80}" if first else "in an empty message"
    return MissingKey(f"there is no trajectory {keys}", valid=_NEEDED)


_NEEDED = (
    "a message with joint_names and points, or with joint_trajectory, trajectory or goal, is needed"
)
