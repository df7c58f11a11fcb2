"""How the pairs that one rule judges stand against it. Not for: putting rules together (`run_answer`)."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from clearance.simulate.certificate import Certificate
from clearance.simulate.moment import Moment
from clearance.simulate.status import STATUSES, Status, status_of
from clearance.world.case import Limits

if TYPE_CHECKING:
    from clearance.simulate.measurement import Measurement
    from clearance.simulate.rule_pairs import RulePairs


@dataclass(frozen=True, eq=False)
class RuleAnswer:
    """How the pairs that one rule judges stand against it.

    Attributes:
        name: of the rule, "default" for the limits that hold where no rule does.
        measurement: of all steps; pairs are those of the run. certificate: None where nothing is proven.
        moment_at: the moment of a step whose clearance is known.
        pairs: its pairs one by one; None where only the nearest of each step is known.
    """

    name: str
    limits: Limits
    measurement: Measurement
    certificate: Certificate | None
    moment_at: Callable[[int], Moment]
    pairs: RulePairs | None = None

    @cached_property
    def worst_sample(self) -> Moment | None:
        """The first step of least clearance; None where none is known."""
        clearance = self.measurement.clearance
        unknown = np.isnan(clearance)
        if unknown.all():
            return None
        touching = self.measurement.touches(slice(None))
        if self.measurement.touching is not None and touching.any():
            return self.moment_at(int(np.argmax(touching)))
        return self.moment_at(int(np.argmin(np.where(unknown, np.inf, clearance))))

    @cached_property
    def worst(self) -> Moment | None:
        """The moment of least clearance, between two steps if a certificate has found a lesser one there."""
        return _lesser(
            self.worst_sample, None if self.certificate is None else self.certificate.worst
        )

    @cached_property
    def status(self) -> str:
        """How its worst moment stands: "clear", "near", "violated" or "contact"."""
        return (
            "clear"
            if self.worst is None
            else status_of(self.worst.clearance, self.limits, self.worst.touches)
        )

    def standing_of(self, moment: Moment) -> tuple[int, float]:
        """What moments are ordered by, the worst first: status, then how far it is above the fail limit [m]."""
        status = status_of(moment.clearance, self.limits, moment.touches)
        return -STATUSES.index(Status(status)), moment.clearance - self.limits.fail


def _lesser(known: Moment | None, between: Moment | None) -> Moment | None:
    """The one of less clearance; contact of the bodies themselves is least."""
    if known is None or between is None:
        return between if known is None else known
    if known.touches:
        return known
    return between if between.touches or between.clearance < known.clearance else known


def standing_worst(moments: Iterable[tuple[RuleAnswer, Moment | None]]) -> Moment | None:
    """Of moments, each with the rule that judges it, the one that stands worst, the first of those alike."""
    standing = [
        (rule.standing_of(moment), i, moment)
        for i, (rule, moment) in enumerate(moments)
        if moment is not None
    ]
    return min(standing, key=lambda row: row[:2])[2] if standing else None


def worst_of(rules: Iterable[RuleAnswer]) -> Moment | None:
    """The moment that stands worst of some rules; None where none is known."""
    return standing_worst((rule, rule.worst) for rule in rules)
