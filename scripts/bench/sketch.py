"""Times the sketch solver against its targets, and against slvs where that is installed.

    PYTHONPATH=. python scripts/bench/sketch.py [--peers] [--seeds N] [--csv scripts/bench/results/sketch.csv]

One run, one core, compiled beforehand; sketches are built outside the clock, a solve includes everything
from the flat lists to the residual. CPU time of this process, which a busy machine does not stretch; fixed
seeds; median, least and greatest of the repetitions.
"""

from __future__ import annotations

import argparse
import csv
import heapq
import math
import sys
import time
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).parents[2]))  # so that it runs from the root without an installation

from clearance.sketch import Sketch
from tests.sketch.drawn_randomly import drawing, tangencies

ARC_LINE_TANGENT, CURVE_CURVE_TANGENT = 100027, 100032
"""SolveSpace's numbers of these constraints, which its library for Python does not name."""

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


def delaunay_edges(points: np.ndarray, random) -> list[tuple[int, int]]:
    """2n - 3 edges of Delaunay triangles taken one beside another, each new point joined to its triangle's
    other two; slivers on the hull included."""
    from scipy.spatial import Delaunay

    mesh = Delaunay(points)
    first = int(random.integers(len(mesh.simplices)))
    a, b, c = (int(v) for v in mesh.simplices[first])
    edges, known, seen, front = [(a, b), (b, c), (a, c)], {a, b, c}, {first}, [first]
    while front:
        k = front.pop(int(random.integers(len(front))))
        for m in (int(m) for m in mesh.neighbors[k] if m >= 0 and int(m) not in seen):
            seen.add(m)
            front.append(m)
            corners = [int(v) for v in mesh.simplices[m]]
            fresh = [v for v in corners if v not in known]
            edges += [(v, u) for v in fresh for u in corners if u != v]
            known.update(fresh)
    return edges


def slivered(n: int, off: float, seed: int):
    """(sketch, true points, edges) of random points, 1 per unit area, drawn `off` (standard deviation) aside."""
    random = np.random.default_rng(seed)
    points = random.uniform(0.0, math.sqrt(n), (n, 2))
    edges = delaunay_edges(points, random)
    return sketched(points, points + random.normal(0.0, off, points.shape), edges), points, edges


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


@dataclass
class Table:
    """The rows of one run: printed as they come, kept for the file."""

    rows: list[tuple[str, str, str, str]] = field(default_factory=list)

    def add(self, what: str, library: str, target: str, measured: str) -> None:
        """Prints and keeps one measurement."""
        print(f"{what:<58} {library:<10} {target:>15}   {measured}", flush=True)
        self.rows.append((what, library, target, measured))

    def write(self, path: Path) -> None:
        """Writes all rows as CSV."""
        with path.open("w", newline="", encoding="utf-8") as out:
            writer = csv.writer(out)
            writer.writerow(("what", "library", "target", "measured"))
            writer.writerows(self.rows)


def spread(times: list[float]) -> str:
    """Median and range of times [ms]."""
    return f"{np.median(times):.2f} ms ({min(times):.2f} to {max(times):.2f})"


def clocked(work) -> tuple[float, object]:
    """[ms] of CPU of one call, and its value."""
    start = time.process_time()
    value = work()
    return 1e3 * (time.process_time() - start), value


def timed(make, repetitions: int = 7):
    """(times [ms], last result) of solving fresh sketches."""
    make().solve()
    times = []
    for _ in range(repetitions):
        s = make()
        taken, result = clocked(s.solve)
        times.append(taken)
    return times, result


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


def relative(result) -> float:
    """The residual relative to the sketch's size."""
    return result.residual / result._problem.size


def patches(table: Table, peers: bool) -> None:
    medians = {}
    for n, target in ((100, "2 ms"), (300, "6 ms"), (1000, "20 ms"), (10000, "500 ms")):
        name = f"triangulated patch, n = {n}, off by 5 %"
        times, result = timed(lambda n=n: patch(n, 0.05, 1)[0])
        medians[n] = float(np.median(times))
        text = f"{spread(times)}, residual / size {relative(result):.1e}"
        table.add(name, "clearance", target, text)
        if peers and n <= 300:
            _, points, edges = patch(n, 0.05, 1)
            taken, done, _ = slvs_solve(points, shaken(points, 0.05, 2), edges)
            table.add(name, "slvs", "", f"{taken:.1f} ms, {'solved' if done else 'failed'}")
    growth = medians[10000] / medians[1000]
    table.add("growth from n = 1000 to 10,000", "clearance", "13.3 (n log n)", f"{growth:.1f}")
    turned(table, peers)


def turned(table: Table, peers: bool) -> None:
    name, solved, flips, theirs, their_flips = (
        "the same, n = 100, off by 20 %, 10 seeds",
        0,
        0,
        0,
        0,
    )
    for seed in range(10):
        s, points, edges = patch(100, 0.2, seed)
        solved += s.solve().solved
        flips += flipped(s, points, edges)
        if peers:
            _, done, x = slvs_solve(points, shaken(points, 0.2, seed + 1), edges)
            theirs += done
            their_flips += flipped(sketched(points, x, edges), points, edges) if done else 0
    table.add(name, "clearance", "10, 0 flipped", f"{solved} solved, {flips} flipped")
    if peers:
        table.add(name, "slvs", "", f"{theirs} solved, {their_flips} flipped")


