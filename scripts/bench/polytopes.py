"""Prints the table of `clearance/query/POLYTOPES.md`: shared regions and common points against the peers.

Run from the repository's root: `PYTHONPATH=. python scripts/bench/polytopes.py [largest n]`. Fixed seed,
bodies prepared outside the clock, medians after a warm-up; peers in the same process.
"""

from __future__ import annotations

import sys
import time

import numpy as np
from scipy.optimize import linprog
from scipy.spatial import ConvexHull, HalfspaceIntersection

from clearance.geometry.polytope import Polytope
from clearance.query.common_point import common_point
from clearance.query.common_point_paper import common_point_paper
from clearance.query.intersection import intersect


def ball(rng: np.random.Generator, n: int, centre: np.ndarray) -> Polytope:
    """The hull of n points on a unit sphere, ready to be cut."""
    v = rng.normal(size=(n, 3))
    return Polytope(v / np.linalg.norm(v, axis=1)[:, None] + centre).prepared()


def median_ms(call, budget: float = 0.5) -> float:
    """Median time of a call [ms], after one that is not counted."""
    call()
    times, end = [], time.perf_counter() + budget
    while len(times) < 3 or (time.perf_counter() < end and len(times) < 200):
        began = time.perf_counter()
        call()
        times.append(time.perf_counter() - began)
    return 1e3 * float(np.median(times))


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


def row(m: int, n: int) -> None:
    """One line of the table."""
    rng = np.random.default_rng([m, n])
    spread = 0.4 if m == 2 else 0.05
    bodies = [ball(rng, n, rng.normal(size=3) * spread) for _ in range(m)]
    ours = median_ms(lambda: intersect(bodies))
    two = median_ms(lambda: intersect(bodies, threads=2)) if m > 3 else np.nan
    point = median_ms(lambda: common_point(bodies))
    paper = median_ms(lambda: common_point_paper(*bodies)) if m == 2 else np.nan
    peer = manifold_of(bodies)
    manifold = median_ms(peer) if peer else np.nan
    scipy = median_ms(lambda: lp_and_qhull(bodies), 0.0) if m * n <= 64000 else np.nan
    print(
        f"| {m} | {n} | {ours:.3f} | {two:.2f} | {point * 1e3:.0f} | {paper * 1e3:.0f} "
        f"| {manifold:.2f} | {scipy:.1f} |",
        flush=True,
    )


def main() -> None:
    """The table, up to the largest n asked for."""
    largest = int(sys.argv[1]) if len(sys.argv) > 1 else 5000
    print(
        "| m | n | ours ms | 2 threads ms | common point µs | GJK µs | manifold ms | LP + Qhull ms |"
    )
    print("|---|---|---|---|---|---|---|---|")
    for m in (2, 64):
        for n in (50, 1000, 5000):
            if n <= largest:
                row(m, n)


if __name__ == "__main__":
    main()
