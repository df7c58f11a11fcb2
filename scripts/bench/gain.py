"""Prints how often, how fast and by how little violated cases are mended, against changes that are known to do.

    python scripts/bench/gain.py [--cases N] [--general N] [--seconds S] [--csv FILE]

One process, one thread, compiled code warm; seconds of CPU. `--general` asks scipy's SLSQP for the same shifts,
from 20 starts, for so many of the cases. "known" is the change that takes back what a case was made by.
"""

from __future__ import annotations

import argparse
import time
from pathlib import Path

import inputs  # noqa: F401  # first: it sets the number of threads before numpy is loaded
import numpy as np
from gain_cases import Made, made
from gain_general import general_shift
from rich.console import Console
from rich.table import Table
from rows import write_csv

from clearance.gains.answer import Gain, gain

COLUMNS = (
    "source", "kind", "who", "kept", "size", "known", "lower_bound", "seconds", "measured", "blocked", "general",
)  # fmt: skip


def row_of(one: Made) -> tuple[dict[str, object], Gain]:
    """What one case came to."""
    who = {"obstacle": one.who} if one.kind == "obstacle" else {"robot": one.who}
    began = time.process_time()
    found = gain(one.case, one.kind, **who)
    row = {
        "source": one.name, "kind": one.kind, "who": one.who, "kept": found.kept, "size": found.size,
        "known": one.known, "lower_bound": found.lower_bound, "seconds": time.process_time() - began,
        "measured": found.n_measured, "blocked": str(found.blocked or ""), "general": None,
    }  # fmt: skip
    return row, found


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--cases", type=int, default=60)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--general", type=int, default=0)
    parser.add_argument("--seconds", type=float, default=600.0)
    parser.add_argument("--csv", type=Path)
    asked = parser.parse_args()
    cases = made(asked.cases, asked.seed)
    rows, left = [], asked.general
    gain(cases[0].case, "base", robot=cases[0].case.robots[0].robot.name)  # compiled code is warm
    for one in cases:
        row, _ = row_of(one)
        if left and one.kind != "waypoints" and row["kept"]:
            row["general"] = general_shift(one, asked.seconds)
            left -= 1
        rows.append(row)
        Console().print(
            f"{one.name:28} {one.kind:10} {'kept' if row['kept'] else 'NOT ':5} {row['size']:.5f} "
            f"known {one.known:.5f} >= {row['lower_bound']:.5f} {row['seconds']:.2f} s {row['blocked']}"
        )
    _print(rows)
    if asked.csv:
        write_csv(rows, COLUMNS, asked.csv)


def _print(rows: list[dict[str, object]]) -> None:
    table = Table(
        "kind", "cases", "kept", "s, median", "s, worst", "size / known", "size / general"
    )
    for kind in ("waypoints", "obstacle", "base"):
        own = [row for row in rows if row["kind"] == kind]
        if not own:
            continue
        kept = [row for row in own if row["kept"]]
        seconds = [row["seconds"] for row in own]
        ratios = [row["size"] / row["known"] for row in kept]
        general = [row["size"] / row["general"] for row in kept if row["general"]]
        table.add_row(
            kind, str(len(own)), f"{100 * len(kept) / len(own):.1f} %", f"{np.median(seconds):.2f}",
            f"{np.max(seconds):.2f}", f"{np.median(ratios):.3f}" if ratios else "",
            f"{np.median(general):.3f} ({len(general)})" if general else "",
        )  # fmt: skip
    Console().print(table)


if __name__ == "__main__":
    main()
