"""Clouds of many points against integer arithmetic on every one of them: inside, on and outside a solid."""

import math
from typing import NamedTuple

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from clearance import PointCloud, Polyhedron, box, distance
from tests.examples import examples
from tests.oracle.box_clouds import GridBox, distances_sq
from tests.strategies import QUARTER_TURNS

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
    st.sampled_from([1, 7, 60, 400]),
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
    assert abs(near.distance - true) <= near.error_bound + 4 * np.spacing(true)


@pytest.mark.parametrize("n", [100, 3000])
def test_a_small_box_about_any_of_many_points_is_in_contact(n):
    """However many groups of points there are, and wherever in the file the point stands."""
    random = np.random.default_rng(n)
    points = random.uniform(-1.0, 1.0, (n, 3))
    cloud, small = PointCloud(points, 0.004), box((0.03, 0.03, 0.03))
    apart = []
    for i in random.integers(n, size=40).tolist():
        pose = np.eye(4)
        pose[:3, 3] = points[i]
        if not distance(small, cloud, pose_a=pose).contact:
            apart.append(i)
    assert apart == []
