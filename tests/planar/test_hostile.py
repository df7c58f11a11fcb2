"""Hostile classes against the oracle: points, closed and open, cusps, far off, tiny and huge."""

import math

import numpy as np
import pytest

from clearance.planar.curve import Curve
from clearance.planar.hausdorff import hausdorff
from tests.examples import first_fast
from tests.oracle import planar_hausdorff as oracle

pytestmark = pytest.mark.skipif(not oracle.PRECISE, reason="no extended floats on this machine")


def arc(center, radius, start=0.0, end=2.0 * math.pi):
    parts = oracle.arc_parts(center, radius, start, end, n=max(1, math.ceil((end - start) / 1.6)))
    return Curve.arc(center, radius, start, end), parts


def line(*points):
    return Curve.polyline(points), oracle.line_parts(points)


def spline(control, degree=3, weights=None, knots=None):
    control = np.array(control, float)
    parts = oracle.spline_parts(control, degree, knots=knots, weights=weights)
    return Curve.bspline(control, degree, knots=knots, weights=weights), parts


def periodic(control):
    """A closed cubic of single knots: the first three control points again at the end."""
    control = [*control, *control[:3]]
    return spline(control, 3, knots=np.arange(len(control) + 4.0))


DOT = spline([[0.25, 0.5], [0.25, 0.5], [0.25, 0.5], [0.25, 0.5 + 1e-14]])
CASES = {
    "point-like spline, circle": (DOT, arc([0, 0], 1.0)),
    "point-like line off the centre, circle": (line([0.125, 0], [0.125, 1e-15]), arc([0, 0], 1.0)),
    "point-like circle, circle": (arc([0.5, 0], 1e-12), arc([0, 0], 1.0)),
    "point-like line, point-like line": (line([0, 0], [1e-15, 0]), line([3, 4], [3, 4 + 1e-15])),
    "point-like polyline, wave": (
        line([1, 1], [1, 1 + 1e-13], [1, 1]),
        spline([[0, 0], [1, 3], [2, -3], [3, 0]]),
    ),
    "circle, open half": (arc([0, 0], 1.0), arc([0, 0], 1.0, 0.0, math.pi)),
    "circle, nearly closed arc": (arc([0, 0], 1.0), arc([0, 0], 1.0, 0.0, 6.2)),
    "closed square, open square": (
        line([0, 0], [1, 0], [1, 1], [0, 1], [0, 0]),
        line([0, 0], [1, 0], [1, 1], [0, 1]),
    ),
    "closed spline, open spline": (
        periodic([[0, 0], [2, 0], [3, 2], [1, 3], [-1, 1]]),
        spline([[0, 0], [2, 0], [3, 2], [1, 3], [-1, 1]]),
    ),
    "two closed splines": (
        periodic([[0, 0], [2, 0], [2, 2], [0, 2]]),
        periodic([[0, 0], [3, 0], [2, 3], [0, 2]]),
    ),
    "cusp, its own chord": (spline([[0, 0], [1, 1], [0, 1], [1, 0]]), line([0, 0], [1, 0])),
    "two cusps that face each other": (
        spline([[0, 0], [1, 1], [0, 1], [1, 0]]),
        spline([[0, 1.6], [1, 0.6], [0, 0.6], [1, 1.6]]),
    ),
    "doubled back inside a piece": (
        spline([[0, 0], [3, 0], [-2, 0], [1, 0]]),
        spline([[0, 0], [1, 0], [2, 0], [3, 0]]),
    ),
    "self-crossing, its mirror image": (
        spline([[0, 0], [3, 2], [-2, 2], [1, 0]]),
        spline([[0, 0], [3, -2], [-2, -2], [1, 0]]),
    ),
    "tangent arches": (
        spline([[0, 0], [1, 1], [2, 1], [3, 0]]),
        spline([[0, 1.5], [1, 0.5], [2, 0.5], [3, 1.5]]),
    ),
    "1e-12 short of tangent": (arc([0, 0], 1.0), arc([2 + 1e-12, 0], 1.0)),
    "tangent inside": (arc([0, 0], 1.0), arc([0.5, 0], 0.5)),
    "coincident ends and end tangents": (
        spline([[0, 0], [1, 1], [2, 1], [3, 0]]),
        spline([[0, 0], [1.5, 1.5], [1.5, 1.5], [3, 0]]),
    ),
    "loop, cusp": (
        spline([[0, 0], [3, 2], [-2, 2], [1, 0]]),
        spline([[0, 0], [1, 1], [0, 1], [1, 0]]),
    ),
    "symmetric over an arch": (
        spline([[-1, 0.3], [-0.5, 0.3], [0.5, 0.3], [1, 0.3]]),
        spline([[-1, 0], [-1, 3], [1, 3], [1, 0]]),
    ),
    "double control points": (
        spline([[0, 0], [0, 0], [2, 1], [2, 1]]),
        spline([[0, 1], [1, 0], [1, 0], [2, 0]]),
    ),
    "arc, polyline": (
        arc([0.2, 0], 1.5, 0.3, 5.0),
        line([-2, 0], [0, 1.3], [1, -1], [2, 2]),
    ),
    "coincident at one end": (
        spline([[0, 0], [1, 2], [2, -2], [3, 0]]),
        line([0, 0], [-1, -2], [-3, 1]),
    ),
    "a repeated knot's corner": (
        spline(
            [[0, 0], [1, 2], [2, 0], [3, 2], [4, 0], [5, 1], [6, 0]],
            knots=[0, 0, 0, 0, 1, 1, 1, 2, 2, 2, 2.0],
        ),
        line([0, 1], [6, 1]),
    ),
    "weights from 1e-3 to 1e3": (
        spline([[0, 0], [1, 2], [2, -2], [3, 0]], weights=np.array([1, 1e3, 1e-3, 1])),
        arc([1, 0], 1.5),
    ),
}


