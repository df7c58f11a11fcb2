"""The distances that the errors of a budget leave of a section's pairs, proven at its steps and between them."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from clearance.budget.errors_of import NOW, errors_of
from clearance.kernels.budget.errors import Errors
from clearance.kernels.budget.sweep import (
    EXACT_VISITS,
    FEW,
    ROUGH_VISITS,
    BudgetIntervals,
    BudgetMoments,
    BudgetRows,
    budget_intervals,
    budget_moments,
)
from clearance.kernels.budget.sweep_state import BudgetScene, new_state
from clearance.kernels.motion.joint_path import JointPath
from clearance.record.measurement import Measurement
from clearance.simulate.measure.certify import MOST_PARTS, joint_path, path_of, with_turning_balls
from clearance.simulate.measure.layout import PairsInMotion, positions_at
from clearance.simulate.measure.resources import in_order, parts
from clearance.simulate.measure.sections import Section, SectionAnswer
from clearance.world.budget import Budget
from clearance.world.forest import joined_positions

ROUNDED_DOWN = 2.0**-48
"""Relative rounding of the sums that make a proven number, beyond the slacks of the bounds."""


ONCE_MORE = (1, 15, 112)
"""Numbers of steps with the least bounds that are proven once more, round after round while that can help."""

AS_LOW = 4e-12
"""[m] A carried bound may be low by this: a step no farther below the least is not proven once more."""


@dataclass(frozen=True, eq=False)
class PathMoments:
    """Moments of a path: (n,) the step before each, and the share of the interval from there, 0 to 1."""

    intervals: np.ndarray
    shares: np.ndarray

    def __len__(self) -> int:
        return len(self.intervals)


@dataclass(frozen=True, eq=False)
class PairsWithErrors:
    """Pairs in motion, and the errors of all that moves them.

    Attributes:
        n_threads: the most threads.
        but_for: a moment, as `CarrierError` calls it, and the budget for errors made then.
    """

    what: PairsInMotion
    budget: Budget
    n_threads: int = 1
    but_for: tuple[str, Budget] | None = None

    @cached_property
    def errors(self) -> Errors:
        """Of the links and bodies of the layout."""
        moment, then = self.but_for or (NOW, self.budget)

        def budget_at(when: str) -> Budget:
            return then if when == moment else self.budget

        return errors_of(self.what.case, budget_at, self.what.layout)

    @cached_property
    def path(self) -> JointPath:
        """The motion of all joints; a single step counts as an interval."""
        links, case, motions = self.what.layout.world.links, self.what.case, self.what.motions
        if self.n_steps > 1:
            return path_of(links, case, motions, slice(0, self.n_steps))
        positions = np.repeat(joined_positions(case, motions, slice(0, 1)), 2, axis=0)
        times, cubic = motions[0].times[[0, 0]], np.zeros(positions.shape[1], dtype=bool)
        return joint_path(links, times, positions, np.zeros_like(positions), cubic)

    def of(self, budget: Budget, but_for: tuple[str, Budget] | None = None) -> PairsWithErrors:
        """The same with another budget."""
        other = PairsWithErrors(self.what, budget, self.n_threads, but_for)
        other.__dict__["path"] = self.path  # errors are no part of it
        return other

    @cached_property
    def idle(self) -> list[BudgetScene]:
        """Scenes not in use by a thread, some MB each; without one, the next question makes its own."""
        return []

    @contextmanager
    def _scene(self) -> Iterator[BudgetScene]:
        """A scene for one thread."""
        scene = _last_of(self.idle) or self._new_scene()
        yield scene
        self.idle.append(scene)

    def _new_scene(self) -> BudgetScene:
        layout = self.what.layout
        world = with_turning_balls(layout.world)  # no two threads share it
        state = new_state(world, self.errors)
        return BudgetScene(layout.whole_faces, world, self.path, self.errors, state)

    @property
    def n_steps(self) -> int:
        """Number of steps."""
        return self.what.motions[0].n_steps

    @cached_property
    def steps(self) -> PathMoments:
        """All steps."""
        numbers = np.arange(self.n_steps)
        intervals = np.minimum(numbers, max(0, self.n_steps - 2))
        return PathMoments(intervals, (numbers - intervals).astype(np.float64))

    def at(
        self,
        moments: PathMoments,
        order: np.ndarray,
        known: np.ndarray,
        enough: float = np.inf,
        points: np.ndarray | None = None,
        is_exact: bool = False,
    ) -> BudgetRows:
        """Bounds at some moments.

        Args:
            order: (n,) the pair to ask first, or -1. known: (n,) [m] nominal, or NaN.
            enough: [m] no bound needs to be greater.
            points: (n, 2, 3) [m] the nearest points of that pair, as it is measured, if they are known.
            is_exact: True to prove as exactly as for few moments.
        """
        n_visits = EXACT_VISITS if is_exact or len(moments) <= FEW else ROUGH_VISITS
        near = np.full((len(moments), 2, 3), np.nan) if points is None else points

        def ask(span: slice) -> BudgetMoments:
            return BudgetMoments(
                _writable(moments.intervals[span]),
                _writable(moments.shares[span]),
                _writable(order[span]),
                _writable(known[span]),
                _writable(near[span]),
                enough,
                n_visits,
            )

        return self._rows(len(moments), budget_moments, ask)

    def between(
        self,
        intervals: np.ndarray,
        order: np.ndarray,
        known: np.ndarray,
        gap: float,
        enough: float = np.inf,
        fail: float | None = None,
    ) -> BudgetRows:
        """Bounds on the motion from some steps to the next.

        Args:
            known: (n,) [m] the least bound at the two ends. gap: [m] allowed below the distance that occurs.
            fail: [m] the limit to decide, if need be with a smaller gap; None: the limit of the rule.
        """
        undecided = self.what.limits.fail if fail is None else fail

        def ask(span: slice) -> BudgetIntervals:
            return BudgetIntervals(
                _writable(intervals[span]),
                _writable(order[span]),
                _writable(known[span]),
                enough,
                gap,
                undecided,
                MOST_PARTS,
            )

        return self._rows(len(intervals), budget_intervals, ask)

    def _rows(
        self, n_rows: int, kernel: Callable, ask: Callable[[slice], BudgetMoments | BudgetIntervals]
    ) -> BudgetRows:
        rows = BudgetRows(np.empty(n_rows), np.full(n_rows, -1), np.full(n_rows, -1.0))
        if n_rows == 0:
            return rows
        _ = self.errors, self.path  # made once, by this thread

        def run(span: slice) -> None:
            own = BudgetRows(*(column[span] for column in rows))
            tally = np.zeros(5, dtype=np.int64)
            with self._scene() as scene:
                kernel(scene, ask(span), own, tally)

        for _ in in_order(run, parts(n_rows), self.n_threads):
            pass
        rows.proven[:] -= ROUNDED_DOWN * np.abs(rows.proven)
        return rows


def proven_of_steps(pairs: PairsWithErrors, found: Measurement) -> BudgetRows:
    """Bounds at each step, from its measurement."""
    what, points = pairs.what, found.points
    if not what.layout.is_in_world:
        positions = positions_at(what.case, what.motions, range(pairs.n_steps))
        points = what.layout.from_world(positions, found.pair, points)
    rows = pairs.at(pairs.steps, found.pair, found.clearance, points=points)
    if pairs.n_steps > FEW:
        _sharpen_least(pairs, found, rows)
    return rows


def _sharpen_least(pairs: PairsWithErrors, found: Measurement, rows: BudgetRows) -> None:
    """Proves the steps with the least bounds once more, until one of these is the least."""
    enough, is_sharp = np.inf, np.zeros(pairs.n_steps, dtype=bool)
    for most in ONCE_MORE:
        lower = np.flatnonzero(~is_sharp & (rows.proven < enough))
        if len(lower) == 0:
            return
        if len(lower) > most:
            lower = np.sort(lower[np.lexsort((-lower, rows.proven[lower]))[:most]])
        _sharpen(pairs, found, rows, lower, enough)
        is_sharp[lower] = True
        enough = float(rows.proven[is_sharp].min()) - AS_LOW


def _sharpen(
    pairs: PairsWithErrors,
    found: Measurement,
    rows: BudgetRows,
    steps: np.ndarray,
    enough: float,
) -> None:
    """Proves some steps once more, up to `enough` [m]."""
    at = pairs.steps
    moments = PathMoments(at.intervals[steps], at.shares[steps])
    sharp = pairs.at(moments, rows.pair[steps], found.clearance[steps], enough, is_exact=True)
    better = sharp.proven > rows.proven[steps]
    rows.proven[steps[better]] = sharp.proven[better]
    rows.pair[steps[better]] = sharp.pair[better]


def proven_between(pairs: PairsWithErrors, steps: BudgetRows, gap: float) -> BudgetRows:
    """Bounds from each step to the next, given the bounds at the steps; the last row is of its step."""
    known = np.minimum(steps.proven[:-1], steps.proven[1:])
    found = pairs.between(np.arange(len(known)), steps.pair[:-1], known, gap)
    last = BudgetRows(steps.proven[-1:], steps.pair[-1:], np.full(1, -1.0))
    return BudgetRows(*(np.concatenate(both) for both in zip(found, last, strict=True)))


def _last_of(idle: list[BudgetScene]) -> BudgetScene | None:
    """Takes the last item, if there is one; other threads may do the same."""
    try:
        return idle.pop()
    except IndexError:
        return None


def _writable(numbers: np.ndarray) -> np.ndarray:
    """As the kernel takes them: compiled once, for arrays that could be written to."""
    flags = numbers.flags
    if flags.c_contiguous and flags.writeable:
        return numbers
    return np.require(numbers, requirements=["C", "W"])


@dataclass(frozen=True, eq=False)
class SectionBudget:
    """The distances that a budget leaves in a section, without padding; pairs and steps are the section's own.

    Attributes:
        answer: as measured. pairs: with their errors.
        steps: proven at each step. between: proven from each step to the next; None without a certificate.
        expected: (n,) [m]. expected_between: of the least moment after each, NaN where the steps are nearer; None
            like `between`.
    """

    answer: SectionAnswer
    pairs: PairsWithErrors
    steps: BudgetRows
    between: BudgetRows | None
    expected: np.ndarray
    expected_between: np.ndarray | None

    @property
    def section(self) -> Section:
        """The section."""
        return self.answer.section
