"""Clouds of few and of many points against rational arithmetic, and what their clearance must not depend on."""

import math
from fractions import Fraction
from typing import NamedTuple

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from clearance import PointCloud, Polyhedron, Query, box, distance, sphere
from tests import oracle
from tests.examples import examples
from tests.made_cases import torus
from tests.oracle.box_clouds import GridBox, distances_sq
from tests.oracle.rationals import posed
from tests.strategies import QUARTER_TURNS, boxes, poses

QUARTERS = st.integers(-12, 12).map(lambda n: n / 4.0)
RADII = st.sampled_from([2.0**-30, 1e-3, 0.1, 0.7])


@st.composite
def points(draw):
    """(n, 3) a few points: of a grid, anywhere, on one line, in one plane, or all the same."""
    grid = np.array(draw(st.lists(st.tuples(QUARTERS, QUARTERS, QUARTERS), min_size=1, max_size=8)))
    kind = draw(st.sampled_from(["grid", "anywhere", "line", "plane", "same", "far"]))
    random = np.random.default_rng(draw(st.integers(0, 2**32 - 1)))
    if kind == "anywhere":
        return random.uniform(-3.0, 3.0, grid.shape)
    if kind == "line":
        return grid[:1] + grid[:, :1] * [1.0, 0.5, -0.25]
    if kind == "plane":
        return grid * [1.0, 1.0, 0.0]
    if kind == "same":
        return np.repeat(grid[:1], len(grid), axis=0)
    return grid + (1000.0 if kind == "far" else 0.0)


def truth(cloud, verts, faces, pose_a, pose_b):
    """The squared distance of a cloud's points to a solid, 0 where one is inside; by rational arithmetic."""
    alone = [(i,) for i in range(len(cloud.vertices))]
    if any(oracle.contains(x, verts, faces, pose_b) for x in posed(cloud.vertices, pose_a)):
        return Fraction(0)
    return oracle.polyhedron_distance_sq(cloud.vertices, alone, verts, faces, pose_a, pose_b)


@given(points(), RADII, boxes(), poses(), poses())
@examples(60)
def test_like_the_oracle(given_points, radius, solid, pose_a, pose_b):
    cloud = PointCloud(given_points, radius)
    near = distance(cloud, Polyhedron(*solid), pose_a=pose_a, pose_b=pose_b)
    to_centre = oracle.root(truth(cloud, *solid, pose_a, pose_b))
    true = max(Fraction(0), to_centre - Fraction(radius))
    assert abs(Fraction(near.distance) - true) <= Fraction(near.error_bound)
    assert near.error_bound <= 1e-14 * (1.0 + near.distance + np.abs(given_points).max())
    assert near.contact == (near.distance == 0.0)
    reach = 64 * np.spacing(np.abs(given_points).max() + np.abs([pose_a, pose_b]).max() + 4.0)
    assert abs(np.linalg.norm(near.point_a - near.point_b) - near.distance) <= reach
    if not near.contact:
        centres = cloud.transformed(pose_a).vertices
        assert abs(np.linalg.norm(centres - near.point_a, axis=1).min() - radius) <= reach


@given(points(), points(), RADII, RADII, poses())
@examples(40)
def test_two_clouds_like_their_nearest_points(one, other, r, s, pose):
    near = distance(PointCloud(one, r), PointCloud(other, s), pose_b=pose)
    moved = other @ pose[:3, :3].T + pose[:3, 3]
    gaps = np.linalg.norm(one[:, None] - moved, axis=2) - r - s
    reach = 1e-15 * (10.0 + np.abs(one).max() + np.abs(moved).max())
    assert abs(near.distance - max(0.0, gaps.min())) <= reach + near.error_bound


@pytest.mark.parametrize("gap", [-(2.0**-40), 0.0, 2.0**-51, 2.0**-20])
def test_touching_is_decided_by_one_bit(gap):
    near = distance(PointCloud([[0.75 + gap, 0.1, 0.2]], 0.25), box([1.0, 1.0, 1.0]))
    assert near.contact == (gap <= 0.0)
    assert near.distance == max(0.0, gap)


def without(solid, omitted):
    """The solid without the faces whose centres are so."""
    corners = np.split(solid.face_vertices, solid.face_starts[1:-1])
    return Polyhedron(
        solid.vertices, [c for c, out in zip(corners, omitted, strict=True) if not out]
    )


def test_points_inside_a_surface_with_holes_are_contact_or_in_doubt():
    """A link that lacks a face, as real ones do, is not the same as nothing there."""
    ball = sphere(radius=1.0, tolerance=0.02)
    cloud = PointCloud([[0.0, 0.0, 0.0], [4.0, 0.0, 0.0]], 0.01)
    cracked = without(ball, np.arange(ball.n_faces) == 40)
    assert distance(cracked, cloud).contact
    lid_off = without(ball, ball.centres[:, 2] > 0.9)
    assert distance(lid_off, cloud).inside == "undecided"
    assert distance(lid_off, PointCloud([[4.0, 0.0, 0.0]], 0.01)).inside == "no"
    assert distance(cloud, lid_off).inside == "undecided"


