"""Bodies against rational arithmetic, and the search against brute force, bit for bit."""

from fractions import Fraction

import numpy as np
import pytest
from hypothesis import given

from clearance import Polyhedron, distance
from clearance.geometry.shapes import sphere
from tests import oracle
from tests.examples import examples
from tests.strategies import BOX_FACES, CUBE_CORNERS, QUARTER_TURNS, boxes, poses, rotations


def pose_of(random, reach):
    pose = np.eye(4)
    pose[:3, :3] = rotations(random, 1)[0]
    pose[:3, 3] = random.normal(size=3) * reach
    return pose


@given(boxes(), boxes(), poses(), poses())
@examples(60)
def test_boxes_like_the_oracle(a, b, pose_a, pose_b):
    near = distance(Polyhedron(*a), Polyhedron(*b), pose_a=pose_a, pose_b=pose_b)
    sq = oracle.solid_distance_sq(*a, *b, pose_a, pose_b)
    assert near.contact == (sq == 0)
    assert oracle.error(near.distance, sq) <= Fraction(near.error_bound)
    assert near.error_bound <= 1e-14 * (1.0 + near.distance)
    gap = np.linalg.norm(near.point_a - near.point_b)
    assert abs(gap - near.distance) <= 16 * np.spacing(np.abs([pose_a, pose_b]).max() + 4.0)


@pytest.mark.parametrize("gap", [0.0, 2.0**-51, 2.0**-40, 2.0**-20])
@pytest.mark.parametrize("turn", QUARTER_TURNS[::5])
def test_touching_is_decided_by_one_bit(gap, turn):
    corners = np.array([[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)], dtype=float)
    cube = Polyhedron(corners, BOX_FACES)
    pose = np.eye(4)
    pose[:3, :3] = turn
    pose[:3, 3] = [1.0 + gap, 0.25, 0.25] - (turn @ corners.T).min(axis=1)
    near = distance(cube, cube, pose_b=pose)
    assert near.contact == (gap == 0.0)
    assert near.distance == gap


def test_rotations_off_by_what_is_allowed_are_taken_as_given():
    """The truth is the distance of R v + t with the R given, orthonormal or not."""
    random = np.random.default_rng(11)
    cube = Polyhedron(CUBE_CORNERS, BOX_FACES)
    for _ in range(20):
        pose_a, pose_b = pose_of(random, 0.0), pose_of(random, 3.0)
        pose_a[:3, :3] *= 1.0 + 2e-7
        pose_b[:3, :3] += random.uniform(-1e-7, 1e-7, (3, 3))
        near = distance(cube, cube, pose_a=pose_a, pose_b=pose_b)
        sq = oracle.solid_distance_sq(
            CUBE_CORNERS, BOX_FACES, CUBE_CORNERS, BOX_FACES, pose_a, pose_b
        )
        assert near.contact == (sq == 0)
        assert oracle.error(near.distance, sq) <= Fraction(near.error_bound)


def test_far_from_the_origin_nothing_is_lost():
    random = np.random.default_rng(12)
    cube = Polyhedron(CUBE_CORNERS, BOX_FACES)
    for _ in range(20):
        pose_a, pose_b = pose_of(random, 1e8), pose_of(random, 2.0)
        pose_b[:3, 3] += pose_a[:3, 3]
        near = distance(cube, cube, pose_a=pose_a, pose_b=pose_b)
        sq = oracle.solid_distance_sq(
            CUBE_CORNERS, BOX_FACES, CUBE_CORNERS, BOX_FACES, pose_a, pose_b
        )
        assert near.contact == (sq == 0)
        assert oracle.error(near.distance, sq) <= Fraction(2) ** -52 * oracle.root(sq)


@pytest.mark.slow
def test_tree_and_brute_force_agree_bit_for_bit():
    """Each face alone as a body, so that nothing is pruned; least faces first."""
    random = np.random.default_rng(13)
    a, b = sphere(0.5, tolerance=0.06), sphere(0.3, tolerance=0.04)
    faces_a = [Polyhedron(a.face(i), [range(len(a.face(i)))]) for i in range(a.n_faces)]
    faces_b = [Polyhedron(b.face(i), [range(len(b.face(i)))]) for i in range(b.n_faces)]
    for _ in range(1):
        pose = pose_of(random, 0.0)
        pose[:3, 3] = random.normal(size=3)
        pose[:3, 3] *= 1.2 / np.linalg.norm(pose[:3, 3])
        near = distance(a, b, pose_b=pose)
        every = [
            (distance(one, other, pose_b=pose).distance, i, j)
            for i, one in enumerate(faces_a)
            for j, other in enumerate(faces_b)
        ]
        assert (near.distance, near.face_a, near.face_b) == min(every)
