"""Biarcs, least distance, of arcs in closed form too, deviation, curve files and the compare command."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import clearance as cl
from clearance.errors import ClearanceError
from clearance.kernels.curve.arc import RADIUS, WIDTH, Chord, set_arc, set_segment
from clearance.kernels.curve.arcs import arcs_distance
from clearance.planar.biarcs import biarcs
from clearance.planar.curve import Curve
from clearance.planar.curve_file import read_curve
from clearance.planar.deviation import deviation
from clearance.planar.hausdorff import hausdorff
from clearance.planar.minimum import minimum_distance
from tests.examples import examples

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


def arc(x0, y0, angle, x1, y1):
    """The arc from one point along a direction to another; the segment where that is the chord's."""
    row, chord = np.zeros(WIDTH), Chord(x0, y0, x1, y1)
    if angle is None:
        set_segment(row, 0.0, 1.0, chord)
    else:
        set_arc(row, 0.0, 1.0, chord, math.cos(angle), math.sin(angle), 1e-15)
    return row


def points_on(row, n=2001):
    """(n, 2) along an arc."""
    if row[RADIUS] == 0.0:
        return np.linspace(row[2:4], row[4:6], n)
    center = row[6:8]
    first, last = (math.atan2(*(row[k : k + 2] - center)[::-1]) for k in (2, 4))
    sweep = (last - first) % (2.0 * math.pi)
    if row[9] < 0.0:
        sweep -= 2.0 * math.pi
    turn = first + sweep * np.linspace(0.0, 1.0, n)
    return center + row[RADIUS] * np.stack([np.cos(turn), np.sin(turn)], axis=1)


def drawn(rng, grid):
    """A random arc or segment, on a coarse grid where ends and centres coincide often."""
    ends = rng.integers(-3, 4, 4) * 0.5 if grid else rng.uniform(-1.5, 1.5, 4)
    if (ends[:2] == ends[2:]).all():
        ends[2] += 1.0
    chord = math.atan2(ends[3] - ends[1], ends[2] - ends[0])
    turns = (
        [None, 0.25 * math.pi, -0.25 * math.pi, 0.1] if grid else [None, *rng.uniform(-1.4, 1.4, 3)]
    )
    turn = turns[rng.integers(4)]
    return arc(*ends[:2], None if turn is None else chord + turn, *ends[2:])


@pytest.mark.slow
@examples(150)
@given(st.integers(0, 2**32 - 1), st.booleans())
def test_the_distance_of_two_arcs_is_that_of_many_points_on_them(seed, grid):
    rng = np.random.default_rng(seed)
    a, b = drawn(rng, grid), drawn(rng, grid)
    least, rounding = arcs_distance(a, b)
    p, q = points_on(a), points_on(b)
    from scipy.spatial import cKDTree

    seen, _ = cKDTree(q).query(p)
    step = max(np.hypot(*np.diff(c, axis=0).T).max() for c in (p, q))
    assert least - rounding <= seen.min() <= least + step
    assert arcs_distance(b, a)[0] == pytest.approx(least, abs=rounding)


@pytest.mark.parametrize("off", [0.0, 1e-16, 1e-12, 1e-6, 0.05])
def test_circles_about_nearly_one_centre_are_apart_by_the_radii_less_the_centres_step(off):
    found = cl.minimum_distance(cl.Curve.circle([0, 0], 1.0), cl.Curve.circle([off, 0], 1.1))
    assert found.distance == pytest.approx(0.1 - off, abs=1e-14)
    assert found.error_bound <= 2e-12


@pytest.mark.parametrize("side", [1.0, -1.0])
def test_a_polyline_alongside_a_circle_is_right_to_the_last_digits(side):
    """Its corners are on a circle of their own: outside, its sides come nearest, inside, its corners."""
    n, radius = 3000, 1.0 + side * 1e-3
    turn = 2.0 * math.pi * np.arange(n) / n
    ring = cl.Curve.polyline(radius * np.stack([np.cos(turn), np.sin(turn)], axis=1), closed=True)
    found = cl.minimum_distance(cl.Curve.circle([0, 0], 1.0), ring)
    wanted = radius * math.cos(math.pi / n) - 1.0 if side > 0.0 else 1.0 - radius
    assert found.distance == pytest.approx(wanted, abs=1e-13)
    assert found.error_bound <= 2e-12


def test_a_curve_beside_its_own_offset_is_certified():
    spline = cl.Curve.bspline([[0, 0], [1, 2], [2, -1], [3, 1], [4, 0], [5, 1]])
    at = np.linspace(0.0, 1.0, 801)
    tangent = spline.derivative(at)
    normal = np.stack([-tangent[:, 1], tangent[:, 0]], axis=1) / np.hypot(*tangent.T)[:, None]
    beside = cl.Curve.polyline(spline.point(at) + 2e-3 * normal)
    found = cl.minimum_distance(spline, beside)
    feet = cl.deviation(beside, spline, samples=20000).distance.min()
    assert found.distance <= feet + 1e-12
    assert found.error_bound <= 1e-11
