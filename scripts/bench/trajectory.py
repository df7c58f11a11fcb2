"""Prints what a step costs: ours beside every peer's loop, on the shared cases and on our scenes.

    python scripts/bench/trajectory.py [--scenes NAME ...] [--csv FILE] [--picture FILE] [--bars FILE]

One process, one thread, compiled code warm, meshes and trees made outside the clock; milliseconds of CPU a
step, median over interleaved passes, each of as many runs as take 50 ms; the first run of each pass, which finds
the others' data in the processor's caches, is told apart. Loops without memory are asked for evenly spread
steps where all of them would exceed their share of `--seconds`. "off by" is the greatest |ours - theirs|; a peer
that says 0 where we say more than `--fault` is listed with the step, and so is the reverse.
"""

from __future__ import annotations

import argparse
import sys
import time
from pathlib import Path

import inputs  # first: it sets the number of threads before numpy is loaded
import numpy as np
from clock import Timing, geometric_mean, interleaved, timed
from inputs import Scene
from loops import StepLoop, loops_of
from peers import absent_peers, versions
from rich.console import Console
from rich.table import Table
from rows import write_csv

COLUMNS = (
    "scene", "library", "method", "triangles", "pairs", "steps", "ms_per_step", "ms_least",
    "ms_greatest", "ms_first", "passes", "steps_asked", "ratio_to_ours", "first_ratio_to_ours",
    "greatest_difference_m", "false_contact_steps", "missed_contact_steps", "counters",
)  # fmt: skip

LIBRARIES = ("fcl", "coal", "klampt")

GROUPS = {
    "fastest of what a peer's user writes first": ("all pairs", "managers", "by spheres"),
    "python-fcl's managers": ("managers",),
    "Klampt with the best so far": ("best so far",),
    "Klampt with bounds carried by hand": ("carried bounds",),
}
"""Endings of the names of loops, by what our time is held against."""

SAME = 1e-9
"""[m] Loops whose answers differ from ours by more measure something else: round shapes where ours have facets."""


def main() -> None:
    """Runs what the command line asks for."""
    asked = arguments()
    console = Console(width=None if sys.stdout.isatty() else 132)
    for line in [*inputs.absent_inputs(), *absent_peers(LIBRARIES)]:
        console.print(line, style="yellow", highlight=False)
    rows, started = [], time.perf_counter()
    for scene in inputs.scenes(asked.scenes):
        found = measured(scene, asked.seconds, asked.passes, asked.fault)
        console.print(table_of(scene, found))
        rows += found
    console.print(summary(rows), highlight=False)
    console.print(
        f"{versions(LIBRARIES)}; {time.perf_counter() - started:.0f} s in all", highlight=False
    )
    if asked.csv:
        write_csv(rows, COLUMNS, asked.csv)
    if asked.picture or asked.bars:
        draw(rows, asked.picture, asked.bars)


def draw(rows: list[dict], picture: Path | None, bars: Path | None) -> None:
    """What pictures are asked for."""
    from figures import draw_ratios, draw_trajectory

    if picture:
        draw_trajectory(rows, picture)
    if bars:
        draw_ratios(rows, bars)


