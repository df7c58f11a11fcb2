"""Prints how often, how fast and by how little violated cases are mended, against a general optimiser and Drake.

    python scripts/bench/gain.py [--cases N] [--made DIR] [--general N] [--seconds S] [--drake N] [--csv FILE]

One process, one thread, compiled code warm; seconds of CPU. Each proposal is written as files, read and certified
anew, `--commands` of them by `clearance check` in a process of its own. "known" is a change that is known to do.
"""

from __future__ import annotations

import argparse
import tempfile
import time
from collections.abc import Iterable
from pathlib import Path
from typing import Any

import inputs  # first: it sets the number of threads before numpy is loaded
import numpy as np
from gain_cases import KINDS, intervals_of
from gain_drake import DrakePath, drake_path, has_drake, takes
from gain_files import Filed, cases_in, kept_afresh, kept_by_command, write_proposal
from gain_general import general_change
from rich.console import Console
from rich.table import Table
from rows import write_csv

import clearance as cl
from clearance.gains.answer import Gain, gain

COLUMNS = (
    "source", "how", "kind", "who", "kept", "size", "known", "lower_bound", "seconds", "measured", "checked", "by",
    "general", "general_seconds", "drake", "drake_seconds", "drake_samples", "drake_convex", "blocked",
)  # fmt: skip


def row_of(one: Filed, out: Path, *, by_command: bool) -> tuple[dict[str, Any], Gain]:
    """What one case came to, and whether what was proposed holds when it is checked anew."""
    case = cl.load_case(one.file)
    began = time.process_time()
    found = gain(case, one.kind, **one.names)
    row = dict.fromkeys(COLUMNS) | {
        "source": one.source, "how": one.how, "kind": one.kind, "who": one.who, "kept": found.kept,
        "size": found.size, "known": one.known, "lower_bound": found.lower_bound,
        "seconds": time.process_time() - began, "measured": found.n_measured,
        "blocked": str(found.blocked or ""),
    }  # fmt: skip
    if found.kept:
        proposal = write_proposal(found, one.file, out)
        row["by"] = "command" if by_command else "reading"
        row["checked"] = (kept_by_command if by_command else kept_afresh)(proposal)
    return row, found


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--cases", type=int, default=60)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--sources", nargs="*", default=(), help="names of folders; all of them")
    parser.add_argument("--made", type=Path, help="where the cases are, or are put")
    parser.add_argument("--commands", type=int, default=30)
    parser.add_argument("--general", type=int, default=0, help="so many cases of each kind")
    parser.add_argument("--seconds", type=float, default=600.0, help="of CPU, for each of these")
    parser.add_argument("--drake", type=int, default=0, help="so many paths")
    parser.add_argument("--csv", type=Path)
    asked = parser.parse_args()
    for line in inputs.absent_inputs():
        Console().print(line)
    with tempfile.TemporaryDirectory() as scratch:
        cases = cases_in(
            asked.made or Path(scratch) / "made", asked.cases, asked.seed, asked.sources
        )
        rows = _rows(cases, Path(scratch) / "out", asked)
    _print(rows)


def _rows(cases: list[Filed], scratch: Path, asked: argparse.Namespace) -> list[dict[str, Any]]:
    left = {"drake": asked.drake, **dict.fromkeys(KINDS, asked.general)}
    every = max(1, len(cases) // max(1, asked.commands))
    gain(cl.load_case(cases[0].file), "base", robot=_first_robot(cases[0]))  # compiled code is warm
    rows = []
    for i, one in enumerate(cases):
        by_command = asked.commands > 0 and i % every == 0
        row, found = row_of(one, scratch / str(i), by_command=by_command)
        case, left_of_drake = cl.load_case(one.file), left["drake"] and one.kind == "waypoints"
        n_intervals = intervals_of(case, found)
        if left[one.kind] and found.kept:
            row["general"], row["general_seconds"] = general_change(one, n_intervals, asked.seconds)
            left[one.kind] -= 1
        if left_of_drake and has_drake() and takes(case):
            row |= _by_drake(drake_path(one, n_intervals, asked.seconds))
            left["drake"] -= 1
        rows.append(row)
        _print_row(i, row)
        if asked.csv:
            write_csv(rows, COLUMNS, asked.csv)
    return rows


def _by_drake(path: DrakePath) -> dict[str, Any]:
    return {
        "drake": path.size if path.proven else None, "drake_seconds": path.seconds,
        "drake_samples": path.sampled, "drake_convex": path.convex,
    }  # fmt: skip


def _first_robot(one: Filed) -> str:
    return str(cl.load_case(one.file).robots[0].robot.name)


def _print_row(i: int, row: dict[str, Any]) -> None:
    told = "kept" if row["kept"] else "NOT"
    told += "" if row["checked"] in (True, None) else ", BUT NOT WHEN CHECKED"
    beside = "".join(
        f" {name} {row[name]:.5f}" for name in ("general", "drake") if row[name] is not None
    )
    print(
        f"{i:3} {row['source']:28} {row['how']:10} {row['kind']:9} {told:4} {row['size']:.5f} known "
        f"{row['known']:.5f} >= {row['lower_bound']:.5f} {row['seconds']:.2f} s{beside} {row['blocked']}",
        flush=True,
    )


def _print(rows: list[dict[str, Any]]) -> None:
    table = Table(
        "kind", "cases", "kept", "checked anew", "s, median", "s, worst", "size / known",
        "size / general", "size / Drake",
    )  # fmt: skip
    for kind in KINDS:
        own = [row for row in rows if row["kind"] == kind]
        if not own:
            continue
        kept = [row for row in own if row["kept"]]
        seconds = [row["seconds"] for row in own]
        table.add_row(
            kind, str(len(own)), f"{100 * len(kept) / len(own):.1f} %",
            str(sum(row["checked"] for row in kept)), f"{np.median(seconds):.2f}",
            f"{np.max(seconds):.2f}", _median(row["size"] / row["known"] for row in kept),
            *(_beside(own, name) for name in ("general", "drake")),
        )  # fmt: skip
    Console().print(table)


def _median(ratios: Iterable[float]) -> str:
    found = [*ratios]
    return f"{np.median(found):.3f}" if found else ""


def _beside(rows: list[dict[str, Any]], name: str) -> str:
    """The median ratio to another's size where both keep the limits, and how many of those asked it kept."""
    asked = [row for row in rows if row[f"{name}_seconds"] is not None]
    both = [row for row in asked if row["kept"] and row[name]]
    if not asked:
        return ""
    n_kept = sum(row[name] is not None for row in asked)
    n_ours = sum(row["kept"] for row in asked)
    return f"{_median(row['size'] / row[name] for row in both)} (it {n_kept}, ours {n_ours} of {len(asked)})"


if __name__ == "__main__":
    main()
