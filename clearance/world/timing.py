"""When a table of samples is followed in a run, and stretches of a run's time. Not for: the samples themselves."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from numbers import Real
from typing import TypeVar

import numpy as np

from clearance.errors import BadInput, BadTime
from clearance.world.field_types import require_types

Times = TypeVar("Times", float, np.ndarray)

AFTER = ("hold", "loop", "absent")
"""After its last sample an actor stays there, begins again, or is not in the cell, which it is not
before its first sample either."""


@dataclass(frozen=True)
class Timing:
    """How the times of a table become times of the run.

    Attributes:
        start: [s] the run's time at the table's time 0.
        rate: how many seconds of the table pass in one of the run; 0.5 is half as fast.
        after: one of `AFTER`. Before its first sample an actor stays there, unless it is absent.
        said: those of "start" and "after" that are given though they are as by default.

    Raises:
        BadTime: a start that is not finite, or a rate that is not above 0. BadInput: an unknown `after`.
    """

    start: float = 0.0
    rate: float = 1.0
    after: str = "hold"
    said: frozenset[str] = field(default=frozenset(), compare=False, repr=False)

    def __post_init__(self) -> None:
        require_types(self, start=Real, rate=Real)
        if not math.isfinite(self.start):
            raise BadTime(f"start is {self.start}", valid="a finite number of seconds")
        if not 0.0 < self.rate < math.inf:
            raise BadTime(
                f"rate is {self.rate}", valid="a number above 0; 1 is as fast as the table"
            )
        if self.after not in AFTER:
            raise BadInput(f"after is {self.after!r:.60}", valid=f"one of {', '.join(AFTER)}")

    @property
    def says_start(self) -> bool:
        """True if somebody says when it begins."""
        return self.start != 0.0 or "start" in self.said

    @property
    def says_after(self) -> bool:
        """True if somebody says what comes after its last sample."""
        return self.after != "hold" or "after" in self.said

    def run_times(self, times: np.ndarray) -> np.ndarray:
        """(n,) [s] the run's times of a table's times; the same array where nothing changes.

        Raises:
            BadTime: they no longer increase, since they round to the same double.
        """
        if self.start == 0.0 and self.rate == 1.0:
            return times
        with np.errstate(over="ignore", invalid="ignore"):
            found = self.start + times / self.rate
            increases = np.diff(found) > 0.0
        if not (np.isfinite(found).all() and increases.all()):
            raise BadTime(
                f"times from {times[0]:g} s to {times[-1]:g} s cannot begin at {self.start:g} s and go "
                f"{self.rate:g} times as fast",
                valid="a start and a rate that leave samples apart",
            )
        return found

    def table_times(self, times: Times) -> Times:
        """[s] A table's times of the run's, also where its samples do not reach."""
        return (times - self.start) * self.rate


def time_text(time: float) -> str:
    """A time, to the millisecond where `%g` would round more: `0.00025`, `3.2`, `1700000003.2`."""
    if not 1e3 <= abs(time) < 1e12:
        return f"{time:g}"
    return f"{time:.3f}".rstrip("0").rstrip(".")


AS_GIVEN = Timing()
"""A table whose times are the run's."""


@dataclass(frozen=True)
class Window:
    """A stretch of a run's time [s]; without bounds it is all of it.

    Raises:
        BadTime: an end that is not after the start, or NaN.
    """

    start: float = -math.inf
    end: float = math.inf

    def __post_init__(self) -> None:
        require_types(self, start=Real, end=Real)
        if not self.start < self.end:
            raise BadTime(
                f"from {time_text(self.start)} s until {time_text(self.end)} s",
                valid="`until` must be after `from`",
            )

    @property
    def ends(self) -> tuple[float, ...]:
        """Those of its bounds that are given [s]."""
        return tuple(end for end in (self.start, self.end) if math.isfinite(end))

    def holds(self, start: float, end: float) -> bool:
        """True if it contains a stretch that its own bounds do not cut."""
        return self.start <= start and end <= self.end

    def __str__(self) -> str:
        words = [f"from {time_text(self.start)} s"] if math.isfinite(self.start) else []
        words += [f"until {time_text(self.end)} s"] if math.isfinite(self.end) else []
        return " ".join(words)


ALWAYS = Window()
"""All of a run."""


def require_increasing(times: np.ndarray) -> None:
    """Nothing, if times increase from sample to sample.

    Raises:
        BadTime: the first pair that does not.
    """
    late = np.flatnonzero(np.diff(times) <= 0.0)
    if len(late):
        before, after = times[late[0] : late[0] + 2].tolist()
        raise BadTime(
            f"time {after} follows {before}", valid="times must increase from sample to sample"
        )
