"""The paper's segments and its polygon iteration: right where they must be, and where they are
not.
"""

import itertools
import math

import numpy as np
import pytest

from clearance.errors import BadPolygon
from clearance.kernels.arithmetic.vec3 import Vec3
from clearance.kernels.paper.polygons import lumelsky
from clearance.query.paper import polygon_distance_paper
from tests import oracle
from tests.examples import some_slow
from tests.strategies import FAMILIES

TRIANGLE = np.array([[0, 0, 0], [3, 0, 0], [0, 3, 0]], dtype=float)
SQUARE = np.array([[0, 0, 0], [2, 0, 0], [2, 2, 0], [0, 2, 0]], dtype=float)


def moved(polygon, *by):
    return polygon + np.array(by)


def true_distance(p, q) -> float:
    return float(oracle.root(oracle.polygon_distance_sq(p, q)))


def size_of(p, q) -> float:
    return max(np.ptp(p, axis=0).max(), np.ptp(q, axis=0).max())


def measured(p, q):
    """The paper's answer, None for the polygons without area that it does not take."""
    try:
        return polygon_distance_paper(p, q)
    except BadPolygon:
        return None


@pytest.mark.slow
def test_segments_agree_with_the_oracle_on_all_small_integer_ones():
    points = [Vec3(*map(float, x)) for x in itertools.product((0, 1, 3), (0, 2), (0, 1))]
    random = np.random.default_rng(1)
    for _ in range(600):
        ends = [points[i] for i in random.integers(0, len(points), 4)]
        found = lumelsky(*ends)
        expected = float(oracle.root(oracle.segment_distance_sq(*ends)))
        assert math.dist(found.p, found.q) == pytest.approx(expected, rel=1e-14, abs=1e-14)
        assert 0 <= found.t <= 1 and 0 <= found.u <= 1


@pytest.mark.parametrize("name", some_slow(sorted(FAMILIES), {"many_sided"}))
def test_never_nearer_than_the_truth_and_between_points_of_the_polygons(name):
    n_measured = 0
    for p, q in zip(*FAMILIES[name](np.random.default_rng(21), 60), strict=True):
        found = measured(p, q)
        if found is None:
            continue
        n_measured += 1
        reach = np.abs([*p, *q]).max()
        rounding = 1e-12 * size_of(p, q) + 4 * np.spacing(reach)
        # polygons are as flat as rounding at their place leaves them, not flatter
        warp = 8 * np.spacing(reach)
        assert found.distance >= true_distance(p, q) - rounding - warp
        for point, polygon in ((found.point_a, p), (found.point_b, q)):
            off = float(oracle.root(oracle.point_polygon_distance_sq(point, polygon)))
            assert off <= rounding + warp
        assert found.distance == pytest.approx(
            math.dist(found.point_a, found.point_b), abs=rounding
        )
    assert n_measured >= 15


def test_counterexample_the_iteration_stops_at_a_point_that_is_no_minimum():
    """Two small integer triangles: true sqrt(2 / 11) = 0.426, answer 1, in two passes.

    The references slide to one edge each and the step along those two edges is the last; the
    closest points lie on other edges.
    """
    other = np.array([[0, 1, 2], [0, -1, 0], [-1, 2, 1]], dtype=float)
    found = polygon_distance_paper(TRIANGLE, other)
    assert oracle.polygon_distance_sq(TRIANGLE, other) * 11 == 2
    assert found.distance == pytest.approx(1.0, abs=1e-12)
    assert found.tally == {"passes": 2, "not_converged": 0}


def test_the_iteration_never_runs_on():
    """Crossing polygons make it creep towards the common point: given up after 50 passes, and
    counted.
    """
    pairs = list(zip(*FAMILIES["crossing_plates"](np.random.default_rng(11), 300), strict=True))
    tallies = [polygon_distance_paper(p, q).tally for p, q in pairs]
    assert max(tally["passes"] for tally in tallies) <= 50
    given_up = [tally for tally in tallies if tally["not_converged"]]
    assert given_up and all(tally["passes"] == 50 for tally in given_up)


def test_a_polygon_without_area_is_refused():
    with pytest.raises(BadPolygon, match="no area; method 'paper' needs corners"):
        polygon_distance_paper(SQUARE, np.array([[0, 0, 1], [1, 1, 2], [2, 2, 3.0]]))
