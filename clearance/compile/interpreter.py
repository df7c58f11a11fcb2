"""What the interpreter is spared while the compiler runs: a stack with little room, and collections of garbage.

CPython keeps frames in pieces of 16 KiB. A call for which the last piece has no room takes a new one from the
system, and gives it back when it returns: a loop that happens to run at the end of a piece does that at each call,
and spends most of its time in the system. Whether it does depends on how deep it was called from; with room, deep
Python code takes as long whatever called it. Not for: how deep calls may go.
"""

from __future__ import annotations

import gc
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any

_SLOTS = 2**17
"""What one frame claims: it gets a piece of twice that, 2 MiB, and leaves half of it to the frames above, which
are never so many. Memory that nothing touches costs nothing."""


def with_room_for_frames(function: Callable, *arguments: Any) -> Any:
    """`function(*arguments)`, with room for some thousand frames in one piece."""
    return function(*arguments)


with_room_for_frames.__code__ = with_room_for_frames.__code__.replace(co_stacksize=_SLOTS)


@contextmanager
def no_collections() -> Iterator[None]:
    """No collections of garbage, which walk all that the compiler holds: a tenth of its time."""
    collects = gc.isenabled()
    gc.disable()
    try:
        yield
    finally:
        if collects:
            gc.enable()
