"""The paper's segments, polygon iteration and loop over face pairs: what they measure, and what they lose."""

import itertools
import math

import numpy as np
import pytest

from clearance.errors import BadPolygon
from clearance.geometry import shapes
from clearance.geometry.polyhedron import Polyhedron
from clearance.geometry.shapes import box
from clearance.kernels.arithmetic.vec3 import Vec3
from clearance.kernels.paper.polygons import lumelsky
from clearance.query.paper import distance_paper, polygon_distance_paper
from tests import oracle
from tests.examples import some_slow
from tests.made_cases import at, faces_of
from tests.strategies import FAMILIES, rotations


def pipe(n: int) -> Polyhedron:
    """A concave body of 4 n quads."""
    return shapes.pipe(inner_radius=0.3, outer_radius=0.35, length=1.0, sections=n)


def true_distance(a, b, pose_a=None, pose_b=None) -> float:
    sq = oracle.polyhedron_distance_sq(
        a.vertices, faces_of(a), b.vertices, faces_of(b), pose_a, pose_b
    )
    return float(oracle.root(sq))


def motion(seed: int, n: int):
    """Poses moving past the origin with a wave, at one random attitude."""
    turn = rotations(np.random.default_rng(seed), 1)[0]
    return [at(x, 0.3 * math.sin(3 * x), 0.9, turned=turn) for x in np.linspace(-2, 2, n)]


def test_without_rules_it_is_the_least_of_all_polygon_pairs():
    a, b = box((0.5, 0.4, 0.3)), pipe(6)
    for b_pose in motion(4, 5):
        moved = b.vertices @ b_pose[:3, :3].T + b_pose[:3, 3]
        least = min(
            polygon_distance_paper(a.vertices[f], moved[g]).distance
            for f, g in itertools.product(faces_of(a), faces_of(b))
        )
        found = distance_paper(a, b, None, b_pose, rule_1=False, rule_2=False)
        assert found.distance == pytest.approx(least, rel=1e-11)
        assert found.tally["measured"] == 6 * b.n_faces


def test_never_nearer_than_the_truth_and_witnesses_lie_on_the_named_faces():
    a, b = box((0.5, 0.4, 0.3)), pipe(16)
    for a_pose, b_pose in zip(motion(5, 12), motion(6, 12)[::-1], strict=True):
        found = distance_paper(a, b, a_pose, b_pose)
        assert found.distance >= true_distance(a, b, a_pose, b_pose) - 1e-14
        for body, pose, face, point in (
            (a, a_pose, found.face_a, found.point_a),
            (b, b_pose, found.face_b, found.point_b),
        ):
            corners = body.face(face) @ pose[:3, :3].T + pose[:3, 3]
            assert oracle.point_polygon_distance_sq(point, corners) < 1e-28
        assert math.dist(found.point_a, found.point_b) == pytest.approx(found.distance, abs=1e-15)


def test_counterexample_rule_2_cuts_every_pair_of_a_knife_over_a_slab():
    """Smallest by hand: 1 mm apart, and all 30 face pairs are cut.

    The knife's edge is at x = 0.9 over a slab that ends at x = 1, and the blade leans outwards. Its
    lower side faces the slab's top, but the top's centre (0, 0, 0) is behind that side's plane; its
    upper side faces away. Every other pair is perpendicular or looks away.
    """
    slab = box((2, 2, 0.02))
    profile = np.array([(0.9, 0.001), (1.9, 1.0), (1.9, 1.2)])
    knife = Polyhedron(
        np.array([(x, y, z) for y in (-0.2, 0.2) for x, z in profile]),
        [(0, 1, 2), (3, 5, 4), (0, 3, 4, 1), (0, 2, 5, 3), (1, 4, 5, 2)],
    )
    lying = at(z=-0.01)
    assert true_distance(slab, knife, lying) == pytest.approx(0.001, rel=1e-12)
    found = distance_paper(slab, knife, lying)
    assert found.distance == math.inf
    assert found.tally["cut_by_rule_2"] == 30
    without = distance_paper(slab, knife, lying, rule_2=False)
    assert without.distance == pytest.approx(0.001, rel=1e-12)


def test_the_example_of_figure_1():
    """Two faces that look at each other, and two that look away, whose normals are opposite as well: in the text
    n2 and n3, where n2 . v1 is positive, and n4 and n8, where n4 . v1 is negative.
    """
    left, right = box((1, 1, 1)), box((1, 1, 1))
    faces = {side: {tuple(n): i for i, n in enumerate(shape.normals.round().tolist())}
             for side, shape in (("left", left), ("right", right))}  # fmt: skip

    def one(shape, side, x):
        return Polyhedron(shape.face(faces[side][x, 0.0, 0.0]), [range(4)])

    n2, n3 = one(left, "left", 1.0), one(right, "right", -1.0)
    n4, n8 = one(left, "left", -1.0), one(right, "right", 1.0)
    beside = at(3.0)
    facing, away = distance_paper(n2, n3, None, beside), distance_paper(n4, n8, None, beside)
    assert (facing.tally["measured"], facing.distance) == (1, 2.0)
    assert (away.tally["cut_by_rule_2"], away.tally["measured"], away.distance) == (1, 0, math.inf)
    assert distance_paper(n4, n8, None, beside, rule_2=False).distance == 4.0
    whole = distance_paper(left, right, None, beside)
    assert (whole.tally["measured"], whole.tally["cut_by_rule_2"], whole.distance) == (1, 35, 2.0)


TRIANGLE = np.array([[0, 0, 0], [3, 0, 0], [0, 3, 0]], dtype=float)
SQUARE = np.array([[0, 0, 0], [2, 0, 0], [2, 2, 0], [0, 2, 0]], dtype=float)


def true_polygon_distance(p, q) -> float:
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
        assert found.distance >= true_polygon_distance(p, q) - rounding - warp
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
