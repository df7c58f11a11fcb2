"""Values of a case that can be right but look wrong: lengths, angles or times in another unit, joints beyond
their limits.

Works on the case itself, so that one made in memory is checked like one from files.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from clearance.world.case import Case
from clearance.world.extents import metres
from clearance.world.joint_limits import notices_on_joints
from clearance.world.joint_speeds import STEP_SLIDE, STEP_TURN, notices_on_speed
from clearance.world.notice import WRAP, Notice, Severity, listed, worst_first
from clearance.world.placed_robot import PlacedRobot
from clearance.world.plausible_motion import (
    CREEP_SLIDE,
    CREEP_TURN,
    LEAST_SLIDE,
    LEAST_TURN,
    greatest_speeds,
    notices_on_motion,
)
from clearance.world.plausible_recordings import notices_on_holes
from clearance.world.plausible_rest import notices_on_bases, notices_on_rest
from clearance.world.plausible_scans import notices_on_scans
from clearance.world.plausible_sizes import notices_on_sizes
from clearance.world.plausible_wrap import notices_on_wrap
from clearance.world.pose_table import PoseTable
from clearance.world.timing import Timing
from clearance.world.trajectory import FURTHER_PASSES, Trajectory
from clearance.world.unproven_motion import notices_on_unproven

LARGE_LIMIT = 0.5
"""[m] A clearance limit above half a metre would forbid a robot most of its cell; in millimetres it
is usual.
"""


def notices_of(case: Case) -> tuple[Notice, ...]:
    """All that is suspect about a case, and all warnings, worst first: what loading found and what is seen here.

    Raises:
        BadInput: `limits.joints` is neither "warn" nor "fail".
    """
    found = [*case.notices, *_notices_of_robots(case)]
    found += _notices_on_limits(case)
    found += _notices_on_padding(case)
    found += notices_on_sizes(case)
    found += notices_on_scans(case)
    found += [one for placed in case.robots for one in notices_on_bases(placed)]
    found += notices_on_tables(case)
    found += notices_on_clocks(case)
    found += _rides_with_tolerance(case)
    moves = [placed.trajectory is not None for placed in case.robots]
    moves += [obstacle.moves is not None for obstacle in case.obstacles]
    for placed in case.robots:
        if not any(moves):
            break  # no robot has to move
        before = case.prefix_of(placed)
        if placed.trajectory is not None:
            found += notices_on_motion(placed, before)
            found += notices_on_rest(placed, before)
            found += notices_on_speed(placed, case.limits.joints, before)
            found += notices_on_holes(placed, before)
            found += notices_on_unproven(placed, before)
            found += notices_on_wrap(placed, before)
        found += notices_on_joints(placed, case.limits.joints, before)
    return worst_first(found)


def _notices_of_robots(case: Case) -> list[Notice]:
    """Notices of loading about the robots; with several robots each says whose it is."""
    whose: dict[Notice, list[str]] = {}
    for placed in case.robots:
        for notice in placed.robot.notices:
            whose.setdefault(notice, []).append(repr(placed.robot.name))
    if len(case.robots) == 1:
        return list(whose)
    return [
        replace(notice, text=f"{notice.text} (robot {listed(names)})")
        for notice, names in whose.items()
    ]


def _notices_on_limits(case: Case) -> list[Notice]:
    limits = case.limits
    given = {"limits.fail": limits.fail, "limits.warn": limits.warn}
    for i, rule in enumerate(limits.rules):
        levels = {"fail": rule.fail, "warn": rule.warn}
        given |= {f"limits.rules[{i}].{key}": level for key, level in levels.items() if level}
    given |= {f"profiles[{i}].limit": space.limit for i, space in enumerate(case.profiles)}
    large = [f"{key} is {value:g} m" for key, value in given.items() if value > LARGE_LIMIT]
    return _in_millimetres(large, "limits are")


def _notices_on_padding(case: Case) -> list[Notice]:
    given = {f"obstacle {one.name!r}": one.padding for one in case.obstacles}
    for placed in case.robots:
        before = case.prefix_of(placed)
        given |= {f"link {before + link!r}": padding for link, padding in placed.padding.items()}
    large = [
        f"the padding of {what} is {value:g} m"
        for what, value in given.items()
        if value > LARGE_LIMIT
    ]
    return _in_millimetres(large, "paddings are")


def _in_millimetres(large: list[str], what: str) -> list[Notice]:
    if not large:
        return []
    names = " and ".join(large) if len(large) < 3 else listed(large)
    text = f"CHECK UNITS: {names}; {what} in metres, is this millimetres?"
    return [Notice(Severity.SUSPECT, "units", text)]


LARGE_TRAVEL = 100.0
"""[m] Nothing in a cell goes so far; in millimetres it is usual."""

FAST_SLIDE, FAST_TURN = 20.0, 100.0
"""[m/s], [rad/s] Nothing in a cell is so fast: delta robots reach 10 m/s. A table that jumps is."""


HALF_TURN = 2e-3
"""[rad] A turn that is as near to half a turn is one: quaternions of three digits are off by so much."""


def notices_on_tables(case: Case) -> list[Notice]:
    """Tables of obstacles that look like another unit, or leave a turn open."""
    texts, halves = [], []
    for obstacle in case.obstacles:
        if obstacle.moves is not None:
            texts += _odd(f"obstacle {obstacle.name!r}", obstacle.moves)
            halves += _half_turns(f"obstacle {obstacle.name!r}", obstacle.moves)
    notices = [Notice(Severity.SUSPECT, "units", f"CHECK UNITS: {text}") for text in texts]
    return [*notices, *(Notice(Severity.SUSPECT, WRAP, text) for text in halves)]


def _half_turns(what: str, table: PoseTable) -> list[str]:
    """Notice of half a turn of a body in a step, which is as far either way round."""
    cosines = np.abs((table.quaternions[1:] * table.quaternions[:-1]).sum(axis=1))
    steps = np.flatnonzero(2.0 * cosines < HALF_TURN)
    if not len(steps):
        return []
    start, end = table.times[steps[0] : steps[0] + 2].tolist()
    return [
        f"{what} turns by half a turn in one step, from {start:g} to {end:g} s, and its table does not say which "
        "way round; give a row between"
    ]


def _odd(what: str, table: PoseTable) -> list[str]:
    travel = float(np.linalg.norm(np.ptp(table.positions, axis=0)))
    if travel > LARGE_TRAVEL:
        return [f"{what} moves {metres(travel)} m; lengths are in metres, is this millimetres?"]
    if len(table) < 2:
        return []
    if _creeps(table):
        length = float(table.times[-1] - table.times[0]) / table.timing.rate
        return [
            f"{what} moves no faster than {CREEP_SLIDE * 1000:g} mm/s and {CREEP_TURN:g} rad/s in {length:g} s; "
            "times are in seconds, is this milliseconds?"
        ]
    return _jump(what, table)


def _jump(what: str, table: PoseTable) -> list[str]:
    """The fastest step of a table, if nothing is so fast. A short way is no jump: stamps can lie close."""
    for ways, least, fast, unit in zip(
        _ways(table), (STEP_SLIDE, STEP_TURN), (FAST_SLIDE, FAST_TURN), ("m", "rad"), strict=True
    ):
        speeds = np.where(ways > least, ways, 0.0) / _lengths(table)
        step = int(speeds.argmax())
        if speeds[step] > fast:
            start, end = table.times[step : step + 2].tolist()
            return [
                f"{what} goes {ways[step]:.3g} {unit} from {start:g} to {end:g} s of its table, at "
                f"{metres(speeds[step])} {unit}/s: does it jump, or are its lengths or times in another unit?"
            ]
    return []


def _ways(table: PoseTable) -> tuple[np.ndarray, np.ndarray]:
    """(n - 1,) [m] and [rad] How far a table goes and turns from sample to sample."""
    ways = np.linalg.norm(np.diff(table.positions, axis=0), axis=1)
    chords = np.linalg.norm(np.diff(table.quaternions, axis=0), axis=1)
    return ways, 4.0 * np.arcsin(np.minimum(1.0, chords / 2.0))


def _lengths(table: PoseTable) -> np.ndarray:
    """(n - 1,) [s] of the run from sample to sample."""
    return np.diff(table.times) / table.timing.rate


def _creeps(table: PoseTable) -> bool:
    """True for a motion that gets somewhere, but never faster than creeping."""
    ways, turns = _ways(table)
    lengths = _lengths(table)
    slow = (ways / lengths).max() <= CREEP_SLIDE and (turns / lengths).max() <= CREEP_TURN
    return bool(slow and (ways.sum() > LEAST_SLIDE or turns.sum() > LEAST_TURN))


SKEW = 1e-3
"""[s] Recordings that begin within it begin together. Beyond it, and within an interval of theirs, each began with
its first message: that is a warning."""


LONGER = 100.0
"""A table in milliseconds takes at least so many times as long as all else that moves: both are of one work, and
milliseconds read as seconds are 1000 times as long."""

SLOW_SLIDE, SLOW_TURN = 5e-3, 1e-2
"""[m/s], [rad/s] A thousandth of what conveyors, slides and joints do at most."""


class _Table(NamedTuple):
    """The owner of a table, and its start and end in the run [s]; the end is infinite if it repeats.

    Attributes:
        length: [s] of the run, once through. slide, turn: its greatest speeds [m/s], [rad/s].
    """

    start: float
    end: float
    name: str
    timing: Timing
    length: float
    slide: float
    turn: float

    @property
    def text(self) -> str:
        until = "on" if self.end == math.inf else f"to {self.end:.12g} s"
        return f"{self.name} moves from {self.start:.12g} {until}"

    @property
    def is_slow(self) -> bool:
        """True for what would be as fast as things in cells are, if its times were in milliseconds."""
        return self.slide <= SLOW_SLIDE and self.turn <= SLOW_TURN

    @property
    def creeps(self) -> bool:
        """True for what is so slow that it is suspect by itself."""
        return self.slide <= CREEP_SLIDE and self.turn <= CREEP_TURN


def notices_on_clocks(case: Case) -> list[Notice]:
    """Notices on tables that end before others begin, and on recordings that are shifted against their stamps.

    There is none where the case says `start` or `after`.
    """
    if case.clock.slack == math.inf:
        return []
    tables, found = sorted(_tables(case)), list(_times_lacking(case))
    for i, later in enumerate(tables[1:], 1):
        earlier = max(tables[:i], key=lambda table: table.end)
        meant = earlier.timing.says_after or later.timing.says_start
        if earlier.end < later.start and not meant:
            text = (
                f"CHECK CLOCKS: {earlier.text}, {later.text}: they never move together; do their times "
                "come from one clock? If so, give the later table a `start:`, or the earlier one `after: hold`"
            )
            found.append(Notice(Severity.SUSPECT, "clocks", text))
    return [*found, *_a_thousand_times_as_long(tables), *_recordings_begin_unlike(case)]


def _a_thousand_times_as_long(tables: Sequence[_Table]) -> Iterator[Notice]:
    """Notices on slow tables that take many times as long as all that is not slow."""
    usual = max(
        (table for table in tables if not table.is_slow),
        key=lambda table: table.length,
        default=None,
    )
    for table in tables if usual is not None else ():
        if table.is_slow and not table.creeps and table.length > LONGER * usual.length > 0.0:
            text = (
                f"CHECK UNITS: {table.name} takes {table.length:g} s, and moves no faster than "
                f"{table.slide * 1000:.3g} mm/s and {table.turn:.3g} rad/s, while {usual.name} takes "
                f"{usual.length:g} s; times are in seconds, is this milliseconds?"
            )
            yield Notice(Severity.SUSPECT, "units", text)


def _times_lacking(case: Case) -> Iterator[Notice]:
    """Notices on programs whose times lack something, or rest on what nobody says, beside others that move."""
    moving = [table.name for table in _tables(case)]
    for placed in case.robots:
        asked = placed.trajectory
        if asked is None or not (asked.left_out or asked.is_rough):
            continue
        own = [f"robot {name!r}" for name in (placed.robot.name, *asked.drives)]
        others = listed([name for name in moving if name not in own])
        if others and asked.left_out:
            text = (
                f"the times of {own[0]} leave out {listed(asked.left_out)}, and {others} moves too"
            )
            yield _lacking(text, asked, case.clock.slack)
        elif others and case.clock.slack == 0.0:
            text = f"the times of {own[0]} rest on accelerations that no file says, and {others} moves too"
            covers = "clock: {slack: seconds} covers what they may be off"
            yield Notice(Severity.WARNING, "clocks", f"{text}; {covers}")


def _lacking(text: str, asked: Trajectory, slack: float) -> Notice:
    """The notice on what a program's times lack: suspect; with slack a warning of what that has to cover."""
    if any(one.startswith(FURTHER_PASSES) for one in asked.left_out):
        says = "clock: unsynchronised measures them at all times of the others"
        return Notice(Severity.SUSPECT, "clocks", f"CHECK CLOCKS: {text}; {says}")
    if slack > 0.0:
        covers = f"all of it has to be within the slack of {slack:g} s"
        return Notice(Severity.WARNING, "clocks", f"{text}: {covers}")
    says = "clock: {slack: seconds} says by how much their times may be off"
    if asked.rides:
        says = (
            f"its tool goes with {listed([*asked.rides])}, so the program has to state these times"
        )
    return Notice(Severity.SUSPECT, "clocks", f"CHECK CLOCKS: {text}; {says}")


