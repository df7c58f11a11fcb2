"""Bodies for the first paper's tests, written out so that they do not depend on the package's own
shapes."""

import itertools

import numpy as np

from clearance.geometry.polyhedron import Polyhedron
from tests.strategies import BOX_FACES


def box(x: float, y: float, z: float) -> Polyhedron:
    """A box about the origin, 6 faces."""
    corners = np.array(list(itertools.product((-0.5, 0.5), repeat=3))) * (x, y, z)
    return Polyhedron(corners, BOX_FACES)


def ring_body(radii, heights, n: int, hollow: bool = False) -> Polyhedron:
    """A surface of rings about z joined by quads; closed by two n-gons, or onto itself where
    `hollow`."""
    angles = 2 * np.pi * np.arange(n) / n
    circle = np.stack([np.cos(angles), np.sin(angles)], axis=1)
    rings = [np.c_[r * circle, np.full(n, h)] for r, h in zip(radii, heights, strict=True)]
    pairs = [(i, i + 1) for i in range(len(rings) - 1)]
    pairs += [(len(rings) - 1, 0)] if hollow else []
    faces = [
        (n * i + k, n * i + (k + 1) % n, n * j + (k + 1) % n, n * j + k)
        for i, j in pairs
        for k in range(n)
    ]
    if not hollow:
        top = n * (len(rings) - 1)
        faces += [tuple(range(n))[::-1], tuple(range(top, top + n))]
    return Polyhedron(np.concatenate(rings), faces)


def ball(radius: float = 1.0, n_rings: int = 11, n: int = 20) -> Polyhedron:
    """A convex body of n (n_rings - 1) quads and 2 caps: 202 polygons unless told otherwise."""
    polar = np.pi * (np.arange(n_rings) + 0.5) / n_rings
    return ring_body(radius * np.sin(polar), -radius * np.cos(polar), n)


def pipe(inner: float, outer: float, length: float, n: int = 16) -> Polyhedron:
    """A concave body of 4 n quads: outer wall, top, inner wall, bottom."""
    half = length / 2
    return ring_body([outer, outer, inner, inner], [-half, half, half, -half], n, hollow=True)


def pose(x: float = 0, y: float = 0, z: float = 0, turn: np.ndarray | None = None) -> np.ndarray:
    """(4, 4) world_from_body."""
    matrix = np.eye(4)
    matrix[:3, 3] = x, y, z
    if turn is not None:
        matrix[:3, :3] = turn
    return matrix
