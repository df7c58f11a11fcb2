"""Every reader on thousands of damaged files: each is read or refused by an error of ours, soon, in little memory.

A valid small file of each kind is damaged in ways that a fixed seed draws: bytes flipped, cut off, doubled, moved,
numbers replaced; or, with `--how structure`, its elements, keys, rows or counts are others (as `rows` says);
or, with `--how cuts`, it is cut off at each byte. Each kind is read in a process of its own with 1 GB of memory,
and 5 s of processor time a file. A warning, and a word on stderr, are faults too.

    python -m tests.formats.damaged.campaign [--how bytes] [--files 5000] [--kinds OBJ,GLB] [--seed 1]
                                             [--keep FOLDER]
"""

from __future__ import annotations

import argparse
import os
import resource
import signal
import subprocess
import sys
import tempfile
import time
import warnings
from collections import Counter
from pathlib import Path
from random import Random

from tests.formats.damaged.anywhere import damaged
from tests.formats.damaged.outcome import outcome
from tests.formats.damaged.rows import Reader, readers

ROOT = Path(__file__).parents[3]

MOST_MEMORY = 1 << 30
"""[bytes] of data that a reading process may have."""

MOST_TIME = 5.0
"""[s] of processor time for a file."""


def content(reader: Reader, how: str, seed: int, i: int) -> bytes:
    """The `i`-th damaged file of a kind."""
    if how == "cuts":
        return reader.valid[:i]
    number = seed * 1_000_003 + i
    if how == "structure":
        return reader.damage(reader.valid, Random(number))
    return damaged(reader.valid, number)


def _work(kind: str, how: str, first: int, last: int, seed: int) -> None:
    """Reads the files `first` to `last` of a kind and tells of each; the system ends it where one is too long."""
    reader = readers()[kind]
    with tempfile.TemporaryDirectory() as folder:
        reader.read(reader.valid, Path(folder))  # compiles and imports outside the limits
        for part in range(1, 8):  # so do the ways of what is not whole, which may start threads
            outcome(reader, reader.valid[: part * len(reader.valid) // 8], Path(folder))
        used = Path("/proc/self/statm").read_text().split()[5]
        limit = MOST_MEMORY + int(used) * resource.getpagesize()
        resource.setrlimit(resource.RLIMIT_DATA, (limit, limit))
        warnings.simplefilter("error")
        for i in range(first, last):
            print(i, end=" ", flush=True)
            signal.setitimer(signal.ITIMER_PROF, MOST_TIME)
            said = outcome(reader, content(reader, how, seed, i), Path(folder))
            signal.setitimer(signal.ITIMER_PROF, 0)
            print(" ".join(said.split()), flush=True)


def fuzz(
    kind: str, how: str, n_files: int, seed: int, keep: Path | None
) -> tuple[Counter, dict[str, int], float]:
    """How often each outcome came, the first file of each fault, and the seconds that all took."""
    found: Counter = Counter()
    firsts: dict[str, int] = {}
    began, first = time.perf_counter(), 0
    while first < n_files:
        work = "--work", kind, how, *map(str, (first, n_files, seed))
        command = [sys.executable, "-m", "tests.formats.damaged.campaign", *work]
        environment = {**os.environ, "OPENBLAS_NUM_THREADS": "1", "PYTHONWARNINGS": "ignore"}
        done = subprocess.run(command, capture_output=True, text=True, env=environment, cwd=ROOT)
        lines = [line.partition(" ") for line in done.stdout.splitlines()]
        for number, _, said in lines:
            said = said.strip() or f"ended by signal {-done.returncode}"
            found[said] += 1
            firsts.setdefault(said, int(number))
        if not lines:
            raise SystemExit(f"{kind}: the process did not start: {done.stderr[-2000:]}")
        if done.stderr.strip():
            found[f"on stderr: {' '.join(done.stderr.split())[:200]}"] += 1
        first = int(lines[-1][0]) + 1
    if keep is not None:
        keep.mkdir(parents=True, exist_ok=True)
        reader = readers()[kind]
        for said, i in firsts.items():
            if said not in ("read", "refused"):
                (keep / f"{i}_{Path(reader.name).name}").write_bytes(content(reader, how, seed, i))
    return found, firsts, time.perf_counter() - began


def main() -> None:
    """Fuzzes the kinds that are asked for and prints the table; exit status 1 where a reader has a fault."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--how", choices=("bytes", "structure", "cuts"), default="bytes")
    parser.add_argument("--files", type=int, default=5000)
    parser.add_argument("--kinds", default="")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--keep", type=Path, help="writes the first file of each fault here")
    given = parser.parse_args()
    n_faults = 0
    print("| kind | files | read | refused | faults | s |\n|---|---|---|---|---|---|", flush=True)
    for kind in given.kinds.split(",") if given.kinds else readers():
        n_files = len(readers()[kind].valid) if given.how == "cuts" else given.files
        found, firsts, seconds = fuzz(kind, given.how, n_files, given.seed, given.keep)
        faults = {said: n for said, n in found.items() if said not in ("read", "refused")}
        n_faults += sum(faults.values())
        row = [kind, n_files, found["read"], found["refused"], sum(faults.values()), round(seconds)]
        print("| " + " | ".join(map(str, row)) + " |", flush=True)
        for said, n in sorted(faults.items(), key=lambda item: -item[1]):
            print(f"  {n} x {said} (file {firsts.get(said, 'unknown')})", flush=True)
    raise SystemExit(n_faults > 0)


if __name__ == "__main__":
    if sys.argv[1:2] == ["--work"]:
        _work(sys.argv[2], sys.argv[3], *map(int, sys.argv[4:]))
    else:
        main()
