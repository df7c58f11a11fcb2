"""Progress on stderr while the work runs: bars in a terminal, elsewhere a line now and then."""

from __future__ import annotations

import sys
from collections.abc import Iterator, Sequence
from contextlib import contextmanager

from clearance.progress import Progress, doing


class _Passes:
    """Which of some passes goes on: each counts from its start again, and that distinguishes them."""

    def __init__(self, names: Sequence[str]) -> None:
        self._names = names
        self.i, self.done, self.total = 0, 0, 0

    def take(self, done: int, total: int) -> None:
        """Counts."""
        if done <= self.done:
            self.i = min(self.i + 1, len(self._names) - 1)
        self.done, self.total = done, total

    @property
    def line(self) -> str:
        """How far it is."""
        counted = f": {self.done:,} of {self.total:,}" if self.total else ""
        return f"{self._names[self.i]}{counted}"


@contextmanager
def shown_progress(silent: bool, passes: Sequence[str]) -> Iterator[Progress | None]:
    """A callback that shows how far each of `passes` is, one after the other; None where silent."""
    if silent:
        yield None
        return
    reached = _Passes(passes)
    if not sys.stderr.isatty():
        with doing(lambda: reached.line):
            yield reached.take
        return
    from rich.console import Console
    from rich.progress import Progress as Bars

    with Bars(console=Console(stderr=True), transient=True) as bars, doing(lambda: ""):
        tasks = [bars.add_task(name, total=None) for name in passes]

        def progress(done: int, total: int) -> None:
            reached.take(done, total)
            bars.update(tasks[reached.i], completed=done, total=total)

        yield progress


@contextmanager
def shown_work(silent: bool, name: str) -> Iterator[None]:
    """Says that some work goes on of which nobody knows how long it is."""
    if silent or not sys.stderr.isatty():
        with doing(lambda: name):
            yield
        return
    from rich.console import Console

    with Console(stderr=True).status(name), doing(lambda: ""):
        yield
