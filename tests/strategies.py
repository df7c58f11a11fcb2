"""Hostile input, two ways: seeded families of polygon pairs in bulk, and hypothesis strategies.

The families are those of `scripts/makers/polygon_pairs.py`, which are here by name too. `lattice_*` strategies
draw small integers, so that parallel, coplanar, touching and zero-area input is the rule and shrinking works;
`polygon_pairs` mixes them with the families. Not for: exact answers (tests/oracle).
"""

from __future__ import annotations

import itertools

import numpy as np
from hypothesis import strategies as st

from scripts.makers.polygon_pairs import FAMILIES, Pairs, anywhere, rotations

__all__ = (
    "BOX_FACES", "CUBE_CORNERS", "FAMILIES", "QUARTER_TURNS", "anywhere", "boxes", "lattice_polygons",
    "polygon_pairs", "poses", "rotations",
)  # fmt: skip


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