def arguments() -> argparse.Namespace:
    """The command line."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    names = sorted(path.parent.name for path in inputs.case_files())
    parser.add_argument("--scenes", nargs="*", choices=names, default=None, metavar="NAME")
    parser.add_argument("--csv", type=Path, help="write the rows here")
    parser.add_argument("--picture", type=Path, help="draw them here (.svg or .png)")
    parser.add_argument("--bars", type=Path, help="draw the ratios here (.svg or .png)")
    parser.add_argument("--seconds", type=float, default=0.8, help="CPU a loop and scene")
    parser.add_argument("--passes", type=int, default=5)
    parser.add_argument(
        "--fault", type=float, default=1e-6, help="[m] beyond which a contact is false"
    )
    return parser.parse_args()


def measured(scene: Scene, seconds: float, passes: int, fault: float) -> list[dict]:
    """One row a loop; ours first."""
    loops = loops_of(scene)
    asked = [steps_for(loop, scene.n_steps, seconds / 3) for loop in loops]
    works = [
        (lambda loop=loop, steps=steps: loop.run(steps))
        for loop, steps in zip(loops, asked, strict=True)
    ]
    timings = interleaved(works, passes, seconds)
    ours = np.full(scene.n_steps, np.nan)
    ours[asked[0]] = timings[0].answer
    return [
        row_of(scene, loop, steps, timing, ours, timings[0], fault)
        for loop, steps, timing in zip(loops, asked, timings, strict=True)
    ]


def steps_for(loop: StepLoop, n_steps: int, seconds: float) -> np.ndarray:
    """All steps, or for a loop without memory as many, evenly spread, as fit into `seconds`."""
    everything = np.arange(n_steps)
    if loop.coherent:
        return everything
    sample = everything[:: max(1, n_steps // 5)]
    spent, _ = timed(lambda: loop.run(sample))
    n_asked = int(np.clip(seconds / max(spent / len(sample), 1e-9), 8, n_steps))
    return np.unique(np.linspace(0, n_steps - 1, n_asked).round().astype(int))


def row_of(
    scene: Scene,
    loop: StepLoop,
    steps: np.ndarray,
    timing: Timing,
    ours: np.ndarray,
    our_timing: Timing,
    fault: float,
) -> dict:
    """What is known of one loop on one scene."""
    theirs = np.maximum(timing.answer, 0.0)  # some say -1 for contact
    per_step = 1e3 / len(steps)
    in_all = scene.n_steps / len(steps)  # ours are asked for all steps
    return {
        "scene": scene.name,
        "library": loop.library,
        "method": loop.name,
        "triangles": scene.n_triangles,
        "pairs": len(scene.pairs),
        "steps": scene.n_steps,
        "ms_per_step": timing.median * per_step,
        "ms_least": timing.least * per_step,
        "ms_greatest": timing.greatest * per_step,
        "ms_first": timing.first * per_step,
        "passes": timing.n_passes,
        "steps_asked": len(steps),
        "ratio_to_ours": timing.median / our_timing.median * in_all,
        "first_ratio_to_ours": timing.first / our_timing.first * in_all,
        "greatest_difference_m": float(np.abs(theirs - ours[steps]).max()),
        "false_contact_steps": " ".join(map(str, steps[(theirs == 0.0) & (ours[steps] > fault)])),
        "missed_contact_steps": " ".join(map(str, steps[(theirs > fault) & (ours[steps] == 0.0)])),
        "counters": " ".join(f"{name}={count}" for name, count in loop.counters.items()),
    }


def table_of(scene: Scene, rows: list[dict]) -> Table:
    """The rows of one scene."""
    title = (
        f"{scene.name}: {len(scene.links)} links, {len(scene.obstacles)} obstacles, "
        f"{scene.n_triangles} triangles, {len(scene.pairs)} pairs, {scene.n_steps} steps"
    )
    table = Table(title=title, title_justify="left", title_style="bold")
    table.add_column("method", no_wrap=True)
    for name in ("ms/step", "least-greatest", "ratio", "off by [m]"):
        table.add_column(name, justify="right", no_wrap=True)
    table.add_column("contact faults")
    table.add_column("a step")
    table.add_column("steps", justify="right", no_wrap=True)
    for row in rows:
        table.add_row(
            row["method"],
            f"{row['ms_per_step']:.4g}",
            f"{row['ms_least']:.3g}-{row['ms_greatest']:.3g}",
            f"{row['ratio_to_ours']:.1f}",
            f"{row['greatest_difference_m']:.1e}",
            faults_of(row),
            per_step(row),
            f"{row['steps_asked']} x {row['passes']}",
        )
    return table


def per_step(row: dict) -> str:
    """The counters that grow with the steps, divided by them."""
    counts = dict(entry.split("=") for entry in row["counters"].split())
    shown = {"queries": "queries", "node_tests": "nodes", "polygon_tests": "polygons"}
    parts = [
        f"{int(counts[key]) / row['steps_asked']:.3g} {name}"
        for key, name in shown.items()
        if key in counts
    ]
    return ", ".join(parts)


def faults_of(row: dict) -> str:
    """How many contacts were false or missed, and the first step of each."""
    parts = []
    for kind in ("false", "missed"):
        steps = row[f"{kind}_contact_steps"].split()
        if steps:
            parts.append(f"{len(steps)} {kind}, first at {steps[0]}")
    return "; ".join(parts) or "none"


def summary(rows: list[dict]) -> str:
    """Geometric means of the ratios, and where anybody is faster than we are."""
    lines = []
    alike_rows = [row for row in rows if row["greatest_difference_m"] <= SAME]
    for what, kinds in GROUPS.items():
        ratios = fastest_ratios(rows, kinds)
        if ratios:
            first = geometric_mean(fastest_ratios(rows, kinds, "first_ratio_to_ours"))
            alike = geometric_mean(fastest_ratios(alike_rows, kinds) or [np.nan])
            lines.append(
                f"{what}: {geometric_mean(ratios):.1f} times our time (geometric mean of {len(ratios)} scenes; "
                f"least {min(ratios):.1f}, greatest {max(ratios):.1f}; of the first run of each pass {first:.1f}; "
                f"of loops with our answers to {SAME:g} m {alike:.1f})"
            )
    peers = [row for row in rows if row["library"] != "clearance"]
    slower = [f"{r['scene']} ({r['method']})" for r in peers if 0 < r["ratio_to_ours"] < 1.0]
    lines.append(
        f"faster than ours: {', '.join(slower)}" if slower else "no peer is faster on any scene"
    )
    return "\n".join(lines)


def fastest_ratios(
    rows: list[dict], kinds: tuple[str, ...], ratio: str = "ratio_to_ours"
) -> list[float]:
    """For each scene the least `ratio` of the loops whose name ends as one of `kinds`."""
    least: dict[str, float] = {}
    for row in rows:
        if row["library"] != "clearance" and row["method"].endswith(kinds):
            least[row["scene"]] = min(least.get(row["scene"], np.inf), row[ratio])
    return list(least.values())


if __name__ == "__main__":
    main()
