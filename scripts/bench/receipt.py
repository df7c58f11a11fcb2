"""Receipts of the scenes and the shared cases: how long they are, and what verifying takes beside a certified run.

    python scripts/bench/receipt.py [--tolerances] [NAME ...] > scripts/bench/results/receipt.csv

CPU time of one process, compiled kernels, the least of three: a run is `check` of a case in memory, a verification
goes from the receipt to the answer with the case in memory. `loaded` are the same two with the case read from its
files each time. `--tolerances` measures receipts of cases with the tolerances of a typical cell instead.
"""

from __future__ import annotations

import csv
import sys
import tempfile
import time
from dataclasses import replace
from pathlib import Path

from budget import typical
from clock import least_time
from inputs import SCENES, SHARED

import clearance as cl

COLUMNS = (
    "case", "steps", "pairs", "kB", "run_s", "verify_s", "ratio", "loaded_run_s", "loaded_verify_s",
    "loaded_ratio", "write_s", "proven",
)  # fmt: skip

WITH_TOLERANCES = (
    "case", "steps", "pairs", "kB", "run_s", "verify_s", "ratio", "write_s", "told_mm", "proven_mm",
    "not_ruled_out", "nominal", "proven",
)  # fmt: skip


def row_with_tolerances(path: Path) -> tuple:
    """The row of a case file with the tolerances of a typical cell: what they leave is proven too."""
    case = cl.load_case(path)
    case = replace(case, tolerance=typical(case))
    run = cl.check(case)
    with tempfile.TemporaryDirectory() as place:
        run.save(place)
        begun = time.process_time()
        receipt = cl.write_receipt(run, place)
        written, size = time.process_time() - begun, receipt.stat().st_size
        found = cl.verify(place, case)
        times = [
            least_time(lambda: cl.check(case), 3),
            least_time(lambda: cl.verify(place, case), 1),
        ]
    told = min(one.least for one in run.record.budget)
    proven = [bound for rule, bound in found.bounds.items() if rule.endswith("with tolerances")]
    return (
        path.parent.name, len(run.steps), found.n_pairs, f"{size / 1e3:.0f}",
        f"{times[0]:.4f}", f"{times[1]:.3f}", f"{times[1] / times[0]:.1f}", f"{written:.1f}",
        f"{1e3 * told:.3f}", f"{1e3 * min(proven, default=0.0):.3f}", found.n_not_ruled_out,
        found.nominal, found.proven,
    )  # fmt: skip


def row(path: Path) -> tuple:
    """The row of a case file."""
    case = cl.load_case(path)
    run = cl.check(case)
    with tempfile.TemporaryDirectory() as place:
        run.save(place)
        begun = time.process_time()
        receipt = cl.write_receipt(run, place, path)
        written, size = time.process_time() - begun, receipt.stat().st_size
        found = cl.verify(place)
        times = [
            least_time(lambda: cl.check(case), 3),
            least_time(lambda: cl.verify(place, case), 3),
            least_time(lambda: cl.check(path), 3),
            least_time(lambda: cl.verify(place), 3),
        ]
    return (
        path.parent.name, len(run.steps), found.n_pairs, f"{size / 1e3:.0f}",
        f"{times[0]:.4f}", f"{times[1]:.3f}", f"{times[1] / times[0]:.1f}",
        f"{times[2]:.3f}", f"{times[3]:.3f}", f"{times[3] / times[2]:.1f}", f"{written:.1f}", found.proven,
    )  # fmt: skip


def main(names: list[str]) -> None:
    """Prints a row a case."""
    tolerances = "--tolerances" in names
    names = [name for name in names if name != "--tolerances"]
    files = [path for place in (SHARED, SCENES) for path in sorted(place.glob("*/case.yaml"))]
    table = csv.writer(sys.stdout)
    table.writerow(WITH_TOLERANCES if tolerances else COLUMNS)
    for path in files:
        if not names or path.parent.name in names:
            table.writerow(row_with_tolerances(path) if tolerances else row(path))
            sys.stdout.flush()


if __name__ == "__main__":
    main(sys.argv[1:])
