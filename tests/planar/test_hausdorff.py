"""The Hausdorff distance against the oracle, against known values, and against the axioms of a metric."""

import math

import numpy as np
import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from clearance.errors import ClearanceError
from clearance.kernels.hausdorff.state import SearchGoal
from clearance.kernels.hausdorff.trim import candidate_arcs
from clearance.planar.curve import Curve
from clearance.planar.directed import placed
from clearance.planar.hausdorff import _solve, hausdorff, within
from tests.examples import examples
from tests.oracle import planar_hausdorff as oracle
from tests.planar.test_within import waves

N_RANDOM = 24
"""Random pairs held against the oracle."""

pytestmark = pytest.mark.skipif(not oracle.PRECISE, reason="no extended floats on this machine")


def random_pair(seed):
    """Two splines, as (control, degree, weights): walks, near copies, rational, far off, tiny and huge."""
    rng = np.random.default_rng(seed)
    n = int(rng.integers(4, 12))
    degree, other = min(int(rng.integers(1, 5)), n - 1), int(rng.integers(1, 4))
    c, d = (np.cumsum(rng.normal(size=(n, 2)), axis=0) for _ in range(2))
    style = seed % 5
    if style == 1:
        d, other = c + rng.normal(size=(n, 2)) * 10.0 ** -int(rng.integers(1, 5)), degree
    weights = rng.uniform(0.3, 3.0, n) if style == 2 else None
    if style == 3:
        c, d = c + 1e6, d + 1e6
    if style == 4:
        scale = 10.0 ** int(rng.integers(-6, 7))
        c, d = c * scale, d * scale
    return (c, degree, weights), (d, other, rng.uniform(0.3, 3.0, n) if seed % 3 == 2 else None)


def truth(one, two):
    middle = np.round(one[0].mean(axis=0)).astype(oracle.REAL)
    moved = [(np.array(c, oracle.REAL) - middle, degree, w) for c, degree, w in (one, two)]
    parts = [oracle.spline_parts(c, degree, weights=w) for c, degree, w in moved]
    return oracle.hausdorff(*parts)


def spline(c, degree, weights):
    return Curve.bspline(c, degree, weights=weights)


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(N_RANDOM))
def test_random_pairs_agree_with_the_oracle(seed):
    one, two = random_pair(seed)
    a, b = spline(*one), spline(*two)
    found = hausdorff(a, b)
    low, high = truth(one, two)
    size = max(a.size, b.size)
    assert high - low <= 1e-9 * size
    assert (
        low - found.error_bound - 1e-16 * size
        <= found.distance
        <= high + found.error_bound + 1e-16 * size
    )
    assert found.error_bound <= 1e-12 * size
    for directed in found.directed.values():
        assert directed.lower <= directed.distance <= directed.upper
        apart = math.hypot(*(directed.point_a - directed.point_b))
        assert apart == pytest.approx(
            directed.distance, abs=1e-14 * size + 1e-15 * np.abs(one[0]).max()
        )


WAVE = np.cumsum(np.random.default_rng(1).normal(size=(30, 2)), axis=0)
TURN = 2.0 * math.pi
OVERLAPS = {
    "identical": (Curve.bspline(WAVE), Curve.bspline(WAVE), 0.0),
    "reversed": (Curve.bspline(WAVE), Curve.bspline(WAVE[::-1]), 0.0),
    "raised degree": (
        Curve.bezier([[0, 0], [1, 2], [2, -1], [3, 0]]),
        Curve.bezier([[0, 0], [0.75, 1.5], [1.5, 0.5], [2.25, -0.75], [3, 0]]),
        0.0,
    ),
    "part of a line": (Curve.line([0, 0], [4, 3]), Curve.polyline([[0, 0], [2, 1.5]]), 2.5),
    "concentric": (Curve.circle([0, 0], 1), Curve.circle([0, 0], 1.25), 0.25),
    "concentric, other start": (
        Curve.circle([0, 0], 1),
        Curve.arc([0, 0], 1.25, 0.3, 0.3 + TURN),
        0.25,
    ),
    "1e-9 apart": (
        Curve.circle([0, 0], 1),
        Curve.arc([0, 0], 1 + 1e-9, 0.3, 0.3 + TURN),
        (1 + 1e-9) - 1,
    ),
    "offset lines": (Curve.line([0, 0], [1, 0]), Curve.line([0, 0.5], [1, 0.5]), 0.5),
    "eccentric": (Curve.circle([0, 0], 1), Curve.circle([0.125, 0], 1), 0.125),
    "a dot in a circle": (Curve.circle([0, 0], 1), Curve.line([-1e-15, 0], [1e-15, 0]), 1.0),
    "closed against open": (
        Curve.circle([0, 0], 1),
        Curve.arc([0, 0], 1, 0, math.pi),
        math.sqrt(2.0),
    ),
}


