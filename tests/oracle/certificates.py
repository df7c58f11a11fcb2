"""Exact polygon distances by guess and proof: a few integer products where brute force takes hundreds.

A guess of the nearest features may come from anywhere; here it is floats, in bulk. Their squared distance is
then computed on the integer grid, and so is a proof that nothing is nearer: along the direction w between
them all corners of one polygon lie at least as far apart from those of the other (weak duality),
min w . y - max w . x = |w| distance, without rounding. What is not proven so, contact above all, is left to
brute force (`polygons`). Shares no code with the package.
"""

from __future__ import annotations

from collections.abc import Iterator
from fractions import Fraction

import numpy as np

from tests.oracle.polygons import polygon_distance_sq
from tests.oracle.rationals import Point, cross, dot, minus

Feature = tuple[Point, ...]


def polygon_distances_sq(ps: np.ndarray, qs: np.ndarray) -> Iterator[tuple[Fraction, bool]]:
    """(exact squared distance, True if by proof and not by brute force) of the pairs (k, n, 3), (k, m, 3)."""
    for p, q, (i, j) in zip(ps, qs, guessed(ps, qs), strict=True):
        scale, grid_p, grid_q = _gridded(p, q)
        one, two = tuple(grid_p[k] for k in i), tuple(grid_q[k] for k in j)
        found = proven_sq(one, two, grid_p, grid_q)
        if found is None:
            yield polygon_distance_sq(p, q), False
        else:
            yield Fraction(found[0], found[1] * scale * scale), True


def proven_sq(one: Feature, two: Feature, p: list[Point], q: list[Point]) -> tuple[int, int] | None:
    """The squared distance of two features as a fraction if no corners of p and q are nearer, else None."""
    w = _direction(one, two)
    if w is None or not any(w):
        return None
    far, near = max(dot(w, x) for x in p), min(dot(w, y) for y in q)
    apart = near - far
    if apart <= 0 or any(dot(w, x) != far for x in one) or any(dot(w, y) != near for y in two):
        return None
    return apart * apart, dot(w, w)


def _direction(one: Feature, two: Feature) -> Point | None:
    """The direction from the first to the second feature if the feet are inside both, else None."""
    if len(one) > 1 and len(two) == 1:
        w = _direction(two, one)
        return None if w is None else (-w[0], -w[1], -w[2])
    if len(one) == 2:
        return _between_segments(*one, *two)
    (x,) = one
    if len(two) == 1:
        return minus(two[0], x)
    if len(two) == 2:
        return _to_segment(x, *two)
    return _to_triangle(x, *two)


def _to_segment(x: Point, a: Point, b: Point) -> Point | None:
    d, r = minus(b, a), minus(a, x)
    length_sq, foot = dot(d, d), -dot(r, d)
    if not 0 <= foot <= length_sq or length_sq == 0:
        return None
    return tuple(length_sq * r[k] + foot * d[k] for k in range(3))


def _to_triangle(x: Point, a: Point, b: Point, c: Point) -> Point | None:
    u, v, r = minus(b, a), minus(c, a), minus(x, a)
    n = cross(u, v)
    t = cross(n, r)
    beta, gamma = dot(v, t), -dot(u, t)
    if beta < 0 or gamma < 0 or beta + gamma > dot(n, n):
        return None
    return n if dot(r, n) < 0 else (-n[0], -n[1], -n[2])


def _between_segments(p0: Point, p1: Point, q0: Point, q1: Point) -> Point | None:
    u, v, r = minus(p1, p0), minus(q1, q0), minus(q0, p0)
    n = cross(u, v)
    t = cross(n, r)
    n_sq, on_p, on_q = dot(n, n), dot(v, t), dot(u, t)
    if not (0 <= on_p <= n_sq and 0 <= on_q <= n_sq):
        return None
    return n if dot(r, n) > 0 else (-n[0], -n[1], -n[2])


