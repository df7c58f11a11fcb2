"""Progress bars on stderr while the work runs; silent where stderr is not a terminal."""

from __future__ import annotations

import sys
from collections.abc import Iterator, Sequence
from contextlib import contextmanager

from clearance.progress import Progress


@contextmanager
def shown_progress(silent: bool, passes: Sequence[str]) -> Iterator[Progress | None]:
    """A callback that draws one bar for each of `passes` in turn; None where silent.

    Each pass counts from its start again: that distinguishes them.
    """
    if silent or not sys.stderr.isatty():
        yield None
        return
    from rich.console import Console
    from rich.progress import Progress as Bars

    with Bars(console=Console(stderr=True), transient=True) as bars:
        tasks = [bars.add_task(name, total=None) for name in passes]
        i_bar, reached = 0, 0

        def progress(done: int, total: int) -> None:
            nonlocal i_bar, reached
            if done <= reached:
                i_bar = min(i_bar + 1, len(tasks) - 1)
            reached = done
            bars.update(tasks[i_bar], completed=done, total=total)

        yield progress
