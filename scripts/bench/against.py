"""Holds `steps` of this checkout against that of another: time of every scene, and whether the bits are the same.

    python scripts/bench/against.py --other FOLDER [--cases FILE ...] [--passes N] [--csv FILE]

One process for each checkout; their passes take turns, so that a change of the machine's speed meets both.
CPU time on one thread, the median over passes of the ratio of two passes that follow each other.
"""

from __future__ import annotations

import argparse
import json
import os
import subprocess
import sys
from pathlib import Path

import inputs  # first: it sets the number of threads before numpy is loaded
import numpy as np
from rows import write_csv

COLUMNS = (
    "scene",
    "pairs",
    "steps",
    "ms_per_step",
    "ratio_to_other",
    "least",
    "greatest",
    "same_bits",
)

WORKER = r"""
import hashlib, json, sys, time
import numpy as np
from clearance import load_case
from clearance.simulate.measure.measure import measure
from clearance.simulate.measure.resources import Resources
from clearance.world.pairs import measured_pairs

try:
    from clearance.simulate.measure.layout import PairsInMotion
    from clearance.world.motion import kinematic_motion

    def work():
        return measure(PairsInMotion(case, motions, pairs), resources=one_thread)

except ImportError:  # older checkouts
    from clearance.simulate.kinematic import kinematic_motion

    def work():
        return measure(case, motions, pairs, resources=one_thread)

one_thread = Resources(jobs=1)
for line in sys.stdin:
    asked, given = json.loads(line)
    if asked == "load":
        case = load_case(given)
        motions = tuple(kinematic_motion(placed) for placed in case.robots)
        pairs, _ = measured_pairs(case)
        found = work()
        arrays = (found.clearance, found.lower_bound, found.pair, found.points)
        bits = hashlib.sha256(b"".join(np.ascontiguousarray(a).tobytes() for a in arrays))
        answer = {"steps": len(found.clearance), "pairs": len(pairs), "bits": bits.hexdigest()}
    else:
        start = time.thread_time()
        for _ in range(given):
            work()
        answer = (time.thread_time() - start) / given
    print(json.dumps(answer), flush=True)
"""
"""What runs in each checkout; lines of JSON in and out."""


class Checkout:
    """A process in which the package is that of a folder."""

    def __init__(self, folder: Path) -> None:
        self._process = subprocess.Popen(
            [sys.executable, "-c", WORKER],
            env=os.environ | {"PYTHONPATH": str(folder)},
            cwd=folder,
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            text=True,
        )

    def ask(self, what: str, given: object) -> object:
        """What it answers to `load` or `time`."""
        assert self._process.stdin and self._process.stdout
        self._process.stdin.write(json.dumps([what, given]) + "\n")
        self._process.stdin.flush()
        return json.loads(self._process.stdout.readline())

    def close(self) -> None:
        """Ends the process."""
        assert self._process.stdin
        self._process.stdin.close()
        self._process.wait()


def main() -> None:
    """Runs what the command line asks for."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--other", type=Path, required=True, metavar="FOLDER")
    parser.add_argument("--cases", nargs="*", type=Path, default=inputs.case_files())
    parser.add_argument("--passes", type=int, default=21)
    parser.add_argument("--csv", type=Path, help="write the rows here")
    asked = parser.parse_args()
    rows = rows_against(asked.other, asked.cases, asked.passes)
    if asked.csv:
        write_csv(rows, COLUMNS, asked.csv)


def rows_against(other: Path, cases: list[Path], passes: int) -> list[dict]:
    """A row a case, each printed as soon as it is known."""
    ours, theirs = Checkout(inputs.ROOT), Checkout(other.resolve())
    rows = []
    for case in cases:
        rows.append(row_of(case.resolve(), ours, theirs, passes))
        print(*(f"{name}={value}" for name, value in rows[-1].items()), flush=True)
    ours.close()
    theirs.close()
    return rows


def row_of(case: Path, ours: Checkout, theirs: Checkout, passes: int) -> dict:
    """One case in both checkouts."""
    loaded = [checkout.ask("load", str(case)) for checkout in (ours, theirs)]
    once = ours.ask("time", 2)
    n_times = int(np.clip(0.05 / once, 1, 200))
    times = np.array(
        [
            [checkout.ask("time", n_times) for checkout in turn][:: 1 if i % 2 else -1]
            for i in range(passes)
            for turn in [(ours, theirs) if i % 2 else (theirs, ours)]
        ]
    )
    ratios = times[:, 0] / times[:, 1]
    return {
        "scene": case.parent.name,
        "pairs": loaded[0]["pairs"],
        "steps": loaded[0]["steps"],
        "ms_per_step": float(np.median(times[:, 0])) * 1e3 / loaded[0]["steps"],
        "ratio_to_other": float(np.median(ratios)),
        "least": float(ratios.min()),
        "greatest": float(ratios.max()),
        "same_bits": loaded[0]["bits"] == loaded[1]["bits"],
    }


if __name__ == "__main__":
    main()
