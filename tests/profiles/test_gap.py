"""The proven gap of a sketch and an outline, on circles, whose gaps are known."""

import pytest

from clearance.planar.curve import Curve
from clearance.profiles.gap import ClosedContours, proven_gap


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
