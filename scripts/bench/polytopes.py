"""Shared regions and common points against the peers: the table of `clearance/query/POLYTOPES.md`, and a CSV.

Run from the repository's root: `python scripts/bench/polytopes.py [--largest N] [--seconds S] [--csv FILE]`.
Fixed seed, bodies prepared outside the clock, warmed up, peers in the same process. The least of the
repetitions is reported with their median and the least processor time (of all threads together): on a busy
machine the first two drift apart, and the third is what can be compared.
"""

from __future__ import annotations

import argparse
import csv
import sys
import time
from pathlib import Path

import numpy as np
from scipy.optimize import linprog
from scipy.spatial import ConvexHull, HalfspaceIntersection

sys.path.insert(
    0, str(Path(__file__).parents[2])
)  # so that it runs from the root without an installation

from clearance.geometry.polytope import Polytope
from clearance.query.common_point import common_point
from clearance.query.common_point_paper import common_point_paper
from clearance.query.intersection import intersect


def ball(rng: np.random.Generator, n: int, centre: np.ndarray) -> Polytope:
    """The hull of n points on a unit sphere, ready to be cut."""
    v = rng.normal(size=(n, 3))
    return Polytope(v / np.linalg.norm(v, axis=1)[:, None] + centre).prepared()


def timed(call, budget: float) -> tuple[float, float, float]:
    """(least, median, least processor) time of a call [ms]; the first counts only if it takes a second."""
    rows, end = [], None
    while True:
        began, worked = time.perf_counter(), time.process_time()
        call()
        row = time.perf_counter() - began, time.process_time() - worked
        if end is not None or row[0] > 1.0:
            rows.append(row)
        now = time.perf_counter()
        end = end or now + budget
        if rows and (now > end or len(rows) == 300):
            break
    wall, work = 1e3 * np.array(rows).T
    return wall.min(), float(np.median(wall)), work.min()


def lp_and_qhull(bodies: list[Polytope]) -> float:
    """The volume by scipy: the deepest point by HiGHS, then Qhull's half-space intersection."""
    rows = np.vstack([body.half_spaces for body in bodies])
    columns = np.column_stack([rows[:, :3], np.ones(len(rows))])
    best = linprog([0, 0, 0, -1], A_ub=columns, b_ub=-rows[:, 3], bounds=[(None, None)] * 4)
    return ConvexHull(HalfspaceIntersection(rows, best.x[:3]).intersections).volume


def manifold_of(bodies: list[Polytope]):
    """A call that intersects with manifold3d, or None where it is not installed."""
    try:
        import manifold3d
    except ImportError:
        return None
    solids = [manifold3d.Manifold.hull_points(body.vertices) for body in bodies]
    both = manifold3d.OpType.Intersect
    return lambda: manifold3d.Manifold.batch_boolean(solids, both).volume()


def rows_of(m: int, n: int, budget: float) -> list[list]:
    """(what, m, n, least ms, median ms, least processor ms) of ours and the peers on one family of balls."""
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
    peer = manifold_of(bodies)
    if peer:
        calls["manifold3d"] = peer
    return [[what, m, n, *timed(call, budget)] for what, call in calls.items()]


def trajectory_row(budget: float, n: int = 50, n_poses: int = 200) -> list:
    """A pose of two bodies that pass each other, each common point begun with the last one's faces."""
    bodies = [ball(np.random.default_rng(i), n, np.zeros(3)) for i in range(2)]
    poses = np.tile(np.eye(4), (n_poses, 2, 1, 1))
    angle, way = np.linspace(0.0, 2.0, n_poses), np.linspace(-2.5, 2.5, n_poses)
    poses[:, 1, 0, 0] = poses[:, 1, 1, 1] = np.cos(angle)
    poses[:, 1, 1, 0], poses[:, 1, 0, 1] = np.sin(angle), -np.sin(angle)
    poses[:, 1, 0, 3], poses[:, 1, 1, 3] = way, 0.3

    def follow():
        warm = ()
        for pair in poses:
            warm = common_point(bodies, pair, warm).warm

    return [
        "common_point, warm, a pose",
        2,
        n,
        *(value / n_poses for value in timed(follow, budget)),
    ]


def main() -> None:
    """Prints a line a measurement and writes them all."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--largest", type=int, default=5000, help="largest number of corners")
    parser.add_argument("--seconds", type=float, default=0.5, help="how long each is repeated")
    parser.add_argument("--csv", type=Path, default=None, help="where to write the rows")
    given = parser.parse_args()
    sizes = [(m, n) for m in (2, 64) for n in (50, 1000, 5000) if n <= given.largest]
    table = [trajectory_row(given.seconds)]
    for m, n in sizes:
        table += rows_of(m, n, given.seconds)
        for what, _, _, least, median, work in (line for line in table if line[1:3] == [m, n]):
            print(
                f"m {m:3d}  n {n:5d}  {what:28s} {least:10.4f} ms  (median {median:.4f}, cpu {work:.4f})"
            )
    if given.csv:
        with given.csv.open("w", newline="", encoding="utf-8") as out:
            writer = csv.writer(out, lineterminator="\n")
            writer.writerow(["what", "m", "n", "least_ms", "median_ms", "least_cpu_ms"])
            writer.writerows([*line[:3], *(f"{value:.5f}" for value in line[3:])] for line in table)


if __name__ == "__main__":
    main()
