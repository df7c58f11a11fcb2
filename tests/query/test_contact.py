"""What an overlap means: closed forms, and promises that a distance query can break."""

import sys

import numpy as np
import pytest

import clearance as cl
from clearance.geometry import boolean, decompose
from tests.made_cases import l_prism

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


def test_containment_is_contact_with_the_full_volume():
    small = cl.box((0.2, 0.2, 0.2))
    found = cl.contact(small, BOX, pose_a=at(0.1, 0.1, 0.2))
    assert found.volume == pytest.approx(0.008, rel=1e-13)
    assert found.penetration == pytest.approx(0.4, rel=1e-13)  # 0.3 to the lid, 0.1 of its own half
    assert found.direction.tolist() == [0.0, 0.0, 1.0]
    around = cl.contact(BOX, small, pose_b=at(0.1, 0.1, 0.2))
    assert around.volume == pytest.approx(0.008, rel=1e-13)
    assert around.direction.tolist() == [0.0, 0.0, -1.0]


@pytest.mark.parametrize("shift", [(1.0, 0.1, 0.2), (1.0, 1.0, 0.2), (1.0, 1.0, 1.0)])
def test_touching_is_0_deep_with_a_volume_of_exactly_0(shift):
    found = cl.contact(BOX, BOX, pose_a=at(*shift))
    assert (found.penetration, found.volume) == (0.0, 0.0)
    assert found.region.is_empty and np.isfinite(found.centroid).all()


def test_apart_is_nothing():
    assert cl.contact(BOX, BOX, pose_a=at(1.0 + 1e-9)) is None


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


@WITH_LIBRARIES
@pytest.mark.cold
def test_two_concave_bodies_keep_every_promise():
    random = np.random.default_rng(11)
    body = l_prism()
    for _ in range(3):
        pose = at(*random.uniform(-0.8, 0.8, 3), turn=random.uniform(0, 6))
        found = cl.contact(body, body, pose_a=pose)
        is_what_it_says(body, body, pose, np.eye(4), found)


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
