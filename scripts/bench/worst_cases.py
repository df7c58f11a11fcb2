"""Prints what a step of a made case costs, ours and the peers': where nothing can be cut, and the field's scene.

    python scripts/bench/worst_cases.py [--cases NAME ...] [--csv FILE] [--seconds S]

Clock, columns and loops are those of `trajectory.py`. The worst cases are linked rings, shells in shells,
facets that are all equally near, and an arm that is anywhere at every step; `arm_among_obstacles` is seven links
of 2048 triangles among 20 obstacles of as many, in smooth motion.
"""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

from inputs import scene_from  # first: it sets the number of threads before numpy is loaded
from peers import absent_peers, versions
from rich.console import Console
from rows import write_csv
from trajectory import COLUMNS, LIBRARIES, fastest_ratios, measured, table_of

from scripts.makers.hostile_cases import (
    arm_among_obstacles,
    everything_equidistant,
    facing_plates,
    linked_tori,
    nested_shells,
    teleporting,
)

CASES = {
    "arm_among_obstacles": lambda: arm_among_obstacles(32, 300),
    "teleporting": lambda: teleporting(32, 60),
    "linked_tori": lambda: linked_tori(16, 40),
    "linked_tori_16k": lambda: linked_tori(64, 10),
    "nested_shells": lambda: nested_shells(4, 10),
    "everything_equidistant": lambda: everything_equidistant(24, 20),
    "facing_plates": lambda: facing_plates(24, 20),
}

HELD_AGAINST = {
    "python-fcl's two managers": ("managers",),
    "python-fcl's and the others' all pairs": ("all pairs",),
    "Klampt with bounds carried by hand": ("carried bounds",),
}


def main() -> None:
    """Runs what the command line asks for."""
    asked = arguments()
    console = Console(width=None if sys.stdout.isatty() else 132)
    for line in absent_peers(LIBRARIES):
        console.print(line, style="yellow", highlight=False)
    rows = []
    for name in asked.cases or CASES:
        scene = scene_from(name, CASES[name]())
        found = measured(scene, asked.seconds, asked.passes, 1e-6)
        console.print(table_of(scene, found))
        rows += found
    for row in summary(rows):
        console.print(row, highlight=False)
    console.print(versions(LIBRARIES), highlight=False)
    if asked.csv:
        write_csv(rows, COLUMNS, asked.csv)


def summary(rows: list[dict]) -> list[str]:
    """A line a case: how many times our time each of the peers' best loops takes."""
    lines = []
    for name in dict.fromkeys(row["scene"] for row in rows):
        of_case = [row for row in rows if row["scene"] == name]
        ratios = {what: fastest_ratios(of_case, kinds) for what, kinds in HELD_AGAINST.items()}
        told = [f"{what} {ratio[0]:.2f}" for what, ratio in ratios.items() if ratio]
        lines.append(f"{name}, times our time: {', '.join(told)}")
    return lines


def arguments() -> argparse.Namespace:
    """The command line."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--cases", nargs="*", choices=list(CASES), default=None, metavar="NAME")
    parser.add_argument("--csv", type=Path, help="write the rows here")
    parser.add_argument("--seconds", type=float, default=0.8, help="CPU a loop and case")
    parser.add_argument("--passes", type=int, default=3)
    return parser.parse_args()


if __name__ == "__main__":
    main()