def irreducible_clusters(table: Table, seeds: int, peers: bool) -> None:
    if seeds == 0:
        return
    solved, times, worst, theirs, their_times = 0, [], 0.0, 0, []
    for seed in range(seeds):
        points, edges = irreducible(100, seed)
        drawn = shaken(points, 0.2, seed + 1000)
        s = sketched(points, drawn, edges)
        taken, result = clocked(s.solve)
        solved += result.solved
        worst = max(worst, relative(result)) if result.solved else worst
        times.append(taken)
        if peers and seed < 10:
            taken, done, _ = slvs_solve(points, drawn, edges)
            theirs += done
            their_times.append(taken)
    name = f"3-connected, n = 100, off by 20 %, {seeds} seeds"
    text = f"{solved} solved, {spread(times)}, 9 of 10 below {np.quantile(times, 0.9):.1f} ms"
    table.add(name, "clearance", "all, 30 ms", f"{text}, residual / size {worst:.1e}")
    if peers:
        table.add(name, "slvs", "", f"{theirs} of {min(seeds, 10)} solved, {spread(their_times)}")


def slivers(table: Table, seeds: int = 20) -> None:
    """Patches of Delaunay triangles, some of whose slivers are drawn the wrong way round."""
    for n in (100, 300, 1000):
        times, worst, solved = [], 0.0, 0
        for seed in range(seeds):
            s, points, edges = slivered(n, 0.05, seed)
            taken, result = clocked(s.solve)
            times.append(taken)
            if result.solved:
                x = np.array([e.position for e in s.entities.values()])
                a, b = np.array(edges).T
                apart = np.linalg.norm(x[a] - x[b], axis=1)
                error = np.abs(apart - np.linalg.norm(points[a] - points[b], axis=1)).max()
                worst, solved = max(worst, error / np.abs(x).max()), solved + 1
        name = f"Delaunay triangles, n = {n}, off by 5 %, {seeds} seeds"
        text = f"{solved} solved, {spread(times)}, error / size {worst:.1e}"
        table.add(name, "clearance", f"{0.95 * seeds:.0f} solved", text)


def midship(table: Table) -> None:
    times, result = timed(lambda: Sketch.load(SKETCHES / "midship_e.yaml"))
    text = f"{spread(times)}, {result.status}, residual / size {relative(result):.1e}"
    table.add("midship section: first solve", "clearance", "10 ms", text)
    s, times = Sketch.load(SKETCHES / "midship_e.yaml"), []
    s.solve()
    for k in range(20):
        s.set("t", 11.0 + 0.01 * k)
        taken, result = clocked(s.solve)
        assert result.solved
        times.append(taken)
    table.add("midship section: change of one dimension", "clearance", "1 ms", spread(times))


def bars(table: Table) -> None:
    """The bar in the box, its length free, drawn in 60 places."""
    solved, lengths = 0, set()
    for seed in range(60):
        random, s = np.random.default_rng(seed), Sketch.load(SKETCHES / "bar_length.yaml")
        turn, middle = random.uniform(0.2, 1.2), np.array([5.0, 3.0]) + random.uniform(-1, 1, 2)
        d = np.array([math.cos(turn), math.sin(turn)])
        m = np.array([-d[1], d[0]])
        for k, (u, v) in enumerate(((-1, -1), (1, -1), (1, 1), (-1, 1))):
            at = s.entity(f"P{k}").variable
            s._lists.numbers[at : at + 2] = (middle + 4.5 * u * d + 0.5 * v * m - s.origin).tolist()
        result = s.solve()
        solved += result.solved
        lengths.add(round(s.value("length"), 4))
    text = f"{solved}, lengths {', '.join(map(str, sorted(lengths)))}"
    table.add("bar in the box from 60 starts", "clearance", "60", text)


def conflict(table: Table) -> None:
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
        times = []
        for _ in range(5):
            taken, names = clocked(lambda s=s: s.solve().conflicts)
            times.append(taken)
        name = f"one dimension {factor} x over {span} edges, n = 300"
        table.add(name, "clearance", "100 ms", f"{spread(times)}, {len(names)} named")


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


def slvs_solve(points: np.ndarray, drawn: np.ndarray, edges):
    """([ms], whether solved, points) of SolveSpace's library on the same distances."""
    from python_solvespace import ResultFlag, SolverSystem

    system = SolverSystem()
    plane = system.create_2d_base()
    p = [system.add_point_2d(float(x), float(y), plane) for x, y in drawn]
    system.dragged(p[0], plane)
    for a, b in edges:
        system.distance(p[a], p[b], float(np.linalg.norm(points[a] - points[b])), plane)
    taken, flag = clocked(system.solve)
    x = np.array([system.params(q.params) for q in p])
    return taken, flag == ResultFlag.OKAY, x


