"""Tables laid out over a run: values and velocities at any time, rounds, jumps."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.interpolate import CubicHermiteSpline

from clearance.errors import BadTime
from clearance.world.knots import knots_of, looped

TIMES = np.array([1.0, 2.0, 4.0, 4.5])
VALUES = np.array([[0.0], [2.0], [-1.0], [3.0]])


def test_a_table_goes_straight_between_its_samples_and_stays_before_and_after():
    knots = knots_of(TIMES, VALUES)
    at = np.array([0.0, 1.0, 1.25, 3.0, 4.5, 9.0])
    assert knots.values_at(at)[:, 0].tolist() == [0.0, 0.0, 0.5, 0.5, 3.0, 3.0]
    assert knots.rates_at(at) is None
    assert not len(knots.jumps)


@given(st.integers(0, 2**32 - 1))
def test_a_part_of_a_cubic_is_the_same_cubic(seed):
    rng = np.random.default_rng(seed)
    times = np.cumsum(rng.uniform(0.1, 2.0, 5))
    values, rates = rng.normal(size=(5, 2)), rng.normal(size=(5, 2))
    knots = knots_of(times, values, rates)
    finer = np.unique(np.concatenate([times, rng.uniform(times[0], times[-1], 20)]))
    spline = CubicHermiteSpline(times, values, rates)
    assert np.allclose(knots.values_at(finer), spline(finer), rtol=0.0, atol=1e-12)
    reported = knots.rates_at(finer)
    assert np.allclose(reported, spline.derivative()(finer), rtol=0.0, atol=1e-11)
    again = CubicHermiteSpline(finer, knots.values_at(finer), reported)
    between = np.linspace(times[0], times[-1], 101)
    assert np.allclose(again(between), spline(between), rtol=0.0, atol=1e-11)


def test_a_cubic_that_begins_or_ends_in_motion_jumps_in_velocity_there():
    rates = np.array([[1.0], [0.0], [0.0], [0.0]])
    knots = knots_of(TIMES, VALUES, rates)
    assert knots.jumps.tolist() == [1.0]
    assert knots.rates_at(np.array([0.0, 0.5, 1.0]))[:, 0].tolist() == [0.0, 0.0, 0.0]
    assert knots.rates_at(np.array([1.0, 1.5]))[0, 0] == 1.0


def test_a_loop_jumps_back_where_its_ends_differ():
    knots = looped(knots_of(TIMES, VALUES), 9.0)
    assert knots.times[0] == 1.0 and knots.times[-1] >= 9.0
    assert knots.jumps.tolist() == [4.5, 8.0, 11.5]
    before, after = knots.values_at(np.array([4.0, 4.5])), knots.values_at(np.array([4.5, 5.0]))
    assert (before[-1, 0], after[0, 0]) == (3.0, 0.0)
    assert knots.values_at(np.array([4.5, 4.75]))[-1, 0] == 0.5


def test_a_loop_that_closes_does_not_jump():
    closed = np.array([[0.0], [2.0], [-1.0], [0.0]])
    assert not len(looped(knots_of(TIMES, closed), 20.0).jumps)


@given(st.integers(0, 2**32 - 1), st.integers(1, 5))
def test_a_loop_is_the_table_again(seed, n_rounds):
    rng = np.random.default_rng(seed)
    times = np.cumsum(rng.uniform(0.1, 2.0, 4))
    values = rng.normal(size=(4, 1))
    once, period = knots_of(times, values), times[-1] - times[0]
    knots = looped(once, times[0] + n_rounds * period)
    for i in range(n_rounds):
        inside = np.sort(rng.uniform(times[0], times[-1], 5))
        found = knots.values_at(np.append(inside + i * period, times[-1] + (i + 1) * period))[:-1]
        assert np.allclose(found, once.values_at(np.append(inside, np.inf))[:-1], atol=1e-9)


def test_too_many_rounds_are_refused():
    with pytest.raises(BadTime, match="loops"):
        looped(knots_of(np.array([0.0, 1e-9]), np.zeros((2, 1))), 10.0)


def test_a_rotation_turns_about_one_axis_at_constant_speed():
    turned = np.array([[0.0, 0.0, 0.0, 1.0], [0.0, 0.0, 1.0, 0.0]])  # half a turn about z
    knots = knots_of(np.array([0.0, 1.0]), turned, n_rotation=4)
    share = np.linspace(0.0, 1.0, 7)
    expected = np.column_stack(
        [np.zeros((7, 2)), np.sin(np.pi / 2 * share), np.cos(np.pi / 2 * share)]
    )
    assert np.allclose(knots.values_at(share), expected, rtol=0.0, atol=1e-15)
