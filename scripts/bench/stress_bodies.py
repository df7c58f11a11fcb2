"""Pairs of small bodies for `stress.py`: boxes, wedges, pyramids; apart, touching, crossing, one in another."""

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from clearance import Polyhedron
from tests.strategies import BOX_FACES, QUARTER_TURNS, rotations

WEDGE_FACES = [(0, 2, 1), (3, 4, 5), (0, 1, 4, 3), (1, 2, 5, 4), (2, 0, 3, 5)]
PYRAMID_FACES = [(0, 3, 2, 1), (0, 1, 4), (1, 2, 4), (2, 3, 4), (3, 0, 4)]


class Part(NamedTuple):
    """A body, and its corners and faces as the oracle takes them."""

    shape: Polyhedron
    vertices: np.ndarray
    faces: list


def part(random: np.random.Generator) -> Part:
    """A box, a wedge or a pyramid, 1e-3 to 2 wide, about the origin."""
    size = (
        10.0 ** random.uniform(-3.0, 0.3, 3)
        if random.random() < 0.5
        else random.choice([0.25, 0.5, 1.0], 3)
    )
    kind = random.integers(3)
    if kind == 0:
        corners = [[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)]
        faces = BOX_FACES
    elif kind == 1:
        corners = [[x, y, z] for z in (-1, 1) for x, y in ((-1, -1), (1, -1), (0, 1))]
        faces = WEDGE_FACES
    else:
        corners = [[-1, -1, -1], [1, -1, -1], [1, 1, -1], [-1, 1, -1], [0, 0, 1]]
        faces = PYRAMID_FACES
    vertices = 0.5 * np.array(corners, dtype=float) * size
    return Part(Polyhedron(vertices, faces), vertices, faces)


def pose(random: np.random.Generator, spread: float, square: bool) -> np.ndarray:
    """Any pose, or a quarter turn at a quarter of a metre."""
    matrix = np.eye(4)
    if square:
        matrix[:3, :3] = QUARTER_TURNS[random.integers(24)]
        matrix[:3, 3] = random.integers(-4, 5, 3) / 4.0
    else:
        matrix[:3, :3] = rotations(random, 1)[0]
        matrix[:3, 3] = random.normal(size=3) * spread
    return matrix


def body_pairs(random: np.random.Generator, n: int) -> Iterator[tuple]:
    """`n` tuples (family, a, b, pose_a, pose_b), families in turn."""
    for i in range(n):
        a, b = part(random), part(random)
        name = (
            "bodies_apart",
            "bodies_square",
            "bodies_close",
            "bodies_far_away",
            "bodies_nested",
        )[i % 5]
        square = name == "bodies_square"
        spread = {"bodies_close": 0.3, "bodies_nested": 0.02}.get(name, 1.5)
        pose_a, pose_b = pose(random, 0.3, square), pose(random, spread, square)
        if name == "bodies_far_away":
            offset = random.normal(size=3) * 10.0 ** random.uniform(0.0, 6.0)
            pose_a[:3, 3] += offset
            pose_b[:3, 3] += offset
        if name == "bodies_nested":
            pose_b[:3, 3] += pose_a[:3, 3]
            vertices = 0.1 * b.vertices
            b = Part(Polyhedron(vertices, b.faces), vertices, b.faces)
        yield name, a, b, pose_a, pose_b
