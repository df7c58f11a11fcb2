"""A clock for tests of what goes on: time passes when the test says so."""

from __future__ import annotations

import threading


class TimelessEnd(threading.Event):
    """The end of some work before which no time passes."""

    def wait(self, timeout: float | None = None) -> bool:
        """Waits until it is set."""
        return super().wait()


class CountedEnd:
    """The end of some work, as `clearance.progress` waits for it.

    Args:
        n: how many waits pass before it.
    """

    def __init__(self, n: int) -> None:
        self._n, self._n_waited = n, 0
        self._passing, self._asked = threading.Semaphore(0), threading.Semaphore(0)
        self._ended = threading.Event()

    def wait(self, timeout: float) -> bool:
        """Waits until the test lets this wait pass; after `n` of them until the end."""
        self._n_waited += 1
        self._asked.release()
        if self._n_waited > self._n:
            return self._ended.wait()
        self._passing.acquire()
        return False

    def pass_all(self) -> None:
        """Lets the waits pass, and returns when all lines are written."""
        for _ in range(self._n):
            self._asked.acquire()
            self._passing.release()
        self._asked.acquire()

    def set(self) -> None:
        """The work is done."""
        self._ended.set()


def counted_end(monkeypatch, n: int) -> CountedEnd:
    """The end of all work that `clearance.progress` waits for."""
    end = CountedEnd(n)
    monkeypatch.setattr("clearance.progress.Event", lambda: end)
    return end