def _rides_with_tolerance(case: Case) -> Iterator[Notice]:
    """Warnings on tools that go with what has tolerances, which do not move them."""
    for placed in case.robots if case.tolerance is not None else ():
        if placed.trajectory is not None and placed.trajectory.rides:
            name, on = placed.robot.name, listed([*placed.trajectory.rides])
            text = (
                f"the tool of robot {name!r} goes with {on} exactly: a tolerance of {on} does not move the tool; "
                f"give robot {name!r} one as large if its controller measures where {on} is"
            )
            yield Notice(Severity.WARNING, "program", text, name)


def _recordings_begin_unlike(case: Case) -> Iterator[Notice]:
    """Notices on recordings that begin together in the case, but not by their stamps."""
    recorded = [one for one in case.robots if one.trajectory and one.trajectory.began is not None]
    recorded.sort(key=_clock_at_start)
    for later in recorded[1:]:
        delay = _clock_at_start(later) - _clock_at_start(recorded[0])
        if delay > SKEW and not later.timing.says_start:
            start = f"{delay / later.timing.rate:.6g}"
            text = (
                f"CHECK CLOCKS: by its stamps the recording of robot {later.robot.name!r} begins {start} s after "
                f"that of {recorded[0].robot.name!r}, but it is taken from 0 s; beside its file, "
                f"`start: {start}` keeps the delay and `start: 0` drops it"
            )
            by_chance = delay <= max(_usual_interval(later), _usual_interval(recorded[0]))
            yield Notice(Severity.WARNING if by_chance else Severity.SUSPECT, "clocks", text)


