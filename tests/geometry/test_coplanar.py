"""Coplanar triangles become few convex polygons with the same points; copies of faces change no answer."""

from __future__ import annotations

from fractions import Fraction

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from clearance import distance
from clearance.geometry.coplanar import merge_coplanar
from clearance.geometry.polyhedron import Polyhedron
from clearance.geometry.tree import surface_of
from tests.examples import examples
from tests.geometry.exact_faces import (
    areas_by_plane,
    corners,
    is_flat_and_convex,
    six_volumes,
)
from tests.made_cases import at, ball, faces_below, faces_of, with_copies

CUBE = np.array([[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)], dtype=float)
CUBE_TRIANGLES = np.array([
    [0, 1, 3], [0, 3, 2], [4, 6, 7], [4, 7, 5], [0, 4, 5], [0, 5, 1],
    [2, 3, 7], [2, 7, 6], [0, 2, 6], [0, 6, 4], [1, 5, 7], [1, 7, 3],
])  # fmt: skip


def merged(vertices, triangles) -> Polyhedron:
    return Polyhedron.from_triangles(np.asarray(vertices, dtype=float), np.asarray(triangles))


def voxel_surface(cells: set[tuple[int, int, int]], diagonals: list[bool]):
    """Outward triangles of the boundary of a set of unit cells, each square cut along one diagonal."""
    vertices: dict[tuple[int, int, int], int] = {}
    triangles = []
    for cell in sorted(cells):
        for axis in range(3):
            for side in (0, 1):
                other = list(cell)
                other[axis] += 2 * side - 1
                if tuple(other) in cells:
                    continue
                u, v = np.eye(3, dtype=int)[(axis + 1) % 3], np.eye(3, dtype=int)[(axis + 2) % 3]
                start = np.array(cell) + side * np.eye(3, dtype=int)[axis]
                square = [start, start + u, start + u + v, start + v][:: 2 * side - 1]
                ids = [vertices.setdefault(tuple(p.tolist()), len(vertices)) for p in square]
                k = int(diagonals[len(triangles) // 2 % len(diagonals)])
                ids = ids[k:] + ids[:k]
                triangles += [[ids[0], ids[1], ids[2]], [ids[0], ids[2], ids[3]]]
    return np.array(list(vertices), dtype=float), np.array(triangles)


def test_a_grid_becomes_one_rectangle_whose_straight_corners_are_gone():
    vertices, triangles = voxel_surface(
        {(x, y, 0) for x in range(5) for y in range(3)}, [True, False]
    )
    shape = merged(vertices, triangles)
    assert shape.n_faces == 6 and len(shape.vertices) == 8


def test_coordinates_beyond_the_exact_range_are_unchanged():
    square = np.array([[0, 0, 0], [1e-200, 0, 0], [1e-200, 1e-200, 0], [0, 1e-200, 0]])
    assert merged(square, [[0, 1, 2], [0, 2, 3]]).n_faces == 2


def test_an_l_shape_is_cut_into_convex_parts():
    vertices, triangles = voxel_surface({(0, 0, 0), (1, 0, 0), (0, 1, 0)}, [False])
    shape = merged(vertices, triangles)
    assert shape.closed and shape.oriented and shape.volume == 3.0
    assert shape.n_faces == 10  # two L sides in two parts each, and six walls
    assert all(is_flat_and_convex(corners(shape, i)) for i in range(shape.n_faces))


def test_folded_and_double_faces_stay_apart():
    square = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], dtype=float)
    folded = merged(square, [[0, 1, 2], [1, 0, 2]])  # a flat pocket: two sides of one triangle
    assert folded.n_faces == 2 and folded.closed and folded.volume == 0.0


@pytest.mark.parametrize("lift", [0.0, 1.0])
def test_a_needle_on_a_long_edge_is_absorbed_and_the_surface_stays_closed(lift):
    # a tetrahedron whose edge 0-1 is met at its middle 4 by the other side, with a needle 0-4-1 in between
    v = np.array([[0, 0, 0], [2, 0, 0], [0, 2, lift], [0, 0, 2], [1, 0, 0]], dtype=float)
    t = np.array([[0, 2, 1], [0, 1, 4], [0, 4, 3], [4, 1, 3], [1, 2, 3], [0, 3, 2]])
    raw = Polyhedron(v, t)
    result = merge_coplanar(v, t)
    shape = merged(v, t)
    assert raw.closed and shape.closed and shape.oriented
    assert result.n_dropped == 1 and result.n_degenerate == 0
    assert six_volumes(shape) == six_volumes(raw)
    assert areas_by_plane(shape) == areas_by_plane(raw)


def test_a_needle_that_nothing_covers_is_kept():
    v = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [5, 5, 5], [6, 6, 6], [7, 7, 7]], dtype=float)
    result = merge_coplanar(v, np.array([[0, 1, 2], [3, 4, 5]]))
    assert (result.n_dropped, result.n_degenerate) == (0, 1)
    assert len(result.face_starts) == 3


def test_equal_vertices_and_signed_zeros_are_one():
    soup = CUBE[CUBE_TRIANGLES].reshape(-1, 3)
    soup[::5] *= np.where(soup[::5] == 0.0, -1.0, 1.0)
    shape = merged(soup, np.arange(36).reshape(-1, 3))
    assert shape.n_faces == 6 and len(shape.vertices) == 8 and shape.closed


