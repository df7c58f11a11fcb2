"""Sketches whose truth is known: points are placed first, dimensions measured, then the drawing is shaken."""

import math

import numpy as np

from clearance.sketch import Sketch


def truth(n, seed, extra=0, missing=0, off=0.03, place=(0.0, 0.0), scale=1.0, turn=0.0):
    """A sketch of n points: a triangulated strip, with some edges more or fewer; (sketch, points,
    truth)."""
    random = np.random.default_rng(seed)
    points = np.array([(0.5 * k, 0.9 * (k % 2)) for k in range(n)]) + random.uniform(
        -0.1, 0.1, (n, 2)
    )
    edges = [(0, 1)] + [(k - j, k) for k in range(2, n) for j in (1, 2)]
    chosen = list(random.permutation(len(edges)))
    edges = [edges[k] for k in sorted(chosen[missing:])]
    far = [(a, b) for a in range(n) for b in range(a + 3, n)]
    edges += [far[k] for k in random.permutation(len(far))[:extra]]
    drawn = points + random.uniform(-off, off, points.shape)
    c, s_ = math.cos(turn), math.sin(turn)
    drawn = scale * drawn @ np.array([[c, s_], [-s_, c]]) + np.array(place)
    s = Sketch()
    p = [s.point(*q) for q in drawn]
    for a, b in edges:
        s.distance(p[a], p[b], scale * float(np.linalg.norm(points[a] - points[b])))
    return s, p, points, edges


def shape(p):
    x = np.array([q.position for q in p])
    return np.linalg.norm(x[:, None] - x[None], axis=2)


def distances(points, drawn, edges):
    """A sketch of the distances measured on `points`, drawn at `drawn`; (sketch, its points)."""
    s = Sketch()
    p = [s.point(*q) for q in drawn]
    for a, b in edges:
        s.distance(p[a], p[b], float(np.linalg.norm(points[a] - points[b])))
    return s, p


def shaken(points, off, seed):
    """The points moved by up to `off`, uniformly in a disc."""
    random = np.random.default_rng(seed)
    angle = random.uniform(0.0, 2.0 * np.pi, len(points))
    radius = off * np.sqrt(random.uniform(0.0, 1.0, len(points)))
    return points + np.column_stack([radius * np.cos(angle), radius * np.sin(angle)])


def prism(n, seed):
    """Two rings of n points joined by spokes and by n - 3 braces: no vertex of two edges, few triangles;
    2 (2 n) - 3 independent edges. (points, edges)."""
    random = np.random.default_rng(seed)
    turn = 2.0 * np.pi * np.arange(n) / n
    ring = np.column_stack([np.cos(turn), np.sin(turn)])
    reach = n / (2.0 * np.pi)
    points = np.concatenate([reach * ring, (reach + 1.0) * ring])
    points += random.uniform(-0.1, 0.1, points.shape)
    edges = [(k, (k + 1) % n) for k in range(n)] + [(n + k, n + (k + 1) % n) for k in range(n)]
    edges += [(k, n + k) for k in range(n)] + [(k, n + (k + 1) % n) for k in range(n - 3)]
    return points, edges


def irreducible(n, seed):
    """Points near a square lattice with 2 n - 3 independent short edges and no point of fewer than three."""
    random = np.random.default_rng(seed)
    side = math.ceil(math.sqrt(n))
    points = np.array([(i, j) for j in range(side) for i in range(side)][:n], float)
    points += random.uniform(-0.15, 0.15, points.shape)
    gaps = np.linalg.norm(points[:, None] - points[None], axis=2)
    short = [(a, b) for a in range(n) for b in range(a + 1, n) if gaps[a, b] < 2.3]
    for _ in range(200):
        degree, edges, basis = np.zeros(n, int), [], np.zeros((0, 2 * n))
        left = [short[k] for k in random.permutation(len(short))]
        while left and len(edges) < 2 * n - 3:
            best = min(range(len(left)), key=lambda k: sorted(degree[list(left[k])]))
            a, b = left.pop(best)
            row = np.zeros(2 * n)
            row[2 * a : 2 * a + 2] = points[a] - points[b]
            row[2 * b : 2 * b + 2] = points[b] - points[a]
            rest = row - basis.T @ (basis @ row)
            rest -= basis.T @ (basis @ rest)
            if np.linalg.norm(rest) > 1e-3:
                basis = np.vstack([basis, rest / np.linalg.norm(rest)])
                edges.append((a, b))
                degree[[a, b]] += 1
        if len(edges) == 2 * n - 3 and degree.min() >= 3:
            return points, edges
    raise AssertionError("no irreducible pattern found")