@pytest.mark.parametrize("name", OVERLAPS)
def test_overlap_does_not_hurt(name):
    a, b, known = OVERLAPS[name]
    found = hausdorff(a, b)
    size = max(a.size, b.size)
    assert abs(found.distance - known) <= 1e-14 * size
    assert found.error_bound <= 2e-14 * size
    assert found.tally.intervals < 2000 and found.tally.given_up == 0


def hausdorff_point(curve, point):
    from clearance.kernels.curve.feet import feet

    out = np.empty((1, 4))
    feet(curve.pieces, curve.leaves, (point - curve.origin)[None], out)
    return out[0, 0]


def slope(curve, parameter, direction):
    """The cosine between the tangent and a direction."""
    tangent = curve.derivative(parameter)
    return abs(tangent @ direction) / (math.hypot(*tangent) * math.hypot(*direction))


FIG_18 = {
    "a": (5, 0, "end"),
    "b": (10, 30, "self_bisector"),
    "c": (15, 0, "common_normal"),
    "d": (30, 0, "common_normal"),
}


@pytest.mark.parametrize("name", FIG_18)
def test_the_situations_of_fig_18_have_their_kinds(name):
    """The paper's numbers of control points; each kind is shown by what defines it."""
    n, seed, kind = FIG_18[name]
    a, b = waves(n, seed)
    found = hausdorff(a, b)
    assert found.kind == kind
    one, at, other = (
        (a, found.parameter_a, b) if found.direction == "a_to_b" else (b, found.parameter_b, a)
    )
    line = found.point_b - found.point_a
    if kind == "end":
        assert min(abs(at), abs(1 - at)) < 1e-12
    elif kind == "common_normal":
        assert slope(a, found.parameter_a, line) < 1e-7 and 1e-9 < at < 1 - 1e-9
        assert slope(b, found.parameter_b, line) < 1e-7
    else:
        assert slope(one, at, line) > 1e-3
        point = one.point(at)
        gaps = np.hypot(*(other.point(np.linspace(0, 1, 200_001)) - point).T)
        low = np.flatnonzero((gaps[1:-1] < gaps[:-2]) & (gaps[1:-1] < gaps[2:])) + 1
        nearest_two = np.sort(gaps[low])[:2]
        assert np.allclose(nearest_two, found.distance, atol=1e-6 * other.size)


points = st.lists(st.tuples(st.integers(-8, 8), st.integers(-8, 8)), min_size=4, max_size=7)


def curve_of(control):
    """A spline, a weighted one, a polyline or a closed polyline, as the first point says; never refused."""
    control = np.array(control, float)
    try:
        kind = int(control[0].sum()) % 4
        if kind >= 2:
            return Curve.polyline(control, closed=kind == 3)
        weights = 1.0 + np.abs(control[:, 0]) if kind else None
        return Curve.bspline(control, min(3, len(control) - 1), weights=weights)
    except ClearanceError:
        return Curve.polyline([[0, 0], [1, 0]])


