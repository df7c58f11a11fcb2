"""Notes on joints that nobody gives a value, and on how what moves does so between the rows of its table, and
before the first and after the last.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator

import numpy as np

from clearance.world.case import Case
from clearance.world.notice import listed, naming
from clearance.world.robot import Robot
from clearance.world.timing import Timing, time_text

MOST_NAMES = 8
"""Of things that do the same, how many a note names."""


_Deed = tuple[str, str]
"""What is said of one thing, and what of several."""

_HOW = "by straight translation, and rotation about one axis at constant speed"


def notes_on_motion(case: Case, start: float, end: float) -> tuple[str, ...]:
    """One line for each kind of motion that a reader could take to be otherwise.

    Args:
        start, end: [s] of the run.
    """
    alike: dict[tuple[str, _Deed], list[str]] = {}
    for kind, name, deed in _deeds(case, start, end):
        alike.setdefault((kind, deed), []).append(repr(name))
    return tuple(
        f"{kind} {names[0]} {one}"
        if len(names) == 1
        else f"{kind}s {listed(names, MOST_NAMES)} {several}"
        for (kind, (one, several)), names in alike.items()
    )


def _deeds(case: Case, start: float, end: float) -> Iterator[tuple[str, str, _Deed]]:
    """A robot or an obstacle, its name, and what it does."""
    moving = [one for one in case.obstacles if one.moves is not None]
    for obstacle in moving:
        between = f"moves between the poses of its table {_HOW}"
        several = f"move between the poses of their tables {_HOW}"
        yield "obstacle", obstacle.name, (between, several)
    for placed in case.robots:
        if placed.trajectory is not None:
            span = _span(placed.trajectory.times, placed.timing)
            for deed in _before_and_after(span, placed.timing, start, end):
                yield "robot", placed.robot.name, deed
    for obstacle in moving:
        assert obstacle.moves is not None
        span = _span(obstacle.moves.times, obstacle.moves.timing)
        starts = (one.window.start for one in case.carries if one.part == obstacle.name)
        picked_up = min(starts, default=math.inf)
        for deed in _before_and_after(span, obstacle.moves.timing, start, end, picked_up):
            yield "obstacle", obstacle.name, deed
        if picked_up < span[1]:
            until = f"picked up at {time_text(picked_up)} s"
            deed = (
                f"follows its table until it is {until}",
                f"follow their tables until they are {until}",
            )
            yield "obstacle", obstacle.name, deed


def _span(times: np.ndarray, timing: Timing) -> tuple[float, float]:
    """The first and last sample of a table [s] of the run."""
    first, last = timing.run_times(times[[0, -1]] if len(times) > 1 else times)[[0, -1]].tolist()
    return first, last


def _before_and_after(
    span: tuple[float, float], timing: Timing, start: float, end: float, picked_up: float = math.inf
) -> Iterator[_Deed]:
    """What something does before and after its table.

    Args:
        picked_up: [s] when it is picked up, which ends its table.
    """
    first, last = span
    early, late = start < first, last < min(end, picked_up)
    if timing.after == "absent":
        if early or late:
            until = "" if early and picked_up < math.inf else f" to {time_text(last)} s only"
            when = f"in the cell from {time_text(first)} s{until} (after: absent)"
            yield f"is {when}", f"are {when}"
        return
    if early:
        when = f"until {time_text(first)} s"
        yield f"stands at its first sample {when}", f"stand at their first samples {when}"
    if late and timing.after == "loop":
        how = f"again and again, every {last - first:g} s (after: loop)"
        yield f"goes through its table {how}", f"go through their tables {how}"
    elif late:
        when = f"from {time_text(last)} s"
        yield f"stands at its last sample {when}", f"stand at their last samples {when}"


def note_on_joints_at_zero(robot: Robot, given: Iterable[str], field: str) -> list[str]:
    """A note naming the moving joints that nobody gives a value; they stay at 0.

    Args:
        field: where a case file could give them one.
    """
    known = set(given)
    at_zero = [joint.name for joint in robot.moving_joints if joint.name not in known]
    return naming(f"joints given neither by the trajectory nor by {field} stay at 0", at_zero, 8)
