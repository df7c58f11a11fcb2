"""Quintics through positions, velocities and accelerations: followed by cubics that are as near as they say, in
rational arithmetic, and proven to be what the joint does.
"""

from fractions import Fraction

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from clearance.errors import BadDimension, BadShape
from clearance.tolerance import PATH_ERROR
from clearance.world.cubic import positions_along
from clearance.world.quintic import with_accelerations
from clearance.world.trajectory import Trajectory
from tests.examples import examples


def exact_quintic(ends, s):
    """The value at a share s of the polynomial of degree 5 with these (q, T v, T^2 a) at 0 and 1, in the basis of
    Hermite.
    """
    r = 1 - s
    q0, v0, a0, q1, v1, a1 = ends
    return (
        q0 * r**3 * (1 + 3 * s + 6 * s**2) + v0 * r**3 * s * (1 + 3 * s) + a0 * r**3 * s**2 / 2
        + q1 * s**3 * (1 + 3 * r + 6 * r**2) - v1 * s**3 * r * (1 + 3 * r) + a1 * s**3 * r**2 / 2
    )  # fmt: skip


def exact_cubic(q0, v0, q1, v1, s):
    r = 1 - s
    return q0 * r**2 * (1 + 2 * s) + v0 * r**2 * s + q1 * s**2 * (1 + 2 * r) - v1 * s**2 * r


def fractions(numbers):
    return [Fraction(float(one)) for one in numbers]


def asked(seed, n_steps=4):
    rng = np.random.default_rng(seed)
    late = rng.choice([0.0, 0.1, 1e4])
    times = late + np.cumsum(rng.choice([0.01, 0.1, 1.0], n_steps) * rng.uniform(0.5, 1.0, n_steps))
    positions, velocities, accelerations = rng.normal(size=(3, n_steps, 1)) * rng.choice(
        [0.0, 0.1, 3.0], (3, 1, 1)
    )
    return Trajectory(times, ("j",), positions, velocities), accelerations


@examples(12)
@given(st.integers(0, 2**32 - 1))
def test_the_cubics_are_as_near_to_the_quintics_as_they_say(seed):
    given_path, accelerations = asked(seed)
    found = with_accelerations(given_path, accelerations)
    assert found.path_error <= 1.001 * PATH_ERROR + 1e-10
    error = Fraction(found.path_error)
    start, at = fractions(given_path.times), fractions(found.times)
    rows = [fractions(column) for column in (found.positions[:, 0], found.velocities[:, 0])]
    of_points = (given_path.positions, given_path.velocities, accelerations)
    points = [fractions(column[:, 0]) for column in of_points]
    for i in range(len(at) - 1):
        k = max(j for j in range(len(start) - 1) if start[j] <= at[i])
        length, part = start[k + 1] - start[k], at[i + 1] - at[i]
        ends = [points[d][j] * length**d for j in (k, k + 1) for d in range(3)]
        q0, q1, v0, v1 = *rows[0][i : i + 2], *(part * rate for rate in rows[1][i : i + 2])
        for tenth in range(0, 11, 2):
            share = Fraction(tenth, 10)
            right = exact_quintic(ends, (at[i] + share * part - start[k]) / length)
            assert abs(exact_cubic(q0, v0, q1, v1, share) - right) <= error


def test_accelerations_at_rest_bend_a_path_that_its_points_do_not_show():
    """From rest to rest at one place with accelerations of 3.2: 1.6 s^2 (1 - s)^2, a tenth in the middle."""
    path = Trajectory(np.array([0.0, 1.0]), ("j",), np.zeros((2, 1)), np.zeros((2, 1)))
    found = with_accelerations(path, np.full((2, 1), 3.2))
    s = np.linspace(0.0, 1.0, 1001)
    right = 1.6 * s**2 * (1.0 - s) ** 2
    assert np.abs(positions_along(found, s)[:, 0] - right).max() <= PATH_ERROR
    assert right.max() == pytest.approx(0.1, abs=1e-15)


@pytest.mark.parametrize(("size", "fault"), [(1e30, BadShape), (1e200, BadDimension)])
def test_accelerations_that_no_joint_has_are_refused(size, fault):
    path = Trajectory(np.array([0.0, 1.0]), ("j",), np.zeros((2, 1)), np.zeros((2, 1)))
    with pytest.raises(fault):
        with_accelerations(path, np.full((2, 1), size))
