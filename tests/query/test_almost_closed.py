"""Bodies inside surfaces that are closed but for a few faults: decided where it is proven, else open."""

from __future__ import annotations

from fractions import Fraction

import numpy as np
import pytest
import trimesh
from scipy.spatial import ConvexHull

from clearance import Polyhedron, Query, box, contact, distance
from clearance.crosscheck.triangles import triangle_soup, winding_number
from clearance.errors import BadInput
from clearance.geometry.closing import FEW, SOME, closing_of
from tests import oracle
from tests.made_cases import at, ball, dented, faces_of
from tests.strategies import rotations

BALL = ball(1.0, 2)
CUBE = box((0.1, 0.1, 0.1))


def faulty(shape: Polyhedron, fault: str, face: int) -> Polyhedron:
    faces = faces_of(shape)
    other = {
        "twice": [*faces, faces[face]],
        "twice, from another corner on": [*faces, np.roll(faces[face], 1).tolist()],
        "missing": faces[:face] + faces[face + 1 :],
        "turned": [*faces[:face], faces[face][::-1], *faces[face + 1 :]],
        "every third turned": [f[::-1] if i % 3 == 0 else f for i, f in enumerate(faces)],
        "every third twice": faces + faces[::3],
    }
    return Polyhedron(shape.vertices, other[fault])


FAULTS = (
    "twice",
    "twice, from another corner on",
    "missing",
    "turned",
    "every third turned",
    "every third twice",
)


@pytest.mark.parametrize("fault", FAULTS)
@pytest.mark.slow
def test_the_answers_are_those_of_the_whole_solid_by_the_oracle(fault: str) -> None:
    """Of rough solids at random poses: contact only inside, none outside, open only beside a hole."""
    random = np.random.default_rng(FAULTS.index(fault))
    tiny = box((2.0**-12,) * 3)
    n_inside = n_open = 0
    for turn in rotations(random, 30):
        whole = dented(random, 2, 0.3)
        outer = faulty(whole, fault, int(random.integers(whole.n_faces)))
        pose_a = at(*random.normal(size=3), turned=turn)
        pose_b = at(*(pose_a[:3, :3] @ random.normal(scale=0.6, size=3) + pose_a[:3, 3]))
        near = distance(outer, tiny, pose_a=pose_a, pose_b=pose_b)
        corner = [Fraction(x) + Fraction(2) ** -13 for x in pose_b[:3, 3].tolist()]
        truth = oracle.contains(corner, whole.vertices, faces_of(whole), pose_a)
        n_inside += truth
        n_open += near.inside == "undecided"
        if near.inside != "undecided":
            assert near.contact == truth
    assert 7 < n_inside < 28 and n_open <= 3


def test_what_is_in_the_hole_is_undecided_by_name() -> None:
    outer = faulty(BALL, "missing", 37)
    middle = BALL.face(37).mean(axis=0)
    for share, expected in ((0.6, "yes"), (0.98, "undecided"), (1.0, "undecided"), (1.3, "no")):
        near = distance(outer, box((0.01, 0.01, 0.01)), pose_b=at(*(share * middle)))
        assert (near.inside, near.contact) == (expected, expected == "yes"), share
    with pytest.raises(BadInput, match="open whether one body is inside the other"):
        contact(outer, box((0.01, 0.01, 0.01)), pose_b=at(*(0.98 * middle)))
    many = Query(outer, box((0.01, 0.01, 0.01))).distances(
        None, [at(*(s * middle)) for s in (0.6, 0.98, 1.3)]
    )
    assert (
        many.undecided.tolist() == [False, True, False]
        and many.distances[1] > 0.0 == many.distances[0]
    )


def test_a_rod_through_the_hole_is_never_said_to_be_outside() -> None:
    """Which of its corners is asked first decides between contact and open."""
    outer = faulty(BALL, "missing", 37)
    middle = BALL.face(37).mean(axis=0)
    z = middle / np.linalg.norm(middle)
    x = np.cross(z, [1.0, 0, 0])
    x /= np.linalg.norm(x)
    turn = np.column_stack([x, np.cross(z, x), z])
    rod = box((0.01, 0.01, 1.0))
    ways = [
        distance(outer, rod, pose_b=at(*middle, turned=turn * way))
        for way in ([1, 1, 1], [1, -1, -1])
    ]
    assert sorted(near.inside for near in ways) == ["undecided", "yes"]


