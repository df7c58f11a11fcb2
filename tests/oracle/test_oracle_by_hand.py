"""The oracle on cases whose answers are worked out by hand; each comment says how."""

import itertools
import math
from fractions import Fraction

import numpy as np
import pytest

from tests import oracle
from tests.strategies import BOX_FACES

SQUARE = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0)]
CUBE_VERTS = list(itertools.product((0, 1), repeat=3))


def moved(polygon, by):
    return [tuple(x + d for x, d in zip(point, by, strict=True)) for point in polygon]


def shifted(x, y, z):
    pose = np.eye(4)
    pose[:3, 3] = x, y, z
    return pose


@pytest.mark.parametrize(
    ("segments", "expected"),
    [
        # crossing at height 2: both feet inside
        (((0, 0, 0), (2, 0, 0), (1, -1, 2), (1, 1, 2)), 4),
        # skew, feet at the ends: from (1, 0, 0) to (3, 4, 0): 4 + 16
        (((0, 0, 0), (1, 0, 0), (3, 4, 0), (3, 9, 0)), 20),
        # parallel and overlapping, 3 apart
        (((0, 0, 0), (4, 0, 0), (1, 3, 0), (9, 3, 0)), 9),
        # parallel, one after the other: 3 along, 4 across
        (((0, 0, 0), (1, 0, 0), (4, 4, 0), (8, 4, 0)), 25),
        # on one line, overlapping, and with a gap of 2
        (((0, 0, 0), (4, 4, 4), (3, 3, 3), (9, 9, 9)), 0),
        (((0, 0, 0), (1, 0, 0), (3, 0, 0), (4, 0, 0)), 4),
        # sharing an end
        (((0, 0, 0), (1, 0, 0), (1, 0, 0), (1, 5, 7)), 0),
        # a point and a segment; two points: 1 + 4 + 4
        (((1, 2, 0), (1, 2, 0), (0, 0, 0), (5, 0, 0)), 4),
        (((0, 0, 0), (0, 0, 0), (1, 2, 2), (1, 2, 2)), 9),
        # the lines y = 0 and x = y at height 1 cross above the origin, but the second starts at
        # (1, 1, 1)
        (((-5, 0, 0), (5, 0, 0), (1, 1, 1), (2, 2, 1)), 2),
        # directions (1, 1, 0) and (0, 1, 1) through the origin and (0, 0, 3): normal (1, -1, 1),
        # 3^2 / 3
        (((-9, -9, 0), (9, 9, 0), (0, -9, -6), (0, 9, 12)), 3),
    ],
)
def test_segments(segments, expected):
    a, b, c, d = segments
    for p, q in itertools.product(((a, b), (b, a)), ((c, d), (d, c))):
        assert oracle.segment_distance_sq(*p, *q) == expected
        assert oracle.segment_distance_sq(*q, *p) == expected


@pytest.mark.parametrize(
    ("point", "expected"),
    [
        ((0.5, 0.5, 3), 9),  # above the inside
        ((0.5, 0.25, 0), 0),  # on it
        ((4, 0.5, 4), 25),  # beside an edge: 3 and 4
        ((-2, -1, 2), 9),  # off a corner: 2, 1, 2
        ((1, 1, 0), 0),  # a corner
    ],
)
def test_point_and_square(point, expected):
    for k in range(4):
        assert oracle.point_polygon_distance_sq(point, SQUARE[k:] + SQUARE[:k]) == expected
    assert oracle.point_polygon_distance_sq(point, SQUARE[::-1]) == expected


def test_square_pairs():
    # faces over each other
    assert oracle.polygon_distance_sq(SQUARE, moved(SQUARE, (0.25, 0.25, 2))) == 4
    # coplanar, edges 2 apart
    assert oracle.polygon_distance_sq(SQUARE, moved(SQUARE, (3, 0, 0))) == 4
    # corners 3 and 4 apart
    assert oracle.polygon_distance_sq(SQUARE, moved(SQUARE, (4, 5, 0))) == 25
    # coplanar overlap
    assert oracle.polygon_distance_sq(SQUARE, moved(SQUARE, (0.5, 0.5, 0))) == 0
    # a shared edge
    assert oracle.polygon_distance_sq(SQUARE, moved(SQUARE, (1, 0, 0))) == 0
    # a shared corner
    assert oracle.polygon_distance_sq(SQUARE, moved(SQUARE, (1, 1, 0))) == 0