@examples(40)
@given(points, points, points)
def test_axioms_of_a_metric(one, two, three):
    a, b, c = curve_of(one), curve_of(two), curve_of(three)
    ab, ba, ac, cb = hausdorff(a, b), hausdorff(b, a), hausdorff(a, c), hausdorff(c, b)
    bounds = ab.error_bound + ac.error_bound + cb.error_bound
    assert abs(ab.distance - ba.distance) <= ab.error_bound + ba.error_bound
    assert ab.distance <= ac.distance + cb.distance + bounds
    assert ab.error_bound <= 1e-13 * max(a.size, b.size)


@examples(80)
@given(points, points)
def test_zero_iff_equal(one, two):
    """0 to rounding for the same curve run through otherwise; no sample of either may be farther than it."""
    a, b = curve_of(one), curve_of(two)
    assert hausdorff(a, a).distance <= 1e-14 * a.size
    assert hausdorff(a, a.reversed()).distance <= 1e-14 * a.size
    found = hausdorff(a, b)
    for one, two in ((a, b), (b, a)):
        for p in one.point(np.linspace(one.limits[0, 0], one.limits[-1, 1], 41)):
            assert hausdorff_point(two, p) <= found.distance + found.error_bound
    assert within(a, b, found.distance)
    assert found.distance < 1e-6 or not within(a, b, found.distance * (1 - 1e-9))


def aim_of(gap, enough=0.0, limit=math.inf):
    return SearchGoal(gap, gap, math.inf, enough, limit, 1e5)


def test_within_stops_at_the_first_point_beyond():
    """A limit far below the distance is refused after a few intervals, one above it after all of them."""
    c = np.cumsum(np.random.default_rng(5).normal(size=(60, 2)), axis=0)
    a, b = Curve.bspline(c), Curve.bspline(c + 0.3 * np.random.default_rng(6).normal(size=c.shape))
    shift, size = placed(a, b)
    intervals = [
        int(_solve(a, b, shift, aim_of(1e-15 * size, limit=limit))[0]["n_cuts"].sum())
        for limit in (1e-3, math.inf)
    ]
    assert intervals[0] * 20 < intervals[1]
    assert not within(a, b, 1e-3) and within(a, b, 10.0)


@examples(60)
@example(one=[(0, -1), (0, 0), (0, 1), (0, 1)], two=[(0, 0)] * 4)
@given(points, points)
def test_trimming_is_safe(one, two):
    a, b = curve_of(one), curve_of(two)
    directed = hausdorff(a, b).directed["a_to_b"]
    bound = 0.9 * directed.distance
    shift, rows = a.origin - b.origin, a.leaves.arcs
    pixel = a.length / max(64, 2 * len(rows))
    remaining = candidate_arcs(a.pieces, a.leaves, b.leaves, shift[0], shift[1], bound, pixel)
    piece, local = a.leaves.piece[remaining], rows[remaining, :2]
    low, high = a.limits[piece].T[:, :, None]
    kept = low + local * (high - low)
    u = np.linspace(a.limits[0, 0], a.limits[-1, 1], 301)
    u = u[
        ((a.limits[:, :1] <= u) & (u <= a.limits[:, 1:])).any(axis=0)
    ]  # pieces of no length are left out
    trimmed = (
        ~((kept[:, :1] <= u) & (u <= kept[:, 1:])).any(axis=0)
        if len(kept)
        else np.ones(len(u), bool)
    )
    for p in a.point(u[trimmed]):
        assert hausdorff_point(b, p) <= bound + 1e-15 * a.size


def test_refusals():
    a = Curve.line([0, 0], [1, 0])
    for call, said in [
        (lambda: hausdorff(a, a, method="best"), "method: 'best'; 'trimmed' or 'paper'"),
        (lambda: hausdorff(a, [[0, 0]]), "b: a list; a clearance Curve"),
        (lambda: hausdorff(a, a, tolerance=math.nan), "tolerance: nan"),
        (lambda: within(a, a, -1.0), "distance: -1"),
    ]:
        with pytest.raises(ClearanceError) as caught:
            call()
        assert said in str(caught.value)
