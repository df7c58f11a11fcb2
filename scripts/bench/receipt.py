"""Prints how long receipts are, and what verifying takes beside a certified run.

    python scripts/bench/receipt.py [--scenes NAME ...] [--tolerances] [--csv FILE]

CPU time, least of three, with the case in memory: a run is `check` of a case, a verification goes from the receipt
to the answer. `loaded` are the same two with the case read from its files each time. `--tolerances` measures
receipts of cases with the tolerances of a typical cell instead, and what they leave proven.
"""

from __future__ import annotations

import tempfile
from dataclasses import replace
from pathlib import Path

import harness
from budget_samples import typical
from harness import SCENES, SHARED, Row, least_time, timed

import clearance as cl

SMALLEST = ["--scenes", "box_box"]


def main(words: list[str] | None = None) -> list[Row]:
    """Runs what the command line asks for."""
    asked = harness.arguments(__doc__, words, scenes=[], tolerances=True)
    files = [path for place in (SHARED, SCENES) for path in sorted(place.glob("*/case.yaml"))]
    chosen = [path for path in files if not asked.scenes or path.parent.name in asked.scenes]
    rows: list[Row] = []
    for path in chosen:
        rows.append(row_of(path, asked.tolerances))
        harness.write_csv(rows, asked.csv)
    harness.show("receipts", rows)
    return rows


def row_of(path: Path, tolerances: bool) -> Row:
    """The row of a case file."""
    case = cl.load_case(path)
    if tolerances:
        case = replace(case, tolerance=typical(case))
    run = cl.check(case)
    with tempfile.TemporaryDirectory() as place:
        run.save(place)
        write_s, receipt = timed(lambda: cl.write_receipt(run, place, "" if tolerances else path))
        found = cl.verify(place, case)
        run_s, verify_s = (
            least_time(lambda: cl.check(case), 3)[0],
            least_time(lambda: cl.verify(place, case), 1 if tolerances else 3)[0],
        )
        row = {
            "case": path.parent.name, "steps": len(run.steps), "pairs": found.n_pairs,
            "kB": receipt.stat().st_size / 1e3, "run_s": run_s, "verify_s": verify_s,
            "ratio": verify_s / run_s, "write_s": write_s, "proven": str(found.proven),
        }  # fmt: skip
        return row | (left(run, found) if tolerances else loaded(path, place))


def loaded(path: Path, place: str) -> Row:
    """The same with the case read from its files each time."""
    run_s, verify_s = (
        least_time(work, 3)[0] for work in (lambda: cl.check(path), lambda: cl.verify(place))
    )
    return {"loaded_run_s": run_s, "loaded_verify_s": verify_s, "loaded_ratio": verify_s / run_s}


def left(run: cl.Run, found: object) -> Row:
    """What the run says that tolerances leave, and what of it is proven again."""
    told = min(one.least for one in run.record.budget)
    proven = [bound for rule, bound in found.bounds.items() if rule.endswith("with tolerances")]
    return {
        "told_mm": 1e3 * told, "proven_mm": 1e3 * min(proven, default=0.0),
        "not_ruled_out": found.n_not_ruled_out, "nominal": str(found.nominal),
    }  # fmt: skip


if __name__ == "__main__":
    main()
