"""A joint, and a link, between two samples: bounds against the motion itself, of joints in rational arithmetic."""

from dataclasses import replace
from fractions import Fraction

import numpy as np
import pytest
from hypothesis import example, given
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from clearance.geometry.shapes import box
from clearance.geometry.tree import surface_of
from clearance.kernels.arithmetic.vec3 import Vec3
from clearance.kernels.mesh.surface import box_of
from clearance.kernels.motion.interval_middle import IntervalMiddle
from clearance.kernels.motion.interval_motion_bound import (
    fill_motion_radii,
    interval_motion_bound_of,
)
from clearance.kernels.motion.joint_motion_bound import (
    BALL_ROUNDING,
    motion_bound_of,
    motion_bound_of_box,
    motion_bound_of_box_along,
    orientation_rounding,
)
from clearance.kernels.motion.joint_path import OUTWARD, BallPath, JointPath, part_of
from clearance.kernels.motion.world import World
from clearance.world.case import Case
from clearance.world.forest import forest_of
from clearance.world.kinematics import (
    all_links,
    floating_links,
    link_poses,
    links_of_robot,
    poses_by_link,
    standing_link,
    values_by_link,
)
from clearance.world.placed_robot import PlacedRobot
from clearance.world.robot import Joint, JointKind, Robot
from clearance.world.trajectory import Trajectory
from tests.examples import examples
from tests.made_cases import random_robot

SHAPE = box((0.3, 0.1, 0.2))


def standing(robot):
    return PlacedRobot(robot, Trajectory(np.zeros(1), (), np.zeros((1, 0))))


def drifts(surface, chain, link, poses, swing, bend, direction):
    middle = IntervalMiddle(np.zeros(len(swing)), swing, bend, poses)
    drift = motion_bound_of(box_of(surface, surface.roots[0]), chain, link, middle)
    along = motion_bound_of_box_along(
        box_of(surface, 0), Vec3(direction[0], direction[1], direction[2]), drift
    )
    return motion_bound_of_box(box_of(surface, 0), drift), along


@examples(40)
@given(
    st.integers(0, 2**32 - 1),
    st.integers(1, 7),
    st.sampled_from([1e-4, 1e-2, 0.3, 2.0]),
    st.sampled_from([0.0, 0.1, 1.0, 10.0]),
)
def test_no_point_leaves_its_bound(seed, n_joints, size, bent):
    rng = np.random.default_rng(seed)
    robot = random_robot(rng, n_joints)
    n_moving = len(robot.moving_joints)
    placed = standing(robot)
    middle, half = rng.uniform(-2, 2, n_moving), size * rng.uniform(-1, 1, n_moving)
    shares = np.concatenate([[0.0], np.linspace(-1.0, 1.0, 41)])
    bend = bent * size * rng.uniform(0, 1, n_moving)
    aside = bend * rng.choice([-1.0, 0.3, 1.0], (len(shares), n_moving))
    aside[0] = 0.0
    poses = link_poses(placed, middle + shares[:, None] * half + aside)
    chain = links_of([standing(robot)])
    swing = values_by_link(links_of_robot(robot), half[None])[0]
    direction = rng.normal(size=3)
    direction /= np.linalg.norm(direction)  # in the frame of the link
    bends = values_by_link(links_of_robot(robot), bend[None])[0]
    bound, bound_along = drifts(
        surface_of(SHAPE), chain, n_joints, poses[0], swing, bends, direction
    )
    corners = np.c_[SHAPE.vertices, np.ones(len(SHAPE.vertices))]
    moved = (poses[:, n_joints] @ corners.T)[:, :3] - (poses[0, n_joints] @ corners.T)[:3]
    lengths = np.linalg.norm(moved, axis=1)
    along = np.abs(np.einsum("i,sij->sj", poses[0, n_joints, :3, :3] @ direction, moved))
    slack = 1e-13
    assert lengths.max() <= bound + slack
    assert along.max() <= bound_along + slack


@pytest.mark.parametrize("bend", [0.0, 0.125])
def test_the_bound_of_a_slide_is_exact_and_a_bend_is_added_in_every_direction(bend):
    robot = Robot("slide", ("a", "b"), (Joint("j", JointKind.PRISMATIC, "a", "b", np.eye(4)),), ())
    chain, poses = links_of([standing(robot)]), np.tile(np.eye(4), (2, 1, 1))
    swings, bends, sideways = (
        np.array([0.0, 0.25]),
        np.array([0.0, bend]),
        np.array([0.0, 1.0, 0.0]),
    )
    bound, along = drifts(surface_of(SHAPE), chain, 1, poses, swings, bends, sideways)
    assert bound == pytest.approx(0.25 + bend, rel=1e-11)
    assert along == pytest.approx(bend, rel=1e-11)


SIZES = st.sampled_from([0.0, 1e-6, 0.3, 7.0, 1e5])


def path_of(positions, velocities, times):
    columns = [
        np.reshape(np.array(values, dtype=float), (-1, 1)) for values in (positions, velocities)
    ]
    return JointPath(np.array(times, dtype=float), *columns, np.ones(1, dtype=bool))


