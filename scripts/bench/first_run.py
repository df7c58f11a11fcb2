"""Prints how long a whole command takes from start to verdict: on a fresh machine, and every time after.

    python scripts/bench/first_run.py [--cases FILE ...] [--warm N] [--fresh 0|1] [--csv FILE]

Each run is a process of its own, `python -m clearance check CASE`, with its own empty cache the
first time and the same folder after; then with `--out` as well, and one of a path that leads to no file. Seconds
on the wall and of CPU with all children; the least of the warm runs. On a busy machine the wall says more about
the others; CPU seconds are then what to compare.
"""

from __future__ import annotations

import argparse
import os
import resource
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Sequence
from pathlib import Path

from inputs import ROOT, case_files
from rich.console import Console
from rich.table import Table
from rows import write_csv

COLUMNS = ("case", "run", "seconds", "cpu_seconds")


def main() -> None:
    """Runs what the command line asks for."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--cases", nargs="*", type=Path, default=None, metavar="FILE")
    parser.add_argument("--warm", type=int, default=5, help="warm runs a case")
    parser.add_argument(
        "--fresh", type=int, default=1, choices=(0, 1), help="0: no first run, the cache in use"
    )
    parser.add_argument("--csv", type=Path, help="write the rows here")
    asked = parser.parse_args()
    rows = []
    with tempfile.TemporaryDirectory() as empty:
        cache = empty if asked.fresh else None
        for i, case in enumerate(asked.cases or case_files()):
            first = "first, empty cache" if i == 0 and asked.fresh else "first of the case"
            rows.append({"case": case.parent.name, "run": first, **ran(case, cache)})
            rows += warm_rows(case, cache, asked.warm)
        rows += least("no file", "refused", asked.warm, lambda: ran(Path("none.yaml"), cache, (2,)))
    console = Console(width=None if sys.stdout.isatty() else 132)
    console.print(table_of(rows))
    for line in lines_of(rows):
        console.print(line, highlight=False)
    if asked.csv:
        write_csv(rows, COLUMNS, asked.csv, digits=4)


def warm_rows(case: Path, cache: str | None, n_runs: int) -> list[dict]:
    """The least of the warm runs without and with a report, which is written anew each time."""

    def reported() -> dict[str, float]:
        with tempfile.TemporaryDirectory() as folder:
            return ran(case, cache, options=("--out", f"{folder}/report"))

    name = case.parent.name
    rows = least(name, "warm", n_runs, lambda: ran(case, cache))
    if n_runs:
        reported()  # the first draws on what no run without a report has
    return rows + least(name, "warm, --out", n_runs, reported)


def least(case: str, run: str, n_runs: int, once: Callable[[], dict[str, float]]) -> list[dict]:
    """The row of the run that took the least CPU time, if any is asked for."""
    found = sorted((once() for _ in range(n_runs)), key=lambda row: row["cpu_seconds"])
    if not found:
        return []
    seconds = min(row["seconds"] for row in found)
    return [{"case": case, "run": run, **found[0], "seconds": seconds}]


def ran(
    case: Path, cache: str | None, ends: Sequence[int] = (0, 1), options: Sequence[str] = ()
) -> dict[str, float]:
    """Seconds of one command; an end that is none of `ends` is no answer."""
    own = {
        name: value
        for name, value in os.environ.items()
        if not name.endswith("_NUM_THREADS") and name != "PYTHONDONTWRITEBYTECODE"
    }  # as a user has them: all threads, and modules that Python compiles once
    environment = own if cache is None else {**own, "XDG_CACHE_HOME": cache}
    before, start = resource.getrusage(resource.RUSAGE_CHILDREN), time.perf_counter()
    command = [sys.executable, "-m", "clearance", "check", str(case), *options]
    done = subprocess.run(
        command, cwd=ROOT, env=environment, capture_output=True, text=True, check=False
    )
    seconds, after = time.perf_counter() - start, resource.getrusage(resource.RUSAGE_CHILDREN)
    if done.returncode not in ends:
        raise SystemExit(done.stderr)
    cpu = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
    return {"seconds": seconds, "cpu_seconds": cpu}


def lines_of(rows: list[dict]) -> list[str]:
    """What is held against the targets."""
    warm = {row["case"]: row for row in rows if row["run"] == "warm"}
    lines = []
    for row in rows:
        if row["run"].startswith("first, nothing") and row["case"] in warm:
            more = row["seconds"] - warm[row["case"]]["seconds"]
            cpu = row["cpu_seconds"] - warm[row["case"]]["cpu_seconds"]
            told = f"{more:.1f} s more than a warm one ({cpu:.1f} s CPU)"
            lines.append(f"first run of {row['case']}: {told}; target 25 s")
    for run, target in (("warm", 0.6), ("warm, --out", 1.0)):
        found = [row for row in rows if row["run"] == run]
        if found:
            slowest = max(found, key=lambda row: row["seconds"])
            told = f"{slowest['seconds']:.2f} s ({slowest['cpu_seconds']:.2f} s CPU)"
            lines.append(f"slowest run, {run}: {slowest['case']}, {told}; target {target} s")
    return lines


def table_of(rows: list[dict]) -> Table:
    """All rows."""
    table = Table(title="from command to verdict", title_justify="left")
    for column in COLUMNS:
        table.add_column(column, justify="right" if "seconds" in column else "left")
    for row in rows:
        table.add_row(row["case"], row["run"], f"{row['seconds']:.2f}", f"{row['cpu_seconds']:.2f}")
    return table


if __name__ == "__main__":
    main()
