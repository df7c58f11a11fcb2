"""Compiles the search in a process of its own while this one still reads its input: the first run on a machine.

The compiler takes one function at a time in a process, which leaves all cores but one idle for half a minute. The
second process fills the cache and says what it has filled in; who comes to a kernel that it is busy with waits for
that word, or for its end (`kernel_table`). Two that start at once, as tests do, take turns. Only the command line
starts it; a program that imports the package compiles in its own process. Not for: what belongs to one command
alone.
"""

from __future__ import annotations

import atexit
import functools
import os
import subprocess
import sys
import threading
from contextlib import suppress
from pathlib import Path

import clearance.kernels.motion.certify
import clearance.kernels.search.body_pair  # noqa: F401 - both enter their kernels in the table
from clearance.compile import kernel_table
from clearance.compile.jit import DISABLED
from clearance.compile.kernel_table import (
    CERTIFY,
    FEATURES,
    REFINE,
    SEARCH,
    SEPARATING_PLANES,
    TOGETHER,
)
from clearance.kept_files import cache_root
from clearance.simulate.parts import usable_cores

IS_SECOND = "CLEARANCE_COMPILES_AHEAD"
"""Set in the environment of the second process, so that no other one follows whatever it comes to run."""

FIRST = (SEARCH, REFINE, SEPARATING_PLANES)
"""What questions about distances need, in the order in which it is come to; the last one where bodies move."""

ALL = (*FIRST, CERTIFY, *TOGETHER, FEATURES)
"""What the second process compiles: then what the proof for the motion and what some scenes need. It is stopped
where the first one ends before."""

LONGEST = 300
"""[s] A guard: a second process that another run's, stopped or frozen, keeps waiting for longer than this ends."""

_starting = threading.Lock()


def start() -> bool:
    """Begins to compile what is not kept from an earlier run, at the first call; True if anything has to be."""
    with _starting:
        return _start_once()


@functools.cache
def _start_once() -> bool:
    if DISABLED or all(map(kernel_table.is_kept, FIRST)):
        return False
    if cache_root() is not None and usable_cores() > 1 and _can_start():
        with suppress(OSError):  # then all is compiled here
            process = _second_process()
            atexit.register(process.kill)
            kernel_table.await_from(process, ALL)
    return True


def _can_start() -> bool:
    return (
        bool(sys.executable) and not getattr(sys, "frozen", False) and IS_SECOND not in os.environ
    )


def _second_process() -> subprocess.Popen:
    """This interpreter once more, with the same path to import from, less the current folder.

    Its stdin is a pipe that closes when this process ends, however that is, and it with it. It is in no terminal,
    which would stop it beside another run that waits for it.
    """
    package = str(Path(__file__).parents[2])
    found = [*filter(None, sys.path), *([] if package in sys.path else [package])]
    script = (
        f"import sys; sys.path[:] = {found!r}; from clearance.cli.compile_ahead import main; main()"
    )
    flags = subprocess._args_from_interpreter_flags()  # type: ignore[attr-defined]  # stubs leave it out
    options = [*flags, "-P"]
    return subprocess.Popen(
        [sys.executable, *options, "-c", script],
        env={**os.environ, IS_SECOND: "1"}, stdin=subprocess.PIPE, stdout=subprocess.PIPE,
        stderr=subprocess.DEVNULL, start_new_session=True,
    )  # fmt: skip


def main() -> None:
    """The second process: compiles into the cache, after any other that does, and says so of each kernel."""
    from filelock import FileLock, Timeout

    threading.Thread(target=_end_with_the_first, daemon=True).start()
    root = cache_root()
    assert root is not None
    turn = FileLock(root / "ahead.lock", timeout=LONGEST, fallback_to_soft=False)
    with suppress(Timeout), turn, os.fdopen(os.dup(1), "w") as told:
        os.dup2(os.open(os.devnull, os.O_WRONLY), 1)
        for place in ALL:
            kernel_table.compile_kernel(place)
            if not kernel_table.is_kept(place):
                return  # no room on the disk: the first has nothing to wait for
            print(place, file=told, flush=True)


def _end_with_the_first() -> None:
    while os.read(0, 1):
        pass
    os._exit(0)