def test_points_within_loose_faces_are_in_doubt():
    """Faces that share no edge have no inside, but go round the point on all sides."""
    ball = sphere(radius=1.0, tolerance=0.02)
    each = [ball.centres[i] + 0.999 * (ball.face(i) - ball.centres[i]) for i in range(ball.n_faces)]
    loose = Polyhedron.merged([Polyhedron(one, [range(len(one))]) for one in each])
    assert distance(loose, PointCloud([[0.1, 0.0, 0.0]], 0.01)).inside == "undecided"
    assert distance(loose, PointCloud([[1.1, 0.0, 0.0]], 0.01)).inside == "no"


@pytest.mark.parametrize("order", [1, -1])
def test_a_contact_is_the_same_wherever_the_search_began(order):
    """Of hundreds of points in a body one is the answer, also where the pose before was apart, or in contact."""
    random = np.random.default_rng(4)
    sheet = PointCloud(random.uniform(-1.0, 1.0, (4000, 3)) * [1.0, 1.0, 0.01], 0.01)
    shapes = (sheet, torus(0.5, 0.1, 24, 12))[::order]
    way = np.tile(np.eye(4), (40, 1, 1))
    way[:, 2, 3] = np.linspace(0.4, -0.4, 40)
    runs = [Query(*shapes).distances(worlds_from_b=one) for one in (way, way[::-1])]
    points_there, points_back = (np.asarray(found.points) for found in runs)
    assert np.array_equal(points_there, points_back[::-1])
    single = [distance(*shapes, pose_b=pose) for pose in way]
    assert points_there.tolist() == [[n.point_a.tolist(), n.point_b.tolist()] for n in single]
    in_contact = [n for n in single if n.contact]
    assert 5 < len(in_contact) < 35
    for pose, near in zip(way, single, strict=True):
        if near.contact:
            centres = sheet.vertices + (pose[:3, 3] if order < 0 else 0.0)
            assert np.linalg.norm(centres - near.point_a, axis=1).min() <= 0.01 * (1.0 + 1e-12)


GRID = 2**10
"""Steps of the grid in a metre."""


class Scan(NamedTuple):
    """A cloud about a body, in steps of the grid."""

    points: np.ndarray
    radius: int
    boxes: list[GridBox]


def scan(random, n, kind):
    """Points of one kind about one to four boxes, of which some are hollow; one may be in, on or within one."""
    boxes = [_box(random, k) for k in range(random.integers(1, 5))]
    points = random.integers(-3 * GRID, 3 * GRID, (n, 3))
    if kind == "clusters":
        centres = random.integers(-3 * GRID, 3 * GRID, (max(1, n // 40), 3))
        points = centres[random.integers(len(centres), size=n)] + random.integers(-9, 10, (n, 3))
    least = distances_sq(points, boxes)
    points = points[least > (GRID // 8) ** 2] if (least > (GRID // 8) ** 2).any() else points
    one = boxes[0]
    middle, place = (one.low + one.high) // 2, random.integers(len(points))
    if kind == "one deep inside":
        boxes[0] = one._replace(cavity=None)
        points[place] = middle + random.integers(-50, 50, 3)
    if kind == "one on a face":
        points[place] = [one.high[0], *middle[1:]]
    if kind == "one in a cavity" and one.cavity is not None:
        points[place] = middle + random.integers(-20, 20, 3)
    return Scan(points, int(random.choice([1, 10, 60])), boxes)


def _box(random, k):
    """Box `k` of at most eight, each in an octant of its own."""
    signs = np.array([1 if k & bit else -1 for bit in (1, 2, 4)])
    middle = signs * random.integers(700, 1200, 3)
    half = random.integers(200, 600, 3)
    wall = random.integers(30, 60)
    hollow = None if random.integers(2) else (middle - half + wall, middle + half - wall)
    return GridBox(middle - half, middle + half, hollow)


KINDS = ["scattered", "clusters", "one deep inside", "one on a face", "one in a cavity"]


def solid_of(boxes):
    parts = []
    for one in boxes:
        parts.append(_between(one.low, one.high))
        if one.cavity is not None:
            parts.append(_between(*one.cavity).flipped())
    return Polyhedron.merged(parts)


def _between(low, high):
    pose = np.eye(4)
    pose[:3, 3] = (low + high) / (2 * GRID)
    return box(((high - low) / GRID).tolist()).transformed(pose)


def answer(given_scan, pose):
    """(what is right [m], what is found) with both at a pose that rounds nothing."""
    cloud = PointCloud(given_scan.points / GRID, given_scan.radius / GRID)
    near = distance(cloud, solid_of(given_scan.boxes), pose_a=pose, pose_b=pose)
    least = int(distances_sq(given_scan.points, given_scan.boxes).min())
    return max(0.0, math.sqrt(least) - given_scan.radius) / GRID, near


@given(
    st.integers(0, 2**32 - 1),
    st.sampled_from([1, 7, 60, 400, 3000]),
    st.sampled_from(KINDS),
    st.sampled_from(QUARTER_TURNS),
)
@examples(80)
def test_contact_and_distance_are_those_of_all_points(seed, n, kind, turn):
    random = np.random.default_rng(seed)
    pose = np.eye(4)
    pose[:3, :3], pose[:3, 3] = turn, random.integers(-8, 8, 3) / 4
    true, near = answer(scan(random, n, kind), pose)
    assert near.contact == (true == 0.0)
    assert near.inside == "yes" or kind != "one deep inside"
    assert abs(near.distance - true) <= near.error_bound + 4 * np.spacing(true)