def test_larger_holes_leave_it_open_and_sheets_hold_nothing() -> None:
    some = Polyhedron(BALL.vertices, faces_of(BALL)[:-10])
    assert closing_of(some) is None and closing_of(some, FEW, SOME) is not None
    near = distance(some, CUBE, pose_b=at(0.1, 0.0, 0.0))
    assert (near.contact, near.inside) == (False, "undecided")
    for n_faces in (160, 250):
        bowl = Polyhedron(BALL.vertices, faces_of(BALL)[:n_faces])
        assert distance(bowl, CUBE, pose_b=at(0.1, 0.0, 0.0)).inside == "no"
    lidless = Polyhedron(box((1.0, 1.0, 1.0)).vertices, faces_of(box((1.0, 1.0, 1.0)))[1:])
    for sheet in (lidless, two_sided(lidless), two_sided(bowl)):
        assert distance(sheet, CUBE).inside == "no"


@pytest.mark.parametrize("n_missing", [1, 2])
def test_a_bar_of_few_faces_without_its_ends_is_in_doubt_as_one_of_many_is(n_missing: int) -> None:
    """Four faces have few edges, of which the open ones are many; the holes are as small as in a fine mesh."""
    bar = box((0.5, 0.1, 0.1))
    ends = [i for i in range(bar.n_faces) if np.ptp(bar.face(i)[:, 0]) == 0.0]
    faces = [face for i, face in enumerate(faces_of(bar)) if i not in ends[:n_missing]]
    hollow, pin = Polyhedron(bar.vertices, faces), box((0.1, 0.02, 0.02))
    for x in (-0.1, 0.0, 0.1):
        near = distance(hollow, pin, pose_b=at(x, 0.0, 0.0))
        assert (near.contact, near.inside) == (False, "undecided"), x
    assert distance(hollow, pin, pose_b=at(0.0, 0.2, 0.0)).inside == "no"


def test_a_cavity_with_a_fault_in_its_wall_stays_outside() -> None:
    wall = faulty(ball(0.5, 2).flipped(), "turned", 12)
    hollow = Polyhedron.merged([BALL, wall])
    assert not distance(hollow, CUBE).contact
    assert distance(hollow, CUBE, pose_b=at(0.75, 0.0, 0.0)).contact


def test_depth_and_volume_are_found_of_what_is_almost_closed() -> None:
    deep = contact(faulty(BALL, "missing", 37), CUBE, pose_b=at(0.2, 0.0, 0.0))
    assert deep.penetration > 0.5 and deep.volume >= 0.999e-3


def apart(shape: Polyhedron, scatter: float) -> Polyhedron:
    """Each face with corners of its own, moved by up to `scatter` [m]."""
    faces = faces_of(shape)
    corners = shape.vertices[np.concatenate(faces)]
    corners = corners + np.random.default_rng(3).uniform(-scatter, scatter, corners.shape)
    ends = np.cumsum([len(face) for face in faces])
    return Polyhedron(
        corners, [list(range(e - len(f), e)) for e, f in zip(ends, faces, strict=True)]
    )


def halves(shape: Polyhedron, scale: float) -> Polyhedron:
    """A shape of two halves, one larger by a little, so that no two of their corners are the same."""
    faces = np.array(faces_of(shape))
    up = shape.vertices[faces].mean(axis=1)[:, 2] > 0.0
    lower = Polyhedron(np.nextafter(shape.vertices, 9.0) * scale, faces[~up])
    return Polyhedron.merged([Polyhedron(shape.vertices, faces[up]), lower])


def with_t_junctions() -> Polyhedron:
    """A cube whose walls are cut at other places than their neighbours."""
    corners, faces = [], []
    for axis in range(3):
        for side in (-1.0, 1.0):
            cuts = np.linspace(-1.0, 1.0, 2 + axis + (side > 0.0))
            for low, high in zip(cuts, cuts[1:], strict=False):
                wall = np.array(
                    [[side, low, -1], [side, high, -1], [side, high, 1], [side, low, 1]]
                )
                faces.append(
                    list(range(len(corners), len(corners) + 4))[:: 1 if side > 0.0 else -1]
                )
                corners += np.roll(wall, axis, axis=1).tolist()
    return Polyhedron(np.array(corners), faces)


def two_sided(shape: Polyhedron) -> Polyhedron:
    return Polyhedron(shape.vertices, [*faces_of(shape), *(face[::-1] for face in faces_of(shape))])


