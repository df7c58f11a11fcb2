"""A row in contact is the same wherever a sweep starts, and the point that it names."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import clearance as cl
from clearance.simulate.measure.layout import PairsInMotion
from clearance.simulate.measure.measure import measure
from clearance.simulate.measure.resources import Resources
from clearance.world.body import Body, Obstacle
from clearance.world.case import Case, PlacedRobot
from clearance.world.motion import Motion, kinematic_motion
from clearance.world.pairs import measured_pairs
from clearance.world.robot import Joint, JointKind, Robot
from clearance.world.trajectory import Trajectory
from tests.simulate.answers.test_contact_modes import channel

ROOT = Path(__file__).parents[3]


def measured(case, motion, steps, need="steps"):
    """What is found of some steps of a motion that is nothing else."""
    part = Motion(motion.placed, motion.times[steps], motion.positions[steps], np.zeros(len(steps)))
    return measure(PairsInMotion(case, (part,), measured_pairs(case)[0]), need, Resources(jobs=1))


def ball_through_wall():
    """A faceted ball that slides into a channel, askew, so that many faces meet at once."""
    joint = Joint("rail", JointKind.PRISMATIC, "ground", "ball", np.eye(4))
    robot = Robot("cart", ("ground", "ball"), (joint,), (Body("ball", cl.sphere(0.15)),))
    way = np.linspace(-0.3, 1.7, 100)
    path = Trajectory(way, ("rail",), way[:, None])
    pose = np.eye(4)
    pose[:3, :3] = [[0.36, 0.48, -0.8], [-0.8, 0.6, 0.0], [0.48, 0.64, 0.6]]
    pose[:3, 3] = [0.7, 0.05, 0.02]
    return Case(
        "ball", (PlacedRobot(robot, path, np.eye(4)),), (Obstacle(Body("wall", channel()), pose),)
    )


def whole_run(need):
    """The ball's case and motion, what is measured of all its steps, and those in contact."""
    case = ball_through_wall()
    motion = kinematic_motion(case.robots[0])
    whole = measured(case, motion, np.arange(motion.n_steps), need)
    return case, motion, whole, np.flatnonzero(whole.clearance == 0.0)


@pytest.mark.parametrize("need", ["steps", "limit"])
def test_a_row_in_contact_does_not_depend_on_where_the_sweep_starts(need):
    case, motion, whole, touching = whole_run(need)
    assert len(touching) > 20
    for start in (0, 1, 10, 21):
        part = measured(case, motion, touching[start:], need)
        assert (part.clearance[:20] == 0.0).all()
        assert np.array_equal(part.pair, whole.pair[touching[start:]])
        assert np.array_equal(part.points, whole.points[touching[start:]])


@pytest.mark.parametrize("need", ["steps", "pairs"])
def test_every_row_before_in_and_after_contact_is_that_of_its_step_alone(need):
    case, motion, whole, touching = whole_run(need)
    assert 5 < touching[0] < touching[-1] < motion.n_steps - 5 and len(touching) > 20
    for step in range(motion.n_steps):
        alone = measured(case, motion, np.array([step]), need)
        assert alone.clearance[0] == whole.clearance[step]
        assert np.array_equal(alone.points[0], whole.points[step])


def test_of_several_pairs_in_contact_the_least_is_named():
    case = cl.load_case(ROOT / "scenes" / "panda_shelf" / "case.yaml")
    motion = kinematic_motion(case.robots[0])
    steps, every = (
        measured(case, motion, np.arange(motion.n_steps), need) for need in ("steps", "pairs")
    )
    for step in np.flatnonzero(steps.clearance == 0.0):
        assert steps.pair[step] == np.flatnonzero(every.every[step] == 0.0)[0]
