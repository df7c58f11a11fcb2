"""Arrays that a kernel halves, or walks until an entry is too far, are in order wherever they are made."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import clearance as cl
from clearance.geometry.tree import join, surface_of
from clearance.ordered import ascending, parents_first
from clearance.planar.curve import assembled
from clearance.simulate.measure.certify import path_of
from clearance.world.forest import forest_of
from clearance.world.kinematics import all_links, standing_link
from clearance.world.motion import kinematic_motion
from tests.made_cases import flying, torus


def random_cloud(random: np.random.Generator) -> cl.PointCloud:
    points = random.uniform(-1.0, 1.0, (int(random.integers(1, 400)), 3))
    return cl.PointCloud(points, float(random.choice([1e-6, 0.004, 0.05, 0.3])))


@pytest.mark.parametrize("seed", range(4))
def test_the_probes_of_a_cloud(seed):
    """One of each group, alone and behind other bodies."""
    random = np.random.default_rng(seed)
    clouds = [random_cloud(random) for _ in range(3)]
    joined = join([torus(0.5, 0.1, 8, 6), *clouds])
    for i, cloud in enumerate(clouds):
        alone = surface_of(cloud)
        assert len(alone.probes) == len(cloud.component_closed)
        assert np.unique(cloud.face_component[alone.probes]).size == len(alone.probes)
        start, end = joined.probe_starts[i + 1 : i + 3]
        for probes in (alone.probes, joined.probes[start:end]):
            assert (np.diff(probes) > 0).all()


def test_an_array_out_of_order_is_a_fault():
    even, uneven = np.array([0.0, 0.0, 1.0]), np.array([0.0, 2.0, 1.0])
    assert ascending(even, strictly=False) is even and ascending(uneven[:2]) is not None
    for values, strictly in ((even, True), (uneven, False)):
        with pytest.raises(AssertionError, match="ascending"):
            ascending(values, strictly=strictly)
    for parents in ([1, -1], [-1, 1], [-2]):
        with pytest.raises(AssertionError, match="parent"):
            parents_first(np.array(parents))


def test_times_of_a_path_links_of_a_forest_and_contours_are_held_to_their_order():
    case = flying("x", cl.box((1.0, 1.0, 1.0)), [], np.zeros((3, 6)))
    motion, links = kinematic_motion(case.robots[0]), forest_of(case).links
    for times in ([0.0, 2.0, 1.0], [0.0, 0.0, 1.0]):
        with pytest.raises(AssertionError, match="ascending"):
            path_of(links, case, [replace(motion, times=np.array(times))], slice(0, 3))
    root = standing_link(np.eye(4))
    with pytest.raises(AssertionError, match="parent"):
        all_links(root._replace(parents=np.array([1])), root)
    rows = np.array([[0, 0, 1], [1, 0, 1], [1, 0, 1], [1, 1, 1], [1, 1, 1], [0, 0, 1]], dtype=float)
    given = rows, np.array([0, 2, 4, 6]), np.array([[0, 1], [1, 2], [2, 3]], dtype=float)
    with pytest.raises(AssertionError, match="ascending"):
        assembled(*given, contour=[0, 1, 0])
