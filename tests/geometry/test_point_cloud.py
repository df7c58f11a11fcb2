"""Clouds of points as bodies: what is kept of what is given, what is refused, and which points hang together."""

import numpy as np
import pytest

from clearance import PointCloud
from clearance.errors import BadDimension, BadShape, EmptyMesh, NotFinite
from clearance.geometry.point_cloud import components_of
from clearance.geometry.tree import surface_of


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
