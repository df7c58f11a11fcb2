"""What can be gained: the least change of a kind, proven, with what no such change can do better.

Not for: how it is written down (`written`), told (`told`) or shown (`page`).
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field, replace
from os import PathLike
from pathlib import Path

import numpy as np

from clearance.errors import BadDimension, BadInput, UnknownRobot, nearest_name
from clearance.gains.binding import bound_by
from clearance.gains.blocked import (
    NOT_FOUND,
    TOO_LATE,
    Blocked,
    blocked_by,
    kept_still,
    unproven,
    worst_pair,
)
from clearance.gains.delay import least_delay
from clearance.gains.joint_ranges import require_within_limits
from clearance.gains.offsets import joint_offsets
from clearance.gains.search import Change, Found, Search
from clearance.gains.shift import Shift, base_shift, obstacle_shift
from clearance.gains.shortfalls import State
from clearance.gains.unreachable import least_offset, least_shift
from clearance.run import Question, Run, answer
from clearance.world.case import Case

KINDS = ("waypoints", "obstacle", "base", "timing")

OWN = {
    "robot": ("waypoints", "base", "timing"),
    "obstacle": ("obstacle",),
    "keep": ("waypoints",),
}
"""Which kinds what is named is of; of others it would be passed over."""

INTERVALS = (12, 24, 48, 96)
"""Of the splines of a path, the coarsest that is enough is taken."""

NO_WORSE = 1.05
"""[-] A change that is within this of what no change can beat is not sought elsewhere."""

INSIDE = 0.8
"""[-] Smaller shifts than the first are sought from so far on the other sides."""

FARTHER = (0.05, 0.1)
"""[m] From how far, where the first search found none."""

MOST_DELAY = 60.0
"""[s] That is looked at, if nothing is given."""


@dataclass(frozen=True)
class Asked:
    """What may be changed.

    Attributes:
        kind: one of `KINDS`. margin: [m] above the fail limits.
        robot, obstacle: names; where there is one, it need not be given.
        keep: (start, end) of the run [s] in which a path stays as it is. keep_ends: its ends stay.
        most_delay: [s].
    """

    kind: str
    margin: float = 0.0
    robot: str | None = None
    obstacle: str | None = None
    keep: tuple[tuple[float, float], ...] = ()
    keep_ends: bool = True
    most_delay: float = MOST_DELAY

    def __post_init__(self) -> None:
        if self.kind not in KINDS:
            raise BadInput(f"unknown kind {self.kind!r:.60}", valid=f"one of {', '.join(KINDS)}")
        for name, kinds in OWN.items():
            if getattr(self, name) and self.kind not in kinds:
                raise BadInput(
                    f"{name} is given, of which a change of kind {self.kind} knows nothing",
                    valid=f"{name} with kind {' or '.join(kinds)}",
                )
        if not 0.0 <= self.margin < np.inf:
            raise BadDimension(f"a margin of {self.margin!r:.60} m", valid="a length, 0 or more")
        if not 0.0 <= self.most_delay < np.inf:
            raise BadInput(f"a delay of {self.most_delay!r:.60} s", valid="a time, 0 or more")
        for start, end in self.keep:
            if not start <= end:
                raise BadInput(
                    f"from {start:g} s to {end:g} s is kept", valid="a start before its end"
                )


@dataclass(frozen=True, eq=False)
class Gain:
    """What a change comes to.

    Attributes:
        asked: what was to be changed. kept: every rule is proven to hold by the margin, in the changed case.
        case: the changed case; the best that was reached where it is not kept.
        change: (3,) [m] of a shift; (n, k) [rad or m] of the samples of a path; (1,) [s] of a delay.
        size: of it [m], [rad] or [s]; 0 where nothing had to be changed. lower_bound: no smaller change of the
            kind is enough; 0 where nothing is known. who: the robot or obstacle that is changed.
        before, after: certified runs of both cases, by their own limits.
        blocked: what stays too near, where it is not kept. binding: what the best that was reached is up against,
            a line each.
        n_measured: how many cases were measured.
        joint_names: of the columns of a path's change. case_file: what the case was read from, if it was.
    """

    asked: Asked
    kept: bool
    case: Case
    change: np.ndarray
    size: float
    lower_bound: float
    who: str
    before: Run
    after: Run
    blocked: Blocked | None
    n_measured: int
    joint_names: tuple[str, ...] = field(default=())
    binding: tuple[str, ...] = field(default=())
    case_file: Path | None = None

    @property
    def unit(self) -> str:
        """Of `size` and `lower_bound`."""
        return {"waypoints": "rad", "timing": "s"}.get(self.asked.kind, "m")


def gain(
    case: Case | str | PathLike[str],
    kind: str = "waypoints",
    *,
    margin: float = 0.0,
    robot: str | None = None,
    obstacle: str | None = None,
    keep: Sequence[tuple[float, float]] = (),
    keep_ends: bool = True,
    most_delay: float = MOST_DELAY,
) -> Gain:
    """The least change of a kind that was found to make every rule of a case hold, proven.

    Args:
        case: or the path of a case file.
        kind: "waypoints": smooth offsets of a robot's joints; "obstacle", "base": a shift along x, y and z, the
            joints as they are; "timing": a robot begins later.
        margin: [m] above the fail limits.
        robot, obstacle: what is changed; where there is one, it need not be named.
        keep: (start, end) of the run [s] in which a path stays as it is. keep_ends: its ends stay.
        most_delay: [s] that is looked at.

    Raises:
        BadInput: what cannot be changed. UnknownRobot, UnknownObstacle: with the nearest name.
    """
    from clearance.load.case_file import load_case

    kept = tuple((start, end) for start, end in keep)
    asked = Asked(kind, margin, robot, obstacle, kept, keep_ends, most_delay)
    if isinstance(case, Case):
        return gained(case, asked)
    if not isinstance(case, str | PathLike):
        given = type(case).__name__
        raise BadInput(f"a {given} is given", valid="a Case, or the path of a case file")
    return replace(gained(load_case(case), asked), case_file=Path(case))


def gained(case: Case, asked: Asked) -> Gain:
    """The gain of what is asked.

    Raises:
        BadInput: as `gain`; clocks that are not tied, where no pair has one time that could be looked at.
    """
    if case.clock.slack:
        raise BadInput("the clocks of the case are not tied", valid="clock: common")
    ways = {"timing": _by_delay, "waypoints": _by_path, "obstacle": _by_shift, "base": _by_shift}
    return ways[asked.kind](case, asked)


def _by_shift(case: Case, asked: Asked) -> Gain:
    shift, who = _shift(case, asked)
    search = Search(shift, asked.margin)
    first = search.state_at(np.zeros(3))
    at_least = least_shift(shift, first, asked.margin)
    blocked = blocked_by(first, shift.gradient, shift.handed)
    if blocked is not None:
        return _gain(case, asked, Found(first, None, 1), np.zeros(3), shift, at_least, who, blocked)
    found = _least_of_several(search, shift, first, at_least)
    return _gain(case, asked, found, found.state.x, shift, at_least, who, None)


def _least_of_several(search: Search, shift: Shift, first: State, at_least: float) -> Found:
    """The least of a search from where it is, and, where that may be beaten, from all sides."""
    best = search.from_state(first)
    if best.kept and shift.size(best.state.x) <= NO_WORSE * at_least:
        return best
    for start in _starts(shift.size(best.state.x) if best.kept else None):
        state = search.state_at(start)
        if best.kept and state.touches:
            continue
        found = search.from_state(state, shift.size(best.state.x) if best.kept else np.inf)
        if found.kept:
            best = found
    return best


def _starts(size: float | None) -> Iterator[np.ndarray]:
    """(3,) [m] shifts to search from, after one of a size was found, or, with None, after none was."""
    axes = (*np.eye(3), *-np.eye(3))
    for far in FARTHER if size is None else (INSIDE * size,):
        yield from (far * side for side in axes)


def _by_path(case: Case, asked: Asked) -> Gain:
    i_robot = _robot(case, asked.robot)
    who = case.robots[i_robot].robot.name
    require_within_limits(case.robots[i_robot])
    for n_intervals in INTERVALS:
        offsets = joint_offsets(case, i_robot, n_intervals, _kept(case, i_robot, asked))
        search = Search(offsets, asked.margin)
        first = search.state_at(np.zeros(offsets.n_joints * offsets.n_splines))
        at_least = least_offset(offsets, first, asked.margin)
        blocked = blocked_by(first, offsets.gradient, offsets.handed)
        if blocked is not None:
            blocked = kept_still(blocked, _windows(case, i_robot, asked))
        found = Found(first, None, 1) if blocked else search.from_state(first)
        if found.kept:
            break
    change = offsets.offsets(found.state.x)
    told = _gain(case, asked, found, change, offsets, at_least, who, blocked)
    return replace(told, joint_names=offsets.placed.asked.joint_names)


def _kept(case: Case, i_robot: int, asked: Asked) -> tuple[tuple[float, float], ...]:
    """The windows of the robot's table [s] in which its path stays as it is: from sample to sample, since those
    next to a window draw the path in it."""
    timing, times = case.robots[i_robot].timing, case.robots[i_robot].asked.times
    kept = []
    for window in asked.keep:
        start, end = ((time - timing.start) * timing.rate for time in window)
        before = max(int(np.searchsorted(times, start, side="right")) - 1, 0)
        after = min(int(np.searchsorted(times, end)), len(times) - 1)
        kept.append((times[before], times[after]))
    if asked.keep_ends:
        kept += [(times[0], times[0]), (times[-1], times[-1])]
    return tuple((float(start), float(end)) for start, end in kept)


def _windows(case: Case, i_robot: int, asked: Asked) -> list[tuple[float, float]]:
    """The same in times of the run; before its path begins and after it ends the robot stands at an end that may
    be kept."""
    timing, times = case.robots[i_robot].timing, case.robots[i_robot].asked.times
    found = []
    for start, end in _kept(case, i_robot, asked):
        first = -np.inf if start <= times[0] else timing.start + start / timing.rate
        last = np.inf if end >= times[-1] else timing.start + end / timing.rate
        found.append((float(first), float(last)))
    return found


def _gain(
    case: Case,
    asked: Asked,
    found: Found,
    change: np.ndarray,
    way: Change,
    at_least: float,
    who: str,
    blocked: Blocked | None,
) -> Gain:
    size = way.size(found.state.x)
    before, after = answer(Question(case)), answer(Question(found.state.case))
    binding: tuple[str, ...] = ()
    if found.kept:
        at_least = min(at_least, size)
    elif blocked is None:
        blocked = worst_pair(found.state, NOT_FOUND) or unproven(after.record, asked.margin)
        robot = found.state.case.robots[_robot(case, who)] if asked.kind == "waypoints" else None
        binding = bound_by(found.state, blocked, robot)
    return Gain(
        asked, found.kept, found.state.case, change, size, at_least, who, before, after, blocked,
        found.n_measured, binding=binding,
    )  # fmt: skip


def _by_delay(case: Case, asked: Asked) -> Gain:
    i_robot = _robot(case, asked.robot)
    found = least_delay(case, i_robot, asked.margin, asked.most_delay)
    before, after = answer(Question(case)), answer(Question(found.state.case))
    blocked = None
    if not found.kept:
        blocked = worst_pair(found.state, TOO_LATE) or unproven(after.record, asked.margin)
    return Gain(
        asked, found.kept, found.state.case, np.array([found.delay]), found.delay, found.at_least,
        case.robots[i_robot].robot.name, before, after, blocked, found.n_measured,
    )  # fmt: skip


def _shift(case: Case, asked: Asked) -> tuple[Shift, str]:
    if asked.kind == "base":
        who = case.robots[_robot(case, asked.robot)].robot.name
        return base_shift(case, who), who
    if asked.obstacle is None and len(case.obstacles) != 1:
        names = ", ".join(obstacle.name for obstacle in case.obstacles[:8])
        raise BadInput("which obstacle may be moved is not said", valid=f"one of {names}")
    who = asked.obstacle or case.obstacles[0].name
    return obstacle_shift(case, who), who


def _robot(case: Case, name: str | None) -> int:
    """Which robot is meant.

    Raises:
        UnknownRobot: with the nearest name. BadInput: none is named, and there are several.
    """
    names = [placed.robot.name for placed in case.robots]
    if name is None and len(names) > 1:
        raise BadInput("which robot may be changed is not said", valid=f"one of {', '.join(names)}")
    if name is not None and name not in names:
        raise UnknownRobot(f"there is no robot {name!r}", valid=nearest_name(name, names))
    return 0 if name is None else names.index(name)
