"""Measures how often, how fast and by how little violated cases are mended, each of which is known to be feasible.

    python scripts/bench/gain.py [--cases N] [--sources NAME ...] [--seed N] [--csv FILE]

Compiled code warm; seconds of CPU. Each changed case is certified anew. "known" is the size of a change that is
known to do; "lower bound" is that of any that does.
"""

from __future__ import annotations

import harness  # first
import numpy as np
from gain_cases import KINDS, ViolatedCase, violated_cases
from harness import Row, timed

import clearance as cl
from clearance.gains.answer import gain

SMALLEST = ["--sources", "box_box", "--cases", "2"]


def main(words: list[str] | None = None) -> list[Row]:
    """Runs what the command line asks for."""
    asked = harness.arguments(__doc__, words, cases=60, seed=0, sources=[])
    rows: list[Row] = []
    for one in violated_cases(asked.cases, asked.seed, asked.sources):
        if not rows:
            gain(one.case, "base", robot=one.case.robots[0].robot.name)  # compiled code is warm
        rows.append(row_of(one))
        harness.tell(" ".join(f"{name}={value}" for name, value in rows[-1].items()))
        harness.write_csv(rows, asked.csv)
    harness.show("violated cases, mended", [figures_of(rows, kind) for kind in KINDS])
    return rows


def row_of(one: ViolatedCase) -> Row:
    """What one case came to, and whether the changed case passes when it is checked anew."""
    who = {"obstacle" if one.kind == "obstacle" else "robot": one.who}
    seconds, found = timed(lambda: gain(one.case, one.kind, **who))
    checked = found.kept and bool(cl.check(found.case, contact="none").passed)
    return {
        "source": one.source, "how": one.how, "kind": one.kind, "who": one.who, "kept": found.kept,
        "checked": checked, "size": found.size, "known": one.known, "lower_bound": found.lower_bound,
        "seconds": seconds, "measured": found.n_measured, "blocked": str(found.blocked or ""),
    }  # fmt: skip


def figures_of(rows: list[Row], kind: str) -> Row:
    """A kind of change in one line: the median and the greatest."""
    own = [row for row in rows if row["kind"] == kind]
    ratios = [row["size"] / row["known"] for row in own if row["kept"]]
    seconds = [row["seconds"] for row in own]
    return {
        "kind": kind, "cases": len(own), "kept": sum(row["kept"] for row in own),
        "checked": sum(row["checked"] for row in own), "seconds": spread(seconds),
        "size / known": spread(ratios),
    }  # fmt: skip


def spread(values: list[float]) -> str:
    """The median, and the greatest in brackets."""
    return f"{np.median(values):.3g} (to {max(values):.3g})" if values else ""


if __name__ == "__main__":
    main()
