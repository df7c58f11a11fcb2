"""Prints what each `need`, a certificate and a second thread cost, in parts of our own `steps`.

    python scripts/bench/needs.py [--scenes NAME ...] [--passes N] [--csv FILE]

Seconds on the wall, since threads are among what is measured: the least of interleaved passes, one thread
unless two are said. python-fcl's all pairs are asked for some steps only and told for all of them.
"""

from __future__ import annotations

import argparse
import sys
import time
from collections.abc import Callable
from pathlib import Path

from inputs import Scene, absent_inputs, case_files, scenes  # first: it sets the number of threads
from rich.console import Console
from rich.table import Table
from rows import write_csv

import numpy as np  # isort: skip

from clock import geometric_mean
from loops import AllPairs
from peers import Fcl, available

from clearance.simulate.measure.certify import certify_motion
from clearance.simulate.measure.layout import PairsInMotion
from clearance.simulate.measure.measure import NEEDS, measure
from clearance.simulate.measure.resources import Resources
from clearance.tolerance import CERTIFY_GAP

COLUMNS = ("scene", "what", "seconds", "ratio_to_steps", "queries", "node_tests", "polygon_tests")

N_ASKED = 8
"""Steps at which python-fcl is asked for all pairs."""

TARGETS = {
    "minimum": "at most 0.2",
    "limit": "at most 0.33",
    "FCL all pairs / pairs": "at least 20",
    "certificate to 0.1 mm": "at most 10",
    "steps, 2 threads": "at most 0.56",
}


def main() -> None:
    """Runs what the command line asks for."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    names = sorted(path.parent.name for path in case_files())
    parser.add_argument("--scenes", nargs="*", choices=names, default=None, metavar="NAME")
    parser.add_argument("--passes", type=int, default=9)
    parser.add_argument("--csv", type=Path, help="write the rows here")
    asked = parser.parse_args()
    console = Console(width=None if sys.stdout.isatty() else 132)
    for line in absent_inputs():
        console.print(line, style="yellow", highlight=False)
    rows = [row for scene in scenes(asked.scenes) for row in rows_of(scene, asked.passes)]
    console.print(table_of(rows))
    for what, target in TARGETS.items():
        console.print(line_of(what, target, rows), highlight=False)
    if asked.csv:
        write_csv(rows, COLUMNS, asked.csv)


def rows_of(scene: Scene, passes: int) -> list[dict]:
    """What everything costs on one scene."""
    works = works_of(scene)
    seconds = {what: np.inf for what in works}
    tallies: dict[str, dict] = {what: {} for what in works}
    for i_pass in range(passes + 1):
        for what, work in works.items():
            start = time.perf_counter()
            tallies[what] = work()
            if i_pass > 0:  # the first one warms up
                seconds[what] = min(seconds[what], time.perf_counter() - start)
    if "FCL all pairs" in seconds:
        seconds["FCL all pairs"] *= scene.n_steps / N_ASKED
        seconds["FCL all pairs / pairs"] = seconds["FCL all pairs"] / seconds["pairs"]
    return [
        row_of(scene, what, spent, seconds["steps"], tallies.get(what, {}))
        for what, spent in seconds.items()
    ]


def row_of(scene: Scene, what: str, spent: float, steps: float, tally: dict) -> dict:
    """A row; a quotient is its own ratio."""
    ratio = spent if "/" in what else spent / steps
    counted = {name: tally.get(name, "") for name in COLUMNS[-3:]}
    seconds = "" if "/" in what else spent
    return {
        "scene": scene.name,
        "what": what,
        "seconds": seconds,
        "ratio_to_steps": ratio,
        **counted,
    }


def in_motion(scene: Scene) -> PairsInMotion:
    """What is measured of a scene; its bodies are laid out each time."""
    return PairsInMotion(scene.case, scene.motions, scene.pairs)


def works_of(scene: Scene) -> dict[str, Callable[[], dict]]:
    """What is measured, by name; each answers its counters."""

    def ours(need: str, jobs: int) -> Callable[[], dict]:
        return lambda: measure(in_motion(scene), need, Resources(jobs=jobs)).tally

    found = measure(in_motion(scene), resources=Resources(jobs=1))

    def certified() -> dict:
        certify_motion(in_motion(scene), found, CERTIFY_GAP, resources=Resources(jobs=1))
        return {}

    works = {need: ours(need, 1) for need in NEEDS}
    works["steps, 2 threads"] = ours("steps", 2)
    works["certificate to 0.1 mm"] = certified
    if available("fcl"):
        peer = AllPairs(scene, Fcl())
        sample = np.linspace(0, scene.n_steps - 1, N_ASKED).round().astype(int)
        works["FCL all pairs"] = lambda: (peer.run(sample), peer.counters)[1]
    return works


def line_of(what: str, target: str, rows: list[dict]) -> str:
    """The ratios of one kind over all scenes."""
    ratios = {row["scene"]: row["ratio_to_steps"] for row in rows if row["what"] == what}
    if not ratios:
        return f"{what}: not measured"
    mean = geometric_mean(list(ratios.values()))
    told = f"{min(ratios.values()):.3g} to {max(ratios.values()):.3g}"
    unit = "" if "/" in what else " of steps"
    return f"{what}: {mean:.3g}{unit}, geometric mean of {len(ratios)} scenes ({told}); target {target}"


def table_of(rows: list[dict]) -> Table:
    """A row a scene, a column a kind of work, in parts of `steps`."""
    kinds = list(dict.fromkeys(row["what"] for row in rows))
    table = Table(
        title="seconds in parts of those of `steps` (its column: ms a scene)", title_justify="left"
    )
    table.add_column("scene", no_wrap=True)
    for kind in kinds:
        table.add_column(kind, justify="right")
    for scene in dict.fromkeys(row["scene"] for row in rows):
        of_scene = {row["what"]: row for row in rows if row["scene"] == scene}
        cells = [
            f"{of_scene[kind]['ratio_to_steps']:.3g}" if kind in of_scene else "" for kind in kinds
        ]
        table.add_row(scene, f"{of_scene['steps']['seconds'] * 1e3:.2f}", *cells[1:])
    return table


if __name__ == "__main__":
    main()
