"""Every array that a kernel halves, or walks until an entry is too far, is in order wherever it is made."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import clearance as cl
from clearance.geometry.tree import join, surface_of
from clearance.planar.curve import assembled
from clearance.simulate.measure.certify import path_of
from clearance.world.forest import forest_of
from clearance.world.kinematics import all_links, standing_link
from clearance.world.motion import kinematic_motion
from tests.made_cases import flying, torus


def random_cloud(random: np.random.Generator) -> cl.PointCloud:
    points = random.uniform(-1.0, 1.0, (int(random.integers(1, 400)), 3))
    return cl.PointCloud(points, float(random.choice([1e-6, 0.004, 0.05, 0.3])))


def probes_of(surface, body: int) -> np.ndarray:
    return surface.probes[surface.probe_starts[body] : surface.probe_starts[body + 1]]


@pytest.mark.parametrize("seed", range(8))
def test_the_probes_of_a_cloud(seed):
    """One of each group, alone and behind other bodies."""
    random = np.random.default_rng(seed)
    clouds = [random_cloud(random) for _ in range(3)]
    joined = join([torus(0.5, 0.1, 8, 6), *clouds])
    for i, cloud in enumerate(clouds):
        alone = surface_of(cloud)
        assert len(alone.probes) == len(cloud.component_closed)
        assert np.unique(cloud.face_component[alone.probes]).size == len(alone.probes)
        for probes in (alone.probes, probes_of(joined, i + 1)):
            assert (np.diff(probes) > 0).all()


def test_the_times_of_a_path():
    case = flying("x", cl.box((1.0, 1.0, 1.0)), [], np.zeros((3, 6)))
    motion = kinematic_motion(case.robots[0])
    links = forest_of(case).links
    found = path_of(links, case, [motion], slice(0, 3)).times
    assert found.tolist() == motion.times.tolist()
    for times in ([0.0, 2.0, 1.0], [0.0, 0.0, 1.0]):
        late = replace(motion, times=np.array(times))
        with pytest.raises(AssertionError, match="ascending"):
            path_of(links, case, [late], slice(0, 3))


def test_the_links_of_a_forest():
    root = standing_link(np.eye(4))
    hung = root._replace(parents=np.array([1]))
    assert all_links(root, hung._replace(parents=np.array([0]))).parents.tolist() == [-1, 0]
    with pytest.raises(AssertionError, match="parent"):
        all_links(hung, root)


def test_the_contours_of_a_curve():
    rows = np.array([[0, 0, 1], [1, 0, 1], [1, 0, 1], [1, 1, 1], [1, 1, 1], [0, 0, 1]], dtype=float)
    given = rows, np.array([0, 2, 4, 6]), np.array([[0, 1], [1, 2], [2, 3]], dtype=float)
    assert assembled(*given, contour=[0, 0, 1]).contour.tolist() == [0, 0, 1]
    with pytest.raises(AssertionError, match="ascending"):
        assembled(*given, contour=[0, 1, 0])
