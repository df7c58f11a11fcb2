"""Curves: what the constructors make, what they refuse, and that evaluation agrees with scipy."""

import math

import numpy as np
import pytest

from clearance.errors import ClearanceError
from clearance.kernels.curve.bezier import rough_joints
from clearance.planar.curve import Curve

SQUARE = [[0, 0], [1, 0], [1, 1], [0, 1]]


def ends_of(curve):
    """(n, 2) whether each piece's start and end is an end of a contour or a corner."""
    return rough_joints(curve.pieces, curve.joints)


@pytest.mark.parametrize("degree", [1, 2, 3, 4, 7])
def test_bspline_agrees_with_scipy(degree):
    from scipy.interpolate import BSpline

    rng = np.random.default_rng(degree)
    control = rng.normal(size=(12, 2))
    inner = np.sort(rng.random(12 - degree - 1))
    knots = np.concatenate([np.zeros(degree + 1), inner, np.ones(degree + 1)])
    curve, spline = Curve.bspline(control, degree, knots), BSpline(knots, control, degree)
    u = np.linspace(0.0, 1.0, 257)[:-1]
    assert np.allclose(curve.point(u), spline(u), atol=1e-13)
    assert np.allclose(curve.derivative(u), spline(u, 1), atol=1e-9)
    if degree > 1:
        scale = np.abs(spline(u, 2)).max()
        assert np.abs(curve.derivative(u, 2) - spline(u, 2)).max() < 1e-8 * scale


def test_unclamped_closed_spline_and_repeated_knots():
    from scipy.interpolate import BSpline

    control = np.random.default_rng(3).normal(size=(9, 2))
    knots = np.array([0, 1, 2, 3, 4, 4, 4, 5, 6, 7, 8, 9, 10], float)
    curve, spline = Curve.bspline(control, 3, knots), BSpline(knots, control, 3)
    u = np.linspace(3.0, 6.999, 301)
    assert np.allclose(curve.point(u), spline(u), atol=1e-13)


def test_arc_is_round_and_circle_closes():
    arc = Curve.arc([2, -1], 3.0, 0.3, 4.0)
    points = arc.point(np.linspace(0, 1, 101))
    assert np.allclose(np.hypot(*(points - [2, -1]).T), 3.0, atol=1e-14)
    assert np.allclose(points[0], [2 + 3 * math.cos(0.3), -1 + 3 * math.sin(0.3)])
    assert np.allclose(points[-1], [2 + 3 * math.cos(4.0), -1 + 3 * math.sin(4.0)])
    circle = Curve.circle([0, 0], 2.0)
    assert circle.is_closed and not arc.is_closed
    assert circle.length == pytest.approx(4.0 * math.pi, rel=1e-12)
    assert not ends_of(circle).any()


def test_corners_and_ends_are_distinguished_from_smooth_joints():
    assert ends_of(Curve.polyline(SQUARE, closed=True)).all()
    spline = Curve.bspline(np.random.default_rng(0).normal(size=(8, 2)))
    assert ends_of(spline).sum() == 2
    slot = Curve.chain([Curve.line([0, 0], [1, 0]), Curve.arc([1, 1], 1, -math.pi / 2, 0)])
    assert ends_of(slot).tolist() == [[True, False], [False, True]]


def test_transformed_reversed_chain_and_contours():
    curve = Curve.bspline([[0, 0], [1, 2], [3, 1], [4, 4]], weights=[1, 2, 1, 3])
    c, s = math.cos(0.7), math.sin(0.7)
    turn = np.array([[c, -s, 5], [s, c, -2]])
    u = np.linspace(0, 1, 17)
    assert np.allclose(
        curve.transformed(turn).point(u), curve.point(u) @ turn[:, :2].T + turn[:, 2]
    )
    assert np.allclose(curve.reversed().point(u), curve.point(1 - u), atol=1e-14)
    two = Curve.contours([curve, Curve.circle([9, 9], 1)])
    assert set(two.contour) == {0, 1} and two.n_pieces == 5


