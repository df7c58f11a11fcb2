"""Polygons cut into triangles: the pieces cover the polygon, all of it, and nothing else."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from clearance.errors import BadPolygon
from clearance.formats.mesh.polygon_cut import cut_rings

L_SHAPE = np.array([[0, 0], [2, 0], [2, 1], [1, 1], [1, 2], [0, 2]], dtype=float)
DART = np.array([[0, 0], [2, 2], [0, 1], [-2, 2]], dtype=float)


def cut_polygons(vertices, polygons):
    """(m, 3) the triangles of polygons that are given one by one."""
    corners = np.array([i for polygon in polygons for i in polygon], dtype=np.int64)
    return cut_rings(
        vertices, corners, np.array([len(polygon) for polygon in polygons], dtype=np.int64)
    )


def placed(flat, axes=(0, 1)):
    points = np.zeros((len(flat), 3))
    points[:, list(axes)] = flat
    return points


def area_vectors(points, triangles):
    a, b, c = (points[triangles[:, i]] for i in range(3))
    return np.cross(b - a, c - a) / 2


@pytest.mark.parametrize("axes", [(0, 1), (1, 2), (2, 0), (1, 0), (2, 1), (0, 2)])
@pytest.mark.parametrize("shape", [L_SHAPE, DART, L_SHAPE[::-1], np.roll(L_SHAPE, 3, axis=0)])
def test_a_concave_polygon_is_covered_without_overlap(shape, axes):
    points = placed(shape, axes)
    triangles = cut_polygons(points, [list(range(len(points)))])
    vectors = area_vectors(points, triangles)
    total = vectors.sum(axis=0)
    x, y = shape.T
    true_area = abs(np.dot(x, np.roll(y, -1)) - np.dot(y, np.roll(x, -1))) / 2
    assert len(triangles) == len(points) - 2
    assert np.linalg.norm(total) == pytest.approx(true_area, abs=1e-15)
    # no triangle turns the other way, so the areas add up only if nothing overlaps
    assert np.linalg.norm(vectors, axis=1).sum() == pytest.approx(true_area, abs=1e-15)
    assert (vectors @ total >= 0).all()


def test_a_polygon_that_crosses_itself_is_refused():
    with pytest.raises(BadPolygon, match="face 1 crosses itself"):
        cut_polygons(placed(np.array([[0, 0], [1, 1], [1, 0], [0, 1]])), [[0, 1, 2], [0, 1, 2, 3]])


@given(seed=st.integers(0, 10_000), n=st.integers(4, 40))
def test_random_rings_are_covered_or_refused(seed, n):
    shape = np.random.default_rng(seed).integers(0, 6, (n, 2)).astype(float)
    points = placed(shape)
    try:
        triangles = cut_polygons(points, [list(range(n))])
    except BadPolygon:
        return
    vectors = area_vectors(points, triangles)[:, 2]
    x, y = shape.T
    assert vectors.sum() == (np.dot(x, np.roll(y, -1)) - np.dot(y, np.roll(x, -1))) / 2
    assert (vectors >= 0).all() or (vectors <= 0).all()
