"""When a limit was passed and for how long, read from the status of each step. Not for: judging a
step."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from clearance.simulate.record import Record
from clearance.simulate.replay import codes_of
from clearance.simulate.steps import STATUSES

MOST_LISTED = 10_000
"""Most intervals of a level, and most events, that are listed; the steps tables have the status of every step."""

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
    """For each of `LEVELS` its first `MOST_LISTED` intervals in order of time; none where only the least step is
    known."""
    clearances = record.clearances
    return {
        level: [_interval(record, clearances, int(a), int(b)) for a, b in runs[:MOST_LISTED]]
        for level, runs in _level_runs(record).items()
    }


def events(record: Record) -> list[Event]:
    """The first `MOST_LISTED` enterings and leavings of a level in order of time; on one step, entering the wider
    level first. None where only the least step is known."""
    steps, order, what = [], [], []
    for level, runs in _level_runs(record).items():
        left = runs[runs[:, 1] < record.steps.num_rows, 1]
        steps += [runs[:, 0], left]
        order += [np.full(len(runs), LEVELS[level]), np.full(len(left), -LEVELS[level])]
        what += [_ENTERED[level]] * len(runs) + [_LEFT[level]] * len(left)
    step = np.concatenate(steps)
    first = np.lexsort([np.concatenate(order), step])[:MOST_LISTED]
    return [_event(record, int(step[i]), what[i]) for i in first]


def not_listed(record: Record) -> dict[str, int]:
    """How many intervals of each level and how many events `intervals` and `events` leave out."""
    runs = _level_runs(record)
    n_steps = record.steps.num_rows
    n_events = sum(len(found) + int((found[:, 1] < n_steps).sum()) for found in runs.values())
    counted = {level: len(found) for level, found in runs.items()} | {"events": n_events}
    return {name: max(0, number - MOST_LISTED) for name, number in counted.items()}


def extent(record: Record, level: str) -> tuple[int, int]:
    """How many intervals of a level there are, and of how many steps."""
    runs = _level_runs(record)[level]
    return len(runs), int((runs[:, 1] - runs[:, 0]).sum())


def _level_runs(record: Record) -> dict[str, np.ndarray]:
    """For each of `LEVELS` (k, 2) first step and step after the last of its runs."""
    codes = codes_of(record.steps)
    if record.need == "minimum":
        codes = codes[:0]
    return {level: _runs(codes >= least) for level, least in LEVELS.items()}


def status_counts(record: Record) -> dict[str, int]:
    """How many steps have each status."""
    counted = record.steps["status"].value_counts().to_pylist()
    counts = {entry["values"]: entry["counts"] for entry in counted}
    return {str(name): counts.get(str(name), 0) for name in STATUSES}


def _runs(inside: np.ndarray) -> np.ndarray:
    """(k, 2) half-open index ranges of the runs of True."""
    change = np.flatnonzero(np.diff(np.concatenate([[False], inside, [False]]).astype(np.int8)))
    return change.reshape(-1, 2)


def _interval(record: Record, clearances: np.ndarray, start: int, stop: int) -> Interval:
    worst = start + int(np.argmin(clearances[start:stop]))
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
