"""Prints how our time and memory grow: with triangles, with steps, and with a second thread.

    python scripts/bench/growth.py [--seconds S] [--csv FILE] [--picture FILE]

One scene throughout, seven links among 20 obstacles in smooth motion: its bodies cut four times as fine at a time,
or its steps made as much closer as they are more. Triangles and steps: milliseconds of CPU a step, median of
interleaved passes. Threads: seconds on the wall, least of alternating passes. Memory: bytes of the arrays that are
searched, and what is allocated at most while steps are measured, by `tracemalloc`.
"""

from __future__ import annotations

import argparse
import tracemalloc

import harness  # first: it sets the number of threads before numpy is loaded
from harness import Row, interleaved, least_on_wall, tell
from inputs import Scene, scene_from

from clearance.geometry.tree import surface_of
from clearance.simulate.measure.layout import PairsInMotion, lay_out
from clearance.simulate.measure.measure import measure
from clearance.simulate.measure.resources import Resources
from scripts.makers.hostile_cases import arm_among_obstacles

SMALLEST = ["--fineness", "4", "8", "--steps", "20", "40", "--seconds", "0.01", "--passes", "1"]


def main(words: list[str] | None = None) -> list[Row]:
    """Runs what the command line asks for; bodies have 2 n^2 triangles for each n of `--fineness`."""
    asked = harness.arguments(
        __doc__, words, seconds=3.0, passes=25, fineness=[8, 16, 32, 64],
        steps=[100, 400, 1600, 6400], picture="",
    )  # fmt: skip
    finer = [scene_from("arm", arm_among_obstacles(n, 400)) for n in asked.fineness]
    closer = [scene_from("arm", arm_among_obstacles(16, n)) for n in asked.steps]
    rows = [*timed_rows("triangles", finer, asked), *timed_rows("steps", closer, asked)]
    rows += thread_rows(closer[-1], asked.passes)
    harness.show("seven links among 20 obstacles", rows)
    for few, many in zip(rows, rows[2 : len(finer)], strict=False):
        grown = many["ms_per_step"] / few["ms_per_step"]
        tell(f"{few['triangles']} to {many['triangles']} triangles: {grown:.2f} times as long")
    tell(*memory_lines(finer, closer))
    harness.write_csv(rows, asked.csv)
    if asked.picture:
        from figures import draw_growth

        draw_growth(rows, asked.picture)
    return rows


def timed_rows(what: str, scenes: list[Scene], asked: argparse.Namespace) -> list[Row]:
    """A row a scene, in parts of the first."""
    works = [lambda scene=scene: run(scene, 1) for scene in scenes]
    timings = interleaved(works, asked.passes, asked.seconds)
    per_step = [t.median / scene.n_steps * 1e3 for t, scene in zip(timings, scenes, strict=True)]
    return [
        row_of(what, scene, 1, ms, ms / per_step[0], timing.answer)
        for scene, ms, timing in zip(scenes, per_step, timings, strict=True)
    ]


def thread_rows(scene: Scene, passes: int) -> list[Row]:
    """One thread and two, in turns."""
    works = {str(jobs): lambda jobs=jobs: run(scene, jobs) for jobs in (1, 2)}
    found = least_on_wall(works, passes)
    one, tally = found["1"]
    assert found["2"][1] == tally
    return [
        row_of("threads", scene, int(jobs), spent / scene.n_steps * 1e3, one / spent, tally)
        for jobs, (spent, _) in found.items()
    ]


def run(scene: Scene, jobs: int) -> dict[str, int]:
    """Every step, and its counters."""
    pairs = PairsInMotion(scene.case, scene.motions, scene.pairs)
    return measure(pairs, resources=Resources(jobs=jobs)).tally


def row_of(what: str, scene: Scene, threads: int, ms: float, ratio: float, tally: dict) -> Row:
    """One measurement."""
    counted = {
        f"{name}_a_step": tally[name] / scene.n_steps for name in ("node_tests", "polygon_tests")
    }
    return {
        "what": what, "triangles": scene.n_triangles, "steps": scene.n_steps, "threads": threads,
        "ms_per_step": ms, "ratio": ratio, **counted,
    }  # fmt: skip


def memory_lines(finer: list[Scene], closer: list[Scene]) -> list[str]:
    """Bytes a triangle beside the mesh, and what measuring allocates, with few steps and many."""
    lines = []
    for scene in finer:
        shapes = [body.shape for body in scene.bodies]
        own = [(shape.vertices, shape.face_starts, shape.face_vertices) for shape in shapes]
        trees = sum(n_bytes(surface_of(shape), of) for shape, of in zip(shapes, own, strict=True))
        joined = n_bytes(lay_out(scene.case, scene.pairs).surface)
        a_triangle = trees / scene.n_triangles, joined / scene.n_triangles
        lines.append(
            f"{scene.n_triangles} triangles: {a_triangle[0]:.0f} bytes a triangle beside the mesh, "
            f"and {a_triangle[1]:.0f} in the joined copy of a run"
        )
    for scene in closer:
        tracemalloc.start()
        run(scene, 1)
        most = tracemalloc.get_traced_memory()[1] / 1e6
        tracemalloc.stop()
        lines.append(
            f"{scene.n_steps} steps: {most:.2f} MB allocated at most, rows and poses included"
        )
    return lines


def n_bytes(arrays: tuple, but: tuple = ()) -> int:
    """Bytes of some arrays, each counted once, but for others."""
    left_out = {id(array) for array in but}
    return sum(
        array.nbytes for array in {id(a): a for a in arrays if id(a) not in left_out}.values()
    )


if __name__ == "__main__":
    main()
