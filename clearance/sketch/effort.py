"""The effort of a solve: its time limit, checked between the steps of its searches; a terminal shows the time.

The answer of a solve that ends in time does not depend on the limit; a solve that is stopped changes
nothing. Not for: how hard a search tries (`execution.run`).
"""

from __future__ import annotations

import math
import sys
import time
from collections.abc import Callable

import numpy as np

from clearance.errors import BadDimension

SECONDS = 5.0
"""[s] Default limit of processor time; sketches of a thousand points need a fraction of it."""

SHOWN_AFTER, SHOWN_EVERY = 1.0, 0.2
"""[s] When a terminal begins to show the time of a solve, and how often."""


class OutOfTime(Exception):
    """A search has passed its limit; raised within this package only.

    Attributes:
        x: (n,) the best numbers that it had found by then; None for none.
    """

    def __init__(self, x: np.ndarray | None = None) -> None:
        super().__init__()
        self.x = x


class TimeLimit:
    """The moment at which searches stop; as a context, it cleans the terminal at the end.

    Args:
        seconds: [s] from now on; infinite for none.
        clock: the time [s]: the processor time of this thread, so that a busy machine stops no more than an
            idle one.

    Raises:
        BadDimension: no number of seconds from 0 on.
    """

    def __init__(self, seconds: float, clock: Callable[[], float] = time.thread_time) -> None:
        if not (isinstance(seconds, int | float) and seconds >= 0.0):
            raise BadDimension(f"seconds is {seconds!r:.60}", valid="0 s or more")
        self.seconds = float(seconds)
        self._clock, self._begin = clock, clock()
        self._shown = SHOWN_AFTER

    def again(self) -> TimeLimit:
        """The same limit, from now on."""
        return TimeLimit(self.seconds, self._clock)

    def is_over(self) -> bool:
        """Whether the time is up; a terminal shows the time used."""
        used = self._clock() - self._begin
        if self._shown <= used < self.seconds:
            self._shown = used + SHOWN_EVERY
            _show(f"solving the sketch: {used:.1f} of at most {self.seconds:g} s")
        return used >= self.seconds

    def require_time(self) -> None:
        """Refuses to go on when the time is up.

        Raises:
            OutOfTime: none is.
        """
        if self.is_over():
            raise OutOfTime

    def __enter__(self) -> TimeLimit:
        return self

    def __exit__(self, *_: object) -> None:
        """Removes what a terminal shows."""
        if self._shown > SHOWN_AFTER:
            _show("")


def _show(text: str) -> None:
    """Writes a line that the next one replaces, where errors go to a terminal."""
    if sys.stderr.isatty():
        sys.stderr.write(f"\r\x1b[K{text}")
        sys.stderr.flush()


UNLIMITED = TimeLimit(math.inf, clock=lambda: 0.0)
"""For problems without a limit."""
