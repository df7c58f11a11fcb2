"""What a case falls short of, and how that changes with what may be changed: linear rows about where it is.

Not for: what may be changed (`shift`, `offsets`), nor by how much it then is (`search`).
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import NamedTuple

import numpy as np

from clearance.findings.standing import code_of
from clearance.run import Question, answer
from clearance.simulate.approaches import Approach, approaches
from clearance.simulate.certificate import motion_codes
from clearance.simulate.record import Record
from clearance.simulate.status import STATUSES, Status
from clearance.tolerance import CERTIFY_GAP
from clearance.world.case import Case, Limits
from clearance.world.rules import Rule

VIOLATED = STATUSES.index(Status.VIOLATED)

TOUCHING = CERTIFY_GAP
"""[m] What is wanted beyond, at least, where bodies touch between two steps."""

Gradient = Callable[[Approach], np.ndarray | None]
"""(k, m) [m] what the clearances of an approach grow by for each unit of the m variables; None for nothing."""


class Rows(NamedTuple):
    """Clearances of pairs at steps, and what each grows by.

    Attributes:
        missing: (k,) [m] how far each is below what is wanted; negative above it.
        gradients: (k, m) [m per unit of a variable].
    """

    missing: np.ndarray
    gradients: np.ndarray


@dataclass(frozen=True)
class Wanted:
    """What a case is to keep.

    Attributes:
        margin: [m] above the fail limit of each rule. beyond: [m] that is to cover rounding.
        extra: (n,) [m] beyond that at each step, so that the motion between them keeps it too.
    """

    margin: float
    beyond: float
    extra: np.ndarray


@dataclass(frozen=True, eq=False)
class State:
    """A case as it was measured, with what comes near.

    Attributes:
        x: (m,) the variables that it is made of. beyond: [m] above what is wanted, what counts as near.
    """

    x: np.ndarray
    case: Case
    record: Record
    beyond: float
    wanted: Wanted

    @cached_property
    def near(self) -> Sequence[Approach]:
        """All that comes near, at the steps."""
        extra = float(self.wanted.extra.max(initial=0.0))
        return [
            *approaches(self.record.rules, self.margin + self.wanted.beyond + extra + self.beyond)
        ]

    @property
    def touches(self) -> bool:
        """True if bodies are in contact at a step."""
        return self.record.nearest.touches

    @property
    def margin(self) -> float:
        """[m] Above the fail limit of each rule."""
        return self.wanted.margin

    @cached_property
    def worst(self) -> float:
        """[m] How far the worst pair is below what is wanted; 0 where none is."""
        return max((float(self.missing(one).max(initial=0.0)) for one in self.near), default=0.0)

    def missing(self, approach: Approach) -> np.ndarray:
        """(k,) [m] how far an approach is below what is wanted; negative above it."""
        level = approach.rule.limits.fail + self.wanted.margin + self.wanted.beyond
        return level + self.wanted.extra[approach.steps] - approach.clearances

    def rows(self, gradient: Gradient) -> Rows:
        """All that is near, and what it grows by; what nothing changes is left out where it is kept."""
        missing, gradients = [np.empty(0)], [np.empty((0, len(self.x)))]
        for approach in self.near:
            found = gradient(approach)
            own = self.missing(approach)
            if found is None:
                found = np.zeros((len(own), len(self.x)))
            kept = (own > 0.0) | found.any(axis=1)
            missing.append(own[kept])
            gradients.append(found[kept])
        return Rows(np.concatenate(missing), np.concatenate(gradients))


def measured(case: Case, x: np.ndarray, wanted: Wanted, beyond: float) -> State:
    """A case with all that comes within `beyond` [m] of what is wanted, at its steps."""
    record = answer(Question(case, certify=False, contact="none")).record
    if len(wanted.extra) != len(record.motions[0].times):
        wanted = replace(wanted, extra=np.zeros(len(record.motions[0].times)))
    return State(x, case, record, beyond, wanted)


def proven(case: Case, margin: float) -> Record:
    """The certified record of a case whose fail limits are raised by a margin [m]."""
    raised = replace(case, limits=_raised(case.limits, margin))
    return answer(Question(raised, certify=True, contact="none")).record


def keeps(record: Record) -> bool:
    """True if every rule is proven to hold at all times."""
    return all(code_of(rule) < VIOLATED for rule in record.rules)


def with_extra(extra: np.ndarray, record: Record) -> np.ndarray:
    """(n,) [m] what is wanted beyond the margin at each step, raised where the motion from it is not proven.

    Where bodies touch between two steps the certificate does not say how deep: three times as much is wanted.
    """
    more = np.zeros(len(record.motions[0].times))
    before = extra if len(extra) == len(more) else np.zeros(len(more))
    for rule in record.rules:
        if rule.certificate is None:
            continue
        codes = motion_codes(rule.certificate, rule.limits, slice(None))
        below = np.flatnonzero(codes >= VIOLATED)
        bound = rule.certificate.lower_bound[below]
        short = rule.limits.fail - bound + CERTIFY_GAP * 1e-3
        ends = (below, np.minimum(below + 1, len(more) - 1))
        again = np.maximum(2.0 * np.maximum(*(before[end] for end in ends)), TOUCHING)
        for end in ends:
            np.maximum.at(more, end, np.where(bound > 0.0, short, np.maximum(short, again)))
    return before + more


def _raised(limits: Limits, margin: float) -> Limits:
    """Limits with fail levels that are higher by a margin [m], and warn levels that are not below them."""
    fail = limits.fail + margin
    rules = tuple(
        rule if rule.fail is None and rule.warn is None else _raised_rule(rule, margin, fail)
        for rule in limits.rules
    )
    return replace(limits, fail=fail, warn=max(limits.warn, fail), rules=rules)


def _raised_rule(rule: Rule, margin: float, fail: float) -> Rule:
    own = fail if rule.fail is None else rule.fail + margin
    warn = None if rule.warn is None else max(rule.warn, own)
    return replace(rule, fail=None if rule.fail is None else own, warn=warn)
