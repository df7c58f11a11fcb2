"""Bodies that both move, between the samples: bounds against samples a thousand times finer."""

from dataclasses import replace

import numpy as np
import pytest

import clearance as cl
from clearance.geometry.shapes import box
from clearance.world.body import Body
from clearance.world.case import PlacedRobot
from clearance.world.pose_table import PoseTable
from clearance.world.robot import Joint, JointKind, Robot
from clearance.world.trajectory import Trajectory
from tests.made_cases import at, dented, random_robot
from tests.simulate.measure.certified import assert_as_tight_as_asked
from tests.simulate.measure.hostile_actors import (
    CARRIED_FROM,
    CARRIED_UNTIL,
    carrying,
)
from tests.simulate.measure.wandering import wandering


def finer(case: cl.Case, times: np.ndarray) -> cl.Case:
    """The case with samples at these times of all robots, which move linearly between their own."""
    robots = []
    for robot in case.robots:
        asked = robot.given_trajectory
        columns = [np.interp(times, asked.times, column) for column in asked.positions.T]
        path = Trajectory(times, asked.joint_names, np.stack(columns, axis=1))
        robots.append(replace(robot, trajectory=path))
    return replace(case, robots=tuple(robots))


@pytest.mark.parametrize("seed", range(3))
@pytest.mark.slow
def test_no_bound_on_two_moving_bodies_is_above_samples_a_thousand_times_finer(seed):
    """Dented bodies that turn by up to a radian a step, apart from each other by less than they move."""
    random = np.random.default_rng(seed)
    robots = []
    for name, side in (("left", -1.0), ("right", 1.0)):
        robot = random_robot(random, 4, sizes=(0.05,))
        robot = replace(
            robot, name=name, bodies=(Body("l4", dented(random, 2, depth=0.4, radius=0.15)),)
        )
        names = tuple(joint.name for joint in robot.moving_joints)
        steps = random.uniform(-1.0, 1.0, (8, len(names))) * 0.4
        slides = [joint.kind is JointKind.PRISMATIC for joint in robot.moving_joints]
        steps[:, slides] *= 0.05
        path = Trajectory(np.arange(8.0), names, steps.cumsum(axis=0))
        robots.append(PlacedRobot(robot, path, at(side * random.uniform(0.2, 0.3))))
    case = cl.Case("turning", tuple(robots), ())
    run = cl.check(case)
    bounds, clearances = run.certificate.lower_bound, run.record.clearances
    for step in {int(np.argmin(bounds[:-1])), *random.integers(0, 7, 2).tolist()}:
        times = np.linspace(step, step + 1.0, 1001)
        sampled = cl.check(finer(case, times), certify=False).record.clearances
        assert bounds[step] <= sampled.min() + 1e-12
        assert sampled.min() <= run.certificate.upper_bound[step] + 1e-4
    assert (bounds <= clearances).all()
    assert_as_tight_as_asked(run)


@pytest.mark.parametrize("faster", ["left", "right"])
@pytest.mark.parametrize("seed", range(2))
def test_tips_that_pass_each_other_between_two_samples_are_seen(seed, faster):
    """Two blades turn to and fro about their middles, one far and one a little; in between both tips point in."""
    random = np.random.default_rng(seed)
    blade = box((0.6, 0.04, 0.04))
    robots = []
    for name, side in (("left", -0.31), ("right", 0.31)):
        spin = Joint(
            "spin", JointKind.CONTINUOUS, "base", "blade", np.eye(4), np.array([0.0, 0.0, 1.0])
        )
        far = random.uniform(0.5, 1.0, 9) if name == faster else random.uniform(0.0, 0.01, 9)
        path = Trajectory(np.arange(9.0), ("spin",), (far * (-1.0) ** np.arange(9))[:, None])
        robot = Robot(name, ("base", "blade"), (spin,), (Body("blade", blade),))
        robots.append(PlacedRobot(robot, path, at(side, 0.0, 0.01 * seed)))
    case = cl.Case("blades", tuple(robots), ())
    run = cl.check(case)
    sampled = cl.check(finer(case, np.linspace(0.0, 8.0, 8001)), certify=False).record.clearances
    dips = [sampled[1000 * k : 1000 * k + 1001].min() for k in range(8)]
    assert (run.certificate.lower_bound[:-1] <= np.array(dips) + 1e-12).all()
    assert min(dips) < run.record.clearances.min() - 1e-3
    assert_as_tight_as_asked(run)


@pytest.mark.parametrize("seed", range(2))
@pytest.mark.slow
def test_no_bound_on_a_part_that_changes_hands_within_an_interval_is_above_finer_samples(seed):
    """The hand-over is at no sample: the steps about it are its own."""
    case = carrying(seed)
    run = cl.check(case)
    times, bounds = run.record.timeline.times, run.certificate.lower_bound
    assert {CARRIED_FROM, CARRIED_UNTIL} <= set(times.tolist())
    for first in np.flatnonzero(np.isin(times, (CARRIED_FROM, CARRIED_UNTIL))) - 1:
        fine = np.linspace(times[first], times[first + 2], 1001)
        edges = np.array([0.0, CARRIED_FROM, CARRIED_UNTIL, 3.0])
        sampled = cl.check(finer(case, np.union1d(fine, edges)), certify=False).record
        within = (sampled.timeline.times >= times[first]) & (
            sampled.timeline.times <= times[first + 2]
        )
        assert bounds[first : first + 2].min() <= sampled.clearances[within].min() + 1e-12


@pytest.mark.parametrize("seed", range(3))
def test_a_body_that_turns_by_half_a_turn_between_two_samples_is_followed_all_the_way(seed):
    """The robot moves too; between the samples of the pose table the body sweeps a half circle."""
    random = np.random.default_rng(seed)
    robot = random_robot(random, 3, sizes=(0.1,))
    robot = replace(robot, bodies=(Body("l3", dented(random, 1, depth=0.3, radius=0.1)),))
    path = wandering(random, robot, cubic=False)
    axis = random.normal(size=3)
    axis /= np.linalg.norm(axis)
    half = np.array([[0.0, 0.0, 0.0, 1.0], [*axis, 6e-17]])
    table = PoseTable(np.array([0.0, 3.0]), np.array([[0.5, 0.0, 0.0], [0.5, 0.1, 0.0]]), half)
    blade = cl.Obstacle(Body("blade", box((0.6, 0.05, 0.05))), moves=table)
    few = np.linspace(0.0, 3.0, 7)
    case = finer(cl.Case("half", (PlacedRobot(robot, path),), (blade,)), few)
    run = cl.check(case)
    sampled = cl.check(finer(case, np.linspace(0.0, 3.0, 6001)), certify=False).record
    step = np.clip(np.searchsorted(few, sampled.timeline.times, side="right") - 1, 0, 5)
    assert (run.certificate.lower_bound[step] <= sampled.clearances + 1e-12).all()
    turns = sampled.clearances.max() - sampled.clearances.min()
    assert turns > 0.01 and len(run.record.timeline.times) == 7
