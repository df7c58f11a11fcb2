"""`clearance batch` as a program of its own, and who works for it, for tests that end one of them."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from contextlib import suppress
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
    out, err = process.communicate(timeout=LONGEST)
    return process.returncode, out, err


def until(what: Callable[[], object]) -> object:
    """Waits until something is so; what it is then."""
    end = time.monotonic() + LONGEST
    while time.monotonic() < end:
        found = what()
        if found:
            return found
        time.sleep(0.02)
    raise AssertionError("it has not come to be")


def segments(place: Path) -> list[Path]:
    """What a store keeps."""
    folder = place / "segments"
    return sorted(folder.glob("*.parquet")) if folder.is_dir() else []


def below(process: int) -> list[int]:
    """The processes that one has started, and theirs."""
    found = []
    for status in Path("/proc").glob("[0-9]*/stat"):
        with suppress(OSError):
            text = status.read_text()
            if int(text.rsplit(")", 1)[1].split()[1]) == process:
                child = int(status.parent.name)
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


def told(place: Path) -> dict:
    """The list of the last batch."""
    return json.loads((place / "batch.json").read_text())
