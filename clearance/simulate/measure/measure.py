"""Measures a motion exactly, as far as is asked: every step, every pair, what is near, or the minimum.

The compiled sweep runs over parts of the steps, on several threads, so that progress can be shown and a run
interrupted; how the steps are parted depends on their number alone, and so does every result. Rows are stored in
memory or on disk (`rows.resumable`). Not for: where the motion comes from (`world.motion`, `physics.bullet`).
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from typing import NamedTuple

import numpy as np

from clearance.kernels.motion.sweep import sweep
from clearance.kernels.motion.sweep_goal import FirstPass, SweepGoal, SweptSteps
from clearance.kernels.motion.sweep_rows import PairRows, StepRows, SweepRows
from clearance.kernels.motion.sweep_state import NOT_LESS
from clearance.record.measurement import SWEEP_COUNTERS, Minima
from clearance.record.rows.blocks import blocks
from clearance.simulate.measure.layout import PairsInMotion, positions_at
from clearance.simulate.measure.measured import MeasuredSteps, no_minima
from clearance.simulate.measure.resources import DEFAULT_RESOURCES, Resources, in_order, parts

NEEDS = ("steps", "pairs", "limit", "minimum")
"""What can be asked: the clearance of every step; of every pair as well; of the steps below the warn limit,
with a lower bound for the others; the least of all steps only."""

FIRST_SAMPLES = 0.5
"""Of so many times the root of their number, steps are sampled first, evenly spread, where only the least of
many is asked for."""

FIRST_EFFORT = 256
"""Node pairs of each search at these first samples: any distance that occurs will do."""

Steps = np.ndarray | range
"""(k,) increasing step indices; a range is of all steps between two."""

PARTS_IN_MEMORY = 128
"""Parts after which the memory of rows that are on disk is let go: 10 MB at most."""


@dataclass(frozen=True, eq=False)
class _Sweep:
    """What all parts of one measurement share."""

    what: PairsInMotion
    resources: Resources
    tally: np.ndarray = field(default_factory=lambda: np.zeros(len(SWEEP_COUNTERS), dtype=np.int64))

    @property
    def n_steps(self) -> int:
        return self.what.motions[0].n_steps

    @property
    def n_pairs(self) -> int:
        return len(self.what.pairs)

    @property
    def quiet(self) -> _Sweep:
        """The same without progress, for passes other than the one that is counted."""
        return replace(self, resources=replace(self.resources, progress=None))

    @property
    def aside(self) -> _Sweep:
        """The same for a few steps, whose rows need no keeping."""
        return replace(self, resources=Resources(self.resources.jobs))

    def step_rows(
        self, name: str, steps: Steps, within: float = np.inf, *, lasting: bool = False
    ) -> StoredRows:
        """The nearest pair of each step, where it is within [m]; if lasting, only what is nearer than before."""
        rows = self._rows(name, len(steps))
        self._run(name, steps, SweepGoal(np.full(self.n_pairs, within), False, lasting), rows=rows)
        return rows

    def every_row(self, name: str, steps: Steps) -> tuple[StoredRows, np.ndarray, Minima]:
        """The nearest pair of each step, every pair at every step, and the least of each."""
        rows = self._rows(name, len(steps))
        every = self._array(f"{name}.every", (len(steps), self.n_pairs))
        goal = SweepGoal(np.full(self.n_pairs, np.inf), True, False)
        return rows, every, self._run(name, steps, goal, rows=rows, every=every)

    def least_rows(self, name: str, steps: Steps, within: np.ndarray) -> Minima:
        """The least of every pair by itself, within (p,) [m]."""
        return self._run(name, steps, SweepGoal(within, True, True))

    def _rows(self, name: str, n_rows: int) -> StoredRows:
        return StoredRows(
            self._array(f"{name}.clearance", (n_rows,)),
            self._array(f"{name}.lower_bound", (n_rows,)),
            self._array(f"{name}.pair", (n_rows,), np.int64),
            self._array(f"{name}.points", (n_rows, 2, 3)),
        )

    def _array(self, name: str, shape: tuple[int, ...], kind: type = np.float64) -> np.ndarray:
        return self.resources.rows.array(self.resources.prefix + name, shape, kind)

    def sweep_steps(
        self,
        steps: Steps,
        goal: SweepGoal,
        rows: StepRows,
        found: PairRows,
        known: np.ndarray | None = None,
    ) -> np.ndarray:
        """Fills the rows of a few steps in one go; the counters, as in `SWEEP_COUNTERS`.

        Args:
            known: (k,) the pair of each step that need not be measured, or -1.
        """
        layout = self.what.layout
        positions = positions_at(self.what.case, self.what.motions, steps)
        numbers = np.arange(steps.start, steps.stop) if isinstance(steps, range) else steps
        counts = np.empty(len(SWEEP_COUNTERS), dtype=np.int64)
        least_only = goal.lasting and not goal.each and goal.within[0] == np.inf
        first = FirstPass(_first_steps(len(steps)) if least_only else _NO_STEPS, FIRST_EFFORT)
        sweep(
            layout.surface,
            layout.world,
            SweptSteps(positions, numbers, _NO_STEPS if known is None else known),
            goal,
            first,
            SweepRows(rows, found),
            counts,
        )
        if not layout.is_in_world:
            layout.to_world(positions, rows.pair, rows.points)
            met = np.where(found.step >= 0, np.arange(len(found.step)), -1)
            where = positions_at(self.what.case, self.what.motions, np.maximum(found.step, 0))
            layout.to_world(where, met, found.points)
        return counts

    def _run(
        self,
        name: str,
        steps: Steps,
        goal: SweepGoal,
        *,
        rows: StoredRows | None = None,
        every: np.ndarray | None = None,
    ) -> Minima:
        """Fills what rows are given, from the part on that an interrupted run had not reached."""
        spans = parts(len(steps), sparse=goal.lasting or bool(goal.within[0] < np.inf))
        log = self.resources.rows.log(self.resources.prefix + name, spans)
        n_minima = self.n_pairs if goal.each else 0
        least, tally = _gathered(log.gathered, n_minima)

        def run_part(span: slice) -> tuple[int, PairRows, np.ndarray]:
            found = _no_pair_rows(self.n_pairs, n_minima, None if every is None else every[span])
            counts = self.sweep_steps(steps[span], goal, _rows_of(rows, span), found)
            return span.stop, found, counts

        results = in_order(run_part, spans[log.done :], self.resources.n_threads)
        for i_part, (done, found, counts) in enumerate(results, start=log.done + 1):
            if goal.each:
                _take_lesser(least, found)
            tally += counts
            log.note(i_part, {**least._asdict(), "tally": tally}, last=i_part == len(spans))
            if i_part % PARTS_IN_MEMORY == 0:
                self.resources.rows.let_go()
            if self.resources.progress:
                self.resources.progress(done, len(steps))
        self.tally[:] += tally
        return least


class StoredRows(NamedTuple):
    """What is stored of `StepRows`: (n,) clearance [m], floor [m], pair, and (n, 2, 3) points [m]."""

    clearance: np.ndarray
    floor: np.ndarray
    pair: np.ndarray
    points: np.ndarray


def _rows_of(rows: StoredRows | None, span: slice) -> StepRows:
    """Arrays for the rows of a part: those that are stored, and new ones for the rest."""
    n_rows = span.stop - span.start
    faces = np.empty((n_rows, 2), dtype=np.int64)
    if rows is not None:
        part = StoredRows(*(column[span] for column in rows))
    else:
        numbers, pair = np.empty((2, n_rows)), np.empty(n_rows, dtype=np.int64)
        part = StoredRows(numbers[0], numbers[1], pair, np.empty((n_rows, 2, 3)))
    return StepRows(part.clearance, part.floor, part.pair, faces, part.points)


def _gathered(known: dict[str, np.ndarray], n_pairs: int) -> tuple[Minima, np.ndarray]:
    """The minima and counters of the parts that are done."""
    if not known:
        return no_minima(n_pairs), np.zeros(len(SWEEP_COUNTERS), dtype=np.int64)
    return Minima(known["clearance"], known["step"], known["points"]), known["tally"]


def measure(
    what: PairsInMotion, need: str = "steps", resources: Resources = DEFAULT_RESOURCES
) -> MeasuredSteps:
    """The exact clearances of pairs in motion.

    Args:
        need: one of `NEEDS`.
        resources: threads, progress, and where the rows are stored.
    """
    work = _Sweep(what, resources)
    if need == "pairs":
        return _every_pair(work)
    if need == "minimum":
        return _minimum(work)
    if need == "limit":
        return _within_limit(work, what.limits.warn)
    rows = work.step_rows("steps", range(work.n_steps))
    return _measurement(work, rows, lambda most: _pair_minima(work.quiet, rows, most))


def nearest_at(what: PairsInMotion, positions: np.ndarray) -> StepRows:
    """The nearest pair at any positions (k, columns) [rad or m], columns as `world.forest` has them."""
    n_rows, n_pairs, layout = len(positions), len(what.pairs), what.layout
    rows, counts = _rows_of(None, slice(0, n_rows)), np.empty(len(SWEEP_COUNTERS), dtype=np.int64)
    sweep(
        layout.surface,
        layout.world,
        SweptSteps(np.ascontiguousarray(positions), np.arange(n_rows), _NO_STEPS),
        SweepGoal(np.full(n_pairs, np.inf), False, False),
        FirstPass(_NO_STEPS, FIRST_EFFORT),
        SweepRows(rows, _no_pair_rows(n_pairs, 0)),
        counts,
    )
    layout.to_world(positions, rows.pair, rows.points)
    return rows


class NearestPairs(NamedTuple):
    """The nearest pair of some steps (n,), -1 where none is known, and its distance (n,) [m]."""

    pairs: np.ndarray
    distances: np.ndarray


def pairs_within(
    what: PairsInMotion, steps: np.ndarray, within: float, nearest: NearestPairs | None = None
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """(k,) places in `steps` (n,), (k,) pairs within [m] there, in order, and (k,) their distances [m].

    Nothing that is farther is measured.

    Args:
        nearest: what is known of the steps, and is not measured again.
    """
    work = _Sweep(what, Resources(jobs=1))
    goal = SweepGoal(np.full(work.n_pairs, within * NOT_LESS), True, False)
    rows, pairs, distances = [_NO_STEPS], [_NO_STEPS], [np.empty(0)]
    for span in parts(len(steps), sparse=True):
        every = np.full((span.stop - span.start, work.n_pairs), np.inf)
        found = _no_pair_rows(work.n_pairs, work.n_pairs, every)
        known = None if nearest is None else nearest.pairs[span]
        work.sweep_steps(steps[span], goal, _rows_of(None, span), found, known)
        if nearest is not None:
            seen = np.flatnonzero(nearest.pairs[span] >= 0)
            every[seen, nearest.pairs[span][seen]] = nearest.distances[span][seen]
        near = np.nonzero(every <= within)
        rows.append(near[0] + span.start)
        pairs.append(near[1])
        distances.append(every[near])
    return np.concatenate(rows), np.concatenate(pairs), np.concatenate(distances)


def _every_pair(work: _Sweep) -> MeasuredSteps:
    rows, every, minima = work.every_row("pairs", range(work.n_steps))
    return _measurement(work, rows, lambda most: minima, every=every)


def _minimum(work: _Sweep) -> MeasuredSteps:
    within = np.inf
    if len(parts(work.n_steps, sparse=True)) > 1:  # else a first sampling is part of the sweep
        few = work.aside.step_rows("first", _first_steps(work.n_steps), lasting=True)
        within = few.clearance.min() * NOT_LESS
    rows = work.step_rows("minimum", range(work.n_steps), within, lasting=True)
    least = int(np.argmin(rows.clearance))
    if np.isnan(rows.clearance[least]):  # rows of an interrupted run that had come further
        least = int(np.nanargmin(rows.clearance))
    rows.pair[:least] = rows.pair[least + 1 :] = -1  # what was met on the way to the least
    return _measurement(work, rows, None)


def _within_limit(work: _Sweep, limit: float) -> MeasuredSteps:
    """The least of all is always known, so that a run has a worst step."""
    rows = work.step_rows("limit", range(work.n_steps), limit * NOT_LESS)
    for block in blocks(work.n_steps):
        floor = rows.floor[block]  # all that could be within the limit was sought
        np.maximum(floor, limit, out=floor, where=rows.pair[block] < 0)
    if any((rows.pair[block] >= 0).any() for block in blocks(work.n_steps)):
        return _measurement(work, rows, None)
    least = _minimum(work.quiet)
    for block in blocks(work.n_steps):
        np.maximum(least.lower_bound[block], rows.floor[block], out=least.lower_bound[block])
    return least


def _pair_minima(work: _Sweep, rows: StoredRows, most: int | None) -> Minima:
    """The least of each pair: first at a few sampled steps, then only what could be nearer.

    If only the nearest pairs are wanted, what is farther than as many of them is dropped; and if as many have
    been the nearest of a step, so are the first samples.
    """
    infinite = np.full(work.n_pairs, np.inf)
    seen = infinite if most is None else _least_as_nearest(work, rows)
    if most is None or np.isfinite(seen).sum() < most:
        first = work.aside.least_rows("first", _first_steps(work.n_steps), infinite)
        seen = np.minimum(seen, first.clearance)
    if most is None or most >= work.n_pairs:
        return work.least_rows("minima", range(work.n_steps), seen * NOT_LESS)
    within = np.minimum(seen, np.partition(seen, most - 1)[most - 1]) * NOT_LESS
    return work.aside.least_rows("nearest", range(work.n_steps), within)


def _least_as_nearest(work: _Sweep, rows: StoredRows) -> np.ndarray:
    """(p,) [m] the least clearance of each pair over the steps at which it is the nearest; infinite if none."""
    least = np.full(work.n_pairs, np.inf)
    for block in blocks(work.n_steps):
        np.minimum.at(least, rows.pair[block], rows.clearance[block])
    return least


_NO_STEPS = np.empty(0, dtype=np.int64)


def _first_steps(n_steps: int) -> np.ndarray:
    last = min(n_steps, 2 + round(FIRST_SAMPLES * math.sqrt(n_steps))) - 1
    return np.arange(last + 1) * (n_steps - 1) // max(1, last)


def _measurement(
    work: _Sweep,
    rows: StoredRows,
    measure_pair_minima: Callable[[int | None], Minima] | None,
    every: np.ndarray | None = None,
) -> MeasuredSteps:
    for block in blocks(work.n_steps):
        unknown = rows.pair[block] < 0
        rows.clearance[block][unknown] = np.nan
        rows.points[block][unknown] = np.nan
    work.resources.rows.let_go()
    return MeasuredSteps(
        rows.clearance,
        rows.floor,
        rows.pair,
        rows.points,
        dict(zip(SWEEP_COUNTERS, work.tally.tolist(), strict=True)),
        every,
        measure_pair_minima=measure_pair_minima,
    )


def _no_pair_rows(n_pairs: int, n_minima: int, every: np.ndarray | None = None) -> PairRows:
    """Arrays for what a part finds of each pair: every step, if `every` is given, and its least, if asked for."""
    return PairRows(np.empty((0, n_pairs)) if every is None else every, *no_minima(n_minima))


def _take_lesser(least: Minima, found: PairRows) -> None:
    nearer = found.clearance < least.clearance
    for mine, theirs in zip(least, found[1:], strict=True):
        mine[nearer] = theirs[nearer]
