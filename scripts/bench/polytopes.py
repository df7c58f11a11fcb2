"""Shared regions and common points against the peers: the table of `clearance/query/POLYTOPES.md`, and a CSV.

    python scripts/bench/polytopes.py [--corners N ...] [--seconds S] [--csv FILE]

Bodies are prepared outside the clock. The least of the repetitions is told with their median and the least
processor time (of all threads together): on a busy machine the first two drift apart, and the third is what can be
compared.
"""

from __future__ import annotations

import time
from collections.abc import Callable

import harness  # first: it sets the number of threads before numpy is loaded
import numpy as np
from harness import Row
from peers import available
from scipy.optimize import linprog
from scipy.spatial import ConvexHull, HalfspaceIntersection

from clearance.geometry.polytope import Polytope
from clearance.query.common_point import common_point, common_point_paper
from clearance.query.intersection import intersect

SMALLEST = ["--corners", "50", "--seconds", "0.01"]


def main(words: list[str] | None = None) -> list[Row]:
    """Runs what the command line asks for."""
    asked = harness.arguments(__doc__, words, corners=[50, 1000, 5000], seconds=0.5)
    rows = [trajectory_row(asked.seconds)]
    for m in (2, 64):
        for n in asked.corners:
            rows += rows_of(m, n, asked.seconds)
    harness.show("shared regions of m bodies of n corners", rows)
    harness.write_csv(rows, asked.csv)
    return rows


def ball(rng: np.random.Generator, n: int, centre: np.ndarray) -> Polytope:
    """The hull of n points on a unit sphere, ready to be cut."""
    v = rng.normal(size=(n, 3))
    return Polytope(v / np.linalg.norm(v, axis=1)[:, None] + centre).prepared()


def repeated(call: Callable[[], object], budget: float) -> np.ndarray:
    """(3,) [ms] least, median and least processor time; the first call counts only if it takes a second."""
    found, end = [], None
    while True:
        began, worked = time.perf_counter(), time.process_time()
        call()
        row = time.perf_counter() - began, time.process_time() - worked
        if end is not None or row[0] > 1.0:
            found.append(row)
        now = time.perf_counter()
        end = end or now + budget
        if found and (now > end or len(found) == 300):
            break
    wall, work = 1e3 * np.array(found).T
    return np.array([wall.min(), np.median(wall), work.min()])


def row_of(what: str, m: int, n: int, ms: np.ndarray) -> Row:
    """One measurement."""
    columns = ("least_ms", "median_ms", "least_cpu_ms")
    return {"what": what, "m": m, "n": n, **dict(zip(columns, ms.tolist(), strict=True))}


def lp_and_qhull(bodies: list[Polytope]) -> float:
    """The volume by scipy: the deepest point by HiGHS, then Qhull's half-space intersection."""
    rows = np.vstack([body.half_spaces for body in bodies])
    columns = np.column_stack([rows[:, :3], np.ones(len(rows))])
    best = linprog([0, 0, 0, -1], A_ub=columns, b_ub=-rows[:, 3], bounds=[(None, None)] * 4)
    return ConvexHull(HalfspaceIntersection(rows, best.x[:3]).intersections).volume


def by_manifold(bodies: list[Polytope]) -> Callable[[], float]:
    """The volume by manifold3d."""
    import manifold3d

    solids = [manifold3d.Manifold.hull_points(body.vertices) for body in bodies]
    both = manifold3d.OpType.Intersect
    return lambda: manifold3d.Manifold.batch_boolean(solids, both).volume()


def rows_of(m: int, n: int, budget: float) -> list[Row]:
    """Ours and the peers on one family of balls."""
    rng = np.random.default_rng([m, n])
    spread = 0.4 if m == 2 else 0.05
    bodies = [ball(rng, n, rng.normal(size=3) * spread) for _ in range(m)]
    calls = {"intersect": lambda: intersect(bodies), "common_point": lambda: common_point(bodies)}
    if m > 2:
        calls["intersect, 2 threads"] = lambda: intersect(bodies, threads=2)
    else:
        calls["common_point_paper (GJK)"] = lambda: common_point_paper(*bodies)
    if m * n <= 64000:
        calls["intersect, dual"] = lambda: intersect(bodies, "dual")
        calls["LP + Qhull (scipy)"] = lambda: lp_and_qhull(bodies)
    if available("manifold3d"):
        calls["manifold3d"] = by_manifold(bodies)
    return [row_of(what, m, n, repeated(call, budget)) for what, call in calls.items()]


def trajectory_row(budget: float, n: int = 50, n_poses: int = 200) -> Row:
    """A pose of two bodies that pass each other, each common point begun with the last one's faces."""
    bodies = [ball(np.random.default_rng(i), n, np.zeros(3)) for i in range(2)]
    poses = np.tile(np.eye(4), (n_poses, 2, 1, 1))
    angle, way = np.linspace(0.0, 2.0, n_poses), np.linspace(-2.5, 2.5, n_poses)
    poses[:, 1, 0, 0] = poses[:, 1, 1, 1] = np.cos(angle)
    poses[:, 1, 1, 0], poses[:, 1, 0, 1] = np.sin(angle), -np.sin(angle)
    poses[:, 1, 0, 3], poses[:, 1, 1, 3] = way, 0.3

    def follow() -> None:
        warm = ()
        for pair in poses:
            warm = common_point(bodies, pair, warm).warm

    return row_of("common_point, warm, a pose", 2, n, repeated(follow, budget) / n_poses)


if __name__ == "__main__":
    main()