def drawings(table: Table, peers: bool) -> None:
    """120 random drawings of lines, arcs, contacts and symmetry, at the origin and far from it."""
    for sizes in (0.0, 1e4, 1e5, 1e8):
        solved, theirs, times, their_times, gaps = 0, 0, [], [], []
        for seed in range(120):
            d = drawing(seed)
            drawn = d.shaken(0.03, seed)
            shift = sizes * np.ptp(drawn, axis=0)
            s, p, _, _ = d.sketch(drawn, shift)
            taken, result = clocked(s.solve)
            times.append(taken)
            x = np.array([s.numbers(q.variable, 2) for q in p])
            size = float(np.ptp(x, axis=0).max())
            radii = [e.radius for e in s.entities.values() if e.what == "circle"]
            error = np.abs(d.equations(np.concatenate([x.ravel(), radii]))).max()
            solved += result.solved and error <= 1e-12 * size
            gaps.append(max(tangencies(d, x), default=0.0) / size)
            if peers:
                taken, done = slvs_drawing(d, drawn + shift)
                theirs += done
                their_times.append(taken)
        name = f"120 drawings of arcs and contacts, {sizes:.0e} sizes from the origin"
        text = f"{solved} solved, {spread(times)}, contacts to {max(gaps):.1e} of size"
        table.add(name, "clearance", "120, 1e-12", text)
        if peers:
            table.add(name, "slvs", "", f"{theirs} solved, {spread(their_times)}")


def slvs_drawing(d, drawn: np.ndarray) -> tuple[float, bool]:
    """([ms], whether solved to 1e-6 of size) of SolveSpace's library on a random drawing."""
    from python_solvespace import ResultFlag, SolverSystem

    system = SolverSystem()
    plane = system.create_2d_base()
    normal = system.add_normal_3d(1.0, 0.0, 0.0, 0.0)
    p = [system.add_point_2d(float(x), float(y), plane) for x, y in drawn]
    system.dragged(p[0], plane)
    e = [system.add_line_2d(p[a], p[b], plane) for a, b in d.segments]
    arcs = [system.add_arc(normal, p[c], p[i], p[j], plane) for c, i, j in d.arcs]
    sizes = [system.add_distance(r, plane) for _, r in d.circles]
    rounds = [
        system.add_circle(normal, p[k], r, plane)
        for (k, _), r in zip(d.circles, sizes, strict=True)
    ]
    of = {"p": p, "s": e, "a": arcs, "c": rounds}
    for kind, entities, value in d.constraints:
        what = [w for w, _ in entities]
        found = [of[w][k] for w, k in entities]
        if kind == "distance":
            system.distance(*found, value, plane)
        elif kind == "radius":
            system.diameter(found[0], 2.0 * value)
        elif kind == "symmetric":
            system.symmetric(*found, plane)
        elif what == ["s", "c"]:  # the library has no such contact: its distance from the centre
            center = d.circles[entities[1][1]][0]
            radius = next(v for k, on, v in d.constraints if k == "radius" and on == (entities[1],))
            system.distance(p[center], found[0], radius, plane)
        else:
            _slvs_tangent(system, d, what, [k for _, k in entities], found, plane)
    taken, flag = clocked(system.solve)
    x = np.array([system.params(q.params) for q in p])
    radii = [system.params(r.params)[0] for r in sizes]
    error = np.abs(d.equations(np.concatenate([x.ravel(), radii]))).max()
    size = float(np.ptp(x, axis=0).max())
    return taken, flag == ResultFlag.OKAY and error <= 1e-6 * size + 1e-9 * np.abs(x).max()


def _slvs_tangent(system, d, what: list[str], index: list[int], found: list, plane) -> None:
    """A contact of SolveSpace's library at the end that two parts share: it wants to know which end."""
    from python_solvespace import Entity

    if what == ["s", "a"]:
        what, index, found = what[::-1], index[::-1], found[::-1]
    _, start, end = d.arcs[index[0]]
    ends = d.segments[index[1]] if what[1] == "s" else d.arcs[index[1]][1:]
    kind, at_end = ARC_LINE_TANGENT, False
    if what[1] == "a":
        kind = CURVE_CURVE_TANGENT
        at_end = ends[1] in (start, end)
    none = Entity.NONE
    system.add_constraint(
        kind, plane, 0.0, none, none, *found, none, none, int(end in ends), int(at_end)
    )


def main() -> None:
    arguments = argparse.ArgumentParser(description=__doc__)
    arguments.add_argument("--peers", action="store_true")
    arguments.add_argument("--seeds", type=int, default=20)
    arguments.add_argument("--csv", type=Path)
    chosen = arguments.parse_args()
    table = Table()
    patches(table, chosen.peers)
    slivers(table)
    drawings(table, chosen.peers)
    midship(table)
    bars(table)
    conflict(table)
    times, result = timed(rectangles, 5)
    text = f"{spread(times)}, residual / size {relative(result):.1e}"
    table.add("1000 separate rectangles", "clearance", "40 ms", text)
    irreducible_clusters(table, chosen.seeds, chosen.peers)
    if chosen.csv:
        table.write(chosen.csv)


if __name__ == "__main__":
    main()