CRACKED = {
    "halves an ulp apart": halves(BALL, 1.0),
    "halves a micrometre apart": halves(BALL, 1.0 + 1e-6),
    "each face apart": apart(BALL, 1e-6),
    "each face apart by far": apart(BALL, 1e-4),
    "T-junctions": with_t_junctions(),
    "two-sided": two_sided(BALL),
    "two-sided, each face apart": two_sided(apart(BALL, 1e-6)),
    "two-sided box": two_sided(box((2.0, 2.0, 2.0))),
}


@pytest.mark.parametrize("kind", CRACKED)
def test_solids_of_patches_that_do_not_meet_and_two_sided_ones_are_undecided_by_name(
    kind: str,
) -> None:
    outer = CRACKED[kind]
    for shift, inside in ((0.2, "undecided"), (0.6, "undecided"), (2.1, "no")):
        place = at(*(shift * np.array([0.6, 0.64, 0.48])))
        near = distance(outer, CUBE, pose_b=place)
        assert (near.contact, near.inside) == (False, inside)
        assert distance(CUBE, outer, pose_a=place).inside == inside
        many = Query(outer, CUBE).distances(None, [place, place])
        assert many.undecided.tolist() == [inside == "undecided"] * 2


def turns_round(shape: Polyhedron, points: np.ndarray) -> np.ndarray:
    """(n,) the winding numbers of what is there, added up face by face: neither caps nor rays."""
    soup = triangle_soup(shape)
    return np.abs(winding_number(soup.corners, points, soup.turns))


def without(shape: Polyhedron, towards: np.ndarray, n_faces: int) -> Polyhedron:
    """The shape less the faces that reach farthest."""
    out = set(np.argsort(shape.centres @ towards)[-n_faces:].tolist())
    return Polyhedron(shape.vertices, [f for i, f in enumerate(faces_of(shape)) if i not in out])


@pytest.mark.slow
@pytest.mark.parametrize("n_faces", [1, 2, 3])
def test_three_quarters_of_all_directions_are_inside_and_one_quarter_is_outside(
    n_faces: int,
) -> None:
    """Of small boxes before, in and past a hole that is not flat, by the solid angles of all faces."""
    random = np.random.default_rng(n_faces)
    outer = without(dented(random, 2, 0.4), random.normal(size=3), n_faces)
    closing, tiny = closing_of(outer), box((2.0**-12,) * 3)
    assert closing is not None
    hull = ConvexHull(outer.vertices).equations
    n_of = dict.fromkeys(("yes", "undecided", "no"), 0)
    for point in random.choice(closing.caps.mean(axis=1), 400):
        place = at(*(point + random.normal(scale=0.15, size=3)))
        near = distance(outer, tiny, pose_b=place)
        if near.contact and near.inside == "no":
            continue  # it meets the surface
        corners = tiny.vertices + place[:3, 3]
        if (corners @ hull[:, :3].T + hull[:, 3] > 0.0).any(axis=1).all():
            continue  # it is beside all faces
        turns = turns_round(outer, corners)
        if (np.abs(turns[:, None] - (0.25, 0.75)) < 1e-3).any():
            continue  # some corners are on this side and some on that
        inside = "yes" if turns[0] > 0.75 else "undecided" if turns.max() > 0.25 else "no"
        assert near.inside == inside
        n_of[inside] += 1
    assert min(n_of.values()) > 10


@pytest.mark.parametrize("place", [(0.0625, 0.0625), (0.03125, 0.0625), (0.09375, 0.015625)])
def test_corners_exactly_on_a_cap_are_undecided(place: tuple[float, float]) -> None:
    """A box that stands on a hole of two triangles in a flat wall: on their common edge, or within one."""
    mesh = trimesh.creation.box((1.0, 1.0, 1.0)).subdivide().subdivide().subdivide()
    low, high = mesh.triangles.min(axis=1), mesh.triangles.max(axis=1)
    is_hole = ((low == (0.0, 0.0, 0.5)) & (high == (0.125, 0.125, 0.5))).all(axis=1)
    assert is_hole.sum() == 2
    outer = Polyhedron(mesh.vertices, mesh.faces[~is_hole].tolist())
    standing = box((2.0**-8,) * 3).transformed(at(*place, 0.5 + 2.0**-9))
    near = distance(outer, standing)
    assert (near.contact, near.inside) == (False, "undecided")
    assert distance(outer, standing, pose_b=at(0.0, 0.0, 0.25)).inside == "no"
