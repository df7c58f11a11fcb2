"""What an overlap means, depth and volume: closed forms, fractions, promises that a distance query can break."""

from __future__ import annotations

import sys

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import clearance as cl
from clearance.geometry import boolean, decompose
from clearance.geometry.boolean import ClosedMesh
from clearance.geometry.convex_parts import convex_parts
from clearance.query.contact import BodyPair
from clearance.query.contact_bounds import bounded_contact
from clearance.query.penetration import ConvexCorners, depths_at_most, penetration
from clearance.query.region_bounds import ball_depth, thickness, ways_through
from tests.made_cases import l_prism
from tests.oracle.depths import squared_depth
from tests.simulate.answers.test_contact_modes import channel

BOX = cl.box((1.0, 1.0, 1.0))
WITH_LIBRARIES = pytest.mark.skipif(
    not (boolean.available() and decompose.available()), reason="extra 'contact' is not installed"
)


def at(x=0.0, y=0.0, z=0.0, turn=0.0):
    """A pose: a turn about z [rad], then a shift [m]."""
    pose = np.eye(4)
    pose[:2, :2] = [[np.cos(turn), -np.sin(turn)], [np.sin(turn), np.cos(turn)]]
    pose[:3, 3] = x, y, z
    return pose


def is_what_it_says(a, b, pose_a, pose_b, found):
    """The translation parts the bodies; one shorter than the lower bound does not, in this direction."""

    def after(length):
        moved = pose_a.copy()
        moved[:3, 3] += length * found.direction
        return cl.distance(a, b, pose_a=moved, pose_b=pose_b)

    assert np.linalg.norm(found.direction) == pytest.approx(1.0, abs=1e-12)
    assert 0.0 <= found.penetration_at_least <= found.penetration
    assert 0.0 <= found.volume_at_least <= found.volume
    assert after(found.penetration * (1 + 1e-9) + 1e-12).distance > 0.0
    assert after(0.999 * found.penetration_at_least - 1e-12).contact


def test_boxes_that_overlap_by_d():
    pose = at(0.9, 0.1, 0.2)
    found = cl.contact(BOX, BOX, pose_a=pose)
    assert found.penetration == pytest.approx(0.1, rel=1e-13)
    assert found.direction.tolist() == [1.0, 0.0, 0.0]
    assert found.volume == pytest.approx(0.1 * 0.9 * 0.8, rel=1e-13)
    assert found.centroid == pytest.approx([0.45, 0.05, 0.1], rel=1e-13)
    assert found.region.volume == pytest.approx(found.volume, rel=1e-13)
    assert found.exact == (True, True) and found.notes == ()
    is_what_it_says(BOX, BOX, pose, np.eye(4), found)


def test_the_answer_moves_with_the_bodies():
    world = at(3.0, -2.0, 1.0, turn=0.7)
    here = cl.contact(BOX, BOX, pose_a=at(0.9, 0.1, 0.2))
    there = cl.contact(BOX, BOX, pose_a=world @ at(0.9, 0.1, 0.2), pose_b=world)
    assert there.penetration == pytest.approx(here.penetration, abs=1e-14)
    assert there.volume == pytest.approx(here.volume, rel=1e-13)
    assert there.direction == pytest.approx(world[:3, :3] @ here.direction, abs=1e-14)
    assert there.centroid == pytest.approx((world @ [*here.centroid, 1.0])[:3], abs=1e-14)


@pytest.mark.parametrize("shift", [(1.0, 0.1, 0.2), (1.0, 1.0, 0.2), (1.0, 1.0, 1.0)])
def test_touching_is_0_deep_with_a_volume_of_exactly_0(shift):
    found = cl.contact(BOX, BOX, pose_a=at(*shift))
    assert (found.penetration, found.volume) == (0.0, 0.0)
    assert found.region.is_empty and np.isfinite(found.centroid).all()
    assert cl.contact(BOX, BOX, pose_a=at(*shift) + 1e-9 * np.eye(4, k=3)) is None


def test_facets_are_reported_and_bound_both_figures():
    rod = cl.cylinder(0.1, 0.5)
    found = cl.contact(rod, BOX, pose_a=at(0.55, 0.1, 0.2))
    true_volume = 0.5 * (0.1**2 * np.arccos(0.5) - 0.05 * np.sqrt(0.1**2 - 0.05**2))
    assert found.penetration_at_least <= 0.05 <= found.penetration
    assert found.penetration - found.penetration_at_least < 3e-4
    assert found.volume_at_least <= true_volume <= found.volume
    assert found.exact == (False, False) and "facets" in found.notes[0]


