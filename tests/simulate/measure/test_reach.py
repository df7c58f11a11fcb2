"""Bodies that no robot can come near are refused before any arithmetic overflows."""

import numpy as np
import pytest

import clearance as cl
from clearance.errors import BadDimension, BadPose
from clearance.world.body import Body, Obstacle
from clearance.world.case import Case
from clearance.world.placed_robot import PlacedRobot
from clearance.world.robot import Joint, JointKind, Mimic, Robot
from clearance.world.trajectory import Trajectory


def case(obstacle_at=1.0, size=0.1, slide=0.0):
    joint = Joint("slide", JointKind.PRISMATIC, "base", "tool", np.eye(4))
    robot = Robot("robot", ("base", "tool"), (joint,), (Body("tool", cl.box((0.1, 0.1, 0.1))),))
    asked = Trajectory(np.array([0.0, 1.0]), ("slide",), np.array([[0.0], [slide]]))
    pose = np.eye(4)
    pose[0, 3] = obstacle_at
    obstacle = Obstacle(Body("post", cl.box((size, size, size))), pose)
    return Case("far", (PlacedRobot(robot, asked),), (obstacle,))


@pytest.mark.parametrize(
    ("far", "named"),
    [
        (case(obstacle_at=1e90), "obstacle 'post'"),
        (case(size=1e90), "obstacle 'post'"),
        (case(slide=-1e200), "link 'tool'"),
    ],
)
def test_a_body_beyond_reach_is_named(far, named):
    with pytest.raises(BadDimension, match=named):
        cl.check(far)


def spinning(turns, multiplier=None, velocities=None):
    """A case whose joint turns so often in a second; with `multiplier`, a joint that follows it."""
    hand = Joint("hand", JointKind.CONTINUOUS, "base", "tool", np.eye(4))
    links, joints = ("base", "tool"), (hand,)
    if multiplier is not None:
        joints += (
            Joint(
                "gear",
                JointKind.REVOLUTE,
                "base",
                "wheel",
                np.eye(4),
                mimic=Mimic("hand", multiplier),
            ),
        )
        links += ("wheel",)
    robot = Robot("robot", links, joints, (Body("tool", cl.box((0.1, 0.1, 0.1))),))
    asked = Trajectory(
        np.array([0.0, 1.0]), ("hand",), 2 * np.pi * np.array([[0.0], [turns]]), velocities
    )
    pose = np.eye(4)
    pose[0, 3] = 1.0
    return Case(
        "spin",
        (PlacedRobot(robot, asked),),
        (Obstacle(Body("post", cl.box((0.1, 0.1, 0.1))), pose),),
    )


@pytest.mark.parametrize(
    ("spins", "named"),
    [
        (spinning(1e7), "joint 'hand' turns by 6.28319e\\+07 rad between 0 s and 1 s"),
        (spinning(0.5, multiplier=-1e4), "joint 'gear' turns by 31415.9 rad"),
        (spinning(0.0, velocities=np.array([[0.0], [1e5]])), "joint 'hand' turns by 100000 rad"),
    ],
)
def test_a_joint_that_spins_between_steps_is_named(spins, named):
    with pytest.raises(BadDimension, match=named):
        cl.check(spins, certify=True)


def test_coordinates_that_cannot_be_squared_are_refused_everywhere():
    with pytest.raises(BadDimension, match="1e\\+200"):
        cl.Polyhedron(1e200 * np.eye(3), [[0, 1, 2]])
    pose = np.eye(4)
    pose[0, 3] = 1e300
    with pytest.raises(BadPose, match="1e\\+300"):
        cl.distance(cl.box((1, 1, 1)), cl.box((1, 1, 1)), pose_b=pose)