def hermite(path, at):
    """The cubic through both samples in the Bernstein form, exactly."""
    q0, q1 = (Fraction(float(x)) for x in path.positions[:, 0])
    v0, v1 = (Fraction(float(x)) for x in path.velocities[:, 0])
    length = Fraction(float(path.times[1])) - Fraction(float(path.times[0]))
    controls = [q0, q0 + length * v0 / 3, q1 - length * v1 / 3, q1]
    weights = [(1 - at) ** 3, 3 * at * (1 - at) ** 2, 3 * at**2 * (1 - at), at**3]
    return sum(w * c for w, c in zip(weights, controls, strict=True))


@examples(60)
@given(st.integers(0, 2**32 - 1), SIZES, SIZES, st.integers(0, 30))
def test_the_motion_stays_within_swing_and_bend(seed, size, speed, depth):
    rng = np.random.default_rng(seed)
    start = rng.uniform(0, 100)
    path = path_of(
        size * rng.uniform(-1, 1, 2),
        speed * rng.uniform(-1, 1, 2),
        [start, start + rng.uniform(1e-3, 2)],
    )
    i = int(rng.integers(0, 2**depth))
    low, high = i / 2**depth, (i + 1) / 2**depth
    found = part_of(path, 0, 0, low, high)
    middle, half = Fraction(low + high) / 2, Fraction(high - low) / 2
    slack = Fraction(2.0**-51) * Fraction(
        max(abs(path.positions[:, 0]))
    )  # rounding of the sum itself
    for t in map(Fraction, (-1, -0.75, -0.3, 0, 0.25, 0.6, 1)):
        rest = hermite(path, middle + half * t) - Fraction(found.middle)
        rest -= t / Fraction(OUTWARD) * Fraction(found.swing)
        assert abs(rest) <= Fraction(found.bend) + slack


def test_the_bend_of_a_parabola_is_no_larger_than_it_must_be():
    there_and_back = path_of([0.0, 0.0], [1.0, -1.0], [0.0, 1.0])
    found = part_of(there_and_back, 0, 0, 0.0, 1.0)
    assert (found.middle, found.swing) == (0.25, 0.0)
    assert found.bend == pytest.approx(0.25, rel=1e-11)


@examples(50)
@given(st.floats(-10, 10), st.floats(-10, 10), st.integers(0, 15))
@example(0.1, 0.7, 3)
def test_without_velocities_the_motion_is_linear(before, after, i):
    path = JointPath(
        np.array([0.0, 1.0]),
        np.array([[before], [after]]),
        np.empty((0, 1)),
        np.ones(1, dtype=bool),
    )
    found = part_of(path, 0, 0, i / 16, (i + 1) / 16)
    assert found.middle == before + 0.5 * (i / 16 + (i + 1) / 16) * (after - before)
    assert found.swing == pytest.approx((after - before) / 32, rel=1e-11, abs=1e-300)
    assert found.bend == 0.0


def test_velocities_of_the_linear_motion_change_nothing_but_rounding():
    path = path_of([0.25, 0.75], [0.5, 0.5], [2.0, 3.0])
    linear = path._replace(velocities=np.empty((0, 1)))
    found, straight = part_of(path, 0, 0, 0.25, 0.5), part_of(linear, 0, 0, 0.25, 0.5)
    assert (found.middle, found.swing) == (straight.middle, straight.swing)
    assert part_of(path._replace(is_cubic=np.zeros(1, dtype=bool)), 0, 0, 0.25, 0.5) == straight
    assert 0.0 < found.bend < 1e-14


def links_of(placed):
    """The links of some placed robots behind one another."""
    named = [
        replace(one, robot=replace(one.robot, name=f"robot_{i}")) for i, one in enumerate(placed)
    ]
    return forest_of(Case("forest", tuple(named), ())).links


def ways_in(surface, world, positions):
    """(k,) [m] the bound on the motion of the first body from the first step to each."""
    radii, noise = np.empty((len(world.frames), positions.shape[1])), np.empty(len(world.frames))
    fill_motion_radii(surface, world, positions, radii, noise)
    steps = range(len(positions))
    return np.array(
        [interval_motion_bound_of(positions, 0, step, radii[0], noise[0]) for step in steps]
    )


ASIDE = np.block(
    [[np.eye(3), np.array([[0.4], [0.0], [-0.2]])], [np.zeros((1, 3)), np.ones((1, 1))]]
)


def ways(surface, frames, links, positions):
    """(k,) [m] the bound on the motion of the body from the first step to each."""
    body, no_pairs = np.zeros(1, dtype=np.int64), np.empty((0, 2), dtype=np.int64)
    world = World(body, frames, body, np.empty((0, 4, 4)), no_pairs, links)
    return ways_in(surface, world, positions)


def placed_at(rng: np.random.Generator, robot: Robot) -> PlacedRobot:
    base = np.eye(4)
    base[:3, 3] = rng.uniform(-3.0, 3.0, 3)
    return PlacedRobot(robot, Trajectory(np.zeros(1), (), np.zeros((1, 0))), world_from_base=base)


