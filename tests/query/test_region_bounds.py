"""Depth by the shared region alone: never below what is proven, never above what the bodies confirm."""

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
from clearance.query.region_bounds import ball_depth, thickness, ways_through
from tests.simulate.answers.test_contact_modes import channel

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


@pytest.mark.parametrize("seed", range(5))
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