REFUSED = [
    (lambda: Curve.polyline([[0, 0]]), "points: 1 point(s); at least 2"),
    (lambda: Curve.polyline([[0, 0], [0, 0], [0, 0]]), "zero length"),
    (lambda: Curve.polyline([[0, 0], [np.nan, 1]]), "points[1, 0]: nan"),
    (lambda: Curve.polyline([[0, 0, 0], [1, 1, 1]]), "shape (2, 3)"),
    (lambda: Curve.bspline(SQUARE[:3]), "control: 3 point(s); at least 4"),
    (lambda: Curve.bspline(SQUARE, weights=[1, -1, 1, 1]), "weights: weight -1 at index 1"),
    (lambda: Curve.bezier(SQUARE, weights=[1, 1e7, 1, 1]), "weights: weights from 1 to 1e+07"),
    (lambda: Curve.bspline(SQUARE, weights=[1, 1]), "weights: an array of shape (2,)"),
    (lambda: Curve.bspline(SQUARE, knots=[0, 0, 0, 0, 1, 1, 1]), "knots: 7 knots for 4"),
    (lambda: Curve.bspline(SQUARE, knots=[0, 0, 0, 1, 0, 1, 1, 1]), "knots: knot 0 at index 4"),
    (lambda: Curve.bspline(SQUARE, knots=[0] * 8), "knots: an empty domain"),
    (lambda: Curve.bspline(SQUARE * 2, 3, [0, 0, 0, 0, 1, 1, 1, 1, 2, 2, 2, 2]), "which tears"),
    (lambda: Curve.bspline(SQUARE, 0), "degree: degree 0"),
    (lambda: Curve.arc([0, 0], -1, 0, 1), "radius: radius -1"),
    (lambda: Curve.arc([0, 0], 1, 1, 1), "sweep of 0"),
    (lambda: Curve.arc([0, 0], 1, 0, 7), "sweep of 7"),
    (lambda: Curve.arc([0, np.nan], 1, 0, 1), "nan"),
    (lambda: Curve.chain([]), "parts: 0 parts"),
    (
        lambda: Curve.chain([Curve.line([0, 0], [1, 0]), Curve.line([2, 0], [3, 0])]),
        "part 1 starts 1 away",
    ),
    (lambda: Curve.line([0, 0], [1, 0]).transformed(np.zeros((2, 3))), "singular"),
    (lambda: Curve.polyline([[0, 0], [1e200, 0]]), "size 1e+200"),
]


@pytest.mark.parametrize(("make", "said"), REFUSED)
def test_refusals_are_one_clear_line(make, said):
    with pytest.raises(ClearanceError) as caught:
        make()
    assert said in str(caught.value)


@pytest.mark.parametrize(
    ("curve", "low", "high"),
    [
        (Curve.arc([2, 1], 3.0, 0.5, 3.5), None, None),
        (Curve.circle([1e6, -1e6], 2.0), [1e6 - 2, -1e6 - 2], [1e6 + 2, -1e6 + 2]),
        (Curve.bezier([[0, 0], [1, 4], [3, 4], [4, 0]]), [0, 0], [4, 3]),
        (Curve.polyline(SQUARE), [0, 0], [1, 1]),
        (Curve.bspline(np.random.default_rng(2).normal(size=(20, 2)), 5), None, None),
        (Curve.bspline(SQUARE, weights=[1, 9, 0.1, 2]), None, None),
        (
            Curve.bezier([[k / 7, 0.1] for k in range(8)], np.linspace(0.3, 3, 8)),
            [0, 0.1],
            [1, 0.1],
        ),
    ],
)
def test_bounding_box_is_the_least(curve, low, high):
    points = curve.point(np.linspace(curve.limits[0, 0], curve.limits[-1, 1], 20_001))
    (x0, y0), (x1, y1) = curve.bounding_box
    slack = 1e-14 * np.abs(curve.bounding_box).max()
    assert (points >= [x0 - slack, y0 - slack]).all() and (points <= [x1 + slack, y1 + slack]).all()
    assert np.allclose(points.min(axis=0), [x0, y0], atol=1e-6)
    assert np.allclose(points.max(axis=0), [x1, y1], atol=1e-6)
    if low is not None:
        assert np.allclose(curve.bounding_box, [low, high], atol=slack)
    assert (curve.box[0] <= curve.bounding_box[0] + slack).all()
    assert (curve.box[1] >= curve.bounding_box[1] - slack).all()
