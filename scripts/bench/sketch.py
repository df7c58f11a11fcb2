"""Times the sketch solver against its targets, and against slvs where that is installed.

    PYTHONPATH=. python scripts/bench/sketch.py [--peers] [--seeds N]

One run, one core, compiled beforehand; sketches are built outside the clock, a solve includes
everything from the
flat lists to the residual. Fixed seeds; median and worst of the repetitions.
"""

from __future__ import annotations

import argparse
import heapq
import math
import time
from pathlib import Path

import numpy as np

from clearance.sketch import Sketch

SKETCHES = Path(__file__).parents[2] / "scenes" / "sketches"


def lattice(n: int) -> np.ndarray:
    """n points of a triangular lattice of unit edges."""
    side = math.ceil(math.sqrt(n))
    return np.array(
        [(i + 0.5 * (j % 2), j * math.sqrt(0.75)) for j in range(side) for i in range(side)][:n]
    )


def neighbours(points: np.ndarray) -> list[set[int]]:
    """The lattice neighbours of every point."""
    key = {(round(2 * x), round(y / math.sqrt(0.75))): k for k, (x, y) in enumerate(points)}
    steps = ((2, 0), (1, 1), (-1, 1), (-2, 0), (-1, -1), (1, -1))
    return [{key[a + u, b + v] for u, v in steps if (a + u, b + v) in key} for a, b in key]


def triangulated(points: np.ndarray) -> list[tuple[int, int]]:
    """2n - 3 edges: every point joined to two neighbours that are joined themselves, from the
    middle out."""
    near = neighbours(points)
    order = np.argsort(np.hypot(*(points - points.mean(axis=0)).T), kind="stable")
    rank = {int(v): k for k, v in enumerate(order)}
    a = int(order[0])
    b = min(near[a], key=rank.get)
    done, edges = {a, b}, [(a, b)]
    heap = [(rank[v], v) for u in (a, b) for v in near[u]]
    heapq.heapify(heap)
    while heap:
        _, v = heapq.heappop(heap)
        if v in done:
            continue
        known = sorted(near[v] & done, key=rank.get)
        pair = next(((p, q) for p in known for q in known if p < q and q in near[p]), None)
        if pair is None:
            continue
        edges += [(pair[0], v), (pair[1], v)]
        done.add(v)
        for u in near[v] - done:
            heapq.heappush(heap, (rank[u], u))
    return edges


def irreducible(n: int, seed: int) -> tuple[np.ndarray, list[tuple[int, int]]]:
    """Jittered lattice points with 2n - 3 independent short edges and no point of fewer than
    three."""
    random = np.random.default_rng(seed)
    points = lattice(n) + random.uniform(-0.15, 0.15, (n, 2))
    gaps = np.linalg.norm(points[:, None] - points[None], axis=2)
    short = [(a, b) for a in range(n) for b in range(a + 1, n) if gaps[a, b] < 2.1]
    while True:
        degree, edges = np.zeros(n, int), []
        basis, generic = np.zeros((2 * n - 3, 2 * n)), random.uniform(-1, 1, (n, 2))
        left = [short[k] for k in random.permutation(len(short))]
        while len(edges) < 2 * n - 3 and left:
            best = min(range(len(left)), key=lambda k: sorted(degree[list(left[k])]))
            a, b = left.pop(best)
            row = np.zeros(2 * n)
            row[2 * a : 2 * a + 2], row[2 * b : 2 * b + 2] = (
                generic[a] - generic[b],
                generic[b] - generic[a],
            )
            row /= np.linalg.norm(row)
            for _ in range(2):
                row -= basis.T @ (basis @ row)
            if np.linalg.norm(row) > 1e-8:
                basis[len(edges)] = row / np.linalg.norm(row)
                edges.append((a, b))
                degree[[a, b]] += 1
        if len(edges) == 2 * n - 3 and degree.min() >= 3:
            return points, sorted(edges)


def shaken(points: np.ndarray, off: float, seed: int) -> np.ndarray:
    """The points moved by up to `off`, uniformly in a disc."""
    random = np.random.default_rng(seed)
    angle, radius = (
        random.uniform(0, 2 * np.pi, len(points)),
        off * np.sqrt(random.uniform(0, 1, len(points))),
    )
    return points + np.column_stack([radius * np.cos(angle), radius * np.sin(angle)])


def sketched(points: np.ndarray, drawn: np.ndarray, edges) -> Sketch:
    """A sketch of distances measured on `points`, drawn at `drawn`."""
    s = Sketch()
    p = [s.point(*q) for q in drawn]
    for a, b in edges:
        s.distance(p[a], p[b], float(np.linalg.norm(points[a] - points[b])))
    return s


def patch(n: int, off: float, seed: int):
    """(sketch, true points, edges) of a triangulated patch."""
    points = lattice(n)
    edges = triangulated(points)
    points = points + np.random.default_rng(seed).uniform(-0.1, 0.1, points.shape)
    return sketched(points, shaken(points, off, seed + 1), edges), points, edges


def timed(make, repetitions: int = 5):
    """(median ms, worst ms, last result) of solving fresh sketches."""
    make().solve()
    times = []
    for _ in range(repetitions):
        s = make()
        start = time.perf_counter()
        result = s.solve()
        times.append(1e3 * (time.perf_counter() - start))
    return float(np.median(times)), max(times), result


def report(name: str, target: str, measured: str) -> None:
    print(f"{name:<52} {target:>16}   {measured}", flush=True)


