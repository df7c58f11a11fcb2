"""A guard on every test: it starts no process and reads no case beside the repository unless it is marked so.

An audit hook sees what the interpreter does, whoever asks for it, and refuses. Whatever the code under test makes
of the refusal, the test fails.
"""

from __future__ import annotations

import os
import sys
from collections.abc import Iterator
from contextlib import contextmanager

from tests.shared_cases import SHARED_CASES

STARTS = {
    "subprocess.Popen",
    "os.fork",
    "os.forkpty",
    "os.exec",
    "os.posix_spawn",
    "os.spawn",
    "os.system",
}
MAY_START = frozenset({"cold", "browser"})
FONT_LIST = "fc-list"
"""What matplotlib starts once on a machine, to find its fonts, in whichever test draws first."""

_marks: frozenset[str] | None = None
refused: list[str] = []
"""What the test that runs was refused."""


class UnmarkedDeed(RuntimeError):
    """A test did what it has no mark for."""


@contextmanager
def guarded(marks: frozenset[str]) -> Iterator[None]:
    """Refuses, inside, what needs one of the marks that are not given."""
    global _marks
    before, _marks = _marks, marks
    refused.clear()
    try:
        yield
    finally:
        _marks = before


def _see(event: str, arguments: tuple) -> None:
    if _marks is None:
        return
    if event in STARTS and not _marks & MAY_START and arguments[0] != FONT_LIST:
        _refuse(f"{event} without the mark cold or browser: {arguments[:2]}")
    elif event == "open" and "shared" not in _marks and _is_shared(arguments[0]):
        _refuse(f"{arguments[0]} is read without the mark shared")


def _is_shared(path: object) -> bool:
    return isinstance(path, str | os.PathLike) and os.fspath(path).startswith(
        f"{SHARED_CASES}{os.sep}"
    )


def _refuse(deed: str) -> None:
    refused.append(deed)
    raise UnmarkedDeed(deed)


sys.addaudithook(_see)
