"""Between samples: cubics, quintics, tables and arcs, against scipy, rationals and by hand; chains of links."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.interpolate import CubicHermiteSpline

from clearance.errors import BadDimension, BadShape, BadTime, NotFinite
from clearance.tolerance import PATH_ERROR
from clearance.world.cubic import extremes_between, positions_along
from clearance.world.joint_limits import ROUNDING, notices_on_joints
from clearance.world.kinematic_chain import chain_between
from clearance.world.kinematics import (
    link_poses,
    links_of_robot,
    moving_velocities,
    rates_by_link,
    values_by_link,
)
from clearance.world.knots import knots_of, looped
from clearance.world.placed_robot import PlacedRobot
from clearance.world.quintic import with_accelerations
from clearance.world.robot import Joint, JointKind, Mimic, Robot
from clearance.world.slerp import aligned, arcs_between, slerp
from clearance.world.trajectory import Trajectory
from tests.examples import examples
from tests.made_cases import random_robot


def random_trajectory(seed, n_steps=5, n_joints=3):
    rng = np.random.default_rng(seed)
    times = np.cumsum(rng.uniform(0.01, 1.0, n_steps))
    size = rng.choice([1e-9, 0.1, 3.0], (n_steps, n_joints))
    velocities = rng.choice([0.0, 0.1, 10.0], (n_steps, n_joints)) * rng.normal(size=size.shape)
    names = tuple(f"j{i}" for i in range(n_joints))
    return Trajectory(times, names, size * rng.normal(size=size.shape), velocities)


@examples(60)
@given(st.integers(0, 2**32 - 1))
def test_positions_and_extremes_are_those_of_the_spline(seed):
    asked = random_trajectory(seed)
    spline = CubicHermiteSpline(asked.times, asked.positions, asked.velocities)
    shares = np.linspace(0.0, 1.0, 201)
    least, greatest = extremes_between(asked.times, asked.positions, asked.velocities)
    for i in range(asked.n_steps - 1):
        times = asked.times[i] + shares * (asked.times[i + 1] - asked.times[i])
        sampled = spline(times)
        size = 1.0 + np.abs(sampled).max()
        assert np.abs(positions_along(asked, times) - sampled).max() <= 1e-13 * size
        assert (least[i] <= sampled.min(axis=0) + 1e-13 * size).all()
        assert (greatest[i] >= sampled.max(axis=0) - 1e-13 * size).all()
        assert np.abs(least[i] - sampled.min(axis=0)).max() <= 1e-3 * size
        assert np.abs(greatest[i] - sampled.max(axis=0)).max() <= 1e-3 * size


def test_before_and_after_a_trajectory_the_robot_rests():
    asked = random_trajectory(1)
    ends = positions_along(asked, asked.times[[0, -1]] + [-5.0, 5.0])
    assert np.abs(ends - asked.positions[[0, -1]]).max() <= 1e-15


def test_mimics_move_at_their_multiple_and_fixed_joints_rest():
    joints = (
        Joint("a", JointKind.REVOLUTE, "l0", "l1", np.eye(4)),
        Joint("b", JointKind.REVOLUTE, "l1", "l2", np.eye(4), mimic=Mimic("a", -2.0, 5.0)),
        Joint("c", JointKind.PRISMATIC, "l2", "l3", np.eye(4)),
    )
    robot = Robot("robot", ("l0", "l1", "l2", "l3"), joints, ())
    asked = Trajectory(np.zeros(1), ("a",), np.array([[0.5]]), np.array([[3.0]]))
    placed = PlacedRobot(robot, asked, fixed_positions={"c": 0.7})
    velocities = moving_velocities(placed, asked.joint_names, asked.velocities)
    assert velocities.tolist() == [[3.0, 0.0]]
    links = links_of_robot(robot)
    assert rates_by_link(links, velocities).tolist() == [[0.0, 3.0, -6.0, 0.0]]
    assert values_by_link(links, np.array([[0.5, 0.7]])).tolist() == [[0.0, 0.5, 4.0, 0.7]]


def test_velocities_that_fit_no_motion_are_refused():
    times, names, positions = np.array([0.0, 1e3]), ("a", "b"), np.zeros((2, 2))
    with pytest.raises(BadShape, match=r"shape \(2, 1\)"):
        Trajectory(times, names, positions, np.zeros((2, 1)))
    with pytest.raises(NotFinite):
        Trajectory(times, names, positions, np.array([[0.0, 0.0], [np.nan, 0.0]]))
    with pytest.raises(BadDimension, match="joint 'b'"):
        Trajectory(times, names, positions, np.array([[0.0, 0.0], [0.0, 1e149]]))


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


def asked(seed, n_steps=3):
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
        for tenth in (2, 5, 8):
            share = Fraction(tenth, 10)
            right = exact_quintic(ends, (at[i] + share * part - start[k]) / length)
            assert abs(exact_cubic(q0, v0, q1, v1, share) - right) <= error


@pytest.mark.parametrize(("size", "fault"), [(1e30, BadShape), (1e200, BadDimension)])
def test_accelerations_that_no_joint_has_are_refused(size, fault):
    path = Trajectory(np.array([0.0, 1.0]), ("j",), np.zeros((2, 1)), np.zeros((2, 1)))
    with pytest.raises(fault):
        with_accelerations(path, np.full((2, 1), size))


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


def test_too_many_rounds_are_refused():
    with pytest.raises(BadTime, match="loops"):
        looped(knots_of(np.array([0.0, 1e-9]), np.zeros((2, 1))), 10.0)


HALF = np.sqrt(0.5)


def units(random, n):
    q = random.normal(size=(n, 4))
    return q / np.linalg.norm(q, axis=1)[:, None]


def by_sines(p, q, s):
    """The arc on the sphere, of quaternions that are neither nearly alike nor opposite."""
    q = -q if p @ q < 0.0 else q
    angle = np.arccos(p @ q)
    return (np.sin((1 - s) * angle) * p + np.sin(s * angle) * q) / np.sin(angle)


@examples(100)
@given(st.integers(0, 2**32 - 1), st.floats(0.0, 1.0))
def test_equal_to_the_arc_of_sines(seed, share):
    random = np.random.default_rng(seed)
    p, q = units(random, 2)
    if abs(p @ q) > 0.999:
        return
    found = slerp(p, q, share)
    sign = -1.0 if p @ q < 0.0 and share == 1.0 else 1.0  # the end is as it was given
    assert np.abs(sign * found - by_sines(p, q, share)).max() < 1e-13
    assert np.linalg.norm(found) == pytest.approx(1.0, abs=1e-14)


def test_half_a_turn_goes_the_way_of_the_signs():
    """Exactly 180 degrees, both ways: deterministic, and the same from the other end."""
    p, q = np.array([0.0, 0.0, 0.0, 1.0]), np.array([0.0, 1.0, 0.0, 0.0])
    assert slerp(p, q, 0.5) == pytest.approx([0.0, HALF, 0.0, HALF])
    assert slerp(p, -q, 0.5) == pytest.approx([0.0, -HALF, 0.0, HALF])
    assert (arcs_between(p, q) == [0.0, 1.0, 0.0, np.pi]).all()
    assert (arcs_between(p, -q) == [0.0, -1.0, 0.0, np.pi]).all()
    assert slerp(q, p, 0.25) == pytest.approx(slerp(p, q, 0.75))


@examples(100)
@given(st.integers(0, 2**32 - 1), st.integers(0, 12))
def test_aligned_neighbours_are_nearest_and_the_same(seed, n):
    random = np.random.default_rng(seed)
    q = units(random, n)
    if random.random() < 0.3:
        q = np.eye(4)[random.integers(0, 4, n)] * random.choice([-1.0, 1.0], (n, 1))
    found = aligned(q)
    assert (np.abs(found) == np.abs(q)).all()
    assert ((found == q).all(axis=1) | (found == -q).all(axis=1)).all()
    assert ((found[:-1] * found[1:]).sum(axis=1) >= -1e-15).all()
    assert (aligned(found) == found).all()
    if n:
        assert (found[0] == q[0]).all()
        arcs, again = arcs_between(q[:-1], q[1:]), arcs_between(found[:-1], found[1:])
        assert (arcs == again).all()


def random_tree(rng, n_joints, **options):
    """A robot whose joints hang on any link before them."""
    robot = random_robot(rng, n_joints, **options)
    joints = [
        replace(joint, parent=f"l{rng.integers(0, i + 1)}") for i, joint in enumerate(robot.joints)
    ]
    return replace(robot, joints=tuple(joints))


@examples(100)
@given(st.integers(0, 2**32 - 1), st.integers(1, 8))
def test_it_places_the_second_link_in_the_first(seed, n_joints):
    rng = np.random.default_rng(seed)
    robot = random_tree(rng, n_joints, mimics=0.4)
    positions = rng.uniform(-3.0, 3.0, (4, len(robot.moving_joints)))
    world = link_poses(PlacedRobot(robot), positions)
    columns = {joint.name: i for i, joint in enumerate(robot.moving_joints)}
    a, b = rng.integers(0, len(robot.link_names), 2)
    chain = chain_between(robot, robot.link_names[a], robot.link_names[b])
    asked = positions[:, [columns[joint.name] for joint in chain.masters]]
    found = chain.frames(asked)[:, -1]
    expected = np.linalg.inv(world[:, a]) @ world[:, b]
    scale = 1.0 + np.abs(world[..., :3, 3]).max()
    assert np.abs(found - expected).max() < 1e-13 * scale


def arm(limit: float) -> Robot:
    """Two joints that turn."""
    names, links = ("a", "b"), ("base", "link_a", "link_b")
    joints = tuple(
        Joint(name, JointKind.REVOLUTE, above, below, np.eye(4), np.array([0.0, 0.0, 1.0]), -limit, limit)
        for name, above, below in zip(names, links, links[1:], strict=False)
    )  # fmt: skip
    return Robot("arm", links, joints, ())


@pytest.mark.parametrize(("beyond", "n_reported"), [(0.5, 1), (-0.5, 0), (0.5 * ROUNDING, 0)])
@pytest.mark.parametrize("side", [-1.0, 1.0])
def test_a_joint_is_reported_where_it_is_beyond_a_limit_at_a_sample(beyond, n_reported, side):
    positions = side * np.array([[0.0, 0.0], [0.0, 1.0 + beyond], [0.0, 0.5]])
    asked = Trajectory(np.arange(3.0), ("a", "b"), positions)
    found = notices_on_joints(PlacedRobot(arm(1.0), asked), "warn")
    assert len(found) == n_reported
    assert all("'b'" in notice.text and "in 1 of 3 steps" in notice.text for notice in found)
