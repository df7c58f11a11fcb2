"""Polygons cut into triangles: the pieces cover the polygon, all of it, and nothing else."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from clearance.errors import BadPolygon
from clearance.load.polygon_cut import cut_polygons

L_SHAPE = np.array([[0, 0], [2, 0], [2, 1], [1, 1], [1, 2], [0, 2]], dtype=float)
DART = np.array([[0, 0], [2, 2], [0, 1], [-2, 2]], dtype=float)


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


def test_a_fan_would_have_been_wrong_here():
    points = placed(DART)
    fan = np.array([[0, 1, 2], [0, 2, 3]])[:, [0, 1, 2]]
    from_tip = np.array([[1, 2, 3], [1, 3, 0]])
    cut = cut_polygons(points, [[1, 2, 3, 0]])
    assert np.linalg.norm(area_vectors(points, from_tip), axis=1).sum() > 2.1
    assert np.linalg.norm(area_vectors(points, cut), axis=1).sum() == pytest.approx(2.0)
    assert np.linalg.norm(area_vectors(points, fan), axis=1).sum() == pytest.approx(2.0)


def test_polygons_of_several_sizes_keep_their_order():
    points = placed(np.array([[0, 0], [1, 0], [1, 1], [0, 1], [-1, 0.5]]))
    triangles = cut_polygons(points, [[0, 1, 2, 3], [0, 1, 2], [0, 1, 2, 3, 4]])
    assert triangles.tolist() == [[0, 1, 2], [0, 2, 3], [0, 1, 2], [0, 1, 2], [0, 2, 3], [0, 3, 4]]


def test_a_polygon_that_crosses_itself_is_refused():
    with pytest.raises(BadPolygon, match="face 1 crosses itself"):
        cut_polygons(placed(np.array([[0, 0], [1, 1], [1, 0], [0, 1]])), [[0, 1, 2], [0, 1, 2, 3]])


def test_a_face_of_two_vertices_is_refused():
    with pytest.raises(BadPolygon, match="face 0 has 2 vertices"):
        cut_polygons(placed(L_SHAPE), [[0, 1]])


@given(
    radii=st.lists(st.integers(1, 8), min_size=4, max_size=9),
    turn=st.integers(0, 8),
    backwards=st.booleans(),
)
def test_star_shaped_polygons_are_covered(radii, turn, backwards):
    n = len(radii)
    angles = 2 * np.pi * np.arange(n) / n
    shape = np.array(radii)[:, None] * np.column_stack([np.cos(angles), np.sin(angles)])
    points = placed(np.roll(shape, turn, axis=0)[:: -1 if backwards else 1])
    vectors = area_vectors(points, cut_polygons(points, [list(range(n))]))
    total = np.linalg.norm(vectors.sum(axis=0))
    assert np.linalg.norm(vectors, axis=1).sum() == pytest.approx(total, rel=1e-12)
