"""When a limit was passed and for how long, read from the status of each step. Not for: judging a
step."""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass

import numpy as np

from clearance.simulate.record import Record
from clearance.simulate.replay import codes_of
from clearance.simulate.steps import STATUSES

LEVELS = {"below_warn": 1, "below_fail": 2, "contact": 3}
"""Each level and the least status code that belongs to it."""

_ENTERED = {
    "below_warn": "warn limit entered",
    "below_fail": "fail limit entered",
    "contact": "contact begins",
}
_LEFT = {
    "below_warn": "warn limit left",
    "below_fail": "fail limit left",
    "contact": "contact ends",
}
_VERDICTS = ("clear", "near miss", "violated", "violated")


@dataclass(frozen=True)
class Interval:
    """A longest run of steps at one level.

    Attributes:
        first_step, last_step: both inside. start, end: their times [s]. worst_step: the first step
            of least clearance; clearance [m], link and obstacle are of that step.
    """

    first_step: int
    last_step: int
    start: float
    end: float
    worst_step: int
    clearance: float
    link: str
    obstacle: str


@dataclass(frozen=True)
class Event:
    """A step at which a level was entered, or the first step after it was left."""

    step: int
    time: float  # [s]
    what: str
    clearance: float | None  # [m]; unknown, and so are the names, where a bound decides
    link: str | None
    obstacle: str | None


def verdict(record: Record) -> str:
    """The worst that any step or profile says: "clear", "near miss" or "violated"."""
    if not all(answer.passed for answer in record.profiles):
        return _VERDICTS[max(codes_of(record.steps).max(), _VERDICTS.index("violated"))]
    return _VERDICTS[int(codes_of(record.steps).max())]


def intervals(record: Record) -> dict[str, list[Interval]]:
    """For each of `LEVELS` its intervals in order of time; none where only the least step is known."""
    if record.need == "minimum":
        return {level: [] for level in LEVELS}
    codes = codes_of(record.steps)
    return {
        level: [_interval(record, a, b) for a, b in _runs(codes >= least)]
        for level, least in LEVELS.items()
    }


def events(record: Record) -> list[Event]:
    """Every entering and leaving of a level in order of time; on one step, entering the wider level
    first. None where only the least step is known."""
    if record.need == "minimum":
        return []
    found: list[tuple[int, int, Event]] = []
    codes = codes_of(record.steps)
    for level, least in LEVELS.items():
        for start, stop in _runs(codes >= least):
            found.append((start, least, _event(record, start, _ENTERED[level])))
            if stop < len(codes):
                found.append((stop, -least, _event(record, stop, _LEFT[level])))
    return [event for *_, event in sorted(found, key=lambda item: item[:2])]


def time_at(record: Record, level: str) -> float:
    """[s] total length of the intervals of a level, from first to last step of each."""
    return sum(interval.end - interval.start for interval in intervals(record)[level])


def status_counts(record: Record) -> dict[str, int]:
    """How many steps have each status."""
    counts = Counter(record.steps["status"].to_pylist())
    return {str(name): counts[str(name)] for name in STATUSES}


def _runs(inside: np.ndarray) -> list[tuple[int, int]]:
    """Half-open index ranges of the runs of True."""
    change = np.flatnonzero(np.diff(np.concatenate([[False], inside, [False]]).astype(np.int8)))
    return [(int(a), int(b)) for a, b in change.reshape(-1, 2)]


def _interval(record: Record, start: int, stop: int) -> Interval:
    worst = start + int(np.argmin(record.clearances[start:stop]))
    row = record.steps.slice(worst, 1).to_pylist()[0]
    times = record.steps["time"]
    return Interval(
        first_step=start,
        last_step=stop - 1,
        start=times[start].as_py(),
        end=times[stop - 1].as_py(),
        worst_step=worst,
        clearance=row["clearance"],
        link=row["link"],
        obstacle=row["obstacle"],
    )


def _event(record: Record, step: int, what: str) -> Event:
    row = record.steps.slice(step, 1).to_pylist()[0]
    return Event(step, row["time"], what, row["clearance"], row["link"], row["obstacle"])
