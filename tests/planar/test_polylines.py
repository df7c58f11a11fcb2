"""Polylines: against the oracle, against the general way, and on outlines of a hundred thousand vertices."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from clearance.errors import ClearanceError
from clearance.planar.curve import Curve
from clearance.planar.hausdorff import hausdorff, within
from tests.examples import examples, some_slow
from tests.oracle import planar_hausdorff as oracle

precise = pytest.mark.skipif(not oracle.PRECISE, reason="no extended floats on this machine")


def walk(n, seed):
    return np.cumsum(np.random.default_rng(seed).normal(size=(n, 2)), axis=0)


def curved(points):
    """The same polyline with every segment raised to degree 2, which takes the general way."""
    points = np.asarray(points, float)
    parts = [
        Curve.bezier([p, 0.5 * (p + q), q])
        for p, q in zip(points[:-1], points[1:], strict=True)
        if np.any(p != q)
    ]
    return Curve.chain(parts)


@precise
@pytest.mark.parametrize("n", some_slow([*range(2, 21), 25, 31, 37, 43], {14, 17, 31}))
def test_vertex_count_sweep_against_the_oracle(n):
    """Every count of vertices, those that are 1 mod 6 among them, whichever side they are on."""
    many, few = walk(n, n), walk(5, 1000 + n)
    low, high = oracle.hausdorff(oracle.line_parts(many), oracle.line_parts(few))
    for p, q in ((many, few), (few, many)):
        found = hausdorff(Curve.polyline(p), Curve.polyline(q))
        assert low - found.error_bound <= found.distance <= high + found.error_bound
    raised = hausdorff(curved(many), Curve.polyline(few))
    assert low - raised.error_bound <= raised.distance <= high + raised.error_bound


vertices = st.lists(st.tuples(st.integers(-6, 6), st.integers(-6, 6)), min_size=2, max_size=12)


@examples(80)
@given(vertices, vertices, st.booleans())
def test_the_quick_way_agrees_with_the_general_one(one, two, near):
    if near:  # the same vertices almost: bisectors, overlap and ties
        two = [(x + 1e-7 * y, y) for x, y in one[::-1]]
    try:
        a, b, c = Curve.polyline(one), Curve.polyline(two), curved(one)
    except ClearanceError:
        return
    quick, general = hausdorff(a, b), hausdorff(c, b)
    size = max(a.size, b.size, quick.distance)
    for direction in ("a_to_b", "b_to_a"):
        p, q = quick.directed[direction], general.directed[direction]
        assert abs(p.distance - q.distance) <= p.error_bound + q.error_bound
        apart = math.dist(p.point_a, p.point_b)
        assert apart == pytest.approx(p.distance, abs=1e-14 * size)
    assert quick.error_bound <= 1e-14 * size and quick.tally.given_up == 0


def outline(n, noise):
    random = np.random.default_rng(2)
    angle = np.linspace(0.0, 2.0 * math.pi, n + 1)[:-1]
    radius = 1.0 + 0.05 * sum(math.exp(-0.4 * k) * np.sin(k * angle + k * k) for k in range(2, 40))
    radius += noise * random.normal(size=n)
    return np.stack([radius * np.cos(angle), radius * np.sin(angle)], axis=1)


@pytest.mark.slow
@pytest.mark.parametrize("noise", [2e-3])
def test_outlines_of_108_594_vertices(noise):
    many = outline(108_594, noise)
    few = many[np.linspace(0, len(many) - 1, 720).astype(int)]
    a, b = Curve.polyline(many), Curve.polyline(few)
    found = hausdorff(a, b)
    assert found.tally.given_up == 0 and found.error_bound <= 1e-14 * a.size
    # the distance at each vertex, by brute force over the 61 segments about its place
    index = np.linspace(0, len(many) - 1, 720).astype(int)
    own = np.searchsorted(index, np.arange(len(many)), side="right") - 1
    best = np.full(len(many), np.inf)
    for step in range(-30, 31):
        k = np.clip(own + step, 0, 718)
        start, along = few[k], few[k + 1] - few[k]
        t = np.clip(((many - start) * along).sum(1) / (along**2).sum(1), 0, 1)[:, None]
        best = np.minimum(best, np.hypot(*(many - start - t * along).T))
    assert found.directed["a_to_b"].kind == "end"
    assert found.directed["a_to_b"].distance == pytest.approx(best.max(), abs=1e-15)
    assert within(a, b, found.distance) and not within(a, b, 0.999 * found.distance)


def slot(n):
    """A rounded slot of lines and arcs, and the closed polyline of `n` vertices on it."""
    parts = [
        Curve.line([3, 0], [37, 0]),
        Curve.arc([37, 3], 3, -0.5 * math.pi, 0.5 * math.pi),
        Curve.line([37, 6], [3, 6]),
        Curve.arc([3, 3], 3, 0.5 * math.pi, 1.5 * math.pi),
    ]
    exact = Curve.chain(parts)
    vertices = exact.point(np.linspace(0, exact.limits[-1, 1], n + 1)[:-1])
    return exact, vertices


def test_an_outline_against_its_own_tessellation():
    """Thousands of joints on the curve itself: each costs one crossing and not a row of halvings."""
    exact, vertices = slot(3000)
    fine = Curve.polyline(vertices, closed=True)
    found = hausdorff(exact, fine)
    assert found.tally.given_up == 0 and found.error_bound <= 1e-14 * exact.size
    assert found.tally.intervals < 10 * len(vertices)
    rows = fine.pieces.control[:, :2].reshape(-1, 2, 2) + fine.origin
    middle, half = rows.mean(axis=1), 0.5 * np.hypot(*(rows[:, 1] - rows[:, 0]).T)
    on_arc = (middle[:, 0] > 37.0) | (middle[:, 0] < 3.0)
    sagitta = 3.0 - np.sqrt(9.0 - half[on_arc] ** 2)
    # the chords across the four joints of line and arc aside, the farthest point is over a chord's middle
    assert sagitta.max() - 1e-13 <= found.distance <= 2.0 * half.max()
    few = hausdorff(exact, Curve.polyline(vertices))
    assert few.distance == pytest.approx(np.hypot(*(vertices[-1] - vertices[0])) / 2, rel=1e-3)


def comb(low, high):
    """Vertices of teeth just below the x axis, ten a unit; those at both ends are 0.1 below."""
    n = round(10 * (high - low))
    return [[low + (high - low) * k / n, -0.15 if k % 2 else -0.1] for k in range(n + 1)]


@pytest.mark.parametrize(("start", "width"), [(64, 6), (66, 2), (90, 2)])
def test_a_straight_edge_over_a_long_row_of_teeth_is_farthest_over_its_gap(start, width):
    bottom = [[start, -12], [start + width, -12]]
    teeth = Curve.polyline([*comb(0, start), *bottom, *comb(start + width, 100)])
    below = Curve.contours([teeth, Curve.arc([50, -60], 1, 0, 1)])  # no polyline any more
    found = hausdorff(Curve.line([0, 0], [100, 0]), below).directed["a_to_b"]
    assert found.distance == pytest.approx(math.hypot(0.5 * width, 0.1), rel=1e-12)
    assert found.lower <= math.hypot(0.5 * width, 0.1) <= found.upper
