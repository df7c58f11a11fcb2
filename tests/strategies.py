"""Hostile input, two ways: seeded families of polygon pairs in bulk, and hypothesis strategies.

A family is a function `(random, n) -> (p, q)` with p (n, k, 3) and q (n, m, 3): planar convex
polygons up to rounding, or degenerate on purpose. `FAMILIES` names them all; what each is hostile
to is its first line. `lattice_*` strategies draw small integers, so that parallel, coplanar,
touching and zero-area input is the rule and shrinking works; `polygon_pairs` mixes them with the
families. Not for: exact answers (tests/oracle).
"""

from __future__ import annotations

import itertools
from collections.abc import Callable

import numpy as np
from hypothesis import strategies as st

Pairs = tuple[np.ndarray, np.ndarray]


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


def _hull(points: list[tuple[int, int]]) -> list[tuple[int, int]]:
    """The convex hull counter-clockwise, corners on its edges kept (monotone chain); a line comes
    out twice."""

    def half(ordered):
        chain: list[tuple[int, int]] = []
        for x in ordered:
            while len(chain) > 1 and _turn(chain[-2], chain[-1], x) < 0:
                chain.pop()
            chain.append(x)
        return chain[:-1]

    ordered = sorted(set(points))
    return half(ordered) + half(ordered[::-1])


def _turn(a: tuple[int, int], b: tuple[int, int], c: tuple[int, int]) -> int:
    return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])


_small = st.integers(-3, 3)
_vector = st.tuples(_small, _small, _small)


@st.composite
def lattice_polygons(draw: st.DrawFn, max_corners: int = 7) -> np.ndarray:
    """(k, 3) convex polygons with small integer coordinates: exactly planar, and often
    degenerate."""
    flat = draw(st.lists(st.tuples(_small, _small), min_size=3, max_size=max_corners))
    corners = _hull(flat) if len(set(flat)) > 2 else flat
    repeated = draw(st.sets(st.integers(0, len(corners) - 1), max_size=2))
    corners = [x for i, x in enumerate(corners) for _ in range(2 if i in repeated else 1)]
    u, v, origin = (np.array(draw(_vector), dtype=float) for _ in range(3))
    return np.array([origin + a * u + b * v for a, b in corners])


@st.composite
def polygon_pairs(draw: st.DrawFn) -> Pairs:
    """One pair: of a family, or two lattice polygons, scaled by a power of ten and moved far
    away."""
    if draw(st.booleans()):
        seed = draw(st.integers(0, 2**32 - 1))
        p, q = FAMILIES[draw(st.sampled_from(sorted(FAMILIES)))](np.random.default_rng(seed), 4)
        i = draw(st.integers(0, 3))
        return p[i], q[i]
    size = draw(st.sampled_from([1.0, 1e-7, 1e6, 2.0**-30]))
    offset = draw(st.sampled_from([0.0, 1.0, 2.0**20]))
    p, q = draw(lattice_polygons()), draw(lattice_polygons())
    return size * (p + offset), size * (q + offset)


@st.composite
def poses(draw: st.DrawFn, reach: float = 3.0) -> np.ndarray:
    """(4, 4) world_from_body: quarter turns and identities as often as any other rotation."""
    pose = np.eye(4)
    if draw(st.booleans()):
        pose[:3, :3] = draw(st.sampled_from(QUARTER_TURNS))
        pose[:3, 3] = [x / 4 for x in draw(st.tuples(*[st.integers(-12, 12)] * 3))]
    else:
        seed = draw(st.integers(0, 2**32 - 1))
        pose[:3, :3] = rotations(np.random.default_rng(seed), 1)[0]
        pose[:3, 3] = draw(st.tuples(*[st.floats(-reach, reach)] * 3))
    return pose


@st.composite
def boxes(draw: st.DrawFn) -> tuple[np.ndarray, list[tuple[int, ...]]]:
    """Vertices (8, 3) and 6 faces of a box about the origin: cubes, slabs and needles, 1e-3 to 2
    wide."""
    size = np.array(draw(st.tuples(*[st.sampled_from([0.001, 0.25, 0.5, 1.0, 2.0])] * 3)))
    corners = np.array(list(itertools.product((-0.5, 0.5), repeat=3))) * size
    return corners, BOX_FACES


CUBE_CORNERS = np.array(list(itertools.product((-1.0, 1.0), repeat=3)))
"""(8, 3) of the cube of side 2 about the origin."""

BOX_FACES = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
"""Corners of `itertools.product` order, counter-clockwise from outside."""

QUARTER_TURNS = [
    np.array(rows) * np.array(signs)[:, None]
    for rows in itertools.permutations(np.eye(3))
    for signs in itertools.product((-1.0, 1.0), repeat=3)
    if np.linalg.det(np.array(rows) * np.array(signs)[:, None]) > 0
]
"""The 24 rotations of the cube onto itself."""
