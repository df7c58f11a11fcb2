"""Times of actors that may come from two clocks, or from one in another unit, or that lack something."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from functools import partial
from typing import NamedTuple

import numpy as np

from clearance.world.case import Case
from clearance.world.notice import Notice, Severity, listed, units
from clearance.world.plausible_motion import CREEP_SLIDE, CREEP_TURN, greatest_speeds
from clearance.world.plausible_tables import changes, greatest_speeds_in
from clearance.world.timing import Timing, time_text
from clearance.world.trajectory import FURTHER_PASSES, Trajectory

SKEW = 1e-3
"""[s] Recordings that begin within it begin together. Beyond it, and within an interval of theirs, each began with
its first message: that is a warning."""

LATENCY = 0.1
"""[s] Two messages that are sent at once are received, or stamped, within it."""

LONGER = 100.0
"""A table in milliseconds takes at least so many times as long as all else that moves: both are of one work, and
milliseconds read as seconds are 1000 times as long."""

STANDS, MINUTE = 20.0, 60.0
"""[-], [s] A cell stands this many times as long as all its tables take, and longer than a minute, where a `start`
or times are milliseconds."""

SLOW_SLIDE, SLOW_TURN = 5e-3, 1e-2
"""[m/s], [rad/s] A thousandth of what conveyors, slides and joints do at most."""


class _Table(NamedTuple):
    """The owner of a table, and its start and end in the run [s]; the end is infinite if it repeats.

    Attributes:
        length: [s] of the run, once through. speeds: what gives its greatest speeds [m/s], [rad/s].
        moves: False for what stands, and is in the cell for this time only.
    """

    start: float
    end: float
    name: str
    timing: Timing
    length: float
    speeds: Callable[[], Sequence[float]]
    moves: bool

    @property
    def text(self) -> str:
        until = "on" if self.end == math.inf else f"to {time_text(self.end)} s"
        does = "moves" if self.moves else "is in the cell"
        return f"{self.name} {does} from {time_text(self.start)} {until}"

    @property
    def is_slow(self) -> bool:
        """True for what would be as fast as things in cells are, if its times were in milliseconds."""
        slide, turn = self.speeds()
        return slide <= SLOW_SLIDE and turn <= SLOW_TURN

    @property
    def creeps(self) -> bool:
        """True for what is so slow that it is suspect by itself."""
        slide, turn = self.speeds()
        return slide <= CREEP_SLIDE and turn <= CREEP_TURN


def notices_on_clocks(case: Case) -> list[Notice]:
    """Notices on tables that end before others begin, and on recordings that are shifted against their stamps."""
    if case.clock.slack == math.inf:
        return []
    tables = sorted(_tables(case))
    return [
        *_times_lacking(case),
        *_never_together(tables),
        *_a_thousand_times_as_long([table for table in tables if table.moves]),
        *_recordings_begin_unlike(case),
        *_recorded_tables_begin_later(case),
    ]


def _never_together(tables: Sequence[_Table]) -> Iterator[Notice]:
    """Notices on tables that end before others begin; where the case says `start` or `after`, if that is long."""
    lengths = [table.length for table in tables if table.moves]
    far = max(MINUTE, STANDS * sum(lengths))
    for i, later in enumerate(tables):
        before = [table for table in tables[:i] if table.moves]
        earlier = max(before, key=lambda table: table.end, default=later)
        wait = later.start - earlier.end
        if wait <= 0.0:
            continue
        if not (earlier.timing.says_after or later.timing.says_start):
            text = (
                f"CHECK CLOCKS: {earlier.text}, {later.text}: they never move together; do their times "
                "come from one clock? If so, give the later table a `start:`, or the earlier one `after: hold`"
            )
            yield Notice(Severity.SUSPECT, "clocks", text)
        elif wait > (max(lengths) if later.timing.start else far):
            text = (
                f"nothing moves from {time_text(earlier.end)} to {time_text(later.start)} s, when {later.name} "
                "begins: `start` and times are in seconds, is this milliseconds?"
            )
            if wait > far:
                yield units(text)
            else:
                yield Notice(Severity.WARNING, "units", text)


def _a_thousand_times_as_long(tables: Sequence[_Table]) -> Iterator[Notice]:
    """Notices on slow tables that take many times as long as all that is not slow."""
    others = [table for table in tables if not table.is_slow] if len(tables) > 1 else []
    if not others:
        return
    usual = max(others, key=lambda table: table.length)
    for table in tables:
        if table.is_slow and not table.creeps and table.length > LONGER * usual.length > 0.0:
            slide, turn = table.speeds()
            text = (
                f"{table.name} takes {table.length:g} s, and moves no faster than "
                f"{slide * 1000:.3g} mm/s and {turn:.3g} rad/s, while {usual.name} takes "
                f"{usual.length:g} s; times are in seconds, is this milliseconds?"
            )
            yield units(text)


def _times_lacking(case: Case) -> Iterator[Notice]:
    """Notices on programs whose times lack something, or rest on what nobody says, beside others that move."""
    for placed in case.robots:
        asked = placed.trajectory
        if asked is None or not (asked.left_out or asked.is_rough):
            continue
        moving = [table.name for table in _tables(case) if table.moves]
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


class _Recording(NamedTuple):
    """Messages, or a table, that something was recorded to follow, or a message that it is to follow.

    Attributes:
        at_start: [s] what their clock showed at the run's time 0; NaN for a table, whose own times are the run's.
        begins: [s] of the run, their first sample. kind: whose they are, and name.
        usual: [s] between two samples, by their clock; of one message `LATENCY`.
        what: the word for it.
    """

    at_start: float
    begins: float
    kind: str
    name: str
    usual: float
    timing: Timing
    what: str = "recording"

    @staticmethod
    def of(
        kind: str, name: str, began: float | None, times: np.ndarray, timing: Timing
    ) -> _Recording:
        """That of samples, from what their clock showed at their time 0 [s]."""
        usual = float(np.median(np.diff(times))) if len(times) > 1 else 0.0
        at_start = math.nan if began is None else began - timing.start * timing.rate
        begins = float(timing.run_times(times)[0])
        return _Recording(at_start, begins, kind, name, usual, timing)

    @property
    def is_table(self) -> bool:
        """True for what does not count from 0 s."""
        return math.isnan(self.at_start)

    def after(self, first: _Recording, delay: str, taken: str, keeps: str, drops: str) -> str:
        """Text: it begins so late after another, how it is taken, and which starts keep and drop the delay."""
        whose = first.kind if first.kind != self.kind else ""
        return (
            f"CHECK CLOCKS: by its stamps the {self.what} of {self.kind}{self.name!r} begins {delay} s after "
            f"that of {whose}{first.name!r}, {taken}; beside its file, `start: {keeps}` keeps the delay "
            f"and `start: {drops}` drops it"
        )


def _recordings_begin_unlike(case: Case) -> Iterator[Notice]:
    """Notices on recordings that begin together in the case, but not by their stamps."""
    recorded = [one for one in _recordings(case) if not one.is_table]
    recorded.sort(key=lambda one: one.at_start)
    for i, later in enumerate(recorded[1:], 1):
        first = _first_like(recorded[:i], later, lambda one: one.at_start)
        delay = later.at_start - first.at_start
        if delay > SKEW and not later.timing.says_start:
            start = time_text(delay / later.timing.rate)
            text = later.after(first, start, "but it is taken from 0 s", keeps=start, drops="0")
            by_chance = delay <= max(later.usual, first.usual)
            yield Notice(Severity.WARNING if by_chance else Severity.SUSPECT, "clocks", text)


def _first_like(
    before: Sequence[_Recording], later: _Recording, begin: Callable[[_Recording], float]
) -> _Recording:
    """The first of those before another; one of its own kind where the delay after that is more than usual."""
    like = next((one for one in before if one.what == later.what), before[0])
    return like if begin(later) - begin(like) > max(later.usual, like.usual) else before[0]


def _recorded_tables_begin_later(case: Case) -> Iterator[Notice]:
    """Notices on recorded tables that by their own times begin more than an interval after something else.

    Beside another recording that is suspect; beside a motion that is planned, a warning.
    """
    recorded = sorted(_recordings(case), key=lambda one: one.begins)
    earliest = min((table.start for table in _tables(case)), default=math.inf)
    lacks = "and no sample says where it is until then"
    for i, later in enumerate(recorded):
        first = _first_like(recorded[: i + 1], later, lambda one: one.begins)
        wait = later.begins - first.begins
        if not later.is_table or later.timing.says_start:
            continue
        if wait > max(later.usual, first.usual):
            delay = time_text(wait)
            text = later.after(first, delay, lacks, keeps="0", drops=f"-{delay}")
            yield Notice(Severity.SUSPECT, "clocks", text)
        elif later.begins - earliest > later.usual:
            text = f"{later.kind}{later.name!r} is recorded from {time_text(later.begins)} s on, {lacks}"
            yield Notice(Severity.WARNING, "clocks", f"{text}; `start: 0` beside its file says so")


def _recordings(case: Case) -> Iterator[_Recording]:
    """Of the robots, and of the obstacles that move."""
    for placed in case.robots:
        asked = placed.trajectory and placed.given_trajectory
        if asked is None:
            continue
        is_table = asked.is_recorded and placed.recording is None
        if asked.began is not None or (is_table and np.ptp(asked.positions, axis=0).any()):
            found = _Recording.of(
                "robot ", placed.robot.name, asked.began, asked.times, placed.timing
            )
            is_message = asked.is_message
            yield found._replace(usual=LATENCY, what="message") if is_message else found
    for obstacle in case.obstacles:
        moves = obstacle.moves
        if moves is not None and moves.began is not None and changes(moves):
            yield _Recording.of("obstacle ", obstacle.name, moves.began, moves.times, moves.timing)


def _tables(case: Case) -> Iterator[_Table]:
    """Of all that moves, and of what stands but comes and goes."""
    for placed in case.robots:
        if placed.trajectory is not None:
            name, asked = f"robot {placed.robot.name!r}", placed.trajectory
            speeds, moves = partial(greatest_speeds, placed), np.ptp(asked.positions, axis=0).any()
            yield from _table(name, asked.times, placed.timing, speeds, bool(moves))
    for obstacle in case.obstacles:
        if obstacle.moves is not None:
            name, table = f"obstacle {obstacle.name!r}", obstacle.moves
            speeds = partial(greatest_speeds_in, table)
            yield from _table(name, table.times, table.timing, speeds, changes(table))


def _table(
    name: str,
    times: np.ndarray,
    timing: Timing,
    speeds: Callable[[], Sequence[float]],
    moves: bool,
) -> Iterator[_Table]:
    if moves or timing.after == "absent":
        start, end = timing.run_times(times)[[0, -1]].tolist()
        until = math.inf if timing.after == "loop" else end
        yield _Table(start, until, name, timing, end - start, speeds, moves)
