"""Prints how long a whole command takes from start to verdict: on a fresh machine, and every time after.

    python scripts/bench/first_run.py [--cases NAME ...] [--warm N] [--kept] [--csv FILE]

Each run is a process of its own, `python -m clearance check CASE`, with its own empty cache the first time and the
same folder after (`--kept`: the user's own); then with `--out` as well, and one of a path that leads to no file.
Seconds on the wall and of CPU with all children; the least of the warm runs. On a busy machine the wall says more
about the others; CPU seconds are then what to compare.
"""

from __future__ import annotations

import os
import resource
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Sequence
from pathlib import Path

import harness
from harness import ROOT, Row
from inputs import case_files

SMALLEST = ["--cases", "box_box", "--warm", "1", "--kept"]


def main(words: list[str] | None = None) -> list[Row]:
    """Runs what the command line asks for."""
    asked = harness.arguments(__doc__, words, cases=[], warm=5, kept=True)
    rows: list[Row] = []
    with tempfile.TemporaryDirectory() as empty:
        cache = None if asked.kept else empty
        for path in case_files():
            if not asked.cases or path.parent.name in asked.cases:
                first = "first of the case" if rows or asked.kept else "first, empty cache"
                rows.append({"case": path.parent.name, "run": first, **ran(path, cache)})
                rows += warm_rows(path, cache, asked.warm)
        refused = least(
            "no file", "refused", asked.warm, lambda: ran(Path("none.yaml"), cache, (2,))
        )
        rows.append(refused)
    harness.show("from command to verdict", rows)
    for run in ("warm", "warm, --out"):
        slowest = max((row for row in rows if row["run"] == run), key=lambda row: row["seconds"])
        cpu = f"{slowest['seconds']:.2f} s ({slowest['cpu_seconds']:.2f} s CPU)"
        harness.tell(f"slowest run, {run}: {slowest['case']}, {cpu}")
    harness.write_csv(rows, asked.csv, digits=4)
    return rows


def warm_rows(path: Path, cache: str | None, n_runs: int) -> list[Row]:
    """The least of the warm runs without and with a report, which is written anew each time."""

    def reported() -> Row:
        with tempfile.TemporaryDirectory() as folder:
            return ran(path, cache, options=("--out", f"{folder}/report"))

    name = path.parent.name
    warm = least(name, "warm", n_runs, lambda: ran(path, cache))
    reported()  # the first draws on what no run without a report has
    return [warm, least(name, "warm, --out", n_runs, reported)]


def least(case: str, run: str, n_runs: int, once: Callable[[], Row]) -> Row:
    """The run that took the least CPU time, and the least seconds of all."""
    found = sorted((once() for _ in range(n_runs)), key=lambda row: row["cpu_seconds"])
    seconds = min(row["seconds"] for row in found)
    return {"case": case, "run": run, **found[0], "seconds": seconds}


def ran(
    path: Path, cache: str | None, ends: Sequence[int] = (0, 1), options: Sequence[str] = ()
) -> Row:
    """Seconds of one command; an end that is none of `ends` is no answer."""
    own = {
        name: value
        for name, value in os.environ.items()
        if not name.endswith("_NUM_THREADS") and name != "PYTHONDONTWRITEBYTECODE"
    }  # as a user has them: all threads, and modules that Python compiles once
    environment = own if cache is None else {**own, "XDG_CACHE_HOME": cache}
    before, start = resource.getrusage(resource.RUSAGE_CHILDREN), time.perf_counter()
    command = [sys.executable, "-m", "clearance", "check", str(path), *options]
    done = subprocess.run(command, cwd=ROOT, env=environment, capture_output=True, text=True)
    seconds, after = time.perf_counter() - start, resource.getrusage(resource.RUSAGE_CHILDREN)
    if done.returncode not in ends:
        raise SystemExit(done.stderr)
    cpu = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
    return {"seconds": seconds, "cpu_seconds": cpu}


if __name__ == "__main__":
    main()
