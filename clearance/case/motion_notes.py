"""Notes on joints that nobody gives a value, and on how what moves does so between the rows of its table, and
before the first and after the last.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator
from typing import NamedTuple

import numpy as np

from clearance.errors import DuplicateName
from clearance.world.case import Case
from clearance.world.notice import listed
from clearance.world.robot import Robot
from clearance.world.timing import Timing

MOST_NAMES = 8
"""Of things that do the same, how many a note names."""


class _Table(NamedTuple):
    """What moves, and when its table is followed: its first and last sample [s] of the run.

    Attributes:
        picked_up: [s] when it is picked up, which ends its table; infinite for what never is.
    """

    what: _Actor
    first: float
    last: float
    timing: Timing
    picked_up: float = math.inf


class _Actor(NamedTuple):
    """A robot or an obstacle, and its name."""

    kind: str
    name: str


class _Sentence(NamedTuple):
    """What is said of one thing, and what of several."""

    one: str
    several: str


_HOW = "by straight translation, and rotation about one axis at constant speed"
BETWEEN_POSES = _Sentence(
    f"moves between the poses of its table {_HOW}", f"move between the poses of their tables {_HOW}"
)


def notes_on_motion(case: Case, start: float, end: float) -> tuple[str, ...]:
    """One line for each kind of motion that a reader could take to be otherwise.

    Args:
        start, end: [s] of the run.
    """
    moving = [obstacle for obstacle in case.obstacles if obstacle.moves is not None]
    said = [(_Actor("obstacle", obstacle.name), BETWEEN_POSES) for obstacle in moving]
    for table in _tables(case):
        said += [(table.what, deed) for deed in _before_and_after(table, start, end)]
        if table.picked_up < table.last:
            said.append((table.what, _until_picked_up(table.picked_up)))
    alike: dict[tuple[str, _Sentence], list[str]] = {}
    for thing, deed in said:
        alike.setdefault((thing.kind, deed), []).append(repr(thing.name))
    return tuple(_line(kind, names, deed) for (kind, deed), names in alike.items())


def _line(kind: str, names: list[str], deed: _Sentence) -> str:
    if len(names) == 1:
        return f"{kind} {names[0]} {deed.one}"
    return f"{kind}s {listed(names, MOST_NAMES)} {deed.several}"


def _tables(case: Case) -> Iterator[_Table]:
    for placed in case.robots:
        if placed.trajectory is not None:
            times = placed.trajectory.times
            yield _table(_Actor("robot", placed.robot.name), times, placed.timing)
    for obstacle in case.obstacles:
        if obstacle.moves is not None:
            table = _table(
                _Actor("obstacle", obstacle.name), obstacle.moves.times, obstacle.moves.timing
            )
            starts = [c.window.start for c in case.carries if c.part == obstacle.name]
            yield table._replace(picked_up=min(starts, default=math.inf))


def _table(what: _Actor, times: np.ndarray, timing: Timing) -> _Table:
    first, last = timing.run_times(times[[0, -1]] if len(times) > 1 else times)[[0, -1]].tolist()
    return _Table(what, first, last, timing)


def _until_picked_up(time: float) -> _Sentence:
    return _Sentence(
        f"follows its table until it is picked up at {time:g} s",
        f"follow their tables until they are picked up at {time:g} s",
    )


def _before_and_after(table: _Table, start: float, end: float) -> Iterator[_Sentence]:
    _, first, last, timing, picked_up = table
    early, late = start < first, last < min(end, picked_up)
    if timing.after == "absent":
        if early and picked_up < math.inf:
            when = f"in the cell from {first:g} s (after: absent)"
            yield _Sentence(f"is {when}", f"are {when}")
        elif early or late:
            when = f"in the cell from {first:g} s to {last:g} s only (after: absent)"
            yield _Sentence(f"is {when}", f"are {when}")
        return
    if early:
        when = f"until {first:g} s"
        yield _Sentence(
            f"stands at its first sample {when}", f"stand at their first samples {when}"
        )
    if late and timing.after == "loop":
        how = f"again and again, every {last - first:g} s (after: loop)"
        yield _Sentence(f"goes through its table {how}", f"go through their tables {how}")
    elif late:
        when = f"from {last:g} s"
        yield _Sentence(f"stands at its last sample {when}", f"stand at their last samples {when}")


def check_not_given_twice(in_case: Iterable[str], in_trajectory: Iterable[str]) -> None:
    """Refuses a fixed value for a joint that the trajectory moves.

    Raises:
        DuplicateName: with the joint.
    """
    columns = set(in_trajectory)
    for name in in_case:
        if name in columns:
            raise DuplicateName(
                f"joint {name!r} is also a column of the trajectory", valid="give it in one place"
            )


def note_on_joints_at_zero(robot: Robot, given: Iterable[str], field: str) -> list[str]:
    """A note naming the moving joints that nobody gives a value; they stay at 0.

    Args:
        field: where a case file could give them one.
    """
    known = set(given)
    at_zero = [joint.name for joint in robot.moving_joints if joint.name not in known]
    if not at_zero:
        return []
    return [
        f"joints given neither by the trajectory nor by {field} stay at 0: {listed(at_zero, 8)}"
    ]
