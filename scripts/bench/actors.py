"""Prints what it costs where everything may move: links of one robot, two robots, certificates, excused pairs.

    python scripts/bench/actors.py [--rows NAME ...] [--seconds S] [--passes N] [--csv FILE]

One process, one thread, compiled code warm, bodies and trees made outside the clock; milliseconds of CPU, the
median of interleaved passes. The peers get our pairs and our triangles, and are asked for some evenly spread steps
where all would exceed their share of `--seconds`. "off by" is the greatest |ours - theirs| at these steps; with
their own cylinders and boxes the peers would iterate, and be off by up to 2e-6 m.

A row is a function in `ROWS` that answers dictionaries with some of `COLUMNS`.
"""

from __future__ import annotations

import argparse
import sys
import time
from collections.abc import Callable
from dataclasses import replace
from functools import partial
from pathlib import Path

import inputs  # first: it sets the number of threads before numpy is loaded
import numpy as np
from actor_cases import CASES, PANDA, absent_robots, read, two_arms
from actor_loops import Actors, certified_sections, loops_of, measured_sections, sections_of
from clock import interleaved
from peers import absent_peers, versions
from rich.console import Console
from rich.table import Table
from rows import write_csv
from trajectory import steps_for

import clearance as cl
from clearance.record.audit import PairStatus
from clearance.simulate.answers.audit.srdf import audit
from clearance.simulate.measure.resources import Resources
from clearance.tolerance import CERTIFY_GAP
from clearance.world.case import Case, Clock

COLUMNS = (
    "what", "case", "method", "pairs", "steps", "triangles", "ms", "least", "greatest", "passes", "steps_asked",
    "ratio", "ratio_of", "target", "greatest_difference_m", "detail",
)  # fmt: skip

TARGETS = {
    "pinocchio": (">=", 50.0),
    "FCL": (">=", 100.0),
    "certificate": ("<=", 10.0),
    "audit": ("<=", 60.0),
    "unsynchronised": ("<=", 5.0),
}
"""What a row's ratio must come to."""

LIBRARIES = ("pinocchio", "fcl")


class Arguments(argparse.Namespace):
    """The command line."""

    rows: list[str]
    seconds: float
    passes: int
    csv: Path | None


def main() -> None:
    """Runs what the command line asks for."""
    asked = arguments()
    console = Console(width=None if sys.stdout.isatty() else 150)
    for line in [*absent_robots(), *absent_peers(LIBRARIES)]:
        console.print(line, style="yellow", highlight=False)
    rows, started = [], time.perf_counter()
    for name in asked.rows:
        if absent_robots() and name not in OF_A_CLONE:
            continue
        found = ROWS[name](asked)
        if found:
            console.print(table_of(name, found))
        rows += found
    console.print(f"{versions(LIBRARIES)}; {time.perf_counter() - started:.0f} s", highlight=False)
    if asked.csv:
        write_csv(rows, COLUMNS, asked.csv)


def arguments() -> Arguments:
    """The command line."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--rows", nargs="*", choices=ROWS, default=list(ROWS), metavar="NAME")
    parser.add_argument("--seconds", type=float, default=3.0, help="CPU a loop and case")
    parser.add_argument("--passes", type=int, default=7)
    parser.add_argument("--csv", type=Path, help="write the rows here")
    return parser.parse_args(namespace=Arguments())


def against_peers(name: str, asked: Arguments) -> list[dict]:
    """Ours and every peer's loop on one case."""
    actors = Actors(CASES[name]())
    loops = loops_of(actors)
    steps = [steps_for(loop, actors.n_steps, asked.seconds / asked.passes) for loop in loops]
    works = [partial(loop.run, own) for loop, own in zip(loops, steps, strict=True)]
    timings = interleaved(works, asked.passes, asked.seconds)
    ours = timings[0].answer
    once = timings[0].median / actors.n_steps
    rows = []
    for loop, own, timing in zip(loops, steps, timings, strict=True):
        n_timed = actors.n_steps if loop.coherent else len(own)
        per_step = 1e3 / n_timed
        rows.append(
            {
                "what": "steps",
                "case": name,
                "method": loop.name,
                "pairs": len(actors.pairs),
                "steps": actors.n_steps,
                "triangles": sum(len(solid.soup.triangles) for solid in actors.solids),
                "ms": timing.median * per_step,
                "least": timing.least * per_step,
                "greatest": timing.greatest * per_step,
                "passes": timing.n_passes,
                "steps_asked": len(own),
                "ratio": timing.median / n_timed / once,
                "ratio_of": "a step of ours",
                "target": target_of(loop.library),
                "greatest_difference_m": float(
                    np.abs(np.maximum(timing.answer, 0.0) - ours[own]).max()
                ),
                "detail": " ".join(f"{key}={count}" for key, count in loop.counters.items()),
            }
        )
    return rows


