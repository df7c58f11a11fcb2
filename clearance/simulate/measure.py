"""Measures a motion exactly, as far as is asked: every step, every pair, what is near, or the minimum.

The compiled sweep runs over parts of the steps, on several threads, so that progress can be shown and a run
interrupted; how the steps are parted depends on their number alone, and so does every result. Not for: where
the motion comes from (`kinematic`, `bullet`).
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from typing import NamedTuple

import numpy as np

from clearance.kernel_table import call
from clearance.kernels.sweep import NOT_LESS, Goal, PairRows, StepRows, sweep
from clearance.simulate.layout import Layout, lay_out
from clearance.simulate.parts import in_order, parts, usable_cores
from clearance.world.case import Case
from clearance.world.motion import Motion
from clearance.world.pairs import Pair

Progress = Callable[[int, int], None]
"""Called with the number of steps done and of all steps."""

NEEDS = ("steps", "pairs", "limit", "minimum")
"""What can be asked: the clearance of every step; of every pair as well; of the steps below the warn limit,
with a lower bound for the others; the least of all steps only."""

FIRST_LOOK = 24
"""Steps that are looked at first, evenly spread, where only the least of many is asked for."""

COUNTERS = ("pairs_skipped", "queries", "node_tests", "polygon_tests")


class Minima(NamedTuple):
    """One row a pair: least clearance [m], the first step that has it, witness points in the world [m]."""

    clearance: np.ndarray
    step: np.ndarray
    points: np.ndarray  # (p, 2, 3)


@dataclass(frozen=True, eq=False)
class Measurement:
    """The least clearances of a motion, one row a step.

    Attributes:
        clearance: (n,) [m], NaN where only a bound was asked for.
        lower_bound: (n,) [m] proven for the step; equal to the clearance within rounding where that is known.
        pair: (n,) index of the pair that attains it, or -1.
        points: (n, 2, 3) witness points [m] in the world frame: on the link, on the obstacle.
        tally: counters by name.
        find_minima: the least clearance of each pair; not measured until it is called. None if it was not
            asked for.
        every: (n, p) [m] the clearance of each pair at each step, if that was asked for.
        may_cut_pairs: True if a pair can be left out by rules without proof (the paper's).
    """

    clearance: np.ndarray
    lower_bound: np.ndarray
    pair: np.ndarray
    points: np.ndarray
    tally: dict[str, int]
    find_minima: Callable[[], Minima] | None
    every: np.ndarray | None = None
    may_cut_pairs: bool = False


@dataclass(frozen=True, eq=False)
class _Sweep:
    """What all parts of one measurement share."""

    layout: Layout
    motions: Sequence[Motion]
    jobs: int
    progress: Progress | None = None
    tally: np.ndarray = field(default_factory=lambda: np.zeros(len(COUNTERS), dtype=np.int64))

    @property
    def n_steps(self) -> int:
        return self.motions[0].n_steps

    @property
    def n_pairs(self) -> int:
        return len(self.layout.pairs)

    @property
    def quiet(self) -> _Sweep:
        """The same without progress, for passes beside the one that is counted."""
        return replace(self, progress=None)

    def step_rows(
        self, steps: np.ndarray, within: float = np.inf, *, lasting: bool = False
    ) -> StepRows:
        """The nearest pair of each step, where it is within [m]; if lasting, only what is nearer than before."""
        goal = Goal(np.full(self.n_pairs, within), False, lasting)
        return self._run(steps, goal, keep_every=False)[0]

    def pair_rows(
        self, steps: np.ndarray, within: np.ndarray, *, keep_every: bool
    ) -> tuple[StepRows, PairRows]:
        """Every pair by itself, within (p,) [m]: at every step, or only the least of each."""
        return self._run(steps, Goal(within, True, not keep_every), keep_every=keep_every)

    def _run(
        self, steps: np.ndarray, goal: Goal, *, keep_every: bool
    ) -> tuple[StepRows, PairRows]:
        n_rows = len(steps)
        rows = StepRows(
            np.empty(n_rows),
            np.empty(n_rows),
            np.empty(n_rows, dtype=np.int64),
            np.empty((n_rows, 2), dtype=np.int64),
            np.empty((n_rows, 2, 3)),
        )
        every = np.empty((n_rows if keep_every else 0, self.n_pairs))
        least = _no_minima(self.n_pairs)

        def run_part(span: slice) -> tuple[int, PairRows, np.ndarray]:
            world = self.layout.world(self.motions, steps[span])
            found = PairRows(every[span] if keep_every else every, *_no_minima(self.n_pairs))
            tally = np.zeros(len(COUNTERS), dtype=np.int64)
            part = StepRows(*(column[span] for column in rows))
            call(sweep, self.layout.surface, world, steps[span], goal, part, found, tally)
            return span.stop, found, tally

        for done, found, tally in in_order(run_part, parts(n_rows), self.jobs):
            _take_lesser(least, found)
            self.tally[:] += tally
            if self.progress:
                self.progress(done, n_rows)
        return rows, PairRows(every, *least)


def measure(
    case: Case,
    motions: Sequence[Motion],
    pairs: Sequence[Pair],
    need: str = "steps",
    *,
    jobs: int | None = None,
    progress: Progress | None = None,
) -> Measurement:
    """The exact clearances of `pairs` over `motions` (one for each robot, with the same steps).

    Args:
        need: one of `NEEDS`.
        jobs: threads; as many as the machine has to offer by default.
    """
    work = _Sweep(lay_out(case, pairs), motions, jobs or usable_cores(), progress)
    if need == "pairs":
        return _every_pair(work)
    if need == "minimum":
        return _minimum(work)
    if need == "limit":
        return _within_limit(work, case.limits.warn)
    rows = work.step_rows(np.arange(work.n_steps))
    return _measurement(work, rows, lambda: _pair_minima(work.quiet))


def _every_pair(work: _Sweep) -> Measurement:
    all_steps, infinite = np.arange(work.n_steps), np.full(work.n_pairs, np.inf)
    rows, found = work.pair_rows(all_steps, infinite, keep_every=True)
    minima = Minima(found.clearance, found.step, found.points)
    return _measurement(work, rows, lambda: minima, every=found.every)


def _minimum(work: _Sweep) -> Measurement:
    rows = work.step_rows(np.arange(work.n_steps), _first_least(work), lasting=True)
    rows.pair[np.arange(work.n_steps) != np.argmin(rows.clearance)] = -1  # met on the way to the least
    return _measurement(work, rows, None)


def _within_limit(work: _Sweep, limit: float) -> Measurement:
    """The least of all is always known, so that a run has a worst step."""
    rows = work.step_rows(np.arange(work.n_steps), limit * NOT_LESS)
    far = rows.pair < 0
    rows.floor[far] = np.maximum(rows.floor[far], limit)  # all that could be within it was sought
    if (rows.pair >= 0).any():
        return _measurement(work, rows, None)
    least = _minimum(work.quiet)
    return replace(least, lower_bound=np.maximum(least.lower_bound, rows.floor))


def _pair_minima(work: _Sweep) -> Minima:
    """The least of each pair: a first look at few steps, then only what could be nearer."""
    first = _first_steps(work.n_steps)
    infinite = np.full(work.n_pairs, np.inf)
    _, seen = work.pair_rows(first, infinite, keep_every=False)
    _, found = work.pair_rows(np.arange(work.n_steps), seen.clearance * NOT_LESS, keep_every=False)
    return Minima(found.clearance, found.step, found.points)


def _first_least(work: _Sweep) -> float:
    """[m] a clearance that some step has, or a little more."""
    rows = work.quiet.step_rows(_first_steps(work.n_steps), lasting=True)
    return float(rows.clearance.min()) * NOT_LESS


def _first_steps(n_steps: int) -> np.ndarray:
    return np.unique(np.linspace(0, n_steps - 1, FIRST_LOOK).round().astype(np.int64))


def _measurement(
    work: _Sweep,
    rows: StepRows,
    find_minima: Callable[[], Minima] | None,
    every: np.ndarray | None = None,
) -> Measurement:
    unknown = rows.pair < 0
    rows.clearance[unknown] = np.nan
    rows.points[unknown] = np.nan
    return Measurement(
        rows.clearance,
        rows.floor,
        rows.pair,
        rows.points,
        dict(zip(COUNTERS, work.tally.tolist(), strict=True)),
        find_minima,
        every,
    )


def _no_minima(n_pairs: int) -> Minima:
    return Minima(
        np.full(n_pairs, np.inf), np.full(n_pairs, -1, dtype=np.int64), np.full((n_pairs, 2, 3), np.nan)
    )


def _take_lesser(least: Minima, found: PairRows) -> None:
    nearer = found.clearance < least.clearance
    for mine, theirs in zip(least, found[1:], strict=True):
        mine[nearer] = theirs[nearer]
