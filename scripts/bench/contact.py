"""Prints what contact costs: a run with and without its overlaps, the verdict beside the peers', large obstacles.

    python scripts/bench/contact.py [--cases NAME ...] [--large N ...] [--no-peers] [--csv FILE] [--seconds S]

Cases are the shared ones with the nearest obstacle pushed into the link that it is nearest to, and a torus that a
block slides through. Milliseconds of CPU, one thread, compiled code warm, least of some runs: `cl.check` with
`contact="none"`, by default, and what the deepest moments then take when they are looked at. The first look of all
of a case is told apart: hulls and solids of bodies are made once. "times the fastest peer" is of the verdict alone
(`trajectory.py`), against all pairs, managers, and pairs sorted by spheres.
"""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

import inputs  # first: it sets the number of threads before numpy is loaded
from clock import geometric_mean, timed
from contact_cases import PUSHED, pushed, through_torus
from peers import absent_peers, versions
from rich.console import Console
from rich.table import Table
from rows import write_csv
from trajectory import GROUPS, LIBRARIES, fastest_ratios, measured

import clearance as cl
from clearance.run import Run
from clearance.world.case import Case

COLUMNS = (
    "case", "triangles", "steps", "steps_in_contact", "rows", "events", "none_ms", "default_ms", "first_look_ms",
    "look_ms", "deepest_at_least_mm", "deepest_mm", "ratio_to_none", "ratio_looked_at", "times_fastest_peer",
)  # fmt: skip

RUNS = 5


def main() -> None:
    """Runs what the command line asks for."""
    asked = arguments()
    console = Console(width=None if sys.stdout.isatty() else 150)
    for line in [*inputs.absent_inputs(), *absent_peers(LIBRARIES)]:
        console.print(line, style="yellow", highlight=False)
    names = (
        asked.cases if asked.cases is not None else list(PUSHED) if inputs.SHARED.is_dir() else []
    )
    rows = [row_of(name, pushed(name), None if asked.no_peers else asked.seconds) for name in names]
    rows += [row_of(f"torus_{n}", through_torus(n), None) for n in asked.large]
    console.print(table_of(rows))
    ratios = [row["times_fastest_peer"] for row in rows if row["times_fastest_peer"]]
    if ratios:
        mean = geometric_mean(ratios)
        told = f"verdict: {mean:.0f} times the fastest stock loop (geometric mean of {len(ratios)})"
        console.print(told, highlight=False)
    console.print(versions(LIBRARIES), highlight=False)
    if asked.csv:
        write_csv(rows, COLUMNS, asked.csv)


def arguments() -> argparse.Namespace:
    """The command line."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--cases", nargs="*", choices=list(PUSHED), default=None, metavar="NAME")
    parser.add_argument(
        "--large", nargs="*", type=int, default=[102_000, 490_000], metavar="TRIANGLES"
    )
    parser.add_argument("--no-peers", action="store_true", help="do not ask other libraries")
    parser.add_argument("--csv", type=Path, help="write the rows here")
    parser.add_argument("--seconds", type=float, default=0.3, help="CPU a loop and case")
    return parser.parse_args()


def row_of(name: str, case: Case, seconds: float | None) -> dict:
    """What is known of one case; `seconds` is what each peer's loop may take, None if none is asked."""
    none, run = least(case, "none")
    default, run = least(case, "events")
    first, _ = timed(lambda: run.record.deepest)
    look, deepest = looked_at(case)
    record = run.record
    return {
        "case": name,
        "triangles": sum(body.n_triangles for body in shapes(case)),
        "steps": record.steps.num_rows,
        "steps_in_contact": int((record.clearances == 0.0).sum()),
        "rows": len(record.contacts),
        "events": len(record.worked_out),
        "none_ms": 1e3 * none,
        "default_ms": 1e3 * default,
        "first_look_ms": 1e3 * first,
        "look_ms": 1e3 * look,
        "deepest_at_least_mm": 1e3 * deepest.penetration_at_least,
        "deepest_mm": 1e3 * deepest.penetration,
        "ratio_to_none": default / none,
        "ratio_looked_at": (default + look) / none,
        "times_fastest_peer": None if seconds is None else against_peers(name, case, seconds),
    }


def shapes(case: Case) -> list:
    """All bodies of a case."""
    links = [body.shape for placed in case.robots for body in placed.robot.bodies]
    return links + [obstacle.body.shape for obstacle in case.obstacles]


def least(case: Case, contact: str) -> tuple[float, Run]:
    """[s] the least of some runs, after one to warm up, and the last run."""
    cl.check(case, contact=contact, resources=cl.Resources(jobs=1))
    found = [
        timed(lambda: cl.check(case, contact=contact, resources=cl.Resources(jobs=1)))
        for _ in range(RUNS)
    ]
    return min(seconds for seconds, _ in found), found[-1][1]


def looked_at(case: Case) -> tuple[float, object]:
    """[s] what the deepest moments of a fresh run take when bodies are known, the least of two; the deepest."""
    runs = [cl.check(case, resources=cl.Resources(jobs=1)) for _ in range(2)]
    found = [timed(lambda run=run: run.record.deepest) for run in runs]
    return min(seconds for seconds, _ in found), found[0][1].known


def against_peers(name: str, case: Case, seconds: float) -> float:
    """How many times our time the fastest stock loop takes for the verdict."""
    rows = measured(inputs.scene_from(name, case), seconds, 3, 1e-6)
    return min(fastest_ratios(rows, next(iter(GROUPS.values()))), default=float("nan"))


def table_of(rows: list[dict]) -> Table:
    """The rows."""
    table = Table(title="contact", title_justify="left", title_style="bold")
    for name in COLUMNS:
        table.add_column(name.replace("_", " "), justify="left" if name == "case" else "right")
    for row in rows:
        table.add_row(*map(_cell, row.values()))
    return table


def _cell(value: object) -> str:
    if value is None:
        return "-"
    return f"{value:.4g}" if isinstance(value, float) else str(value)


if __name__ == "__main__":
    main()
