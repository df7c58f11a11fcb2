"""How the rows of a record stand: each step, and the motion to the next, against the rule that is worst."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from clearance.record.certificate import motion_codes
from clearance.record.moment import Moment
from clearance.record.record import Record
from clearance.record.status import STATUSES, Status, sample_codes
from clearance.record.table import Table


@dataclass(frozen=True, eq=False)
class RowStatus:
    """The rows of a record against its rules."""

    record: Record

    @cached_property
    def between(self) -> np.ndarray:
        """(n,) True where the status of a row is that of the motion to the next."""
        if self.record.certificate is None:
            return np.zeros(self.record.rows.n_rows, dtype=bool)
        return between_of(self.record.rows)

    def of_samples(self, steps: slice | np.ndarray = slice(None)) -> np.ndarray:
        """(k,) the status of each of some steps by itself, the worst of all rules; 0 where a bound does not
        decide."""
        codes = [sample_codes(one.measurement, one.limits, steps) for one in self.record.rules]
        return np.maximum(np.max(codes, axis=0), 0)

    @cached_property
    def rule_between(self) -> np.ndarray:
        """(n,) the place among the rules of the most critical one in the motion to the next step, and of
        those alike of the least margin above its fail limit."""
        rules = self.record.rules
        if len(rules) == 1 or not self.between.any():
            return np.zeros(self.record.rows.n_rows, dtype=np.int64)
        proven = [(one, one.certificate) for one in rules if one.certificate is not None]
        codes = np.array([motion_codes(c, one.limits, slice(None)) for one, c in proven])
        margins = np.array(
            [certificate.upper_bound - one.limits.fail for one, certificate in proven]
        )
        margins[codes < codes.max(axis=0)] = np.inf
        return np.argmin(margins, axis=0)

    @cached_property
    def least(self) -> np.ndarray:
        """(n,) [m] at the step, or on the way to the next where the status is of that; NaN where only a bound is
        known."""
        clearances = self.record.clearances
        if not self.between.any():
            return clearances
        uppers = [one.certificate.upper_bound for one in self.record.rules if one.certificate]
        chosen = np.array(uppers)[self.rule_between, np.arange(len(clearances))]
        return np.where(self.between, chosen, clearances)

    @cached_property
    def margin(self) -> np.ndarray:
        """(n,) [m] what rows of one status are ordered by: how far `least` is above the fail limit of its rule, or
        itself where there is one rule."""
        rules = self.record.rules
        if len(rules) == 1:
            return self.least
        fail = np.array([one.limits.fail for one in rules])
        return self.least - fail[np.where(self.between, self.rule_between, self.rules)]

    @cached_property
    def rules(self) -> np.ndarray:
        """(n,) the place among the rules of what judged each step."""
        return rule_places(self.record)


def rule_places(record: Record) -> np.ndarray:
    """(n,) the place among the record's rules of what judged each step."""
    n_steps = record.rows.n_rows
    if len(record.rules) == 1:
        return np.zeros(n_steps, dtype=np.int64)
    return record.rows.names("rule").places_in(one.name for one in record.rules)


def codes_of_moments(record: Record, moments: list[Moment]) -> np.ndarray:
    """(k,) how some moments stand against what judges them, as indices into `STATUSES`."""
    codes = [STATUSES.index(Status(record.status_of(moment))) for moment in moments]
    return np.array(codes, dtype=np.uint8)


def between_of(steps: Table) -> np.ndarray:
    """(n,) True where the status in a table of steps is that of the motion to the next step."""
    if "between" not in steps:
        return np.zeros(steps.n_rows, dtype=bool)
    return steps.numbers("between")


def status_codes_of(steps: Table) -> np.ndarray:
    """(n,) uint8 the statuses of a steps table as indices into `STATUSES`; 0 where there is none."""
    found = steps.names("status").places_in(map(str, STATUSES))
    return np.maximum(found, 0).astype(np.uint8)


def status_counts(record: Record) -> dict[str, int]:
    """How many steps have each status."""
    names = [str(name) for name in STATUSES]
    codes = record.rows.names("status").places_in(names)
    counts = np.bincount(codes[codes >= 0], minlength=len(names))
    return dict(zip(names, counts.tolist(), strict=True))
