"""Hostile pairs of polygons in bulk, by seed: what each family is hostile to is its first line.

A family is a function `(random, n) -> (p, q)` with p (n, k, 3) and q (n, m, 3): planar convex polygons up to
rounding, or degenerate on purpose. `FAMILIES` names them all. Tests and benchmarks draw the same ones.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

Pairs = tuple[np.ndarray, np.ndarray]


def from_least_corner(polygon: np.ndarray) -> np.ndarray:
    """The polygon read so that all take the same fan of triangles, where rounding has bent it."""
    doubled = [tuple(x) for x in polygon.tolist()] * 2
    n = len(polygon)
    return np.roll(polygon, -min(range(n), key=lambda i: doubled[i : i + n]), axis=0)


def rotations(random: np.random.Generator, n: int) -> np.ndarray:
    """(n, 3, 3) rotation matrices, uniformly distributed."""
    w, x, y, z = random.normal(size=(n, 4)).T
    norm = np.sqrt(w * w + x * x + y * y + z * z)
    w, x, y, z = w / norm, x / norm, y / norm, z / norm
    return np.stack(
        [
            np.stack([1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)], -1),
            np.stack([2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)], -1),
            np.stack([2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)], -1),
        ],
        axis=1,
    )


def flat_polygons(random: np.random.Generator, n: int, k: int, slender: float = 1.0) -> np.ndarray:
    """(n, k, 3) convex polygons in z = 0, corners on an ellipse about the origin of half-axes 1,
    slender."""
    angles = np.sort(random.uniform(0, 2 * np.pi, (n, k)), axis=1)
    zero = np.zeros((n, k))
    return np.stack([np.cos(angles), slender * np.sin(angles), zero], axis=-1)


def placed(random: np.random.Generator, polygons: np.ndarray, spread: float = 1.5) -> np.ndarray:
    """The polygons, each turned and moved at random."""
    n = len(polygons)
    turned = np.einsum("nij,nkj->nki", rotations(random, n), polygons)
    return turned + random.normal(scale=spread, size=(n, 1, 3))


def _together(random: np.random.Generator, p: np.ndarray, q: np.ndarray) -> Pairs:
    """Both polygons of each pair by one and the same random motion."""
    both = placed(random, np.concatenate([p, q], axis=1))
    return both[:, : p.shape[1]].copy(), both[:, p.shape[1] :].copy()


def anywhere(random: np.random.Generator, n: int, k: int = 3, m: int = 3) -> Pairs:
    """Random shapes, places and directions."""
    return placed(random, flat_polygons(random, n, k)), placed(random, flat_polygons(random, n, m))


def scaled(random: np.random.Generator, n: int) -> Pairs:
    """Sizes from 1e-9 to 1e9: absolute tolerances."""
    p, q = anywhere(random, n, 4, 3)
    size = 10.0 ** random.uniform(-9, 9, (n, 1, 1))
    return p * size, q * size


def unequal(random: np.random.Generator, n: int) -> Pairs:
    """One polygon up to 1e9 times the other, near its surface: tolerances relative to the
    larger."""
    p = flat_polygons(random, n, 5)
    small = 10.0 ** random.uniform(-9, 0, (n, 1, 1))
    foot = p.mean(axis=1, keepdims=True) + [0, 0, 1] * small * random.uniform(-1, 3, (n, 1, 1))
    return _together(random, p, placed(random, flat_polygons(random, n, 3), 0.5) * small + foot)


def needles(random: np.random.Generator, n: int) -> Pairs:
    """Slivers of slenderness 1 to 1e-12: normals that are rounding error."""
    slender = 10.0 ** random.uniform(-12, 0, (2, n, 1))
    p, q = (flat_polygons(random, n, k) for k in (3, 4))
    p[..., 1] *= slender[0]
    q[..., 1] *= slender[1]
    return placed(random, p, 0.4), placed(random, q, 0.4)


def near_parallel_edges(random: np.random.Generator, n: int) -> Pairs:
    """Edges facing each other, angle 1e-16 to 1e-2, gap 1e-9 to 1: the segment formula's
    denominator."""
    angle, gap = 10.0 ** random.uniform(-16, -2, n), 10.0 ** random.uniform(-9, 0, n)
    zero, one, shift = np.zeros(n), np.ones(n), random.uniform(-1.5, 1.5, n)
    p = np.stack(
        [
            np.stack([-one, zero, zero], -1),
            np.stack([one, zero, zero], -1),
            np.stack([zero, zero, -one], -1),
        ],
        axis=1,
    )
    q = np.stack(
        [
            np.stack([shift - np.cos(angle), -np.sin(angle), gap], -1),
            np.stack([shift + np.cos(angle), np.sin(angle), gap], -1),
            np.stack([shift, zero, gap + 1], -1),
        ],
        axis=1,
    )
    return _together(random, p, q)


def parallel_faces(random: np.random.Generator, n: int) -> Pairs:
    """Faces over each other, a continuum of closest points, gap 1e-9 to 1."""
    p, q = flat_polygons(random, n, 4), flat_polygons(random, n, 5)
    q[..., :2] += random.uniform(-1.5, 1.5, (n, 1, 2))
    q[..., 2] = 10.0 ** random.uniform(-9, 0, (n, 1))
    return _together(random, p, q)


def coplanar(random: np.random.Generator, n: int) -> Pairs:
    """One plane, half of them overlapping and half apart; the plane is exact in every second
    pair."""
    p, q = flat_polygons(random, n, 4), flat_polygons(random, n, 3)
    q[..., :2] += random.uniform(-2, 2, (n, 1, 2))
    turned_p, turned_q = _together(random, p, q)
    exact = np.arange(n) % 2 == 0
    return np.where(exact[:, None, None], p, turned_p), np.where(exact[:, None, None], q, turned_q)


def shared_vertex(random: np.random.Generator, n: int) -> Pairs:
    """The same corner in both, bit for bit: contact at a point."""
    p, q = anywhere(random, n, 4, 3)
    shifted = q - q[:, :1] + p[:, 2:3]
    shifted[:, 0] = p[:, 2]
    return p, shifted


def shared_edge(random: np.random.Generator, n: int) -> Pairs:
    """The same two corners in both, bit for bit, as neighbours on a mesh have."""
    p = placed(random, flat_polygons(random, n, 3))
    apex = p.mean(axis=1) + random.normal(size=(n, 3))
    return p, np.stack([p[:, 1], p[:, 0], apex], axis=1)


def vertex_on_face(random: np.random.Generator, n: int) -> Pairs:
    """A corner on an axis-parallel face, and one ulp above and below: contact decided by one
    bit."""
    p, q = flat_polygons(random, n, 4), placed(random, flat_polygons(random, n, 3))
    height = random.choice([0.0, 1.0, -3.0, 1e6], size=n)
    p[..., 2] = height[:, None]
    weight = random.dirichlet(np.ones(4), n)
    q[:, 0, :2] = np.einsum("nk,nki->ni", weight, p)[:, :2]
    q[:, :, 2] = height[:, None] + np.abs(q[:, :, 2]) + 0.1
    toward = random.choice([-np.inf, np.nan, np.inf], size=n)
    q[:, 0, 2] = np.where(np.isnan(toward), height, np.nextafter(height, toward))
    return p, q


def rounded_onto_face(random: np.random.Generator, n: int) -> Pairs:
    """A corner on a face at any attitude, but for its rounding: all of the distance is below an ulp."""
    p, q = placed(random, flat_polygons(random, n, 3)), anywhere(random, n, 3, 3)[1]
    foot = np.einsum("nk,nki->ni", random.dirichlet(np.ones(3), n), p)
    normal = np.cross(p[:, 1] - p[:, 0], p[:, 2] - p[:, 0])
    normal /= np.linalg.norm(normal, axis=1, keepdims=True)
    heights = np.einsum("nki,ni->nk", q - q[:, :1], normal)
    q = q - q[:, :1] + (np.abs(heights) - heights)[..., None] * normal[:, None] + foot[:, None]
    return p, q


def far_away(random: np.random.Generator, n: int) -> Pairs:
    """Both 1 to 1e8 sizes from the origin: squares before differences."""
    p, q = anywhere(random, n, 4, 4)
    offset = random.normal(size=(n, 1, 3)) * 10.0 ** random.uniform(0, 8, (n, 1, 1))
    return p + offset, q + offset


def crossing_plates(random: np.random.Generator, n: int) -> Pairs:
    """Polygons that pass through each other: only the piercing shows the contact."""
    p, q = flat_polygons(random, n, 4), placed(random, flat_polygons(random, n, 4), 0.0)
    foot = np.einsum("nk,nki->ni", random.dirichlet(np.ones(4), n), p)
    middle = np.einsum("nk,nki->ni", random.dirichlet(np.ones(4), n), q)
    return _together(random, p, q + (foot - middle)[:, None])


def nearly_touching(random: np.random.Generator, n: int) -> Pairs:
    """A tip 1e-12 to 1e-3 before a face or an edge: cancellation, and false contact."""
    p = flat_polygons(random, n, 6)
    gap = 10.0 ** random.uniform(-12, -3, n)
    weight = random.dirichlet(np.full(6, random.choice([0.05, 1.0])), n)
    tip = np.einsum("nk,nki->ni", weight, p) + gap[:, None] * [0, 0, 1]
    away = np.abs(random.normal(size=(n, 2, 3))) * [1, 1, 0.7]
    return _together(random, p, np.stack([tip, tip + away[:, 0], tip + away[:, 1] * [-1, 1, 1]], 1))


def degenerate(random: np.random.Generator, n: int) -> Pairs:
    """Points, segments, repeated and collinear corners, in turn, exactly so."""
    p, q = anywhere(random, n, 4, 5)
    kind = np.arange(n) % 4
    p[kind == 0] = p[kind == 0][:, :1]
    p[kind == 1, 1:3] = p[kind == 1, :1]
    grid = random.integers(-4, 5, (n, 1, 3)).astype(float)
    steps = random.integers(-3, 4, (n, 4, 1))
    line = grid + steps * random.integers(-3, 4, (n, 1, 3))
    p[kind == 2] = line[kind == 2]
    q[kind == 3, 2] = q[kind == 3, 1]
    q[kind == 3, 4] = q[kind == 3, 0]
    return p, q


def many_sided(random: np.random.Generator, n: int) -> Pairs:
    """8 to 64 corners: loops over corners, and edges short beside the polygon."""
    k, m = random.integers(8, 65, 2)
    return anywhere(random, n, int(k), int(m))


FAMILIES: dict[str, Callable[[np.random.Generator, int], Pairs]] = {
    family.__name__: family
    for family in (
        anywhere,
        scaled,
        unequal,
        needles,
        near_parallel_edges,
        parallel_faces,
        coplanar,
        shared_vertex,
        shared_edge,
        vertex_on_face,
        rounded_onto_face,
        far_away,
        crossing_plates,
        nearly_touching,
        degenerate,
        many_sided,
    )
}
