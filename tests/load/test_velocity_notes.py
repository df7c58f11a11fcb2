"""What is told of velocities that carry a joint beyond its limits, or look like degrees a second."""

import numpy as np
import pytest

from clearance.load.plausibility import motion_notes
from clearance.world.case import PlacedRobot
from clearance.world.robot import Joint, JointKind, Robot
from clearance.world.trajectory import Trajectory


def notes(positions, velocities, kind=JointKind.REVOLUTE):
    joint = Joint("elbow", kind, "a", "b", np.eye(4), lower=-1.0, upper=1.0)
    robot = Robot("robot", ("a", "b"), (joint,), ())
    columns = [np.array(values, dtype=float)[:, None] for values in (positions, velocities)]
    asked = Trajectory(np.arange(len(positions), dtype=float), ("elbow",), *columns)
    return motion_notes(PlacedRobot(robot, asked))


def test_a_cubic_that_leaves_the_limits_between_samples_is_told():
    assert notes([0.9, 0.9, 0.0], [0.8, -0.8, -1.0]) == [
        "CHECK: joint 'elbow' leaves its limits -1 to 1 rad by up to 0.1 rad between two samples, "
        "on the cubic that its velocities make, in 1 of 2 intervals"
    ]


@pytest.mark.parametrize(
    ("positions", "velocities"),
    [
        ([0.9, 0.9, 0.0], [0.3, -0.3, -1.0]),
        ([1.0, 1.0], [0.0, 0.0]),
        ([-1.0, 1.0], [0.0, 0.0]),
        ([0.1 + 0.2, 0.7], [0.4, 0.4]),
        ([0.5], [9.0]),
    ],
)
def test_what_stays_within_its_limits_is_not(positions, velocities):
    assert notes(positions, velocities) == []


def test_beyond_at_the_samples_is_told_once():
    told = notes([0.5, 1.5, 0.5], [0.0, 0.0, 0.0])
    assert len(told) == 1
    assert told[0].endswith("in 1 of 3 steps")


def test_degrees_a_second_are_told():
    positions = np.sin(np.linspace(0.0, 3.0, 20))
    velocities = np.gradient(positions)
    assert not any("CHECK UNITS" in note for note in notes(positions, velocities))
    told = notes(positions, np.degrees(velocities))
    assert any("velocities of joint 'elbow'" in note and "degrees/s" in note for note in told)
    told = notes(positions, 1000.0 * velocities, JointKind.PRISMATIC)
    assert any("is this mm/s?" in note for note in told)
    assert notes([0.0, 0.0], [1e-4, 1e-4]) == []