def test_a_polygon_inside_another_in_one_plane_touches_it():
    small = [(0.4, 0.4, 0), (0.6, 0.4, 0), (0.5, 0.6, 0)]
    assert oracle.polygons_touch(SQUARE, small)
    assert oracle.polygons_touch(small, SQUARE)


def test_a_triangle_through_a_square():
    blade = [(0.5, 0.5, -1), (0.5, 0.5, 1), (5, 0.5, 1)]
    assert oracle.polygons_touch(SQUARE, blade)
    beside = moved(blade, (1, 0, 0))  # its edge is now at x = 1.5, half beyond the square's x = 1
    assert oracle.polygon_distance_sq(SQUARE, beside) == Fraction(1, 4)


@pytest.mark.parametrize("foot", [(0.5, 0.25), (0.5, 0.75)])
@pytest.mark.parametrize("turned", [False, True])
def test_a_spike_through_either_half_of_a_square(foot, turned):
    # far from all edges: only the piercing itself shows it, from above and from below
    spike = [(*foot, -9), (*foot, 9), (5, 5, 9 if turned else -9)]
    for square, blade in itertools.product((SQUARE, SQUARE[::-1]), (spike, spike[::-1])):
        assert oracle.polygons_touch(square, blade)
        assert oracle.polygons_touch(blade, square)
    assert not oracle.polygons_touch(SQUARE, moved(spike, (0.75, 0, 0)))


@pytest.mark.parametrize("k", range(4))
def test_each_edge_counts_wherever_the_polygon_starts(k):
    # the post x = -2 faces the middle of the edge x = 0, and nothing else, 2 away
    post = [(-2, 0.5, -1), (-2, 0.5, 1), (-9, 0.5, 0)]
    square = SQUARE[k:] + SQUARE[:k]
    assert oracle.polygon_distance_sq(square, post) == 4
    assert oracle.polygon_distance_sq(post, square) == 4


def test_a_corner_over_a_face_is_decided_to_one_ulp():
    tip = lambda z: [(0.3, 0.4, z), (0.3, 0.4, 1), (0.2, 0.9, 1)]  # noqa: E731
    assert oracle.polygons_touch(SQUARE, tip(0.0))
    assert oracle.polygons_touch(SQUARE, tip(-math.ulp(0.0)))
    assert not oracle.polygons_touch(SQUARE, tip(math.ulp(0.0)))
    lifted = moved(SQUARE, (0, 0, 1.0))
    above = [(0.3, 0.4, math.nextafter(1.0, 2)), (0.3, 0.4, 3), (0.2, 0.9, 3)]
    assert oracle.polygon_distance_sq(lifted, above) == Fraction(1, 2**104)


def test_two_edges_that_cross_above_each_other():
    # ridges x axis (below) and y axis (above, 1/8 higher): edge-edge minimum inside both
    below = [(-1, 0, 0), (1, 0, 0), (0, 0, -5)]
    above = [(0, -1, 0.125), (0, 1, 0.125), (0, 0, 5)]
    assert oracle.polygon_distance_sq(below, above) == Fraction(1, 64)


@pytest.mark.parametrize(
    ("flat", "hull"),
    [
        ([(0, 0, 0), (2, 0, 0), (1, 0, 0)], [(0, 0, 0), (2, 0, 0)]),  # the middle comes last
        (
            [(1, 0, 0), (0, 0, 0), (2, 0, 0), (0.5, 0, 0)],
            [(0, 0, 0), (2, 0, 0)],
        ),  # the middle comes first
        ([(1, 1, 1)] * 5, [(1, 1, 1)]),
        ([(0, 0, 0), (0, 0, 0), (1, 2, 3)], [(0, 0, 0), (1, 2, 3)]),
        ([SQUARE[0], *SQUARE, SQUARE[3], SQUARE[3]], SQUARE),  # repeated corners
        ([(0, 0, 0), (0.5, 0, 0), *SQUARE[1:], (0, 0.25, 0)], SQUARE),  # corners within edges
    ],
)
def test_degenerate_polygons_are_the_hull_of_their_corners(flat, hull):
    others = [
        [(1.5, y, z), (1.5, y + 3, z), (1.25, y + 1, z + 2)] for y in (-5, 0, 2) for z in (0, 1)
    ]
    for other in [*others, SQUARE, [(7, 8, 9)]]:
        assert oracle.polygon_distance_sq(flat, other) == oracle.polygon_distance_sq(hull, other)


