"""Gaps of a sketch and an outline, proven on circles; nearest places on lines and arcs; hulls of swept edges."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from clearance.errors import BadShape
from clearance.kernels.profile.swept_hulls import MOST, fattened_hull, hull_of
from clearance.planar.curve import Curve
from clearance.profiles.contour import Contour
from clearance.profiles.fit_rows import gaps_of_shape, sides_of
from clearance.profiles.gap import ClosedContours, proven_gap
from clearance.profiles.pieces import ContourPieces
from tests.examples import examples
from tests.oracle.outlines import inside


def contours(*circles: tuple[float, float]) -> ClosedContours:
    """Circles about points of the x axis: where, and of which radius."""
    return ClosedContours.of_curve(Curve.contours([Curve.circle((x, 0.0), r) for x, r in circles]))


RING = contours((0.0, 1.0))


@pytest.mark.parametrize(
    ("circles", "around", "gap"),
    [
        ([(0.0, 0.5)], True, 0.5),
        ([(0.25, 0.5)], True, 0.25),
        ([(3.0, 0.5)], False, 1.5),
        ([(3.0, 0.5), (-2.0, 0.25)], False, 0.75),
    ],
)
def test_a_gap_is_never_overstated(circles, around, gap):
    found, least = proven_gap(RING, contours(*circles), around=around)
    assert found <= gap <= least.distance + 1e-12
    assert found == pytest.approx(gap, abs=1e-6)


@pytest.mark.parametrize("around", [True, False])
def test_where_one_contour_is_on_the_wrong_side_there_is_no_gap(around):
    found, _ = proven_gap(RING, contours((0.0, 0.5), (3.0, 0.5)), around=around)
    assert found == -1.0


@pytest.mark.parametrize(
    "circles",
    [
        [(0.0, 1.0), (1.5, 1.0)],
        [(0.0, 1.0), (0.0, 1.0)],
        [(9.0, 1.0), (0.0, 1.0), (0.1, 0.95)],
    ],
)
def test_contours_that_overlap_are_refused_for_parity_would_leave_out_what_both_enclose(circles):
    with pytest.raises(
        BadShape, match=r"zone: contours \d and \d overlap, as at .*; contours beside"
    ):
        contours(*circles).require_apart("zone")


@pytest.mark.parametrize(
    "circles",
    [
        [(0.0, 1.0), (2.5, 1.0)],
        [(0.0, 1.0), (2.0, 1.0)],
        [(0.0, 1.0), (0.0, 0.5), (0.0, 0.25)],
        [(0.0, 1.0), (0.5, 0.5)],
    ],
)
def test_contours_beside_one_another_or_nested_are_not(circles):
    contours(*circles).require_apart("zone")


def test_a_contour_that_laps_over_itself_is_refused_and_one_that_crosses_itself_is_not():
    turn = 4.0 * np.pi / 5.0 * np.arange(5)
    star = Curve.polyline(np.stack([np.cos(turn), np.sin(turn)], axis=1), closed=True)
    with pytest.raises(BadShape, match="zone: contour 1 laps over itself, as at"):
        ClosedContours.of_curve(star).require_apart("zone")
    eight = Curve.polyline([[0, 0], [1, 1], [1, 0], [0, 1]], closed=True)
    ClosedContours.of_curve(eight).require_apart("zone")


def ring(seed, n):
    """A closed chain about the origin, lines and arcs either way."""
    rng = np.random.default_rng(seed)
    turn = np.sort(rng.uniform(0.0, 2.0 * math.pi, n))
    radius = rng.uniform(0.5, 1.0, n)
    vertices = np.stack([radius * np.cos(turn), radius * np.sin(turn)], axis=1)
    return Contour(vertices, rng.uniform(-0.9, 0.9, n) * (rng.random(n) < 0.6))


@examples(50)
@given(st.integers(0, 10**6), st.integers(3, 70))
def test_no_point_of_many_on_the_pieces_is_nearer_than_the_foot(seed, n):
    pieces = ContourPieces([ring(seed, n), ring(seed + 1, 5)])
    points = np.random.default_rng(seed).uniform(-2.0, 2.0, (20, 2))
    piece, share, foot = pieces.feet(points)
    assert np.allclose(pieces.point(piece, share), foot, atol=1e-12)
    off = np.hypot(*(points - foot).T)
    along = pieces.point(*pieces.spread(64))
    least = np.hypot(*(points[:, None] - along[None]).transpose(2, 0, 1)).min(axis=1)
    longest = 4.0 * math.pi / 64.0
    assert (off <= least + 1e-12).all() and (off >= least - longest).all()


@pytest.mark.parametrize("bulge", [0.0, 0.1, -0.02])
def test_beyond_a_sharp_corner_a_point_is_outside_whichever_side_is_nearest(bulge):
    """Behind a needle's tip the point lies before one of its sides and behind the other's line."""
    needle = Contour(np.array([[0.0, 0.0], [3.0, -0.2], [3.0, 0.2]]), np.array([bulge, 0.0, bulge]))
    closed = ClosedContours((needle,))
    sides = sides_of(closed.pieces, closed.region)
    points = np.array([[-0.1, 0.02], [-0.1, -0.02], [-1e-3, 1e-3], [1.0, 0.0], [3.1, 0.3]])
    other = ContourPieces([Contour(points, np.zeros(len(points)))])
    samples = np.arange(len(points)), np.zeros(len(points))
    reported = gaps_of_shape(closed.pieces, sides, other, samples).distance > 0.0
    rows = [np.column_stack([needle.vertices, needle.bulges]).tolist()]
    assert reported.tolist() == [bool(inside(p.tolist(), rows)) for p in points]


def slender(rng: np.random.Generator) -> np.ndarray:
    """(4, 2) points on a line, but for rounding."""
    a, b = rng.normal(size=(2, 2))
    points = a + rng.random(4)[:, None] * (b - a)
    if rng.random() < 0.5:
        points[:, 1] = points[0, 1] * (1.0 + rng.integers(-2, 3, 4) * np.finfo(float).eps)
    return points


def test_the_hull_of_points_on_a_line_has_each_once_and_widened_holds_them_all():
    rng = np.random.default_rng(0)
    for _ in range(300):
        points, width = slender(rng), float(10.0 ** rng.uniform(-7, -2))
        out, widened = np.empty((40, 2)), np.empty((16, 2))
        assert hull_of(points.copy(), 4, out) <= 4
        n = fattened_hull(points.copy(), 4, width, widened, out)
        assert 4 <= n <= MOST
        corners = out[:n]
        sides = np.roll(corners, -1, axis=0) - corners
        for point in points:
            away = point - corners
            assert (sides[:, 0] * away[:, 1] - sides[:, 1] * away[:, 0] >= -1e-15).all()