def flipped(s: Sketch, points: np.ndarray, edges) -> int:
    """How many triangles of edges lie the other way round than in `points`."""
    x = np.array([e.position for e in s.entities.values()])
    joined = [set() for _ in points]
    for a, b in edges:
        joined[a].add(b), joined[b].add(a)
    triples = {tuple(sorted((a, b, c))) for a, b in edges for c in joined[a] & joined[b]}
    return sum(
        np.linalg.det([x[b] - x[a], x[c] - x[a]])
        * np.linalg.det([points[b] - points[a], points[c] - points[a]])
        < 0
        for a, b, c in triples
    )


def patches(peers: bool) -> None:
    for n, target in ((100, "2 ms"), (300, "6 ms"), (1000, "20 ms"), (10000, "500 ms")):
        median, worst, result = timed(lambda n=n: patch(n, 0.05, 1)[0])
        left = result.residual / result._problem.size
        text = f"{median:.2f} ms (worst {worst:.2f}), residual / size {left:.1e}"
        if peers and n <= 300:
            text += f", slvs {slvs_time(*patch(n, 0.05, 1)[1:], 0.05):.0f} ms"
        report(f"triangulated patch, n = {n}, off by 5 %", target, text)
    solved = flips = 0
    for seed in range(10):
        s, points, edges = patch(100, 0.2, seed)
        solved += s.solve().solved
        flips += flipped(s, points, edges)
    report(
        "the same, n = 100, off by 20 %, 10 seeds",
        "10, 0 flipped",
        f"{solved} solved, {flips} flipped",
    )


def irreducible_clusters(seeds: int) -> None:
    if seeds == 0:
        return
    solved, times = 0, []
    for seed in range(seeds):
        points, edges = irreducible(100, seed)
        s = sketched(points, shaken(points, 0.2, seed + 1000), edges)
        start = time.perf_counter()
        solved += s.solve().solved
        times.append(1e3 * (time.perf_counter() - start))
    median, most = np.quantile(times, 0.5), np.quantile(times, 0.9)
    text = f"{solved} of {seeds}, median {median:.1f} ms, 9 of 10 below {most:.0f} ms"
    report(f"3-connected, n = 100, off by 20 %, {seeds} seeds", "all, 30 ms", text)


def midship() -> None:
    median, worst, result = timed(lambda: Sketch.load(SKETCHES / "midship_e.yaml"), 5)
    report(
        "midship section: first solve",
        "10 ms",
        f"{median:.2f} ms (worst {worst:.2f}), {result.status}",
    )
    s, times = Sketch.load(SKETCHES / "midship_e.yaml"), []
    s.solve()
    for k in range(20):
        s.set("t", 11.0 + 0.01 * k)
        start = time.perf_counter()
        assert s.solve().solved
        times.append(1e3 * (time.perf_counter() - start))
    report(
        "midship section: change of one dimension",
        "1 ms",
        f"{np.median(times):.2f} ms (worst {max(times):.2f})",
    )


def conflict() -> None:
    times = []
    for span, factor in ((4, 1.1), (8, 1.1), (8, 0.9)):
        s, points, edges = patch(300, 0.05, 1)
        present = {tuple(sorted(e)) for e in edges}
        a, b = next(
            (a, b)
            for a in range(120, 300)
            for b in range(a + 1, 300)
            if span - 1 < np.linalg.norm(points[a] - points[b]) < span and (a, b) not in present
        )
        p = list(s.entities.values())
        s.distance(p[a], p[b], factor * float(np.linalg.norm(points[a] - points[b])), name="wrong")
        s.solve().conflicts  # noqa: B018 - compiled
        start = time.perf_counter()
        names = s.solve().conflicts
        times.append(1e3 * (time.perf_counter() - start))
        report(
            f"one dimension {factor} x over {span} edges, n = 300",
            "100 ms",
            f"{times[-1]:.1f} ms, {len(names)} named",
        )


def rectangles() -> Sketch:
    """1000 rectangles of their own: four points, four segments, three right angles, two sides."""
    s, random = Sketch(), np.random.default_rng(0)
    for k in range(1000):
        corners = np.array([[0, 0], [2, 0], [2, 1], [0, 1]]) + 3.0 * np.array([k % 32, k // 32])
        p = [s.point(*q) for q in corners + random.uniform(-0.1, 0.1, (4, 2))]
        sides = [s.segment(p[i], p[(i + 1) % 4]) for i in range(4)]
        for i in range(3):
            s.perpendicular(sides[i], sides[i + 1])
        s.distance(p[0], p[1], 2.0), s.distance(p[1], p[2], 1.0)
    return s


def slvs_time(points: np.ndarray, edges, off: float) -> float:
    """[ms] of SolveSpace's library on the same patch."""
    from python_solvespace import SolverSystem

    system = SolverSystem()
    plane = system.create_2d_base()
    drawn = shaken(points, off, 2)
    p = [system.add_point_2d(float(x), float(y), plane) for x, y in drawn]
    system.dragged(p[0], plane)
    for a, b in edges:
        system.distance(p[a], p[b], float(np.linalg.norm(points[a] - points[b])), plane)
    start = time.perf_counter()
    system.solve()
    return 1e3 * (time.perf_counter() - start)


def main() -> None:
    arguments = argparse.ArgumentParser(description=__doc__)
    arguments.add_argument("--peers", action="store_true")
    arguments.add_argument("--seeds", type=int, default=20)
    chosen = arguments.parse_args()
    report("what", "target", "measured")
    patches(chosen.peers)
    midship()
    conflict()
    median, worst, _ = timed(rectangles, 3)
    report("1000 separate rectangles", "40 ms", f"{median:.1f} ms (worst {worst:.1f})")
    irreducible_clusters(chosen.seeds)


if __name__ == "__main__":
    main()
