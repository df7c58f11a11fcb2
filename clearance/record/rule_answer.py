"""How the pairs that one rule judges stand against it. Not for: finding it, and joining rules (`simulate`)."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from clearance.record.certificate import Certificate
from clearance.record.measurement import Measurement
from clearance.record.moment import Moment
from clearance.record.status import STATUSES, Status, status_of
from clearance.world.case import Limits
from clearance.world.pairs import Pair

MOST_NEAR_STEPS = 250_000
"""Of a section; where something is near at more, only the nearest pair of each is told, to save memory."""


@dataclass(frozen=True, eq=False)
class RuleAnswer:
    """How the pairs that one rule judges stand against it.

    Attributes:
        name: of the rule, "default" for the limits that hold where no rule does.
        measurement: of all steps; pairs are those of the run. certificate: None where nothing is proven.
        worst_sample: the first step of least clearance; None where none is known.
        worst: the moment of least clearance, between two steps if a certificate has found a lesser one there.
        sections: the pairs that it judges, one row for each part of the run.
    """

    name: str
    limits: Limits
    measurement: Measurement
    certificate: Certificate | None = None
    worst_sample: Moment | None = None
    worst: Moment | None = None
    sections: tuple[tuple[Pair, ...], ...] = ()

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


@dataclass(frozen=True, eq=False)
class NearRows:
    """Pairs near at steps, one row a pair and step, steps in order.

    Attributes:
        steps, pairs: (k,) pairs are places among those of the run. clearances: (k,) [m] less padding.
        touching: (k,) where the bodies themselves touch.
        nearest_only: (k,) True where only the nearest pair of the step is known: others may be near as well.
    """

    steps: np.ndarray
    pairs: np.ndarray
    clearances: np.ndarray
    touching: np.ndarray
    nearest_only: np.ndarray


def standing_worst(moments: Iterable[tuple[RuleAnswer, Moment | None]]) -> Moment | None:
    """Of moments, each with the rule that judges it, the most critical one, the first of those alike."""
    standing = [
        (rule.standing_of(moment), i, moment)
        for i, (rule, moment) in enumerate(moments)
        if moment is not None
    ]
    return min(standing, key=lambda row: row[:2])[2] if standing else None


def worst_of(rules: Iterable[RuleAnswer]) -> Moment | None:
    """The most critical moment of some rules; None where none is known."""
    return standing_worst((rule, rule.worst) for rule in rules)
