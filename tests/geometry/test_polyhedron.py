"""What a polyhedron refuses, and what it finds out about itself."""

from __future__ import annotations

import pickle

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from clearance import PointCloud
from clearance.errors import (
    BadDimension,
    BadPolygon,
    BadPose,
    BadShape,
    EmptyMesh,
    NotFinite,
)
from clearance.geometry.point_cloud import components_of
from clearance.geometry.polyhedron import Polyhedron
from clearance.geometry.shapes import box, cylinder, sphere
from clearance.geometry.tree import surface_of
from tests.examples import examples

SQUARE = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], dtype=float)
PENTAGRAM = np.array([[np.cos(a), np.sin(a), 0] for a in np.arange(5) * 4 * np.pi / 5])


@pytest.mark.parametrize(
    ("vertices", "faces", "fault", "words"),
    [
        (SQUARE, [], EmptyMesh, "no faces"),
        (SQUARE * np.nan, [[0, 1, 2]], NotFinite, "vertex 0"),
        (SQUARE[:, :2], [[0, 1, 2]], BadShape, "(4, 2)"),
        ("abc", [[0, 1, 2]], BadShape, "numbers"),
        (SQUARE, [[0, 1, 2], [0, 1]], BadPolygon, "face 1 has 2"),
        (SQUARE, [[0, 1, 2], [0, 1, 4]], BadPolygon, "face 1 refers to vertex 4"),
        (SQUARE, [[0, 1, -1]], BadPolygon, "vertex -1"),
        (SQUARE, [[0, 1, 2], [0, 1, 1, 2]], BadPolygon, "face 1 has vertex 1 twice"),
        (SQUARE, [[0.0, 1.0, 2.5]], BadPolygon, "whole"),
        (SQUARE * [1, 1, 0] + [[0, 0, 0], [0, 0, 1e-6], [0, 0, 0], [0, 0, 0]], [[0, 1, 2, 3]],
         BadPolygon, "face 0 is not flat"),
        ([[0, 0, 0], [2, 0, 0], [0.5, 0.5, 0], [0, 2, 0]], [[0, 1, 2, 3]], BadPolygon, "not convex"),
        (PENTAGRAM, [[0, 1, 2, 3, 4]], BadPolygon, "not convex"),
    ],
)  # fmt: skip
def test_refuses(vertices, faces, fault, words):
    with pytest.raises(fault, match=None) as caught:
        Polyhedron(vertices, faces)
    assert words in str(caught.value)


def test_excess_must_not_be_negative():
    with pytest.raises(BadDimension):
        Polyhedron(SQUARE, [[0, 1, 2, 3]], excess=-1e-9)


def test_rounding_far_from_the_origin_is_no_warp():
    turn = np.eye(4)
    turn[:3, :3] = np.linalg.qr(np.random.default_rng(0).normal(size=(3, 3)))[0]
    turn[:3, :3] *= np.sign(np.linalg.det(turn[:3, :3]))
    turn[:3, 3] = [1e5, -3e5, 7e4]
    moved = cylinder(1e-3, 1e-2).transformed(turn)
    faces = np.split(moved.face_vertices, moved.face_starts[1:-1])
    assert Polyhedron(moved.vertices, faces).n_faces == moved.n_faces


def test_normals_of_a_needle_are_right_and_of_a_line_zero():
    tip = 1.0 / 3.0
    v = np.array([[0, 0, 0], [1, 1, 1], [tip, tip, tip], [tip, tip, np.nextafter(tip, 1)]])
    flat = Polyhedron(v, [[0, 1, 2], [0, 1, 3]])
    assert not flat.normals[0].any()
    assert np.allclose(flat.normals[1], np.array([1, -1, 0]) / np.sqrt(2), atol=1e-12)


