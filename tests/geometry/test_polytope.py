"""Polytopes from points, half-spaces and polyhedra; refusals in one line."""

from __future__ import annotations

import itertools

import numpy as np
import pytest

from clearance.errors import BadPolygon, BadShape, ClearanceError, EmptyMesh, NotFinite
from clearance.geometry.polyhedron import Polyhedron
from clearance.geometry.polytope import Polytope
from clearance.geometry.polytope_hull import NotSolid, Unbounded
from clearance.kernels.polytope.exits import cell_of, exit_in, is_in_ball
from clearance.query.intersection import intersect
from tests.made_cases import at
from tests.oracle.polytope_volumes import half_spaces, shared_volume
from tests.strategies import rotations

CUBE = np.array(list(itertools.product([0.0, 1.0], repeat=3)))
WALLS = np.vstack(
    [np.column_stack([np.eye(3), -np.ones(3)]), np.column_stack([-np.eye(3), np.zeros(3)])]
)


def test_a_cube_has_six_merged_faces():
    cube = Polytope(np.vstack([CUBE, [[0.5, 0.5, 0.5], [0.5, 0.5, 1.0], [0.5, 1.0, 1.0]]]))
    assert (cube.n_faces, len(cube.vertices), cube.volume) == (6, 8, 1.0)
    assert np.array_equal(cube.centroid, [0.5, 0.5, 0.5])
    assert {tuple(row) for row in cube.half_spaces + 0.0} == {tuple(row) for row in WALLS + 0.0}


@pytest.mark.slow
@pytest.mark.parametrize("n", [4, 5, 9, 14])
def test_volume_and_face_count_are_those_of_the_oracle(n):
    for seed in range(4):
        points = np.random.default_rng([n, seed]).normal(size=(n, 3))
        body = Polytope(points)
        exact = shared_volume(points)
        assert abs(body.volume / float(exact) - 1.0) < 1e-14
        assert body.n_faces == len(half_spaces(points))


@pytest.mark.parametrize(
    ("make", "error"),
    [
        (lambda: Polytope(np.zeros((0, 3))), EmptyMesh),
        (lambda: Polytope(np.zeros((4, 2))), BadShape),
        (lambda: Polytope(np.vstack([CUBE, [[np.nan, 0, 0]]])), NotFinite),
        (lambda: Polytope(CUBE * [1, 1, 0]), NotSolid),
        (lambda: Polytope(CUBE @ np.diag([1, 1, 0]) + np.outer(CUBE[:, 0], [0, 0, 1])), NotSolid),
        (lambda: Polytope.from_half_spaces(WALLS[:5]), Unbounded),
        (lambda: Polytope.from_half_spaces(WALLS + [0, 0, 0, 0.6]), NotSolid),
        (lambda: Polytope.from_half_spaces(np.zeros((4, 4))), ClearanceError),
    ],
)
def test_refusals_are_one_line(make, error):
    with pytest.raises(error) as caught:
        make()
    assert len(str(caught.value)) > 10


def test_a_concave_or_open_polyhedron_is_refused():
    cube = Polytope(CUBE).polyhedron()
    faces = [cube.face_vertices[a:b] for a, b in itertools.pairwise(cube.face_starts)]
    with pytest.raises(BadPolygon):
        Polytope.from_polyhedron(Polyhedron(cube.vertices, faces[:5]))
    two = Polyhedron.merged([cube, Polytope(CUBE + 3.0).polyhedron()])
    with pytest.raises(BadPolygon):
        Polytope.from_polyhedron(two)


@pytest.mark.slow
@pytest.mark.parametrize(
    "shape", [(1, 1, 1), (1e-6, 1, 1), (1, 1e-6, 1e-6), (1, 30, 0.1), (1e6, 1e6, 1e6)]
)
@pytest.mark.parametrize("n", [4, 12, 400])
def test_the_map_of_directions_finds_the_face_that_looking_at_all_finds(shape, n):
    """And the inner ball holds nothing that is not inside."""
    rng = np.random.default_rng([n, 5])
    v = rng.normal(size=(n, 3)) * shape @ np.linalg.qr(rng.normal(size=(3, 3)))[0]
    body = Polytope(v + [3.0, -2.0, 1.0])
    x = np.vstack(
        [rng.normal(size=(500, 3)) @ np.diag(shape), v - v.mean(axis=0), np.eye(3), -np.eye(3)]
    )
    gauges = (x @ (body.normals / body.face_widths[:, None]).T).max(axis=1)
    rounding = 64.0 * 2.0**-53 * np.abs(body.vertices).max() / body.face_widths.min()
    for point, gauge in zip(x, gauges, strict=True):
        cell, bound = cell_of(body.packed, *point)
        assert exit_in(body.packed, cell, *point)[1] == pytest.approx(gauge, rel=rounding)
        assert bound >= gauge * (1.0 - rounding)
        assert not is_in_ball(
            body.packed, *(point * (1.0 - 1e-9) / gauge)
        )  # all but on the surface
    if n == 400 and max(shape) / min(shape) < 1e5:
        inside = 0.9 * x / gauges[:, None]
        assert any(is_in_ball(body.packed, *point) for point in inside)


def test_a_moved_body_is_the_hull_of_the_moved_corners():
    body, other = (Polytope(np.random.default_rng(i).normal(size=(60, 3))) for i in range(2))
    pose = at(1.0, -2.0, 0.5, turned=rotations(np.random.default_rng(5), 1)[0])
    moved = body.moved(pose)
    again = Polytope(body.vertices @ pose[:3, :3].T + pose[:3, 3])
    assert moved.volume == pytest.approx(again.volume, rel=1e-14)
    assert moved.n_faces == again.n_faces
    both, there = intersect([body, other]), intersect([moved, other.moved(pose)])
    assert there.volume == pytest.approx(both.volume, rel=1e-13)
