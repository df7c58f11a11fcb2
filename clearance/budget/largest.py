"""The greatest single tolerance, all others as given, at which a limit is still proven to be kept.

What is asked of one tolerance is tried out at the steps and intervals where it can matter; the number that is told
was proven at all of them. Not for: what is left (`proven`).
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from clearance.budget.proven import Moments, PairsWithErrors
from clearance.budget.section_budget import SectionBudget
from clearance.budget.sources import SourceKey, sizes_of, units_of, with_sizes
from clearance.world.budget import Budget
from clearance.world.case import Case
from clearance.world.mimics import leads_of
from clearance.world.reach import farthest_reach

GREATEST = {"rad": 0.2, "m": 0.1, "s": 1.0}
"""No tolerance beyond these is looked for."""

SHARPNESS = 2e-3
"""The share of a tolerance within which the greatest is found."""

MOST_TRIES = 24

MORE_ROWS = 8
"""Each time that rows keep a limit this many times as many are asked at once."""

MOST_ROUNDS = 6
"""Times that moments are added at which a number turned out too large; then it is halved until it is proven."""


@dataclass(eq=False)
class Largest:
    """Finds the greatest tolerances with which the pairs of one rule keep a limit.

    Attributes:
        fail: [m] the limit, of clearances less padding.
    """

    fail: float
    sections: Sequence[SectionBudget]
    _hard: list[tuple[int, bool, int]] = field(default_factory=list)
    _known: dict[SourceKey, tuple[float | None, ...]] = field(default_factory=dict)

    def of(self, case: Case, key: SourceKey) -> tuple[float | None, ...]:
        """The greatest of each number of an error; None where even 0 does not keep the limit."""
        if key not in self._known:
            units = enumerate(units_of(case, key))
            self._known[key] = tuple(self._of_number(key, place, unit) for place, unit in units)
        return self._known[key]

    def _of_number(self, key: SourceKey, place: int, unit: str) -> float | None:
        trial = _Trial(self, key, place, unit)
        if not trial.keeps(0.0):
            return None
        if trial.keeps(GREATEST[unit]):
            return GREATEST[unit]
        low, high = 0.0, GREATEST[unit]
        for _ in range(MOST_ROUNDS):
            low, high = trial.narrowed(low, high)
            if trial.keeps(low):
                return low
            low, high = 0.0, low
        while low < high and not trial.keeps(high):
            high = 0.5 * high
        return high


@dataclass(eq=False)
class _Trial:
    """Tries out one number of one error."""

    asked: Largest
    key: SourceKey
    place: int
    unit: str

    def __post_init__(self) -> None:
        self.given = sizes_of(self._budget, self.key)[self.place]
        self.levers = [self._lever(section) for section in self.asked.sections]

    @property
    def _budget(self) -> Budget:
        return self.asked.sections[0].pairs.budget

    def keeps(self, number: float) -> bool:
        """True if the limit is proven to be kept everywhere."""
        for i, section in enumerate(self.asked.sections):
            pairs = self._pairs(section, number)
            for between in (False, True):
                rows = self._open(i, number, between=between)
                failing = _failing(section, pairs, rows, self._limit(section), between=between)
                if failing is not None:
                    if number > 0.0:
                        self.asked._hard.append((i, between, failing))
                    return False
        return True

    def narrowed(self, low: float, high: float) -> tuple[float, float]:
        """Bounds of the greatest number, as far as the hard moments tell."""
        for _ in range(MOST_TRIES):
            if high - low <= SHARPNESS * high:
                break
            middle = 0.5 * (low + high)
            low, high = (middle, high) if self._keeps_hard(middle) else (low, middle)
        return low, high

    def _keeps_hard(self, number: float) -> bool:
        for i, between, row in dict.fromkeys(self.asked._hard):
            section = self.asked.sections[i]
            pairs = self._pairs(section, number)
            if (
                _failing(section, pairs, np.array([row]), self._limit(section), between=between)
                is not None
            ):
                return False
        return True

    def _pairs(self, section: SectionBudget, number: float) -> PairsWithErrors:
        sizes = list(sizes_of(self._budget, self.key))
        sizes[self.place] = number
        return section.pairs.of(with_sizes(self._budget, self.key, tuple(sizes)))

    def _limit(self, section: SectionBudget) -> float:
        return self.asked.fail + section.section.padding

    def _open(self, i: int, number: float, *, between: bool) -> np.ndarray:
        """Rows not known to keep the limit from what is proven with the number as given, hardest first."""
        section = self.asked.sections[i]
        rows = section.between if between else section.steps
        if rows is None:
            return np.empty(0, dtype=np.int64)
        proven = rows.proven[:-1] if between else rows.proven
        more = max(0.0, number - self.given)
        taken = 2.0 * math.sin(0.5 * more) if self.unit == "rad" else more
        left = proven - (taken * self.levers[i] if more > 0.0 else 0.0)
        open_rows = np.flatnonzero(left < self._limit(section))
        return open_rows[np.argsort(left[open_rows], kind="stable")]

    def _lever(self, section: SectionBudget) -> float:
        """[m/rad], [m/m] or [m/s] more than any point can move by one more of the number."""
        if self.unit == "s":
            return math.inf
        case = section.section.phase.case
        reach = farthest_reach(case, section.section.phase.motions)
        lever = 4.0 * reach + 1.0 if self.unit == "rad" else 1.0
        factor = 1.0
        for placed in case.robots:
            if placed.robot.name == self.key.owner:
                factor += sum(
                    abs(more) for leads in leads_of(placed.robot).values()
                    for name, more in leads[1:] if name == self.key.part
                )  # fmt: skip
        return (
            2.0
            * factor
            * (
                lever
                if self.unit == "rad"
                else max(1.0, 4.0 * reach + 1.0 if factor > 1.0 else 1.0)
            )
        )


def _failing(
    section: SectionBudget, pairs: PairsWithErrors, rows: np.ndarray, limit: float, *, between: bool
) -> int | None:
    """A row of which less than the limit is proven; None if all keep it. Rows come hardest first."""
    first, many = 0, 1
    while first < len(rows):
        block = rows[first : first + many]
        enough = limit * (1.0 + 1e-9) + 1e-12
        for row in block[_proven(section, pairs, block, enough, between=between) < limit]:
            one = np.array([row])
            if _proven(section, pairs, one, math.inf, between=between)[0] < limit:
                return int(row)
        first, many = first + many, MORE_ROWS * many
    return None


def _proven(
    section: SectionBudget,
    pairs: PairsWithErrors,
    rows: np.ndarray,
    enough: float,
    *,
    between: bool,
) -> np.ndarray:
    """[m] what is proven of some rows; near a finite `enough` it is some per cent of the errors lower."""
    if not between:
        return _proven_of_steps(section, pairs, rows, enough)
    assert section.between is not None
    assert section.answer.certificate is not None
    gap = section.answer.certificate.gap
    known = np.full(len(rows), enough + 2.0 * gap)  # so that no more than the limit is asked about
    if not math.isfinite(enough):
        ends = (_proven_of_steps(section, pairs, end, enough) for end in (rows, rows + 1))
        known = np.minimum(*ends)
    return pairs.between(rows, section.between.pair[rows], known, gap, enough).proven


def _proven_of_steps(
    section: SectionBudget, pairs: PairsWithErrors, rows: np.ndarray, enough: float
) -> np.ndarray:
    at = section.pairs.steps()
    moments = Moments(at.intervals[rows], at.shares[rows])
    nominal = section.answer.found.clearance[rows]
    return pairs.at(moments, section.steps.pair[rows], nominal, enough).proven