@WITH_LIBRARIES
@pytest.mark.cold
def test_a_concave_body_is_left_by_its_hollow():
    """A box in the corner of an L leaves through the hollow, not through the hull."""
    body, peg = l_prism(), cl.box((0.4, 0.4, 0.4))
    pose = at(1.1, 2.0, 0.5)  # 0.1 of it in the stem, the rest in the hollow
    found = cl.contact(peg, body, pose_a=pose)
    assert found.volume == pytest.approx(0.1 * 0.4 * 0.4, rel=1e-9)
    assert 0.1 <= found.penetration < 0.1002
    assert found.penetration_at_least == pytest.approx(
        0.1, rel=1e-9
    )  # the region is convex, 0.1 wide
    assert found.direction == pytest.approx([1.0, 0.0, 0.0], abs=1e-6)
    assert not found.exact[0]
    is_what_it_says(peg, body, pose, np.eye(4), found)
    rough = cl.contact(peg, body, pose_a=pose, bounded=False)
    assert (rough.penetration, rough.penetration_at_least) == (found.penetration, 0.0)
    assert np.array_equal(rough.direction, found.direction)


def merged(*boxes):
    """One surface of axis-parallel boxes (low, high); those whose third item is True are cavities."""
    parts = []
    for low, high, *hollow in boxes:
        low, high = np.array(low), np.array(high)
        box = cl.box(tuple(high - low))
        moved = box.transformed(at(*(low + high) / 2.0))
        parts.append(moved.flipped() if hollow else moved)
    return cl.Polyhedron.merged(parts)


POST, BEAM = ((-1, -1, -3), (1, 1, 3)), ((-3, -1, -1), (3, 1, 1))


@WITH_LIBRARIES
@pytest.mark.parametrize(
    "boxes, volume",
    [
        ([POST, BEAM], 40.0),
        ([POST, BEAM, ((-0.5, -0.5, -0.5), (0.5, 0.5, 0.5), True)], 40.0),  # the other one fills it
        ([POST, BEAM, ((-0.5, -0.5, 1.5), (0.5, 0.5, 2.5), True)], 39.0),
        ([POST, POST], 24.0),
        ([POST, ((-1, -1, -1), (1, 1, 5))], 32.0),
        ([POST, ((-0.5, -0.5, -0.5), (0.5, 0.5, 0.5))], 24.0),
    ],
)
def test_what_two_components_fill_counts_once(boxes, volume):
    found = cl.contact(merged(*boxes), cl.box((20.0, 20.0, 20.0)), rough=True)
    assert found.volume == pytest.approx(volume, rel=1e-12)
    assert found.volume_at_least == pytest.approx(volume, rel=1e-12)


@pytest.mark.parametrize("thin", [1e-13, 1e-10])
def test_a_sheet_of_overlap_has_a_volume_of_its_area_times_its_depth(thin):
    pose = at(1.0 - thin)
    found = cl.contact(BOX, BOX, pose_a=pose)
    assert found.volume == pytest.approx(1.0 - pose[0, 3], abs=3e-16)
    assert found.penetration == pytest.approx(1.0 - pose[0, 3], abs=3e-16)


def test_a_surface_without_an_inside_is_bounded_not_invented():
    opened = cl.Polyhedron(BOX.vertices, [BOX.face_vertices[4 * i : 4 * i + 4] for i in range(5)])
    found = cl.contact(opened, BOX, pose_a=at(0.9))
    assert found.penetration == pytest.approx(0.1, rel=1e-12) and found.penetration_at_least == 0.0
    assert found.volume == pytest.approx(0.1, rel=1e-12) and found.volume_at_least == 0.0
    assert found.exact == (False, False) and "not closed" in " ".join(found.notes)


def test_without_the_libraries_depth_and_volume_are_bounds(monkeypatch):
    monkeypatch.setattr(decompose, "available", lambda: False)
    monkeypatch.setitem(sys.modules, "manifold3d", None)
    monkeypatch.setattr(boolean, "available", lambda: False)
    peg, pose = cl.box((0.4, 0.4, 0.4)), at(1.1, 2.0, 0.5)
    found = cl.contact(peg, l_prism(), pose_a=pose)
    assert found.penetration >= 0.1 - 1e-12 and found.volume >= 0.016 - 1e-12
    assert found.volume_at_least == 0.0 and not any(found.exact)
    assert "clearance[contact]" in " ".join(found.notes)
    is_what_it_says(peg, l_prism(), pose, np.eye(4), found)


def test_a_flat_body_has_no_depth_and_says_so():
    sheet = cl.Polyhedron(
        np.array([[-1.0, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0]]), [[0, 1, 2, 3]]
    )
    with pytest.raises(cl.BadInput, match="no depth"):
        cl.contact(sheet, BOX)


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


@pytest.mark.parametrize("deep", [1.0, 1e-3, 1e-9, 1e-12])
def test_a_box_pushed_into_a_box_by_d_is_d_deep(deep):
    a = cl.Polytope.from_polyhedron(cl.box((4.0, 4.0, 4.0)))
    b = cl.Polytope(a.vertices + [4.0 - deep, 0.25, -0.5])
    found = penetration(a, b)
    assert found.depth == pytest.approx(deep, abs=1e-15)
    assert found.direction.tolist() == [-1.0, 0.0, 0.0]


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
