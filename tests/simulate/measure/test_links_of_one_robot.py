"""Links of one robot that no single joint joins, without an SRDF: what can be worked out by hand."""

import numpy as np
import pytest

import clearance as cl
from clearance.world.robot import Joint, JointKind
from tests.made_cases import at

X, Z = np.array([1.0, 0.0, 0.0]), np.array([0.0, 0.0, 1.0])


def joint(kind, parent, child, place=(0.0, 0.0, 0.0), axis=X):
    return Joint(f"{parent}_{child}", JointKind(kind), parent, child, at(*place), axis)


def run_of(joints, shapes, moves):
    """A run of a robot of boxes, at the samples 0, 1 and 2 s of joints that move evenly from 0.

    Args:
        shapes: size and centre [m] by link. moves: where each joint ends [rad or m].
    """
    links = (joints[0].parent, *(one.child for one in joints))
    bodies = tuple(
        cl.Body(name, cl.box(shapes[name][0]).transformed(at(*shapes[name][1])))
        for name in links
        if name in shapes
    )
    rows = np.linspace(0.0, 1.0, 3)[:, None] * np.array([*moves.values()])
    path = cl.Trajectory(np.arange(3.0), tuple(moves), rows)
    robot = cl.Robot("own", links, joints, bodies)
    placed = cl.PlacedRobot(robot, path, self_clearance=cl.SelfClearance())
    return cl.check(cl.Case("own", (placed,), ()))


def met(run):
    return run.verdict.status, {run.worst["link"], run.worst["obstacle"]}


def test_two_carts_on_a_bare_world_meet():
    joints = (joint("prismatic", "world", "left"), joint("prismatic", "world", "right", (1, 0, 0)))
    cube = ((0.1, 0.1, 0.1), (0, 0, 0))
    ends = {"world_left": 0.5, "world_right": -0.5}
    run = run_of(joints, {"left": cube, "right": cube}, ends)
    assert met(run) == ("contact", {"left", "right"})
    assert run.record.clearances.tolist() == pytest.approx([0.9, 0.4, 0.0])
    deepest = run.record.deepest.penetration
    assert deepest == pytest.approx(0.1)  # the cubes coincide, and have sides of 0.1 m


def test_two_bars_on_one_bare_base_meet():
    """Bars from 0.1 to 0.6 m, at first along x and -x, are swung together by a right angle each."""
    joints = (
        joint("fixed", "world", "base"),
        joint("revolute", "base", "one", axis=Z),
        joint("revolute", "base", "other", axis=Z),
    )
    bar = (0.5, 0.02, 0.02)
    shapes = {"one": (bar, (0.35, 0, 0)), "other": (bar, (-0.35, 0, 0))}
    run = run_of(joints, shapes, {"base_one": np.pi / 2, "base_other": -np.pi / 2})
    assert met(run) == ("contact", {"one", "other"})
    assert run.record.clearances[0] == pytest.approx(0.2)


def test_a_trunk_meets_the_wall_that_stands_in_the_world_of_its_base():
    joints = (
        joint("fixed", "world", "wall", (1, 0, 0)),
        joint("fixed", "world", "base"),
        joint("prismatic", "base", "trunk"),
    )
    shapes = {
        "wall": ((0.1, 2, 2), (0, 0, 0)),
        "base": ((0.1, 0.1, 0.1), (0, 0, -0.5)),
        "trunk": ((0.1, 0.1, 0.1), (0, 0, 0)),
    }
    run = run_of(joints, shapes, {"base_trunk": 1.0})
    assert met(run) == ("contact", {"trunk", "wall"})
    assert run.record.clearances.tolist() == pytest.approx([0.9, 0.4, 0.0])
    assert run.record.deepest.penetration == pytest.approx(0.1)


def test_a_finger_meets_what_is_bolted_to_its_palm():
    """The camera and the finger are both on the palm: one by a fixed joint, one by a joint that moves."""
    joints = (
        joint("fixed", "palm", "camera", (0.3, 0, 0)),
        joint("prismatic", "palm", "finger"),
    )
    cube = ((0.1, 0.1, 0.1), (0, 0, 0))
    run = run_of(joints, {"camera": cube, "finger": cube}, {"palm_finger": 0.25})
    assert met(run) == ("contact", {"camera", "finger"})
