"""Stretches of the motion below a limit, and when each begins and ends. Not for: finding them."""

from __future__ import annotations

from dataclasses import dataclass

LEVELS = {"below_warn": 1, "below_fail": 2, "contact": 3}
"""Each level and the least status code that belongs to it."""


@dataclass(frozen=True)
class Interval:
    """A longest stretch of the motion at one level; of steps where only they are known.

    Attributes:
        first_step, last_step: both inside; the one before it where no step is.
        start, end: [s] before and after, the motion is proven to be above the level; of steps first and last.
        worst_step: the first most critical step, or the one before that moment; worst_time [s], clearance
            [m], the two bodies (link, obstacle) and the rule that judges them are of that moment.
        between: that moment is between two steps.
    """

    first_step: int
    last_step: int
    start: float
    end: float
    worst_step: int
    worst_time: float
    between: bool
    clearance: float
    link: str
    obstacle: str
    rule: str


@dataclass(frozen=True)
class Event:
    """When a level was entered or left; of steps the first at it, and the first after it.

    Attributes:
        step: the step, or the one before the moment. between: whether it is between steps.
        clearance: [m] of the pair that is nearest then; unknown, and so are the names, where a bound decides.
        rule: what judges it.
        least: [m] until the level is left again; None where it is left.
    """

    step: int
    time: float  # [s]
    between: bool
    what: str
    clearance: float | None
    link: str | None
    obstacle: str | None
    rule: str
    least: float | None = None