def certificates(name: str, make: Callable, asked: Arguments) -> list[dict]:
    """A certificate to 0.1 mm in parts of the run's own `steps`; all phases and rules of the run."""
    case = make()
    sections = sections_of(case)
    found = measured_sections(sections)
    works = [
        partial(measured_sections, sections),
        partial(certified_sections, sections, found, CERTIFY_GAP),
    ]
    timings = interleaved(works, asked.passes, asked.seconds)
    n_steps = sections.timeline.motions[0].n_steps
    rows = []
    for method, timing in zip(("steps", "certificate to 0.1 mm"), timings, strict=True):
        rows.append(
            {
                "what": "certificate",
                "case": name,
                "method": method,
                "pairs": len(sections.plan.pairs),
                "steps": n_steps,
                "ms": timing.median * 1e3 / n_steps,
                "least": timing.least * 1e3 / n_steps,
                "greatest": timing.greatest * 1e3 / n_steps,
                "passes": timing.n_passes,
                "ratio": timing.median / timings[0].median,
                "ratio_of": "its own steps",
                "target": "" if method == "steps" else target_of("certificate"),
                "detail": f"sections={len(sections.plan.sections)}",
            }
        )
    return rows


def handover() -> Case:
    """Two arms, one of which hands the other a part."""
    return cl.load_case(inputs.SCENES / "dual_arm_handover" / "case.yaml")


def audited(asked: Arguments) -> list[dict]:
    """All excused pairs of a 7-axis arm, once; seconds on one thread."""
    robot, matrix = read(*PANDA)
    audit(robot, matrix)  # compiles
    start = time.process_time()
    found = audit(robot, matrix)
    seconds = time.process_time() - start
    by_status = {
        status: sum(pair.finding.status is status for pair in found) for status in PairStatus
    }
    return [
        {
            "what": "audit of excused pairs",
            "case": "panda",
            "method": "clearance.simulate.answers.audit.srdf",
            "pairs": len(found),
            "ms": seconds * 1e3,
            "ratio": seconds,
            "ratio_of": "a second",
            "target": target_of("audit"),
            "detail": " ".join(f"{status.name.lower()}={n}" for status, n in by_status.items()),
        }
    ]


def unsynchronised(asked: Arguments) -> list[dict]:
    """A whole check of two arms whose clocks nothing ties: steps, and the proof over all pairs of times."""
    case = replace(two_arms(), clock=Clock(np.inf))
    cl.check(case, resources=Resources(jobs=1))  # compiles
    start = time.process_time()
    run = cl.check(case, resources=Resources(jobs=1))
    seconds = time.process_time() - start
    least = run.record.certificate
    return [
        {
            "what": "unsynchronised",
            "case": "two_arms",
            "method": "check, to 0.1 mm",
            "pairs": len(run.pair_minima),
            "steps": run.steps.num_rows,
            "ms": seconds * 1e3,
            "ratio": seconds,
            "ratio_of": "a second",
            "target": target_of("unsynchronised"),
            "detail": f"clearance from {least.lower_bound.min() * 1e3:.3f} mm",
        }
    ]


OF_A_CLONE = ("certificate of a handed part",)
"""Rows whose robots come with what the tests need."""

ROWS: dict[str, Callable[[Arguments], list[dict]]] = {
    "self and scene of an arm": partial(against_peers, "arm"),
    "humanoid": partial(against_peers, "humanoid"),
    "two arms": partial(against_peers, "two_arms"),
    "certificate of two arms": partial(certificates, "two_arms", two_arms),
    "certificate of a handed part": partial(certificates, "dual_arm_handover", handover),
    "unsynchronised": unsynchronised,
    "audit": audited,
}


def target_of(kind: str) -> str:
    """The target of a kind of row, or nothing."""
    return "{} {:g}".format(*TARGETS[kind]) if kind in TARGETS else ""


def is_met(row: dict) -> bool | None:
    """Whether a row's ratio is what is asked; None where nothing is."""
    if not row["target"]:
        return None
    sign, number = row["target"].split()
    return row["ratio"] >= float(number) if sign == ">=" else row["ratio"] <= float(number)


def table_of(name: str, rows: list[dict]) -> Table:
    """Some rows."""
    first = rows[0]
    title = f"{name}: {first.get('pairs')} pairs, {first.get('steps', 'no')} steps"
    table = Table(title=title, title_justify="left", title_style="bold")
    for column in ("case", "method"):
        table.add_column(column, no_wrap=True)
    for column in ("ms", "ratio", "of", "target", "met", "off by [m]"):
        table.add_column(column, justify="right", no_wrap=True)
    table.add_column("detail")
    for row in rows:
        off = row.get("greatest_difference_m")
        table.add_row(
            row["case"],
            row["method"],
            f"{row['ms']:.4g}",
            f"{row['ratio']:.4g}",
            row["ratio_of"],
            row["target"],
            {None: "", True: "yes", False: "NO"}[is_met(row)],
            "" if off is None else f"{off:.1e}",
            row.get("detail", ""),
        )
    return table


if __name__ == "__main__":
    main()