def _usual_interval(placed: PlacedRobot) -> float:
    """[s] between two samples of a recording, by its clock."""
    intervals = np.diff(placed.given_trajectory.times)
    return float(np.median(intervals)) if len(intervals) else 0.0


def _clock_at_start(placed: PlacedRobot) -> float:
    """[s] What the clock of a recording showed at the run's time 0."""
    began = placed.given_trajectory.began
    assert began is not None
    return began - placed.timing.start * placed.timing.rate


def _tables(case: Case) -> Iterator[_Table]:
    for placed in case.robots:
        if placed.trajectory is not None and np.ptp(placed.trajectory.positions, axis=0).any():
            name = f"robot {placed.robot.name!r}"
            speeds = greatest_speeds(placed)
            yield _table(name, placed.trajectory.times, placed.timing, speeds)
    for obstacle in case.obstacles:
        if obstacle.moves is not None and _changes(obstacle.moves):
            name, moves = f"obstacle {obstacle.name!r}", obstacle.moves
            speeds = [float((ways / _lengths(moves)).max()) for ways in _ways(moves)]
            yield _table(name, moves.times, moves.timing, speeds)


def _changes(table: PoseTable) -> bool:
    return any(np.ptp(one, axis=0).any() for one in (table.positions, table.quaternions))


def _table(name: str, times: np.ndarray, timing: Timing, speeds: Sequence[float]) -> _Table:
    start, end = timing.run_times(times)[[0, -1]].tolist()
    until = math.inf if timing.after == "loop" else end
    return _Table(start, until, name, timing, end - start, *speeds)
