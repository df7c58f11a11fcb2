"""Bodies, and one inside another, against rational arithmetic; the search against brute force, bit for bit."""

from fractions import Fraction

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from clearance import Polyhedron, distance
from clearance.geometry.tree import surface_of
from clearance.kernels.arithmetic.double_double import frames_of
from clearance.kernels.arithmetic.vec3 import rigid
from clearance.kernels.search.containment import contained
from clearance.kernels.search.scratch import new_scratch
from tests import oracle
from tests.examples import examples, first_fast
from tests.made_cases import at, torus
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


OCTAHEDRON = np.array(
    [[1, 0, 0], [-1, 0, 0], [0, 1, 0], [0, -1, 0], [0, 0, 1], [0, 0, -1]], dtype=float
)
OCTAHEDRON_FACES = [
    (0, 2, 4), (2, 1, 4), (1, 3, 4), (3, 0, 4), (2, 0, 5), (1, 2, 5), (3, 1, 5), (0, 3, 5),
]  # fmt: skip


def is_contained(a, b, pose_a, pose_b):
    return contained(a, 0, b, 0, frames_of(rigid(pose_a), rigid(pose_b)), new_scratch())[0]


def cube(half):
    return Polyhedron(CUBE_CORNERS * half, BOX_FACES)


@pytest.mark.parametrize("turn", first_fast(QUARTER_TURNS, 6))
def test_rays_through_corners_and_edges_are_no_special_case(turn):
    """Over an octahedron's tip all rays along an axis meet a corner, over its edges an edge."""
    outer, tiny = Polyhedron(4.0 * OCTAHEDRON, OCTAHEDRON_FACES), cube(0.125)
    for x, y, z in [
        (0.125, 0.125, 0.125),
        (1.125, 0.125, 0.125),
        (0.125, 0.125, 5.125),
        (0.125, 5.0, 0.125),
    ]:
        pose = at(*(turn @ (x, y, z)))
        near = distance(outer, tiny, pose_b=pose)
        sq = oracle.solid_distance_sq(
            4.0 * OCTAHEDRON, OCTAHEDRON_FACES, CUBE_CORNERS * 0.125, BOX_FACES, None, pose
        )
        assert near.contact == (sq == 0)
        assert (near.face_a == -1) == (max(x, y, z) < 5.0)


@given(poses(reach=1.0), poses(reach=1.0), st.sampled_from([1.0, 0.25, 0.01]), st.booleans())
@examples(60)
def test_any_poses_like_the_oracle(pose_a, pose_b, size, swapped):
    shapes = [(CUBE_CORNERS, BOX_FACES), (CUBE_CORNERS * 0.3 * size, BOX_FACES)]
    if swapped:
        shapes.reverse()
    near = distance(*(Polyhedron(*s) for s in shapes), pose_a=pose_a, pose_b=pose_b)
    sq = oracle.solid_distance_sq(*shapes[0], *shapes[1], pose_a, pose_b)
    assert near.contact == (sq == 0)
    assert oracle.error(near.distance, sq) <= Fraction(near.error_bound)


def test_both_poses_are_taken_exactly():
    """Far from the origin the motion between the bodies is not a float; `contained` does not round it."""
    random = np.random.default_rng(31)
    a, b = surface_of(cube(1.0)), surface_of(cube(2.0**-60))
    for _ in range(60):
        pose_a, pose_b = np.eye(4), np.eye(4)
        pose_a[:3, :3] = rotations(random, 1)[0]
        pose_a[:3, 3] = random.normal(size=3)
        face_point = np.array([1.0, *random.uniform(-0.9, 0.9, 2)])
        pose_b[:3, 3] = pose_a[:3, :3] @ face_point + pose_a[:3, 3]
        if (
            oracle.polyhedron_distance_sq(
                CUBE_CORNERS, BOX_FACES, CUBE_CORNERS * 2.0**-60, BOX_FACES, pose_a, pose_b
            )
            == 0
        ):
            continue
        found = is_contained(a, b, pose_a, pose_b)
        corner = [pose_b[:3, 3].tolist()[k] for k in range(3)]
        assert found == oracle.contains(
            [Fraction(x) + Fraction(2) ** -60 for x in corner], CUBE_CORNERS, BOX_FACES, pose_a
        )


@pytest.mark.slow
def test_rays_through_many_faces_like_the_oracle():
    """A ray looks only into the boxes of the tree that it may meet; a ring is met up to four times."""
    random = np.random.default_rng(32)
    ring = torus(1.0, 0.4, 14, 7)
    faces = ring.face_vertices.reshape(-1, 3).tolist()
    n_inside = 0
    for _ in range(60):
        pose_a, pose_b = np.eye(4), np.eye(4)
        pose_a[:3, :3] = rotations(random, 1)[0]
        pose_a[:3, 3] = random.normal(size=3)
        x = random.uniform((-1.4, -1.4, -0.4), (1.4, 1.4, 0.4))
        pose_b[:3, 3] = pose_a[:3, :3] @ x + pose_a[:3, 3]
        near = distance(ring, cube(2.0**-20), pose_a=pose_a, pose_b=pose_b)
        corner = [Fraction(x) + Fraction(2) ** -20 for x in pose_b[:3, 3].tolist()]
        assert near.contact == oracle.contains(corner, ring.vertices, faces, pose_a)
        n_inside += near.contact
    assert 10 < n_inside < 50
