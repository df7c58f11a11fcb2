"""The greatest single tolerance, all others as given, at which a limit is still proven to be kept.

A tolerance is tried at the steps and intervals where it can matter; the number reported is proven at all of them.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import NamedTuple

import numpy as np

from clearance.budget.proven import PairsWithErrors, PathMoments, SectionBudget
from clearance.budget.sources import SourceKey, sizes_of, units_of, with_sizes
from clearance.kernels.search.proof import FINEST_GAP
from clearance.record.budget import most_searched
from clearance.world.budget import Budget
from clearance.world.case import Case
from clearance.world.mimics import leads_of
from clearance.world.reach import farthest_reach

SHARPNESS = 2e-3
"""Relative accuracy of the greatest tolerance."""

FIRST = {"rad": 0.002, "m": 0.002, "s": 0.02}
"""First size to try for an error that is 0."""

FARTHER = 4.0
"""Factor to the next size while a row keeps the limit."""

COARSE = 0.02
"""The gap allowed in a proof of an interval, as a share of the increase of the loss."""

MORE_ROWS = 8
"""While rows keep the limit, the number asked at once grows by this factor."""

SPARE = 1e-11
"""[m] A proof of all steps may be lower by this than one of a few; with a certificate, by its gap at a limit."""

MOST_ROUNDS = 6
"""Rounds that add rows where a number was too large; after them it is halved until it is proven."""


class _Row(NamedTuple):
    """A step, or the interval after it, of one of the sections."""

    section: int
    between: bool
    row: int


@dataclass(eq=False)
class ToleranceSearch:
    """Finds the greatest tolerances with which the pairs of one rule keep a limit.

    Attributes:
        fail: [m] the limit, of clearances less padding.
    """

    fail: float
    sections: Sequence[SectionBudget]
    _hard: list[_Row] = field(default_factory=list)
    _known: dict[SourceKey, tuple[float | None, ...]] = field(default_factory=dict)

    def of(self, case: Case, key: SourceKey) -> tuple[float | None, ...]:
        """The greatest size of each number of an error; None where even 0 does not keep the limit."""
        if key not in self._known:
            units = enumerate(units_of(case, key))
            self._known[key] = tuple(self._of_number(key, place, unit) for place, unit in units)
        return self._known[key]

    def _of_number(self, key: SourceKey, place: int, unit: str) -> float | None:
        trial = _Trial(self, key, place, unit)
        if not trial.keeps(0.0):
            return None
        number = most_searched(unit, trial.given)
        for _ in range(MOST_ROUNDS):
            for row in [*dict.fromkeys([*self._least, *self._hard])]:
                number = trial.greatest_at(row, number)
            if trial.keeps(number):
                return number
        while number > 0.0 and not trial.keeps(number):
            number = 0.5 * number
        return number

    @cached_property
    def _least(self) -> list[_Row]:
        """The step and the interval with the least bound of each section, with the errors as given."""
        least = []
        for i, section in enumerate(self.sections):
            least.append(_Row(i, False, int(np.argmin(section.steps.proven))))
            if section.between is not None and len(section.between.proven) > 1:
                least.append(_Row(i, True, int(np.argmin(section.between.proven[:-1]))))
        return least


@dataclass(eq=False)
class _Trial:
    """Tries out one number of one error."""

    asked: ToleranceSearch
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
        """True if the limit is proven everywhere."""
        for i, section in enumerate(self.asked.sections):
            pairs = self._pairs(section, number)
            for between in (False, True):
                rows = self._open(i, number, between=between)
                failing = _failing(section, pairs, rows, self._limit(section), between=between)
                if failing is not None:
                    if number > 0.0:
                        self.asked._hard.append(_Row(i, between, failing))
                    return False
        return True

    def greatest_at(self, row: _Row, most: float) -> float:
        """About the greatest number up to `most` with which one row is proven to keep the limit, or 0."""
        from scipy.optimize import brentq

        seen: dict[float, float] = {}

        def beyond(number: float) -> float:
            if number not in seen:
                seen[number] = self._beyond(row, number)
            return seen[number]

        def greatest_kept() -> float:
            return max(
                (number for number, remaining in seen.items() if remaining >= 0.0), default=0.0
            )

        high = min(most, 2.0 * self.given if self.given > 0.0 else FIRST[self.unit])
        while beyond(high) >= 0.0:
            if high >= most:
                return most
            high = min(most, FARTHER * high)
        low = greatest_kept()
        if beyond(low) < 0.0:
            return 0.0
        root = brentq(beyond, low, high, xtol=SHARPNESS * high * 0.25, rtol=SHARPNESS)
        beyond((1.0 - SHARPNESS) * root)
        return greatest_kept()

    def _beyond(self, row: _Row, number: float) -> float:
        """[m] the margin of the bound of a row to the limit."""
        section = self.asked.sections[row.section]
        pairs = self._pairs(section, number)
        remaining = _proven(section, pairs, np.array([row.row]), math.inf, between=row.between)
        return float(remaining[0]) - self._limit(section)

    def _pairs(self, section: SectionBudget, number: float) -> PairsWithErrors:
        sizes = list(sizes_of(self._budget, self.key))
        sizes[self.place] = number
        return section.pairs.of(with_sizes(self._budget, self.key, tuple(sizes)))

    def _limit(self, section: SectionBudget) -> float:
        certificate = section.answer.certificate
        spare = SPARE if certificate is None else 2.0 * FINEST_GAP * certificate.gap
        return self.asked.fail + section.section.padding + spare

    def _open(self, i: int, number: float, *, between: bool) -> np.ndarray:
        """Rows whose bounds with the number as given do not prove the limit, hardest first."""
        section = self.asked.sections[i]
        rows = section.between if between else section.steps
        if rows is None:
            return np.empty(0, dtype=np.int64)
        proven = rows.proven[:-1] if between else rows.proven
        more = max(0.0, number - self.given)
        loss = 2.0 * math.sin(0.5 * more) if self.unit == "rad" else more
        remaining = proven - (loss * self.levers[i] if more > 0.0 else 0.0)
        open_rows = np.flatnonzero(remaining < self._limit(section))
        return open_rows[np.argsort(remaining[open_rows], kind="stable")]

    def _lever(self, section: SectionBudget) -> float:
        """[m/rad], [m/m] or [m/s] an upper bound on the motion of any point by one more unit of the number."""
        if self.unit == "s":
            return math.inf
        case = section.section.phase.case
        reach = farthest_reach(case, section.section.phase.motions)
        factor = 1.0
        for placed in case.robots:
            if placed.robot.name == self.key.owner:
                factor += sum(
                    abs(more) for leads in leads_of(placed.robot).values()
                    for name, more in leads[1:] if name == self.key.part
                )  # fmt: skip
        has_lever = self.unit == "rad" or factor > 1.0
        past = [one for part in case.obstacles for one in part.past if one.owner == self.key.owner]
        own = [one for one in past if factor > 1.0 or one.joint == self.key.part]
        reach = max([reach, *(float(np.linalg.norm(one.origin)) for one in own)])
        return 2.0 * (1 + len(own)) * factor * (4.0 * reach + 1.0 if has_lever else 1.0)


def _failing(
    section: SectionBudget, pairs: PairsWithErrors, rows: np.ndarray, limit: float, *, between: bool
) -> int | None:
    """A row whose bound is below the limit; None if all keep it. Rows come hardest first."""
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
    """[m] the bounds of some rows; near a finite `enough` they are lower by some per cent of the errors."""
    if not between:
        return _proven_of_steps(section, pairs, rows, enough)
    assert section.between is not None
    assert section.answer.certificate is not None
    gap = section.answer.certificate.gap
    if math.isfinite(enough):
        known = np.full(len(rows), enough + 2.0 * gap)  # no more than the limit is asked about
        return pairs.between(rows, section.between.pair[rows], known, gap, enough).proven
    ends = [_proven_of_steps(section, pairs, end, enough) for end in (rows, rows + 1)]
    known = np.minimum(*ends)
    order = section.between.pair[rows]
    # than with the errors as given
    greater_loss = float(np.max(section.between.proven[rows] - known))
    if COARSE * greater_loss <= gap:
        return pairs.between(rows, order, known, gap, enough).proven
    return pairs.between(rows, order, known, COARSE * greater_loss, enough, fail=math.inf).proven


def _proven_of_steps(
    section: SectionBudget, pairs: PairsWithErrors, rows: np.ndarray, enough: float
) -> np.ndarray:
    at = section.pairs.steps
    moments = PathMoments(at.intervals[rows], at.shares[rows])
    nominal = section.answer.found.clearance[rows]
    return pairs.at(moments, section.steps.pair[rows], nominal, enough).proven
