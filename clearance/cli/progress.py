"""Progress bars on stderr while the work runs; silent where stderr is not a terminal."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager

Progress = Callable[[int, int], None]


@contextmanager
def shown_progress(silent: bool, cross_check: bool) -> Iterator[Progress | None]:
    """A callback that draws one bar for measuring and one for the cross-check; None where silent.

    The work counts from its start again for the second bar: that is how they are told apart.
    """
    if silent or not sys.stderr.isatty():
        yield None
        return
    from rich.console import Console
    from rich.progress import Progress as Bars

    with Bars(console=Console(stderr=True), transient=True) as bars:
        names = ["measuring", "cross-checking"] if cross_check else ["measuring"]
        tasks = [bars.add_task(name, total=None) for name in names]
        reached = [0] * len(tasks)

        def progress(done: int, total: int) -> None:
            i_bar = int(done <= reached[0] and len(tasks) > 1)
            reached[i_bar] = done
            bars.update(tasks[i_bar], completed=done, total=total)

        yield progress