cells = st.sets(st.tuples(*[st.integers(0, 2)] * 3), min_size=1, max_size=10)
maps = st.lists(st.integers(-3, 3), min_size=9, max_size=9).map(lambda x: np.array(x).reshape(3, 3))
maps = maps.filter(lambda m: round(np.linalg.det(m)) > 0)


@examples(80)
@given(
    cells,
    st.lists(st.booleans(), min_size=1, max_size=7),
    maps,
    st.sampled_from([1.0, 2.0**-40, 1e6 + 0.1]),
)
def test_the_points_stay_exactly_the_same(cells, diagonals, matrix, shift):
    vertices, triangles = voxel_surface(cells, diagonals)
    vertices = vertices @ matrix.T.astype(float) + (0.0 if shift < 1.0 else np.floor(shift))
    raw, shape = Polyhedron(vertices, triangles), merged(vertices, triangles)
    assert areas_by_plane(shape) == areas_by_plane(raw)
    assert six_volumes(shape) == six_volumes(raw)
    assert shape.closed == raw.closed and shape.oriented == raw.oriented
    assert all(is_flat_and_convex(corners(shape, i)) for i in range(shape.n_faces))
    assert shape.n_faces < raw.n_faces
    assert {tuple(p) for p in shape.vertices} <= {tuple(p) for p in raw.vertices}


@examples(60)
@given(st.data())
def test_rounded_coordinates_merge_only_where_rationals_agree(data):
    """Two triangles in a plane whose coordinates are rounded: merged exactly when the determinant is 0."""
    number = st.floats(-10, 10, width=32)
    a, b, c = (np.array(data.draw(st.tuples(number, number, number))) for _ in range(3))
    s, t = data.draw(st.sampled_from([(1.0, 1.0), (0.5, 0.75), (0.3, 1.1)]))
    d = a + s * (b - a) + t * (c - a)
    points = np.stack([a, b, d, c])
    exact = [[Fraction(float(x)) for x in p] for p in points]
    p, q, r = ([x - o for x, o in zip(e, exact[0], strict=True)] for e in exact[1:])
    normal = [q[1] * p[2] - q[2] * p[1], q[2] * p[0] - q[0] * p[2], q[0] * p[1] - q[1] * p[0]]
    determinant = sum(x * y for x, y in zip(normal, r, strict=True))
    result = merge_coplanar(points, np.array([[0, 1, 2], [0, 2, 3]]))
    if determinant != 0:
        assert len(result.face_starts) == 3
    elif len(result.face_starts) == 2 and result.n_dropped == 0:
        faces = np.split(result.face_vertices, result.face_starts[1:-1])
        assert is_flat_and_convex([tuple(exact_row(result.vertices[i])) for i in faces[0]])


def exact_row(row):
    return [Fraction(float(x)) for x in row]


BALL = ball(1.0, 3)
TINY = ball(0.05, 1)


def test_a_face_that_another_one_shares_two_corners_with_is_no_copy() -> None:
    corners = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0.5, 0.5, 1)]
    fans = Polyhedron(
        np.array(corners, dtype=float), [(0, 1, 4), (0, 1, 2, 3), (0, 1, 2), (1, 0, 4), (0, 1, 4)]
    )
    leaves = faces_below(surface_of(fans))[surface_of(fans).roots[0]]
    assert sorted(leaves) == [0, 1, 2]


@pytest.mark.slow
@pytest.mark.parametrize(
    ("faces", "turned_round", "holds"),
    [
        (range(BALL.n_faces), False, True),  # winds twice
        (range(BALL.n_faces), True, False),  # not at all
        (range(0, BALL.n_faces, 3), False, True),  # closed but for the copies, which count once
    ],
)
def test_copies_count_in_what_is_inside(faces: range, turned_round: bool, holds: bool) -> None:
    doubled = with_copies(BALL, list(faces), turned_round=turned_round)
    assert distance(doubled, TINY, pose_b=at(0.3, 0.2, 0.1)).contact == holds
    assert doubled.component_two_sided.tolist() == [turned_round]


def test_only_the_parts_that_hold_nothing_are_two_sided() -> None:
    both = with_copies(TINY, list(range(TINY.n_faces)), turned_round=True)
    sheet = Polyhedron(np.array([(3.0, 0, 0), (4, 0, 0), (3, 1, 0)]), [(0, 1, 2), (0, 2, 1)])
    bowl = Polyhedron(BALL.vertices, faces_of(BALL)[:40])
    bowl = with_copies(bowl, list(range(40)), turned_round=True)
    open_too = with_copies(ball(9.0, 1), [0, 1], turned_round=True)
    parts = Polyhedron.merged([BALL, both, sheet, open_too, bowl.transformed(at(20.0, 0.0, 0.0))])
    assert parts.component_two_sided.tolist()[:4] == [False, True, False, False]
    assert parts.component_two_sided[4:].all()


def test_a_cavity_that_is_there_twice_is_still_wound_round() -> None:
    """Once outward and twice inward: not zero, as without a tree."""
    hollow = Polyhedron.merged([ball(2.0, 2), BALL.flipped(), BALL.flipped()])
    assert distance(hollow, TINY).contact
    assert not distance(Polyhedron.merged([ball(2.0, 2), BALL.flipped()]), TINY).contact
