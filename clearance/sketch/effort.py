"""The time limit of a solve, checked between the steps of its searches.

The answer of a solve that ends in time does not depend on the limit; a solve that is stopped changes
nothing. Not for: how hard a search tries (`execution.run`).
"""

from __future__ import annotations

import math
import time
from collections.abc import Callable

from clearance.errors import BadDimension

SECONDS = 10.0
"""[s] Default limit of processor time; sketches of a hundred points take milliseconds."""


class OutOfTime(Exception):
    """A search has passed its limit; raised within this package only."""


class TimeLimit:
    """The moment at which searches stop.

    Args:
        seconds: [s] from now on; infinite for none.
        clock: tells the time [s]: the processor time of this thread, so that a busy machine stops no more than an
            idle one.

    Raises:
        BadDimension: no number of seconds from 0 on.
    """

    def __init__(self, seconds: float, clock: Callable[[], float] = time.thread_time) -> None:
        if not (isinstance(seconds, int | float) and seconds >= 0.0):
            raise BadDimension(f"seconds is {seconds!r:.60}", valid="0 s or more")
        self.seconds = float(seconds)
        self._clock, self._end = clock, clock() + self.seconds

    def again(self) -> TimeLimit:
        """The same limit, from now on."""
        return TimeLimit(self.seconds, self._clock)

    def require_left(self) -> None:
        """Nothing, if time is left.

        Raises:
            OutOfTime: none is.
        """
        if self._clock() >= self._end:
            raise OutOfTime


UNLIMITED = TimeLimit(math.inf, clock=lambda: 0.0)
"""For problems without a limit."""