@pytest.mark.parametrize("size", [1e-150, 1e-9, 1.0, 1e9, 1e150])
def test_planes_do_not_depend_on_scale(size):
    shape, one = box((size, size, size)), box((1, 1, 1))
    assert np.array_equal(shape.normals, one.normals)
    assert np.allclose(shape.radii / size, np.sqrt(0.5), rtol=1e-15)
    assert np.allclose(shape.centres / size, one.centres, rtol=1e-15)


def test_a_box_knows_itself():
    shape = box((1, 2, 3))
    assert shape.closed and shape.oriented and shape.manifold and shape.volume == 6.0
    assert shape.n_triangles == 12 and shape.triangles().shape == (12, 3)
    assert np.array_equal(shape.bounds, [[-0.5, -1, -1.5], [0.5, 1, 1.5]])
    assert (np.einsum("ij,ij->i", shape.normals, shape.centres) > 0).all()
    assert shape.flipped().volume == -6.0


def test_an_open_or_torn_surface_is_distinguished_from_a_closed_one():
    shape = box((1, 1, 1))
    faces = np.split(shape.face_vertices, shape.face_starts[1:-1])
    opened = Polyhedron(shape.vertices, faces[1:])
    assert not opened.closed and opened.oriented and opened.volume is None
    assert not opened.component_closed.any()
    twisted = Polyhedron(shape.vertices, [faces[0][::-1], *faces[1:]])
    assert twisted.closed and not twisted.oriented and twisted.volume is None
    assert not twisted.component_closed.any()


def test_components_are_judged_one_by_one():
    a, b = box((1, 1, 1)), box((1, 1, 1))
    pose = np.eye(4)
    pose[0, 3] = 5.0
    rest = Polyhedron(b.vertices, np.split(b.face_vertices, b.face_starts[1:-1])[1:])
    both = Polyhedron.merged([a, rest.transformed(pose)])
    assert both.face_component.tolist() == [0] * 6 + [1] * 5
    assert both.component_closed.tolist() == [True, False]


def test_boxes_that_share_an_edge_still_have_an_inside():
    pose = np.eye(4)
    pose[:2, 3] = 1.0
    both = Polyhedron.merged([box((1, 1, 1)), box((1, 1, 1)).transformed(pose)])
    assert both.closed and both.oriented and not both.manifold
    assert both.component_closed.tolist() == [True] and both.volume == 2.0


def test_outward_turns_what_is_inside_out_and_leaves_cavities():
    solid, hollow = box((3, 3, 3)), box((1, 1, 1)).flipped()
    cavity = Polyhedron.merged([solid, hollow])
    assert cavity.volume == 26.0 and cavity.outward() is cavity
    assert Polyhedron.merged([solid.flipped()]).outward().volume == 27.0
    pose = np.eye(4)
    pose[0, 3] = 9.0
    beside = Polyhedron.merged([solid, hollow.transformed(pose)])
    assert beside.volume == 26.0 and beside.outward().volume == 28.0


@examples(40)
@given(st.lists(st.floats(0.01, 100) | st.floats(-100, -0.01), min_size=3, max_size=3))
def test_scaling_keeps_the_outside_outside(factors):
    shape = box((1, 2, 3)).scaled(factors)
    assert shape.volume == pytest.approx(6 * abs(np.prod(factors)))
    round_one = sphere(0.1, tolerance=0.01)
    assert round_one.scaled(factors).excess >= round_one.excess * np.abs(factors).max()


@pytest.mark.parametrize("factor", [0, np.nan, np.inf, (1, 2), (1, 0, 1)])
def test_scaling_by_nonsense_is_refused(factor):
    with pytest.raises(BadDimension):
        box((1, 1, 1)).scaled(factor)


def test_a_solid_from_another_process_cannot_be_written_either():
    copy = pickle.loads(pickle.dumps(box((1.0, 2.0, 3.0))))
    assert copy.volume == 6.0
    with pytest.raises(ValueError, match="read-only"):
        copy.vertices[0, 0] = 7.0


