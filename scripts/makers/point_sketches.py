"""Sketches of distances between points whose true places are known, drawn aside of them: patches of triangles,
irreducible clusters, Delaunay triangles with slivers. Fixed seeds.
"""

from __future__ import annotations

import heapq
import math

import numpy as np

from clearance.sketch import Sketch

Edges = list[tuple[int, int]]
"""Pairs of points between which a distance is given."""


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


def triangulated(points: np.ndarray) -> Edges:
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
        joined = sorted(near[v] & done, key=rank.get)
        pair = next(((p, q) for p in joined for q in joined if p < q and q in near[p]), None)
        if pair is None:
            continue
        edges += [(pair[0], v), (pair[1], v)]
        done.add(v)
        for u in near[v] - done:
            heapq.heappush(heap, (rank[u], u))
    return edges


def irreducible(n: int, seed: int) -> tuple[np.ndarray, Edges]:
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


def delaunay_edges(points: np.ndarray, random: np.random.Generator) -> Edges:
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


def slivered(n: int, off: float, seed: int) -> tuple[Sketch, np.ndarray, Edges]:
    """(sketch, true points, edges) of random points, 1 per unit area, drawn `off` (standard deviation) aside."""
    random = np.random.default_rng(seed)
    points = random.uniform(0.0, math.sqrt(n), (n, 2))
    edges = delaunay_edges(points, random)
    return sketched(points, points + random.normal(0.0, off, points.shape), edges), points, edges


def constructed(
    n: int, off: float, seed: int, near: int | None = None
) -> tuple[Sketch, np.ndarray, Edges]:
    """(sketch, true points, edges) of random points, 1 per unit area, each at distances from two before it.

    These are any two, or two of the `near` nearest. Points are drawn `off` (standard deviation) aside.
    """
    random = np.random.default_rng(seed)
    points = random.uniform(0.0, math.sqrt(n), (n, 2))
    edges = [(0, 1)]
    for k in range(2, n):
        gaps = np.linalg.norm(points[:k] - points[k], axis=1)
        edges += [(int(a), k) for a in random.choice(np.argsort(gaps)[:near], 2, replace=False)]
    return sketched(points, points + random.normal(0.0, off, points.shape), edges), points, edges


def shaken(points: np.ndarray, off: float, seed: int) -> np.ndarray:
    """The points moved by up to `off`, uniformly in a disc."""
    random = np.random.default_rng(seed)
    angle, radius = (
        random.uniform(0, 2 * np.pi, len(points)),
        off * np.sqrt(random.uniform(0, 1, len(points))),
    )
    return points + np.column_stack([radius * np.cos(angle), radius * np.sin(angle)])


def sketched(points: np.ndarray, drawn: np.ndarray, edges: Edges) -> Sketch:
    """A sketch of distances measured on `points`, drawn at `drawn`."""
    s = Sketch()
    p = [s.point(*q) for q in drawn]
    for a, b in edges:
        s.distance(p[a], p[b], float(np.linalg.norm(points[a] - points[b])))
    return s


def patch(n: int, off: float, seed: int) -> tuple[Sketch, np.ndarray, Edges]:
    """(sketch, true points, edges) of a triangulated patch."""
    points = lattice(n)
    edges = triangulated(points)
    points = points + np.random.default_rng(seed).uniform(-0.1, 0.1, points.shape)
    return sketched(points, shaken(points, off, seed + 1), edges), points, edges


def flipped(s: Sketch, points: np.ndarray, edges: Edges) -> int:
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