def test_a_bent_polygon_is_its_fan():
    bent = [
        (0, 0, 0),
        (2, 0, 0),
        (2, 2, 1),
        (0, 2, 0),
    ]  # the diagonal from (0, 0, 0) to (2, 2, 1) is on it
    assert oracle.point_polygon_distance_sq((1, 1, 0.5), bent) == 0
    assert oracle.point_polygon_distance_sq((1, 1, 0), bent) > 0


def test_touching_is_exact_far_from_the_origin():
    far = (2.0**40, -(2.0**41), 2.0**39)
    assert (
        oracle.polygon_distance_sq(moved(SQUARE, far), moved(SQUARE, (far[0], far[1], far[2] + 2)))
        == 4
    )


def test_scaling_by_any_factor_scales_the_answer_exactly():
    p, q = SQUARE, [(3, 1, 2), (4, 7, 3), (5, 2, 2)]
    sq = oracle.polygon_distance_sq(p, q)
    for k in (Fraction(1, 7), Fraction(10) ** 30, Fraction(2) ** -900):
        scaled = [[tuple(k * x for x in point) for point in polygon] for polygon in (p, q)]
        assert oracle.polygon_distance_sq(*scaled) == k * k * sq


def test_cubes():
    def measure(pose, of=oracle.polyhedron_distance_sq):
        return of(CUBE_VERTS, BOX_FACES, CUBE_VERTS, BOX_FACES, None, pose)

    assert measure(shifted(3, 0, 0)) == 4
    assert measure(shifted(2, 3, 3)) == 9  # corner to corner: 1, 2, 2
    assert measure(shifted(1, 0.5, 0.5)) == 0
    half_inside = np.diag([0.5, 0.5, 0.5, 1]) + shifted(0.25, 0.25, 0.25) - np.eye(4)
    assert measure(half_inside) == Fraction(1, 16)  # the surfaces are a quarter apart
    assert measure(half_inside, oracle.solid_distance_sq) == 0
    assert measure(shifted(3, 0, 0), oracle.solid_distance_sq) == 4


def test_the_nearest_faces_of_two_cubes_are_those_that_hold_nearest_points():
    """Side by side 2 apart: all nearest points are on x = 1 and x = 3, and on the rims of four faces beside."""
    faced = {f for f, face in enumerate(BOX_FACES) if all(CUBE_VERTS[v][0] == 1 for v in face)}
    beside = {f for f, face in enumerate(BOX_FACES) if any(CUBE_VERTS[v][0] == 1 for v in face)}
    opposite = {f for f, face in enumerate(BOX_FACES) if any(CUBE_VERTS[v][0] == 0 for v in face)}
    cube = (CUBE_VERTS, BOX_FACES)
    sq, pairs = oracle.nearest_faces(*cube, *cube, pose_b=shifted(3, 0, 0))
    assert sq == 4 and {f for f, _ in pairs} == beside and {g for _, g in pairs} == opposite
    assert faced < beside and pairs == sorted(pairs)
    for f, g in itertools.product(range(6), range(6)):
        p = [CUBE_VERTS[v] for v in BOX_FACES[f]]
        q = moved([CUBE_VERTS[v] for v in BOX_FACES[g]], (3, 0, 0))
        assert ((f, g) in pairs) == (oracle.polygon_distance_sq(p, q) == sq)


def test_cubes_that_touch_have_one_pair_of_faces_that_do():
    cube = (CUBE_VERTS, BOX_FACES)
    sq, ((f, g),) = oracle.nearest_faces(*cube, *cube, pose_b=shifted(1, 1, 1))
    assert sq == 0 and {(1, 1, 1)} <= {CUBE_VERTS[v] for v in BOX_FACES[f]}
    assert {(0, 0, 0)} <= {CUBE_VERTS[v] for v in BOX_FACES[g]}


