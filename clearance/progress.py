"""How far a long piece of work is, for whoever started it; who waits for it hears of it now and then."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from threading import Event, Thread

Progress = Callable[[int, int], None]
"""Called with how many steps are done, and how many there are."""

EVERY = 10.0
"""[s] Between two lines about work that goes on."""

_doing: list[Callable[[], str]] = []
"""What is being done, the innermost part last."""


@contextmanager
def doing(line: Callable[[], str]) -> Iterator[None]:
    """Names what is being done until the block ends; an empty line stands for what shows itself."""
    _doing.append(line)
    try:
        yield
    finally:
        _doing.remove(line)


@contextmanager
def never_silent(line: Callable[[], str]) -> Iterator[None]:
    """Writes the innermost line to stderr every `EVERY` seconds until the block ends, with the time so far.

    Args:
        line: of the whole.
    """
    with doing(line):
        if len(_doing) > 1:  # somebody writes already
            yield
            return
        end = Event()
        thread = Thread(target=_write_lines, args=(end,), daemon=True)
        thread.start()
        try:
            yield
        finally:
            end.set()
            thread.join()


def _write_lines(end: Event) -> None:
    n = 0
    while not end.wait(EVERY):
        n += 1
        line = _doing[-1]() if _doing else ""
        if line:
            print(f"{line}, {n * EVERY:.0f} s so far", file=sys.stderr, flush=True)
