"""Times the sketch solver, and SolveSpace's library on the same distances where that is installed.

    python scripts/bench/sketch.py [--sizes N ...] [--seeds N] [--csv FILE]

Sketches are built outside the clock, a solve includes everything from the flat lists to the residual. Milliseconds
of CPU: median, least and greatest.
"""

from __future__ import annotations

import harness  # first: it sets the number of threads before numpy is loaded
import numpy as np
from harness import SCENES, Row, timed
from peers import absent_peers, available

from clearance.sketch import Sketch, SketchResult
from scripts.makers.point_sketches import (
    Edges,
    constructed,
    flipped,
    irreducible,
    patch,
    shaken,
    sketched,
    slivered,
)

MIDSHIP = SCENES / "sketches" / "midship_e.yaml"

SMALLEST = ["--sizes", "30", "--seeds", "1"]


def main(words: list[str] | None = None) -> list[Row]:
    """Runs what the command line asks for."""
    asked = harness.arguments(__doc__, words, sizes=[100, 300, 1000], seeds=20)
    harness.tell(*absent_peers(["python_solvespace"]))
    rows = midship_rows()
    for n in asked.sizes:
        rows += patch_rows(n)
        rows += [slivers_row(n, asked.seeds), constructions_row(n, asked.seeds)]
    rows.append(clusters_row(min(asked.sizes), asked.seeds))
    harness.show("sketches", rows)
    harness.write_csv(rows, asked.csv)
    return rows


def midship_rows() -> list[Row]:
    """The section of a ship: its first solve, and one after a dimension has changed."""
    solved = [solve(Sketch.load(MIDSHIP)) for _ in range(8)][1:]  # the first one warms up
    changed, s = [], Sketch.load(MIDSHIP)
    s.solve()
    for k in range(20):
        s.set("t", 11.0 + 0.01 * k)
        changed.append(solve(s))
    whats = ("midship section: first solve", "midship section: change of one dimension")
    return [row_of(what, rows) for what, rows in zip(whats, (solved, changed), strict=True)]


def patch_rows(n: int) -> list[Row]:
    """A patch of triangles drawn off by 5 %, and off by 20 % which triangles come out flipped; and the peer."""
    patch(n, 0.05, 1)[0].solve()
    rows = [
        row_of(
            f"triangulated patch, n = {n}, off by 5 %",
            [solve(patch(n, 0.05, 1)[0]) for _ in range(7)],
        )
    ]
    far, n_flipped = [], 0
    for seed in range(10):
        s, points, edges = patch(n, 0.2, seed)
        far.append(solve(s))
        n_flipped += flipped(s, points, edges)
    rows.append(row_of(f"the same, off by 20 %, {n_flipped} triangles flipped", far))
    if available("python_solvespace") and n <= 300:
        _, points, edges = patch(n, 0.05, 1)
        ms, is_solved = by_solvespace(points, shaken(points, 0.05, 2), edges)
        rows.append(
            {"what": f"SolveSpace: patch, n = {n}", "asked": 1, "solved": int(is_solved), "ms": ms}
        )
    return rows


def slivers_row(n: int, seeds: int) -> Row:
    """Delaunay triangles, some of whose slivers are drawn the wrong way round."""
    made = [slivered(n, 0.05, seed)[0] for seed in range(seeds)]
    return row_of(f"Delaunay triangles, n = {n}, off by 5 %", [solve(s) for s in made])


def constructions_row(n: int, seeds: int) -> Row:
    """Each point at distances from two of its six nearest before it."""
    made = [constructed(n, 0.05, seed, 6)[0] for seed in range(seeds)]
    return row_of(f"constructions, n = {n}, off by 5 %", [solve(s) for s in made])


def clusters_row(n: int, seeds: int) -> Row:
    """Clusters in which no point can be peeled off and no three form a body."""
    found = []
    for seed in range(seeds):
        points, edges = irreducible(n, seed)
        found.append(solve(sketched(points, shaken(points, 0.2, seed + 1000), edges)))
    return row_of(f"irreducible clusters, n = {n}, off by 20 %", found)


def solve(s: Sketch) -> tuple[float, SketchResult]:
    """[ms] of one solve, and its result."""
    seconds, result = timed(s.solve)
    return 1e3 * seconds, result


def row_of(what: str, found: list[tuple[float, SketchResult]]) -> Row:
    """Some solves in one row; the residual is the worst of those that are solved."""
    times = [ms for ms, _ in found]
    solved = [result for _, result in found if result.solved]
    residual = max((one.residual / one._problem.size for one in solved), default=None)
    return {
        "what": what, "asked": len(found), "solved": len(solved), "ms": float(np.median(times)),
        "ms_least": min(times), "ms_greatest": max(times), "residual / size": residual,
    }  # fmt: skip


def by_solvespace(points: np.ndarray, drawn: np.ndarray, edges: Edges) -> tuple[float, bool]:
    """[ms] of SolveSpace's library on the same distances, and whether they are solved."""
    from python_solvespace import ResultFlag, SolverSystem

    system = SolverSystem()
    plane = system.create_2d_base()
    p = [system.add_point_2d(float(x), float(y), plane) for x, y in drawn]
    system.dragged(p[0], plane)
    for a, b in edges:
        system.distance(p[a], p[b], float(np.linalg.norm(points[a] - points[b])), plane)
    seconds, flag = timed(system.solve)
    return 1e3 * seconds, flag == ResultFlag.OKAY


if __name__ == "__main__":
    main()
