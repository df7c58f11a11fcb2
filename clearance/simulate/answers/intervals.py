"""When a limit was passed and for how long: by the certified motion, else by the status of steps."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from clearance.record.levels import LEVELS, Event, Interval
from clearance.record.record import Record
from clearance.record.row_status import RowStatus, status_codes_of
from clearance.simulate.answers.measured_run import MeasuredRun, MotionLevels, Span, moment_fields
from clearance.simulate.answers.stretches import runs_of

MOST_LISTED = 10_000
"""Most intervals of a level, and most events, that are listed; the steps tables have the status of every step."""


_ENTERED = {
    "below_warn": "warn limit entered",
    "below_fail": "fail limit entered",
    "contact": "contact begins",
}
_EXITED = {
    "below_warn": "warn limit left",
    "below_fail": "fail limit left",
    "contact": "contact ends",
}


_FIELDS = ("time", "clearance", "link", "obstacle", "rule")


def intervals(run: MeasuredRun) -> dict[str, list[Interval]]:
    """For each of `LEVELS` its first `MOST_LISTED` intervals in order of time; none where only the least step is
    known."""
    record, motion = run.record, run.motion_levels
    if motion is not None:
        return {
            level: [_motion_interval(motion, level, span) for span in spans[:MOST_LISTED]]
            for level, spans in motion.spans.items()
        }
    seen = _Levels.of(run)
    return {
        level: [seen.interval(int(a), int(b)) for a, b in runs[:MOST_LISTED]]
        for level, runs in _level_runs(record).items()
    }


def events(run: MeasuredRun) -> list[Event]:
    """The first `MOST_LISTED` enterings and leavings of a level in order of time; on one step, entering the wider
    level first. None where only the least step is known."""
    record, motion = run.record, run.motion_levels
    if motion is not None:
        return _motion_events(motion)
    steps, order, what, stops = [], [], [], []
    for level, runs in _level_runs(record).items():
        exits = runs[runs[:, 1] < record.rows.n_rows, 1]
        steps += [runs[:, 0], exits]
        stops += [runs[:, 1], exits]
        order += [np.full(len(runs), LEVELS[level]), np.full(len(exits), -LEVELS[level])]
        what += [_ENTERED[level]] * len(runs) + [_EXITED[level]] * len(exits)
    step, stop = np.concatenate(steps), np.concatenate(stops)
    first = np.lexsort([np.concatenate(order), step])[:MOST_LISTED]
    seen = _Levels.of(run)
    codes = np.concatenate(order)
    return [seen.event(int(step[i]), int(stop[i]), int(codes[i]), what[i]) for i in first]


def _motion_interval(motion: MotionLevels, level: str, span: Span) -> Interval:
    steps, worst = motion.steps_in(span), motion.worst(level, span)
    fields = moment_fields(worst, span[0] if worst is None else worst.time)
    return Interval(
        first_step=int(steps[0]),
        last_step=int(steps[-1]),
        start=span[0],
        end=span[1],
        worst_step=int(steps[0]) if worst is None else worst.step,
        worst_time=fields.pop("time"),
        between=worst is None or worst.between,
        **fields,
    )


def _motion_events(motion: MotionLevels) -> list[Event]:
    """The first events, entering the wider level first and leaving the deeper one first."""
    edges = []
    for level, spans in motion.spans.items():
        for span in spans:
            edges.append((span[0], LEVELS[level], level, span))
            if span[1] < motion.times[-1]:
                edges.append((span[1], -LEVELS[level], level, span))
    found = []
    for time, order, level, span in sorted(edges, key=lambda edge: edge[:2])[:MOST_LISTED]:
        leaves = order < 0
        moment = motion.edge(level, span, last=leaves)
        worst = None if leaves else motion.worst(level, span)
        step = int(np.searchsorted(motion.times, time, side="right")) - 1
        fields = moment_fields(moment, time)
        found.append(
            Event(
                step=step,
                between=bool(motion.times[step] != time),
                what=(_EXITED if leaves else _ENTERED)[level],
                least=None if worst is None else worst.clearance,
                **fields,
            )
        )
    return found


def not_listed(run: MeasuredRun) -> dict[str, int]:
    """How many intervals of each level and how many events `intervals` and `events` leave out."""
    record, motion = run.record, run.motion_levels
    if motion is not None:
        counted = {level: len(spans) for level, spans in motion.spans.items()}
        ends = [span[1] for spans in motion.spans.values() for span in spans]
        n_events = len(ends) + sum(end < motion.times[-1] for end in ends)
    else:
        runs, n_steps = _level_runs(record), record.rows.n_rows
        n_events = sum(len(found) + int((found[:, 1] < n_steps).sum()) for found in runs.values())
        counted = {level: len(found) for level, found in runs.items()}
    counted["events"] = n_events
    return {name: max(0, number - MOST_LISTED) for name, number in counted.items()}


def extent(run: MeasuredRun, level: str) -> tuple[int, int]:
    """How many intervals of a level there are, and of how many steps, not counting those of which only the motion
    to the next is at that level."""
    record, motion = run.record, run.motion_levels
    if motion is not None:
        n_steps = int((RowStatus(record).of_samples() >= LEVELS[level]).sum())
        return len(motion.spans[level]), n_steps
    runs = _level_runs(record)[level]
    seen = _Levels.of(run)
    n_between = int((seen.rows.between & (seen.own < LEVELS[level]) & _inside(runs, record)).sum())
    return len(runs), int((runs[:, 1] - runs[:, 0]).sum()) - n_between


def _inside(runs: np.ndarray, record: Record) -> np.ndarray:
    """(n,) True for the steps in any of the runs."""
    change = np.zeros(record.rows.n_rows + 1, dtype=np.int64)
    change[runs[:, 0]], change[runs[:, 1]] = 1, -1
    return np.cumsum(change[:-1]) > 0


def _level_runs(record: Record) -> dict[str, np.ndarray]:
    """For each of `LEVELS` (k, 2) first step and step after the last of its runs."""
    codes = status_codes_of(record.rows)
    if record.need == "minimum":
        codes = codes[:0]
    return {level: runs_of(codes >= least) for level, least in LEVELS.items()}


@dataclass(frozen=True, eq=False)
class _Levels:
    """How each row stands, and what is least where.

    Attributes:
        own: (n,) the status code of each step by itself.
    """

    run: MeasuredRun
    rows: RowStatus
    own: np.ndarray

    @staticmethod
    def of(run: MeasuredRun) -> _Levels:
        rows = RowStatus(run.record)
        codes = status_codes_of(run.record.rows)
        own = codes if not rows.between.any() else np.where(rows.between, rows.of_samples(), codes)
        return _Levels(run, rows, own)

    def moment(self, step: int) -> dict[str, Any]:
        """What is known of a step, or of the moment after it that gives it its status."""
        if not self.rows.between[step]:
            return self.sample(step)
        certificate = self.run.rules[int(self.rows.rule_between[step])].certificate
        assert certificate is not None
        moment = certificate.moment_of(step)
        return {name: getattr(moment, name) for name in _FIELDS}

    def sample(self, step: int) -> dict[str, Any]:
        """What is known of a step."""
        row = self.run.record.rows.row(step)
        columns = ("time", "clearance", *self.run.record.sides[:2], "rule")
        return {name: row[column] for name, column in zip(_FIELDS, columns, strict=True)}

    def interval(self, start: int, stop: int) -> Interval:
        worst = start + self._worst(slice(start, stop))
        fields = self.moment(worst)
        times = self.run.record.motions[0].times
        between = self.rows.between
        last = min(stop, len(times) - 1) if between[stop - 1] else stop - 1
        return Interval(
            first_step=start,
            last_step=stop - 1,
            start=float(times[start]),
            end=float(times[last]),
            worst_step=worst,
            worst_time=fields.pop("time"),
            between=bool(between[worst]),
            **fields,
        )

    def _worst(self, steps: slice) -> int:
        """The first most critical of some rows, and of those alike is nearest to the fail limit."""
        margin = self.rows.margin[steps]
        if len(self.run.record.rules) > 1:
            codes = status_codes_of(self.run.record.rows.at(steps))
            margin = np.where(codes == codes.max(), margin, np.inf)
        return int(np.nanargmin(margin))

    def event(self, step: int, stop: int, code: int, what: str) -> Event:
        """Entering the level of a status code at a step, until `stop`; leaving it if these are the same."""
        known = self.rows.least[step:stop]
        least = None if stop == step or np.isnan(known).all() else float(np.nanmin(known))
        between = stop > step and bool(self.own[step] < code)
        fields = self.moment(step) if between else self.sample(step)
        return Event(step=step, between=between, what=what, least=least, **fields)