def test_a_rotated_pose_is_taken_as_given():
    # the cube turned by a 3-4-5 rotation about z, as exact rationals, its corner (1, 0, 0) at
    # (0.6, 0.8, 0)
    turn = [
        [Fraction(3, 5), Fraction(-4, 5), 0, 0],
        [Fraction(4, 5), Fraction(3, 5), 0, 0],
        [0, 0, 1, 0],
        [0, 0, 0, 1],
    ]
    # its greatest x is 3/5; a cube whose least x is 2
    sq = oracle.polyhedron_distance_sq(
        CUBE_VERTS, BOX_FACES, CUBE_VERTS, BOX_FACES, turn, shifted(2, 0, 0)
    )
    assert sq == Fraction(7, 5) ** 2


def test_containment():
    for point, expected in [
        ((0.5, 0.5, 0.5), True),
        ((0, 0, 0), True),
        ((1, 0.5, 0.5), True),
        ((0.5, 0, 1), True),
        ((math.nextafter(1, 2), 0.5, 0.5), False),
        ((math.nextafter(1, 0), 0.5, 0.5), True),
        ((2, 0, 0), False),  # in the plane of faces and on the line of edges
        ((0.5, 0.5, -1), False),
    ]:
        assert oracle.contains(point, CUBE_VERTS, BOX_FACES) is expected
    assert oracle.contains((5.5, 0.5, 0.5), CUBE_VERTS, BOX_FACES, shifted(5, 0, 0))


def test_winding_counts_how_often():
    inner = [tuple(0.25 + 0.5 * x for x in v) for v in CUBE_VERTS]
    second = [tuple(i + 8 for i in face) for face in BOX_FACES]
    assert oracle.winding_number((0.5, 0.5, 0.5), CUBE_VERTS + inner, BOX_FACES + second) == 2
    hollow = [face[::-1] for face in second]
    assert oracle.winding_number((0.5, 0.5, 0.5), CUBE_VERTS + inner, BOX_FACES + hollow) == 0
    assert oracle.winding_number((0.1, 0.5, 0.5), CUBE_VERTS + inner, BOX_FACES + hollow) == 1
    assert not oracle.contains((0.5, 0.5, 0.5), CUBE_VERTS + inner, BOX_FACES + hollow)


def test_one_part_of_two_inside_is_contact():
    small = [tuple(0.25 + 0.5 * x for x in v) for v in CUBE_VERTS]
    away = [tuple(x + 9 for x in v) for v in CUBE_VERTS]
    both = BOX_FACES + [tuple(i + 8 for i in face) for face in BOX_FACES]
    assert oracle.solid_distance_sq(CUBE_VERTS, BOX_FACES, away + small, both) == 0
    assert oracle.solid_distance_sq(CUBE_VERTS, BOX_FACES, away + small, both, closed_a=False) > 0


def test_an_open_surface_holds_nothing():
    with pytest.raises(ValueError, match="not closed"):
        # without its face x = 1 the rays through the gap count differently
        oracle.contains((0.9, 0.5, 0.5), CUBE_VERTS, BOX_FACES[:1] + BOX_FACES[2:])


def test_root():
    assert oracle.root(Fraction(9, 4)) == Fraction(3, 2)
    assert oracle.root(0) == 0
    digits = 141421356237309504880168872420969807856967187537694  # sqrt(2) by the tables
    assert math.floor(oracle.root(2, 55) * 10**50) == digits
    for k in (-200, -3, 0, 77):
        r = oracle.root(2 * Fraction(100) ** k)
        assert r**2 < 2 * Fraction(100) ** k < (r * (1 + Fraction(1, 10**49))) ** 2
    assert oracle.error(1.5, Fraction(9, 4)) == 0
    assert oracle.error(2.0, Fraction(9, 4)) == Fraction(1, 2)


@pytest.mark.slow
def test_far_faces_are_skipped_only_where_they_cannot_win():
    """The ordered loop of whole surfaces against all pairs of polygons, without order or bound."""
    random = np.random.default_rng(7)
    for _ in range(6):
        verts = random.normal(size=(2, 12, 3)) * 10.0 ** random.integers(-6, 6)
        verts[1] += verts[0, 0] * random.integers(0, 4)
        faces = random.integers(0, 12, size=(2, 9, 3))
        expected = min(
            oracle.polygon_distance_sq(verts[0][f], verts[1][g]) for f in faces[0] for g in faces[1]
        )
        assert oracle.polyhedron_distance_sq(verts[0], faces[0], verts[1], faces[1]) == expected
