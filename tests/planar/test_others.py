"""Biarcs, least distance, deviation, curve files and the compare command."""

import math

import numpy as np
import pytest

from clearance.errors import ClearanceError
from clearance.planar.biarcs import biarcs
from clearance.planar.curve import Curve
from clearance.planar.curve_file import read_curve
from clearance.planar.deviation import deviation
from clearance.planar.hausdorff import hausdorff
from clearance.planar.minimum import minimum_distance

WAVE = Curve.bspline([[0, 0], [1, 2], [2, -1], [3, 0], [4, 3], [5, 0]])
CUSP = Curve.bezier([[0, 0], [1, 1], [0, 1], [1, 0]])


@pytest.mark.parametrize(
    "curve",
    [
        WAVE,
        CUSP,
        Curve.circle([1e6, -1e6], 3.0),
        Curve.line([0, 0], [1, 2]),
        Curve.bezier([[0, 0], [3, 0], [-2, 0], [1, 0]]),  # straight, and doubled back
        Curve.bezier([[0, 0], [1, 1], [2, -1], [3, 0]]),  # an inflection
        Curve.bspline(
            [[0, 0], [1, 2], [2, 0], [3, 2], [4, 0]], 2, [0, 0, 0, 1, 1, 2, 2, 2.0]
        ),  # a corner
        Curve.bspline([[0, 0], [1, 2], [2, -1], [3, 0]], weights=[1, 50, 0.02, 1]),
    ],
)
@pytest.mark.parametrize("share", [1e-2, 1e-5])
def test_biarcs_stay_within_their_proven_error(curve, share):
    fitted = biarcs(curve, share * curve.size)
    assert (fitted.error <= share * curve.size).all()
    for (u0, u1), start, end, center, radius, error in zip(
        fitted.parameters,
        fitted.start,
        fitted.end,
        fitted.center,
        fitted.radius,
        fitted.error,
        strict=True,
    ):
        points = curve.point(np.linspace(u0, u1, 33))
        slack = error + 1e-15 * np.abs(points).max()
        assert np.hypot(*(points[0] - start)) <= slack and np.hypot(*(points[-1] - end)) <= slack
        if math.isfinite(radius):
            assert np.abs(np.hypot(*(points - center).T) - radius).max() <= slack
        else:
            along = (points - start) @ (end - start) / max(1e-300, (end - start) @ (end - start))
            feet = start + np.clip(along, 0, 1)[:, None] * (end - start)
            assert np.hypot(*(points - feet).T).max() <= slack
    assert np.allclose(fitted.parameters[1:, 0], fitted.parameters[:-1, 1])


def test_biarcs_of_a_circle_are_the_circle():
    fitted = biarcs(Curve.circle([0, 0], 2.0), 1e-9)
    assert np.allclose(fitted.radius, 2.0, atol=1e-12) and len(fitted) <= 8
    with pytest.raises(ClearanceError, match="a tolerance of 0"):
        biarcs(WAVE, 0.0)


def test_deviation_profile():
    base = Curve.line([0, 0], [5, 0])
    profile_of = deviation(WAVE, base, limit=0.5, samples=400)
    assert profile_of.distance.max() <= hausdorff(WAVE, base).directed["a_to_b"].distance + 1e-14
    assert np.allclose(profile_of.distance, np.abs(profile_of.point[:, 1]), atol=1e-14)
    assert len(profile_of.beyond) == 2
    assert np.allclose(np.abs(WAVE.point(profile_of.beyond.ravel())[:, 1]), 0.5, atol=1e-12)
    for samples in (2, 3, 50):  # no excursion hides between samples, however few
        few = deviation(WAVE, base, limit=0.5, samples=samples)
        assert np.allclose(few.beyond, profile_of.beyond, atol=1e-12)
    weights = np.array([1, 5, 0.2, 1.0])
    bent = Curve.contours([Curve.bezier([[0, 0], [1, 9], [2, -9], [3, 0]], weights), WAVE])
    assert np.allclose(
        deviation(bent, base, limit=1.0, samples=2).beyond,
        deviation(bent, base, limit=1.0, samples=3000).beyond,
        atol=1e-12,
    )
    with pytest.raises(ClearanceError, match="share: 101; 0 to 100"):
        profile_of.percentile(101)
    tent = deviation(Curve.line([0, 0], [1, 1]), Curve.line([0, 0], [1, 0]), samples=1000)
    assert tent.mean == pytest.approx(0.5, abs=1e-9)
    assert tent.percentile(90) == pytest.approx(0.9, abs=2e-3)


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("curves: []", "curves: an empty list"),
        ("curves:\n  - splin: {}", "curves[0]: 'splin'"),
        ("curves:\n  - circle: {center: [0, 0]}", "curves[0]: circle: radius: nothing given"),
        (
            "curves:\n  - circle: {center: [0, 0], radius: -1}",
            "curves[0]: circle: radius: radius -1",
        ),
        ("a: [", "not YAML"),
    ],
)
def test_curve_files_are_refused_with_file_and_field(tmp_path, text, said):
    file = tmp_path / "c.yaml"
    file.write_text(text)
    with pytest.raises(ClearanceError) as caught:
        read_curve(str(file))
    assert said in str(caught.value) and "c.yaml" in str(caught.value)


def test_least_distance_at_ends_and_corners_closes_its_bounds():
    """Minima at borders of cells, where the distance falls linearly: once the whole budget went there."""
    pairs = [
        (Curve.line([0, 0], [1, 1]), Curve.line([2, 1.5], [3, 5]), math.hypot(1, 0.5)),
        (Curve.polyline([[0, 0], [1, 1], [2, 0]]), Curve.line([-1, 3], [4, 3]), 2.0),
        (Curve.polyline([[0, 0], [1, 1], [2, 0]]), Curve.circle([1, 4], 1), 2.0),
        (Curve.circle([1e6, 0], 1), Curve.circle([1e6 + 3, 0], 1), 1.0),
        (Curve.line([0, 0], [4, 0]), Curve.line([1, 0.5], [3, 0.5]), 0.5),
        (Curve.line([0, 0], [4, 0]), Curve.line([0, 1e-9], [4, 1e-9]), 1e-9),
    ]
    for a, b, known in pairs:
        found = minimum_distance(a, b)
        assert abs(found.distance - known) <= 1e-15 * known + a.rounding + b.rounding
        assert found.error_bound <= 1e-12 * max(a.size, b.size)
        assert minimum_distance(b, a).distance == pytest.approx(known, abs=1e-14)
