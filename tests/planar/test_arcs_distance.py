"""The least distance of two arcs in closed form, and of curves that run alongside each other."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import clearance as cl
from clearance.kernels.curve.arc import RADIUS, WIDTH, Chord, set_arc, set_segment
from clearance.kernels.curve.arcs import arcs_distance
from tests.examples import examples


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