def test_points_are_kept_once_and_in_order():
    cloud = PointCloud([[1, 0, 0], [0, 0, 0], [1, 0, 0], [-0.0, 0, 0], [0, 0, 1]], 0.1)
    assert cloud.vertices.tolist() == [[0, 0, 0], [0, 0, 1], [1, 0, 0]]
    assert cloud.n_points == 3
    assert cloud.bounds.tolist() == [[-0.1, -0.1, -0.1], [1.1, 0.1, 1.1]]
    assert (cloud.closed, cloud.volume, cloud.n_triangles) == (False, None, 0)


@pytest.mark.parametrize(
    ("points", "radius", "fault", "word"),
    [
        ([], 0.1, BadShape, "shape"),
        (np.empty((0, 3)), 0.1, EmptyMesh, "no points"),
        ([[0, 0, np.nan]], 0.1, NotFinite, "vertex 0"),
        ([[0, 0]], 0.1, BadShape, "(1, 2)"),
        ([[0, 0, 0]], 0.0, BadDimension, "radius is 0.0"),
        ([[0, 0, 0]], -1.0, BadDimension, "radius is -1.0"),
        ([[0, 0, 0]], float("nan"), BadDimension, "radius is nan"),
        ([[0, 0, 0]], "1", BadDimension, "radius is '1'"),
    ],
)
def test_what_is_no_cloud_is_refused(points, radius, fault, word):
    with pytest.raises(fault) as caught:
        PointCloud(points, radius)
    assert word in str(caught.value)


def test_a_cloud_is_never_taken_for_a_surface():
    with pytest.raises(BadShape, match="no faces"):
        PointCloud([[0, 0, 0]], 0.1).triangles()


def test_motion_and_scale_keep_the_radius():
    turned = np.eye(4)[[1, 0, 2, 3]] * [[1], [-1], [1], [1]]
    cloud = PointCloud([[1.0, 2.0, 3.0]], 0.1)
    assert cloud.transformed(turned).vertices.tolist() == [[2.0, -1.0, 3.0]]
    assert cloud.scaled([1.0, -1.0, 2.0]).vertices.tolist() == [[1.0, -2.0, 6.0]]
    assert {cloud.transformed(turned).ball_radius, cloud.scaled(0.5).ball_radius} == {0.1}


def test_the_box_of_all_holds_the_balls():
    points = np.random.default_rng(2).uniform(-1.0, 1.0, (200, 3))
    for cloud in (PointCloud(points, 0.3), PointCloud(points[:1], 0.3)):
        tree = surface_of(cloud)
        axes, half = tree.boxes[:9, 0].reshape(3, 3).astype(float), tree.boxes[9:12, 0]
        reach = np.abs((cloud.vertices - tree.centres[:3, 0]) @ axes.T).max(axis=0)
        assert (half >= reach + 0.3).all()


def test_groups_hang_together_by_their_balls():
    line = np.arange(6)[:, None] * [0.05, 0.0, 0.0]
    apart = np.concatenate([line, line + [0.0, 1.0, 0.0]])
    assert len(set(components_of(apart, 0.1).tolist())) == 2
    assert len(set(components_of(apart, 0.001).tolist())) == 12
    assert components_of(apart, 1e-9).tolist() == list(range(12))  # more cells than can be numbered


def test_no_group_holds_points_whose_balls_are_apart():
    """A group is joined by balls that touch: checked by joining all that do."""
    random = np.random.default_rng(5)
    for _ in range(20):
        points, radius = random.uniform(0.0, 1.0, (60, 3)), random.uniform(0.02, 0.2)
        touch = np.linalg.norm(points[:, None] - points, axis=2) <= 2.0 * radius
        for _ in range(6):
            touch = touch @ touch
        groups = components_of(points, radius)
        assert touch[groups[:, None] == groups].all()


def test_transforming_needs_a_rigid_motion():
    with pytest.raises(BadPose):
        box((1, 1, 1)).transformed(np.diag([1.0, 1, -1, 1]))
