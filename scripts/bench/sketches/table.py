"""The table of one run, and how a solve is timed. Not for: what is measured."""

from __future__ import annotations

import csv
import time
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from clearance.sketch import Sketch, SketchResult


@dataclass
class Table:
    """The rows of one run: printed as they come, kept for the file."""

    rows: list[tuple[str, str, str, str]] = field(default_factory=list)

    def add(self, what: str, library: str, target: str, measured: str) -> None:
        """Prints and keeps one measurement."""
        print(f"{what:<58} {library:<10} {target:>15}   {measured}", flush=True)
        self.rows.append((what, library, target, measured))

    def write(self, path: Path) -> None:
        """Writes all rows as CSV."""
        with path.open("w", newline="", encoding="utf-8") as out:
            writer = csv.writer(out)
            writer.writerow(("what", "library", "target", "measured"))
            writer.writerows(self.rows)


def spread(times: list[float]) -> str:
    """Median and range of times [ms]."""
    return f"{np.median(times):.2f} ms ({min(times):.2f} to {max(times):.2f})"


def clocked(work: Callable[[], Any]) -> tuple[float, Any]:
    """[ms] of CPU of one call, and its value."""
    start = time.process_time()
    value = work()
    return 1e3 * (time.process_time() - start), value


def timed(make: Callable[[], Sketch], repetitions: int = 7) -> tuple[list[float], SketchResult]:
    """(times [ms], last result) of solving fresh sketches."""
    make().solve()
    times = []
    for _ in range(repetitions):
        s = make()
        taken, result = clocked(s.solve)
        times.append(taken)
    return times, result


def relative(result: SketchResult) -> float:
    """The residual relative to the sketch's size."""
    return result.residual / result._problem.size
