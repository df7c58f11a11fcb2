"""Compiles the search in a process of its own while this one still reads its input: the first run on a machine.

The compiler takes one function at a time in a process, which leaves all cores but one idle for half a minute. The
second process fills the cache; who comes to a kernel that it is busy with waits for it (`kernel_table`). Two that
start at once, as tests do, take turns. Not for: what belongs to one command alone.
"""

from __future__ import annotations

import atexit
import functools
import os
import subprocess
import sys
import threading
from contextlib import suppress

import numba

import clearance.kernels.body_pair  # noqa: F401 these enter `ALL` into the table, with what they import
import clearance.kernels.certify  # noqa: F401
from clearance import kernel_table
from clearance.jit import cache_root
from clearance.kernel_table import CERTIFY, FEATURES, PARTING, REFINE, SEARCH, TOGETHER

IS_SECOND = "CLEARANCE_COMPILES_AHEAD"
"""Set in the environment of the second process, so that no other one follows whatever it comes to run."""

FIRST = (SEARCH, REFINE, PARTING)
"""What questions about distances need, in the order in which it is come to; the last one where bodies move."""

ALL = (*FIRST, CERTIFY, *TOGETHER, FEATURES)
"""What the second process compiles: then what the proof for the motion and what some scenes need. It is stopped
where the first one ends before."""

_starting = threading.Lock()


def start() -> bool:
    """Begins to compile what is not kept from an earlier run, at the first call; True if anything has to be."""
    with _starting:
        return _start_once()


@functools.cache
def _start_once() -> bool:
    if numba.config.DISABLE_JIT or all(map(kernel_table.is_kept, FIRST)):
        return False
    if usable_cores() > 1 and sys.executable and not getattr(sys, "frozen", False) and IS_SECOND not in os.environ:
        with suppress(OSError):  # then all is compiled here
            process = _second_process()
            atexit.register(_stop, process)
            kernel_table.await_from(process, ALL)
    return True


def _second_process() -> subprocess.Popen:
    """This interpreter once more, with the same path to import from: neither more nor less may be found there."""
    script = f"import sys; sys.path[:] = {sys.path!r}; from clearance.ahead import main; main()"
    options = subprocess._args_from_interpreter_flags()
    none = subprocess.DEVNULL
    return subprocess.Popen(
        [sys.executable, *options, "-c", script],
        env={**os.environ, IS_SECOND: "1"}, stdin=none, stdout=none, stderr=none,
    )  # fmt: skip


def _stop(process: subprocess.Popen) -> None:
    process.terminate()
    process.wait()


def usable_cores() -> int:
    """The cores that this process may run on."""
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1


def main() -> None:
    """The second process: compiles into the cache, after any other that does."""
    import fcntl

    cache_root().mkdir(parents=True, exist_ok=True)
    with open(cache_root() / "ahead.lock", "w") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        for place in ALL:
            kernel_table.compile_kernel(place)
