"""Certified bounds where the trajectory has velocities: closed forms, dense samples, what linear motion hides."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from scipy.interpolate import CubicHermiteSpline

import clearance as cl
from clearance.errors import BadDimension
from clearance.world.body import Body, Obstacle
from clearance.world.case import Case
from clearance.world.placed_robot import PlacedRobot
from clearance.world.robot import Joint, JointKind, Mimic, Robot
from clearance.world.trajectory import Trajectory
from tests.simulate.measure.certified import assert_as_tight_as_asked, assert_never_above_samples

SCENES = Path(__file__).parents[3] / "scenes"
GAP = 1e-4


def placed_at(x=0.0, y=0.0, z=0.0, turned=0.0):
    pose = np.eye(4)
    pose[:2, :2] = [[np.cos(turned), -np.sin(turned)], [np.sin(turned), np.cos(turned)]]
    pose[:3, 3] = x, y, z
    return pose


def one_joint_case(kind, shape, obstacle, pose, velocities):
    """A joint that is at 0 at all samples, one a second."""
    joint = Joint("joint", kind, "base", "tool", np.eye(4), np.array([0.0, 0.0, 1.0]))
    robot = Robot("robot", ("base", "tool"), (joint,), (Body("tool", shape),))
    n_steps = len(velocities)
    speeds = np.array(velocities, dtype=float)[:, None]
    asked = Trajectory(np.arange(n_steps, dtype=float), ("joint",), np.zeros((n_steps, 1)), speeds)
    standing = (Obstacle(Body("post", obstacle), pose),)
    return Case(
        "crossing", (PlacedRobot(robot, asked),), standing, accept=("units",)
    )  # velocities by intent


def linear(case):
    placed = case.robots[0]
    without = replace(placed.trajectory, velocities=None)
    return replace(case, robots=(replace(placed, trajectory=without),))


def certificate_of(case):
    return cl.check(case, certify=True).record.certificate


def test_a_slide_that_overshoots_comes_as_near_as_the_closed_form_says():
    box, plate = cl.box((0.1, 0.1, 0.1)), cl.box((1.0, 1.0, 0.02))
    case = one_joint_case(
        JointKind.PRISMATIC,
        box,
        plate,
        placed_at(z=0.05 + 0.25 + 0.002 + 0.01),
        [1.0, -1.0, 0.5, 0.0],
    )
    found = certificate_of(case)
    heights = np.array([0.25, 0.0, 0.5 * 4 / 27])  # q = v s (1 - s)^2 is highest at s = 1/3
    true = 0.252 - heights
    assert (found.lower_bound[:-1] <= true + 1e-15).all()
    assert (found.lower_bound[:-1] >= true - GAP).all()
    assert found.lower_bound[-1] == cl.check(case).record.clearances[-1]


def gripper_case():
    """A turning arm with a mimicking wrist and a slide, between two posts, with strong velocities."""
    joints = (
        Joint("turn", JointKind.REVOLUTE, "base", "arm", np.eye(4), np.array([0.0, 0.0, 1.0])),
        Joint(
            "wrist", JointKind.REVOLUTE, "arm", "hand", placed_at(x=0.4), np.array([0.0, 1.0, 0.0]),
            mimic=Mimic("turn", -1.5, 0.4),
        ),
        Joint("reach", JointKind.PRISMATIC, "hand", "tool", placed_at(x=0.1)),
    )  # fmt: skip
    bodies = (
        Body("hand", cl.pipe(inner_radius=0.02, outer_radius=0.03, length=0.3, sections=12)),
        Body("tool", cl.box((0.3, 0.02, 0.05))),
    )
    robot = Robot("robot", ("base", "arm", "hand", "tool"), joints, bodies)
    rng = np.random.default_rng(11)
    positions = np.cumsum(rng.uniform(-0.4, 0.4, (5, 2)), axis=0) * [1.0, 0.2]
    velocities = rng.uniform(-2.0, 2.0, (5, 2)) * [1.0, 0.2]
    asked = Trajectory(
        np.array([0.0, 0.5, 1.3, 1.7, 2.9]), ("turn", "reach"), positions, velocities
    )
    posts = tuple(
        Obstacle(Body(name, cl.box((0.1, 0.1, 1.0))), placed_at(x=x, y=y, turned=0.3))
        for name, x, y in (("left", 0.6, 0.9), ("right", 0.3, -1.0))
    )
    return Case("gripper", (PlacedRobot(robot, asked),), posts)


def thinned_scene(name):
    """A scene with a sample in ten and velocities that are nearly, but not quite, those of its motion."""
    case = cl.load_case(SCENES / name / "case.yaml")
    placed = case.robots[0]
    asked = placed.trajectory
    kept = np.linspace(0, asked.n_steps - 1, 12).astype(int)
    rates = np.gradient(asked.positions, asked.times, axis=0)[kept]
    rates *= np.random.default_rng(3).uniform(0.5, 1.5, rates.shape)
    part = Trajectory(asked.times[kept], asked.joint_names, asked.positions[kept], rates)
    return replace(case, robots=(replace(placed, trajectory=part),))


@pytest.fixture(
    scope="module",
    params=[
        gripper_case,
        lambda: thinned_scene("box_pipe"),
        pytest.param(lambda: thinned_scene("iiwa_pipe_rack"), marks=pytest.mark.slow),
    ],
    ids=["gripper", "box_pipe", "iiwa_pipe_rack"],
)
def certified(request):
    return cl.check(request.param(), certify=True)


def finer(case, first, n_parts):
    """The case on one interval, sampled `n_parts` times on the cubic, which is scipy's."""
    placed = case.robots[0]
    asked = placed.trajectory
    times = np.linspace(asked.times[first], asked.times[first + 1], n_parts + 1)
    spline = CubicHermiteSpline(asked.times, asked.positions, asked.velocities)
    part = Trajectory(times, asked.joint_names, spline(times))
    return replace(case, robots=(replace(placed, trajectory=part),))


@pytest.mark.slow
def test_the_bound_is_never_above_a_thousand_samples(certified):
    assert_never_above_samples(certified, finer, 2)
    assert_as_tight_as_asked(certified)


def test_an_overshoot_beyond_all_reach_is_refused():
    far = one_joint_case(
        JointKind.PRISMATIC,
        cl.box((0.1, 0.1, 0.1)),
        cl.box((0.1, 0.1, 0.1)),
        placed_at(x=5.0),
        [1e8, 0.0],
    )
    with pytest.raises(BadDimension, match="link 'tool'"):
        cl.check(far, certify=True)
