"""`clearance batch` as a program of its own, and who works for it, for tests that end one of them."""

from __future__ import annotations

import os
import signal
import sqlite3
import subprocess
import sys
import time
from collections.abc import Callable
from contextlib import closing, suppress
from pathlib import Path

ROOT = Path(__file__).parents[2]

LONGEST = 300
"""[s] A guard: nothing here takes as long, however busy the machine is."""


def started(*arguments: str, module: tuple[str, ...] = ("clearance", "batch")) -> subprocess.Popen:
    """The program, running, in a session of its own; its lines are kept."""
    environment = os.environ | {"PYTHONPATH": str(ROOT)}
    return subprocess.Popen(
        [sys.executable, "-m", *module, *arguments],
        env=environment,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        start_new_session=True,
    )


def finished(*arguments: str) -> tuple[int, str, str]:
    """Exit code, output and errors of the program."""
    process = started(*arguments)
    out, err = ended(process)
    return process.returncode, out, err


def ended(process: subprocess.Popen) -> tuple[str, str]:
    """Output and errors of a program once it has ended; how far it was is left out, which a busy machine tells."""
    out, err = process.communicate(timeout=LONGEST)
    lines = err.splitlines(keepends=True)
    return out, "".join(
        line for line in lines if " cases measured" not in line and " so far" not in line
    )


def until(what: Callable[[], object]) -> object:
    """Waits until something is so; what it is then."""
    end = time.monotonic() + LONGEST
    while time.monotonic() < end:
        found = what()
        if found:
            return found
        time.sleep(0.02)
    raise AssertionError("it has not come to be")


def n_kept(place: Path) -> int:
    """How many rows a store has by now; 0 where there is none yet."""
    path = place / "store.sqlite"
    if not path.is_file():
        return 0
    with closing(sqlite3.connect(path, timeout=60)) as db, suppress(sqlite3.OperationalError):
        return db.execute("SELECT count(*) FROM cases").fetchone()[0]
    return 0


def below(process: int) -> list[int]:
    """The processes that one has started, and theirs."""
    found = []
    for listed in Path(f"/proc/{process}/task").glob("*/children"):
        with suppress(OSError):
            for child in map(int, listed.read_text().split()):
                found += [child, *below(child)]
    return found


def workers_of(process: int) -> list[int]:
    """The worker processes of a batch: those that have loaded Python and measure."""
    found = []
    for child in below(process):
        with suppress(OSError):
            command = Path(f"/proc/{child}/cmdline").read_bytes()
            if b"spawn_main" in command:
                found.append(child)
    return found


def kill(process: int) -> None:
    """Ends a process as the kernel does: it learns nothing of it."""
    with suppress(ProcessLookupError):
        os.kill(process, signal.SIGKILL)


def is_gone(process: int) -> bool:
    """True if a process has ended, or waits only for its parent to notice."""
    try:
        text = Path(f"/proc/{process}/stat").read_text()
    except OSError:
        return True
    return text.rsplit(")", 1)[1].split()[0] == "Z"
