"""The numpy parts that decide what the peer may skip and what lies where."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from clearance.crosscheck.containment import is_inside, winding_number
from clearance.crosscheck.peer_run import (
    PeerRun,
    greatest_displacements,
    lower_bound_boxes,
    world_boxes,
)
from clearance.crosscheck.triangles import triangle_soup
from clearance.geometry.point_cloud import PointCloud
from clearance.geometry.polyhedron import Polyhedron
from clearance.query.distance import distance
from tests.crosscheck.sliding import box, rail_record
from tests.made_cases import ball, faces_of

pytestmark = pytest.mark.peer


def random_poses(rng: np.random.Generator, n: int) -> np.ndarray:
    poses = np.tile(np.eye(4), (n, 1, 1))
    poses[:, :3, :3] = Rotation.random(n, random_state=rng).as_matrix()
    poses[:, :3, 3] = rng.normal(size=(n, 3))
    return poses


def test_inside_is_what_a_box_says():
    rng = np.random.default_rng(7)
    points = rng.uniform(-2, 2, size=(500, 3))
    expected = (np.abs(points) < [0.5, 1.0, 1.5]).all(axis=1)
    soup = triangle_soup(box(1.0, 2.0, 3.0))
    assert expected.any() and np.array_equal(is_inside(soup, points), expected)
    numbers = winding_number(soup.corners, points)
    assert np.allclose(numbers, np.round(numbers), atol=1e-12)


def test_a_cavity_is_outside():
    outer, inner = box(2, 2, 2), box(1, 1, 1)
    shell = Polyhedron(
        np.vstack([outer.vertices, inner.vertices]),
        [
            *outer.face_vertices.reshape(-1, 4),
            *(inner.face_vertices.reshape(-1, 4)[:, ::-1] + 8),
        ],
    )
    points = np.array([[0.0, 0.0, 0.0], [0.75, 0.0, 0.0], [1.5, 0.0, 0.0]])
    assert is_inside(triangle_soup(shell), points).tolist() == [False, True, False]


def test_before_a_hole_the_peer_says_inside_where_the_package_says_contact():
    """By the faces alone, which are there on three quarters of all sides, or are not."""
    whole = ball(1.0, 2)
    outer = Polyhedron(whole.vertices, faces_of(whole)[2:])
    points = whole.centres[:2].mean(axis=0) + np.random.default_rng(5).normal(
        scale=0.1, size=(200, 3)
    )
    found = is_inside(triangle_soup(outer), points)
    ours = [distance(outer, PointCloud([point], 1e-9)).inside == "yes" for point in points]
    assert 20 < found.sum() < 180 and found.tolist() == ours


def test_bounds_never_exceed_what_samples_show():
    rng = np.random.default_rng(3)
    soup = triangle_soup(box(1.0, 0.1, 0.4))
    poses = random_poses(rng, 40)
    samples = rng.uniform(*soup.bounds, size=(200, 3))
    world = samples @ poses[:, :3, :3].transpose(0, 2, 1) + poses[:, None, :3, 3]
    moved = np.linalg.norm(np.diff(world, axis=0), axis=2).max(axis=1)
    bound = greatest_displacements(soup.bounds, poses)
    assert (bound >= moved).all() and (bound < 1.5 * moved).all()
    fixed = np.array([[-0.2, -0.3, -0.1], [0.1, 0.2, 0.3]])
    nearest = np.clip(world, *fixed)
    gaps = np.linalg.norm(world - nearest, axis=2).min(axis=1)
    assert (lower_bound_boxes(world_boxes(soup.bounds, poses), fixed) <= gaps).all()


def test_skipping_changes_no_answer():
    """All pairs asked at every step give what the sorted, bounded search gives, with far fewer
    queries.
    """
    rng = np.random.default_rng(11)
    obstacles = {
        f"o{i}": (box(*rng.uniform(0.1, 0.5, 3)), tuple(rng.uniform(-3, 3, 3))) for i in range(12)
    }
    positions = np.cumsum(rng.uniform(-0.2, 0.25, 60)).tolist()
    rows = [(0.0, "o0", (0, 0, 0), (0, 0, 0))] * 60
    run = PeerRun(rail_record(box(0.3, 0.2, 0.1), obstacles, positions, rows))
    answers = run.measure()
    poses = run.poses(0, 60)
    for step in range(60):
        run.pairs[0].link.peer.place(poses[0, step])
        every = [pair.link.peer.distance(pair.other.peer) for pair in run.pairs]
        assert answers.clearances[step] == min(every)
    assert answers.n_queries < 60 * 12 / 2
