"""Depth: of convex bodies against fractions and closed forms, of others by their shared region alone."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import clearance as cl
from clearance.geometry import boolean
from clearance.geometry.boolean import ClosedMesh
from clearance.geometry.convex_parts import convex_parts
from clearance.geometry.envelope import envelope
from clearance.query.contact import BodyPair
from clearance.query.contact_bounds import bounded_contact
from clearance.query.penetration import ConvexCorners, depths_at_most, penetration
from clearance.query.region_bounds import ball_depth, thickness, ways_through
from tests.oracle.depths import squared_depth
from tests.simulate.answers.test_contact_modes import channel


def lattice_body(random, n, reach):
    while True:
        points = random.integers(-reach, reach + 1, (n, 3))
        try:
            return points, cl.Polytope(points.astype(float))
        except cl.ClearanceError:
            continue


def test_depth_is_that_of_fractions():
    random = np.random.default_rng(7)
    n_deep = 0
    for _ in range(40):
        p, a = lattice_body(random, 6, 4)
        q, b = lattice_body(random, 6, 4)
        exact = (
            float(squared_depth([tuple(map(int, r)) for r in p], [tuple(map(int, r)) for r in q]))
            ** 0.5
        )
        found = penetration(a, b)
        assert found.depth == pytest.approx(exact, rel=1e-14, abs=1e-14)
        assert found.at_least == pytest.approx(exact, rel=1e-14, abs=1e-14)
        n_deep += exact > 0.0
    assert n_deep > 20


def ball(n, random, centre=(0.0, 0.0, 0.0), radius=1.0):
    points = random.normal(size=(n, 3))
    return cl.Polytope(radius * points / np.linalg.norm(points, axis=1)[:, None] + centre)


def test_balls_of_many_corners_part_by_the_sum_of_their_radii():
    random = np.random.default_rng(5)
    found = penetration(ball(3000, random), ball(3000, random, (1.2, 0.5, 0.0), 0.6))
    assert found.depth == pytest.approx(1.6 - 1.3, abs=4e-3)
    assert found.depth < 0.3 and found.depth - found.at_least < 1e-13
    assert found.rounds < 20
    assert found.direction @ [-12 / 13, -5 / 13, 0.0] > 0.99


@pytest.mark.parametrize("deep", [1.0, 1e-3, 1e-9, 1e-12])
def test_a_box_pushed_into_a_box_by_d_is_d_deep(deep):
    a = cl.Polytope.from_polyhedron(cl.box((4.0, 4.0, 4.0)))
    b = cl.Polytope(a.vertices + [4.0 - deep, 0.25, -0.5])
    found = penetration(a, b)
    assert found.depth == pytest.approx(deep, abs=1e-15)
    assert found.direction.tolist() == [-1.0, 0.0, 0.0]


def test_needles_and_sheets_have_their_depth():
    needle = cl.Polytope.from_polyhedron(cl.box((1e-6, 1e-6, 2.0)))
    sheet = cl.Polytope.from_polyhedron(cl.box((2.0, 2.0, 1e-7)))
    assert penetration(needle, sheet).depth == pytest.approx(1.0 + 5e-7 - 1e-6 * 0.45, rel=2e-6)
    assert penetration(needle, needle).depth == pytest.approx(1e-6, rel=1e-9)


def test_bounds_by_26_directions_are_never_below_the_depth():
    random = np.random.default_rng(9)
    hulls = [cl.Polytope(random.normal(size=(12, 3)) + random.normal(size=3)) for _ in range(10)]
    bodies = [ConvexCorners(hull.vertices, hull.normals) for hull in hulls]
    bounds = depths_at_most(bodies[:5], bodies[5:])
    depths = np.array([[penetration(a, b).depth for b in bodies[5:]] for a in bodies[:5]])
    assert (bounds >= depths * (1.0 - 1e-12)).all()
    assert (depths > 0.1).sum() > 5 and (bounds == 0.0).any()
    cubes = [cl.Polytope(cl.box((1.0, 1.0, 1.0)).vertices + [x, 0.0, 0.0]) for x in (0.0, 0.75)]
    placed = [ConvexCorners(cube.vertices, cube.normals) for cube in cubes]
    assert depths_at_most(placed, placed).tolist() == [[1.0, 0.25], [0.25, 1.0]]
    assert depths_at_most([], bodies).shape == (0, 10)


needs_manifold = pytest.mark.skipif(not boolean.available(), reason="manifold3d is not installed")


def mesh_of(body, shift=(0.0, 0.0, 0.0)):
    return ClosedMesh(body.vertices + shift, body.triangles())


def corners_of(body):
    return body.vertices[body.triangles()]


def posed(seed, reach):
    random = np.random.default_rng(seed)
    pose = np.eye(4)
    pose[:3, :3] = Rotation.random(random_state=seed).as_matrix()
    pose[:3, 3] = reach * random.uniform(-1.0, 1.0, 3)
    return pose


def test_a_slab_shared_by_two_large_boxes_is_half_a_ball_of_each():
    """Boxes of 1 m that share 0.1 m: a ball about the middle reaches 0.05 in both."""
    slab, shift = cl.box((0.1, 1.0, 1.0)), np.array([0.45, 0.0, 0.0])
    bodies = [corners_of(cl.box((1.0, 1.0, 1.0))) + [[x, 0.0, 0.0]] for x in (0.0, 0.9)]
    found = ball_depth(mesh_of(slab, shift), bodies, 0.0)
    assert found == pytest.approx(0.1, rel=1e-8) and found <= 0.1
    assert ball_depth(mesh_of(slab, shift), bodies, 0.03) == pytest.approx(0.07, rel=1e-8)


def test_the_thinnest_way_comes_first_and_pieces_count_by_themselves():
    ways = ways_through(mesh_of(cl.box((0.1, 0.3, 0.2))))
    assert ways[0].length == pytest.approx(0.1) and abs(ways[0].direction[0]) == pytest.approx(1.0)
    one, other = mesh_of(cl.box((0.1, 0.3, 0.2))), mesh_of(cl.box((0.2, 0.1, 0.1)), (5.0, 0.0, 0.0))
    both = ClosedMesh(
        np.concatenate([one.vertices, other.vertices]),
        np.concatenate([one.triangles, other.triangles + len(one.vertices)]),
    )
    assert thickness(both, np.eye(3)) == pytest.approx([0.2, 0.3, 0.2])


@needs_manifold
@pytest.mark.parametrize("seed", range(4))
@pytest.mark.cold
def test_rough_bounds_hold_those_of_cut_bodies_apart(seed):
    """Both enclose the same depth, so that neither's lower bound is above the other's upper one."""
    a, b, pose = channel(), channel(), posed(seed, 0.5)
    near = cl.distance(a, b, pose_a=pose)
    if not near.contact:
        pytest.skip("apart")
    rough, fine = (
        BodyPair(a, b, *(convex_parts(body, rough=is_rough) for body in (a, b))).contact(
            pose, near.point_b
        )
        for is_rough in (True, False)
    )
    assert rough.penetration_at_least <= fine.penetration * (1.0 + 1e-9)
    assert fine.penetration_at_least <= rough.penetration * (1.0 + 1e-9)
    assert 0.0 < rough.penetration_at_least <= rough.penetration
    assert rough.volume == pytest.approx(fine.volume, rel=1e-9)
    moved = pose.copy()
    moved[:3, 3] += rough.penetration * (1.0 + 1e-9) * rough.direction
    assert cl.distance(a, b, pose_a=moved).distance > 0.0


@pytest.mark.parametrize("seed", range(2))
def test_an_envelope_holds_its_points(seed):
    points = np.random.default_rng(seed).normal(size=(300, 3)) * [1.0, 0.3, 0.01] + [
        10.0,
        0.0,
        -5.0,
    ]
    rows = envelope(points).half_spaces
    assert (points @ rows[:, :3].T + rows[:, 3]).max() <= 1e-11


@pytest.mark.parametrize("seed", range(5))
def test_bounds_alone_are_bounds(seed):
    a, b, pose = cl.box((0.3, 0.2, 0.5)), cl.box((1.0, 0.4, 0.6)), posed(seed, 0.2)
    near = cl.distance(a, b, pose_a=pose)
    assert near.contact
    truth, reported = (
        cl.contact(a, b, pose_a=pose),
        bounded_contact(a, b, pose, near.point_b, "why"),
    )
    assert reported.penetration_at_least <= truth.penetration <= reported.penetration
    assert reported.volume_at_least <= truth.volume <= reported.volume
    moved = pose.copy()
    moved[:3, 3] += reported.penetration * (1.0 + 1e-9) * reported.direction
    assert cl.distance(a, b, pose_a=moved).distance > 0.0