@pytest.mark.slow
@pytest.mark.parametrize("name", first_fast(CASES, 6))
def test_hostile_classes_agree_with_the_oracle(name):
    (a, one), (b, two) = CASES[name]
    found = hausdorff(a, b)
    low, high = oracle.hausdorff(one, two)
    size = float(np.hypot(*(np.maximum(a.box[1], b.box[1]) - np.minimum(a.box[0], b.box[0]))))
    slack = found.error_bound + 2e-16 * size
    assert low - slack <= found.distance <= high + slack
    # 1e-7: where all of one curve is equally far (a circle about a point) the oracle can leave out nothing
    assert high - low <= 1e-7 * size and found.error_bound <= 2e-14 * size
    assert hausdorff(b, a).distance == pytest.approx(found.distance, abs=2.0 * found.error_bound)
    apart = math.dist(found.point_a, found.point_b)
    assert apart == pytest.approx(found.distance, abs=2e-15 * size)


WAVES = [[[0, 0], [1, 2], [2, -2], [3, 0]], [[0, 1], [1, -2], [2, 1], [3, 1]]]
CUSPS = [[[0, 0], [1, 1], [0, 1], [1, 0]], [[0, 0.5], [1, 1.5], [0, 1.25], [1, 0.5]]]


@pytest.mark.parametrize("controls", [WAVES, CUSPS], ids=["waves", "cusps"])
@pytest.mark.parametrize(
    ("scale", "offset"),
    [(1e-90, 0.0), (1e90, 0.0), (1.0, 1e6), (1e-3, 1e6), (2.0**-20, -(2.0**25)), (1e6, 1e12)],
)
def test_tiny_huge_and_far_agree_with_the_oracle(controls, scale, offset):
    c, d = (np.array(points, float) * scale + offset for points in controls)
    found = hausdorff(Curve.bspline(c), Curve.bspline(d))
    parts = [oracle.spline_parts(np.array(p, oracle.REAL) - offset, 3) for p in (c, d)]
    low, high = oracle.hausdorff(*parts)
    assert low - found.error_bound <= found.distance <= high + found.error_bound
    assert found.error_bound <= 1e-13 * scale


def test_map_grows_with_length_and_not_with_the_page():
    one, two = (Curve.bspline(points) for points in WAVES)
    near = hausdorff(one, two).tally.pixels
    away = np.array([[1.0, 0.0, 1e7], [0.0, 1.0, 1e7]])
    large = np.array([[1e4, 0.0, 0.0], [0.0, 1e4, 0.0]])
    assert abs(hausdorff(one, two.transformed(away)).tally.pixels - near) <= 8
    assert hausdorff(one.transformed(large), two.transformed(large)).tally.pixels <= near + 8
    random = np.random.default_rng(0)
    pixels = []
    for n in (50, 200):
        c = np.stack([np.arange(n) * 1.0, random.normal(size=n)], axis=1)
        pixels.append(hausdorff(Curve.bspline(c), Curve.bspline(c + [0, 0.5])).tally.pixels)
    assert 3.0 < pixels[1] / pixels[0] < 5.0