@examples(60)
@given(st.integers(0, 2**32 - 1), st.integers(1, 7), st.sampled_from([0.0, 1e-9, 1e-3, 0.3, 3.0]))
def test_no_body_moves_farther_than_its_joints_say(seed, n_joints, size):
    rng = np.random.default_rng(seed)
    placed = [
        placed_at(rng, random_robot(rng, n_joints, sizes=(0.0, 0.5, 50.0), mimics=0.4))
        for _ in range(2)
    ]
    moving = [len(one.robot.moving_joints) for one in placed]
    first = rng.uniform(-4.0, 4.0, sum(moving)) * rng.choice([1.0, 1e3])
    positions = first + size * rng.uniform(-1.0, 1.0, (20, sum(moving)))
    positions[0] = first
    body = SHAPE if rng.random() < 0.5 else SHAPE.transformed(ASIDE)
    corners = np.column_stack([body.vertices, np.ones(len(body.vertices))])
    link, i_robot = n_joints, int(rng.integers(2))
    frame = link + i_robot * (n_joints + 1)
    columns = slice(0, moving[0]) if i_robot == 0 else slice(moving[0], None)
    poses = link_poses(placed[i_robot], positions[:, columns])[:, link]
    world = corners @ poses.transpose(0, 2, 1)
    moved = np.linalg.norm(world - world[0], axis=2).max(axis=1)
    bound = ways(surface_of(body), np.array([frame]), links_of(placed), positions)
    assert (moved <= bound).all()


def test_rounding_of_orientations_counts_for_all_that_they_carry():
    """Of two ball joints: one at the body, one beyond three slides of 1, 0.25 and 0.125 m."""
    floating = floating_links(1, 0, 0, np.eye(4)), floating_links(5, 7, 4, ASIDE)
    links = all_links(standing_link(np.eye(4)), *floating)
    slides = [np.zeros(9) for _ in range(3)]
    for values, value in zip(slides, (-1.0, 0.25, 0.125), strict=True):
        values[5] = value
    state = IntervalMiddle(*slides, np.empty((9, 4, 4)))
    balls = BallPath(np.array([4, 8]), links.parent_from_joint[[4, 8]], np.empty((0, 2, 8)))
    surface = surface_of(SHAPE)
    found = orientation_rounding(box_of(surface, surface.roots[0]), links, 8, balls, state)
    reach = np.linalg.norm(SHAPE.bounds[1])
    far = 2.0 * reach + 1.375 + np.linalg.norm(ASIDE[:3, 3])
    assert found == pytest.approx(BALL_ROUNDING * far, rel=1e-4, abs=0.0) and found > 0.0


@examples(40)
@given(
    st.integers(0, 2**32 - 1),
    st.sampled_from([1e-9, 1e-3, 0.3, 1.0]),
    st.sampled_from([1.0, 1.0 - 1e-6, 0.5]),
)
def test_no_body_moves_farther_than_its_quaternions_say(seed, size, length):
    """It floats on what floats; slides move too, or stand."""
    rng = np.random.default_rng(seed)
    floating = floating_links(1, 0, 0, np.eye(4)), floating_links(5, 7, 4, ASIDE)
    links = all_links(standing_link(np.eye(4)), *floating)
    change = size * rng.choice([0.0, 1.0]) * rng.uniform(-1.0, 1.0, (12, 14))
    positions = rng.uniform(-2.0, 2.0, 14) + change
    for column in (3, 10):
        turns = Rotation.from_rotvec(size * rng.uniform(-1.0, 1.0, (12, 3)))
        turned = Rotation.random(random_state=seed % 2**30 + column) * turns
        positions[:, column : column + 4] = length * turned.as_quat()
    corners = np.column_stack([SHAPE.vertices, np.ones(len(SHAPE.vertices))])
    world = corners @ poses_by_link(links, positions)[:, 8].transpose(0, 2, 1)
    moved = np.linalg.norm(world - world[0], axis=2).max(axis=1)
    assert (moved <= ways(surface_of(SHAPE), np.array([8]), links, positions)).all()


def test_parts_of_a_long_chain_that_are_off_orthonormal_stretch_the_bound():
    offset = np.diag([1.0 + 4.9e-7] * 3 + [1.0])
    offset[0, 3] = 0.5
    axis = np.array([0.0, 0.0, 1.0])
    joints = [
        Joint(f"j{i}", JointKind("fixed"), f"l{i}", f"l{i + 1}", offset, axis)
        for i in range(1, 200)
    ]
    joints.insert(0, Joint("j0", JointKind("revolute"), "l0", "l1", np.eye(4), axis))
    robot = Robot("chain", tuple(f"l{i}" for i in range(201)), tuple(joints), ())
    placed = PlacedRobot(robot, Trajectory(np.zeros(1), (), np.zeros((1, 0))))
    positions = np.array([[0.0], [0.001]])
    speck = box((1e-4, 1e-4, 1e-4))
    ends = link_poses(placed, positions)[:, 200, :, 3]
    bound = ways(surface_of(speck), np.array([200]), links_of([placed]), positions)
    assert np.linalg.norm(ends[1] - ends[0]) <= bound[1] <= 0.1 * 1.001
