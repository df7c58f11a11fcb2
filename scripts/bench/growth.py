"""Prints how our time and memory grow: with triangles, with steps, and with a second thread.

    python scripts/bench/growth.py [--seconds S] [--csv FILE] [--picture FILE]

One scene throughout, seven links among 20 obstacles in smooth motion: its bodies cut four times as fine at a time,
or its steps made as much closer as they are more. Triangles and steps: milliseconds of CPU a step, median of
interleaved passes. Threads: seconds on the wall, least of alternating passes. Memory: bytes of the arrays that are
searched, and what is allocated at most while steps are measured, by `tracemalloc`.
"""

from __future__ import annotations

import argparse
import sys
import time
import tracemalloc
from pathlib import Path

from inputs import Scene, scene_from  # first: it sets the number of threads before numpy is loaded

import numpy as np  # isort: skip

from clock import interleaved
from rich.console import Console
from rich.table import Table
from rows import write_csv

from clearance.geometry.polyhedron import Polyhedron
from clearance.geometry.tree import surface_of
from clearance.kernels.mesh.surface import Surface
from clearance.simulate.measure.layout import PairsInMotion, lay_out
from clearance.simulate.measure.measure import measure
from clearance.simulate.measure.resources import Resources
from scripts.makers.hostile_cases import arm_among_obstacles

COLUMNS = ("what", "triangles", "steps", "threads", "ms_per_step", "ratio", "counters")

FINENESS = (8, 16, 32, 64)
"""Bodies have 2 n^2 triangles: each is four times as fine as the one before."""

STEPS = (100, 400, 1600, 6400)
"""Of one motion."""


def main() -> None:
    """Runs what the command line asks for."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--seconds", type=float, default=3.0, help="CPU a size")
    parser.add_argument("--passes", type=int, default=25)
    parser.add_argument("--fineness", nargs="*", type=int, default=FINENESS, metavar="N")
    parser.add_argument("--steps", nargs="*", type=int, default=STEPS, metavar="N")
    parser.add_argument("--csv", type=Path, help="write the rows here")
    parser.add_argument("--picture", type=Path, help="draw them here (.svg or .png)")
    asked = parser.parse_args()
    finer = [scene_from("arm", arm_among_obstacles(n, 400)) for n in asked.fineness]
    closer = [scene_from("arm", arm_among_obstacles(16, n)) for n in asked.steps]
    rows = [*timed_rows("triangles", finer, asked), *timed_rows("steps", closer, asked)]
    rows += thread_rows(closer[-1], asked.passes)
    console = Console(width=None if sys.stdout.isatty() else 132)
    console.print(table_of(rows))
    for line in [*growth_lines(rows), *memory_lines(finer, closer)]:
        console.print(line, highlight=False)
    if asked.csv:
        write_csv(rows, COLUMNS, asked.csv)
    if asked.picture:
        from figures import draw_growth

        draw_growth(rows, asked.picture)


def timed_rows(what: str, scenes: list[Scene], asked: argparse.Namespace) -> list[dict]:
    """A row a scene, in parts of the first."""
    timings = interleaved(
        [lambda scene=scene: run(scene, 1) for scene in scenes], asked.passes, asked.seconds
    )
    per_step = [t.median / scene.n_steps * 1e3 for t, scene in zip(timings, scenes, strict=True)]
    return [
        row_of(what, scene, 1, ms, ms / per_step[0], timing.answer)
        for scene, ms, timing in zip(scenes, per_step, timings, strict=True)
    ]


def thread_rows(scene: Scene, passes: int) -> list[dict]:
    """One thread and two, in turns."""
    least, tallies = {1: np.inf, 2: np.inf}, {}
    for _ in range(passes):
        for jobs in least:
            start = time.perf_counter()
            tallies[jobs] = run(scene, jobs)
            least[jobs] = min(least[jobs], time.perf_counter() - start)
    assert tallies[1] == tallies[2]
    return [
        row_of("threads", scene, jobs, spent / scene.n_steps * 1e3, least[1] / spent, tallies[jobs])
        for jobs, spent in least.items()
    ]


def run(scene: Scene, jobs: int) -> dict[str, int]:
    """Every step, and its counters."""
    return measure(
        PairsInMotion(scene.case, scene.motions, scene.pairs), resources=Resources(jobs=jobs)
    ).tally


def row_of(what: str, scene: Scene, threads: int, ms: float, ratio: float, tally: dict) -> dict:
    """One measurement."""
    counters = " ".join(f"{name}={count}" for name, count in tally.items())
    return {
        "what": what, "triangles": scene.n_triangles, "steps": scene.n_steps, "threads": threads,
        "ms_per_step": ms, "ratio": ratio, "counters": counters,
    }  # fmt: skip


def growth_lines(rows: list[dict]) -> list[str]:
    """What 16 times the triangles and a second thread do to the time."""
    by_size = [row for row in rows if row["what"] == "triangles"]
    lines = []
    for few, many in zip(by_size, by_size[2:], strict=False):
        grown = many["ms_per_step"] / few["ms_per_step"]
        lines.append(
            f"{few['triangles']} to {many['triangles']} triangles: {grown:.2f} times as long; target 2.5"
        )
    two = next(row for row in rows if row["what"] == "threads" and row["threads"] == 2)
    return [*lines, f"2 threads: {two['ratio']:.2f} times as fast as 1; target 1.8"]


def memory_lines(finer: list[Scene], closer: list[Scene]) -> list[str]:
    """Bytes a triangle beside the mesh, and what measuring allocates, with few steps and many."""
    lines = []
    for scene in finer:
        shapes = [solid.shape for solid in [*scene.links, *scene.obstacles]]
        trees = (
            sum(beside_the_mesh(surface_of(shape), shape) for shape in shapes) / scene.n_triangles
        )
        joined = beside_the_mesh(lay_out(scene.case, scene.pairs).surface) / scene.n_triangles
        lines.append(
            f"{scene.n_triangles} triangles: {trees:.0f} bytes a triangle beside the mesh; target 400; "
            f"and {joined:.0f} in the joined copy of a run"
        )
    for scene in closer:
        most = allocated(scene) / 1e6
        lines.append(
            f"{scene.n_steps} steps: {most:.2f} MB allocated at most, rows and poses included"
        )
    return lines


def beside_the_mesh(surface: Surface, shape: Polyhedron | None = None) -> int:
    """Bytes of a searchable form that are not in the mesh's own arrays."""
    own = (
        {id(array) for array in (shape.vertices, shape.face_starts, shape.face_vertices)}
        if shape
        else set()
    )
    arrays = {id(array): array for array in surface if id(array) not in own}
    return sum(array.nbytes for array in arrays.values())


def allocated(scene: Scene) -> int:
    """[bytes] at most at one time, over what the scene holds."""
    tracemalloc.start()
    run(scene, 1)
    most = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    return most


def table_of(rows: list[dict]) -> Table:
    """All rows."""
    table = Table(title="seven links among 20 obstacles", title_justify="left")
    for column in COLUMNS[:-1]:
        table.add_column(column, justify="right" if column != "what" else "left")
    table.add_column("nodes, polygons a step", justify="right")
    for row in rows:
        counts = dict(entry.split("=") for entry in row["counters"].split())
        a_step = [int(counts[name]) / row["steps"] for name in ("node_tests", "polygon_tests")]
        cells = [str(row[name]) for name in COLUMNS[:4]]
        times = [f"{row[name]:.4g}" for name in COLUMNS[4:6]]
        table.add_row(*cells, *times, f"{a_step[0]:.4g}, {a_step[1]:.4g}")
    return table


if __name__ == "__main__":
    main()
