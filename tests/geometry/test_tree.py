"""The bounding tree: every face in one leaf, every box around what is below it, few lanes empty."""

from __future__ import annotations

import numpy as np
import pytest

from clearance.geometry.polyhedron import Polyhedron
from clearance.geometry.tree import surface_of
from clearance.kernels.arithmetic.lanes import WIDTH
from tests.made_cases import ball, faces_below, torus


def soup(n: int) -> Polyhedron:
    """Triangles anywhere, of all sizes."""
    random = np.random.default_rng(n)
    sizes = 10.0 ** random.uniform(-3, 0, (n, 1, 1))
    corners = random.normal(size=(n, 1, 3)) + sizes * random.normal(size=(n, 3, 3))
    return Polyhedron(corners.reshape(-1, 3), np.arange(3 * n).reshape(n, 3))


SHAPES = [soup(n) for n in (1, 2, 3, 4, 5, 6, 9, 17, 64, 65, 300)] + [
    ball(1.0, 3),
    torus(1.0, 0.25, 40, 20),
]


@pytest.mark.parametrize("shape", SHAPES, ids=lambda shape: str(shape.n_faces))
def test_every_face_is_in_one_leaf_and_every_box_holds_its_faces(shape: Polyhedron) -> None:
    surface = surface_of(shape)
    below = faces_below(surface)
    assert below[surface.roots[0]] == {*range(shape.n_faces)}
    leaves = surface.children[surface.children[:, 1] == 0, 0]
    assert sorted(leaves.tolist()) == list(range(shape.n_faces))
    boxes = surface.boxes.reshape(-1, 12, WIDTH).astype(np.float64)
    centres = surface.centres.reshape(-1, 3, WIDTH)
    for node in np.flatnonzero(surface.children[:, 1] >= 0):
        group, k = divmod(node, WIDTH)
        axes, half = boxes[group, :9, k].reshape(3, 3), boxes[group, 9:, k]
        for face in below[node]:
            corners = surface.face_vertices[
                surface.face_starts[face] : surface.face_starts[face + 1]
            ]
            away = surface.vertices[corners] - centres[group, :, k]
            assert (np.abs(np.linalg.solve(axes.T, away.T).T) <= half).all()