def _gridded(p: np.ndarray, q: np.ndarray) -> tuple[int, list[Point], list[Point]]:
    """The least scale, a power of two, that makes all coordinates integers, and these."""
    ratios = [x.as_integer_ratio() for x in [*p.ravel().tolist(), *q.ravel().tolist()]]
    scale = max(below for _, below in ratios)
    whole = [above * (scale // below) for above, below in ratios]
    points = [tuple(whole[k : k + 3]) for k in range(0, len(whole), 3)]
    return scale, points[: len(p)], points[len(p) :]


def guessed(ps: np.ndarray, qs: np.ndarray) -> list[tuple[tuple[int, ...], tuple[int, ...]]]:
    """The corners of the nearest features of each pair as far as floats can tell."""
    origin = ps[:, :1]
    spread = np.abs(np.concatenate([ps, qs], axis=1) - origin).max(axis=(1, 2))
    size = np.where(spread > 0.0, spread, 1.0)[:, None, None]
    ps, qs = (ps - origin) / size, (qs - origin) / size
    with np.errstate(all="ignore"):
        kinds = [
            _corners_and_corners(ps, qs),
            _corners_and_edges(ps, qs),
            _flipped(_corners_and_edges(qs, ps)),
            _corners_and_triangles(ps, qs),
            _flipped(_corners_and_triangles(qs, ps)),
            _edges_and_edges(ps, qs),
        ]
    gaps = np.stack([np.where(np.isfinite(gap), gap, np.inf) for gap, _ in kinds])
    best = gaps.argmin(axis=0)
    return [kinds[kind][1](i) for i, kind in enumerate(best)]


def _flipped(kind):
    gap, corners = kind
    return gap, lambda i: corners(i)[::-1]


def _least(gaps: np.ndarray, features: list, others: list):
    """The least of (k, features, others) for each pair, and which two it is of."""
    flat = np.where(np.isnan(gaps), np.inf, gaps).reshape(len(gaps), -1)
    at = flat.argmin(axis=1)
    gap = flat[np.arange(len(flat)), at]
    return gap, lambda i: (features[at[i] // len(others)], others[at[i] % len(others)])


def _corners(n: int) -> list[tuple[int, ...]]:
    return [(i,) for i in range(n)]


def _edges(n: int) -> list[tuple[int, ...]]:
    return [(i, (i + 1) % n) for i in range(n)]


def _corners_and_corners(ps, qs):
    d = ps[:, :, None] - qs[:, None]
    return _least((d * d).sum(-1), _corners(ps.shape[1]), _corners(qs.shape[1]))


def _corners_and_edges(ps, qs):
    a, d = qs[:, None], (np.roll(qs, -1, axis=1) - qs)[:, None]
    r = ps[:, :, None] - a
    share = (r * d).sum(-1) / (d * d).sum(-1)
    off = r - share[..., None] * d
    gap = np.where((share > 0) & (share < 1), (off * off).sum(-1), np.inf)
    return _least(gap, _corners(ps.shape[1]), _edges(qs.shape[1]))


def _corners_and_triangles(ps, qs):
    triangles = [(0, k, k + 1) for k in range(1, qs.shape[1] - 1)]
    a, b, c = (qs[:, [t[k] for t in triangles]] for k in range(3))
    u, v = b - a, c - a
    n = np.cross(u, v)[:, None]
    r = ps[:, :, None] - a[:, None]
    t = np.cross(n, r)
    beta, gamma, n_sq = (v[:, None] * t).sum(-1), -(u[:, None] * t).sum(-1), (n * n).sum(-1)
    inside = (beta >= 0) & (gamma >= 0) & (beta + gamma <= n_sq)
    gap = np.where(inside, (r * n).sum(-1) ** 2 / n_sq, np.inf)
    return _least(gap, _corners(ps.shape[1]), triangles)


def _edges_and_edges(ps, qs):
    u, v = np.roll(ps, -1, axis=1) - ps, np.roll(qs, -1, axis=1) - qs
    n = np.cross(u[:, :, None], v[:, None])
    r = qs[:, None] - ps[:, :, None]
    t = np.cross(n, r)
    n_sq, on_p, on_q = (n * n).sum(-1), (v[:, None] * t).sum(-1), (u[:, :, None] * t).sum(-1)
    inside = (on_p > 0) & (on_p < n_sq) & (on_q > 0) & (on_q < n_sq)
    gap = np.where(inside, (r * n).sum(-1) ** 2 / n_sq, np.inf)
    return _least(gap, _edges(ps.shape[1]), _edges(qs.shape[1]))
