"""Links that one joint joins, apart at home or at first: where on the whole way they meet, worked out by hand.

An arm from 0.1 to 0.6 m is 0.05 m thick. A hand as thick turns about a joint at 0.65 m, and begins 0.05 m from it.
With s, c of the angle from folded flat, their corners meet where 0.05 s - 0.025 c = 0.025, so s = 0.8: at a turn
of pi - asin 0.8 either way.
"""

import re
from dataclasses import replace

import numpy as np
import pytest

import clearance as cl
from clearance.formats.robot.compound_joints import chained
from clearance.simulate.measure.neighbours import Neighbours
from clearance.world.collision_matrix import PARENT, CollisionMatrix
from clearance.world.robot import Joint, JointKind, Mimic
from clearance.world.rules import Allowance
from tests.made_cases import at

Z = np.array([0.0, 0.0, 1.0])
MEETS = np.pi - np.arcsin(0.8)
BAR = (0.5, 0.05, 0.05)


def folding(samples=None, velocities=None, limits=(-np.inf, np.inf), matrix=None, **placed):
    """The arm on a base far from both, whose hand goes from sample to sample [rad] in 2 s each."""
    joints = (
        Joint("shoulder", JointKind.PRISMATIC, "base", "arm", np.eye(4)),
        Joint("wrist", JointKind.REVOLUTE, "arm", "hand", at(0.65), Z, *limits),
    )
    shapes = {
        "base": ((0.1, 0.1, 0.1), (0, 0, 3)),
        "arm": (BAR, (0.35, 0, 0)),
        "hand": (BAR, (0.3, 0, 0)),
    }
    bodies = tuple(
        cl.Body(name, cl.box(size).transformed(at(*place)))
        for name, (size, place) in shapes.items()
    )
    path = None
    if samples is not None:
        rows = np.array(samples, dtype=float)[:, None]
        speeds = None if velocities is None else np.array(velocities, dtype=float)[:, None]
        path = cl.Trajectory(2.0 * np.arange(len(rows)), ("wrist",), rows, velocities=speeds)
    robot = cl.Robot("own", ("base", "arm", "hand"), joints, bodies)
    one = cl.PlacedRobot(robot, path, self_clearance=cl.SelfClearance(matrix), **placed)
    return cl.Case("own", (one,), (), accept=("wrap",))


def told_of(case):
    return [
        one
        for one in cl.check(case).verdict.warnings
        if one.startswith(("neighbours", "links arm"))
    ]


@pytest.mark.parametrize(
    ("samples", "velocities", "angle", "time"),
    [
        ([0.0, 2.9], None, MEETS, 2.0 * MEETS / 2.9),
        ([0.5, -2.2, -2.6], None, -MEETS, 2.0 + 2.0 * (MEETS - 2.2) / 0.4),
        (
            [0.0, 2.0 * np.pi - 0.5],
            None,
            MEETS,
            2.0 * MEETS / (2.0 * np.pi - 0.5),
        ),  # free at both samples
        (
            [0.0, 0.0],
            [6.0, -6.0],
            MEETS,
            1.0 - np.sqrt(1.0 - MEETS / 3.0),
        ),  # 3 t (2 - t) rad on its cubic
        ([0.0, 2.2], None, None, None),
        ([0.0, 0.0], [4.4, -4.4], None, None),  # 2.2 rad at 1 s
    ],
)
def test_the_first_moment_between_samples_at_which_neighbours_meet_is_told(
    samples, velocities, angle, time
):
    told = told_of(folding(samples, velocities))
    assert len(told) == (angle is not None)
    for one in told:
        assert (
            one.startswith("neighbours arm - hand, 0.1 m apart at first, touch ")
            or samples[0] == 0.5
        )
        found = re.search(r"wrist = (\S+) rad, at (\S+) s", one)
        assert float(found[1]) == pytest.approx(angle, abs=2e-3)
        assert float(found[2]) == pytest.approx(time, abs=3e-3)


def test_neighbours_that_come_below_their_fail_limit_are_told_of_as_those_that_meet():
    """On the way to 2 rad they come from 100 mm to some millimetres of each other."""
    case = folding([0.0, 2.0])
    (arm, hand), wrist = case.robots[0].robot.bodies[1:], case.robots[0].robot.joints[1]

    def gap(turn):
        turned = wrist.parent_from_joint @ turn_about_z(turn)
        return cl.distance(arm.shape, hand.shape, pose_b=turned).distance

    for limits, level in (
        (cl.Limits(fail=0.04), 0.04),
        (cl.Limits(fail=0.001, rules=(cl.Rule(("arm", "hand"), fail=0.04),)), 0.04),
        (cl.Limits(fail=0.04, rules=(cl.Rule(("arm", "hand"), fail=0.001),)), None),
        (cl.Limits(fail=0.001), None),
        (cl.Limits(fail=0.098), 0.098),  # 2 mm above it at first
        (cl.Limits(fail=0.2), None),  # below it at home and at first: nothing is new
    ):
        told = told_of(replace(case, limits=limits))
        assert len(told) == (level is not None)
        for one in told:
            assert f"0.1 m apart at first, come below their fail limit of {1e3 * level:g} mm" in one
            turn, time = map(float, re.search(r"wrist = (\S+) rad, at (\S+) s", one).groups())
            assert gap(turn) == pytest.approx(level, abs=1e-3)
            assert time == pytest.approx(turn, abs=3e-3)


def turn_about_z(turn):
    pose = np.eye(4)
    pose[:2, :2] = [[np.cos(turn), -np.sin(turn)], [np.sin(turn), np.cos(turn)]]
    return pose


def test_neighbours_that_begin_folded_are_told_of_where_they_are_apart_at_home():
    (told,) = told_of(folding([2.9, 3.3]))
    assert (
        "0.1 m apart at home (wrist = 0 rad), touch at the first step already, at wrist = 2.9 rad"
        in told
    )


def test_what_a_file_excuses_or_a_row_allows_is_told_of_no_more():
    folded = folding([0.0, 2.9])
    row = Allowance(("hand", "arm"))
    assert told_of(replace(folded, allow=(row,))) == []
    for reason, n_told in (
        ("Adjacent", 1),
        ("User", 0),
        ("Default", 1),
    ):  # Adjacent is nobody's word, and Default says that they touch at home
        matrix = CollisionMatrix(disabled=(("arm", "hand", reason),))
        assert len(told_of(folding([0.0, 2.9], matrix=matrix))) == n_told
    for reason, n_told in ((PARENT, 1), ("excluded", 0)):
        (placed,) = folded.robots
        own = CollisionMatrix(disabled=(("arm", "hand", reason),))
        filtered = replace(placed, robot=replace(placed.robot, own_matrix=own))
        assert len(told_of(replace(folded, robots=(filtered,)))) == n_told
    run = cl.check(folding([0.0, 2.9], matrix=CollisionMatrix()))
    assert run.status == "contact" and {run.worst["link"], run.worst["obstacle"]} == {"arm", "hand"}


def flanged(samples, disabled, last, *bodies):
    """The arm with a flange on its wrist, from which the joint `last` leads to the hand."""
    (placed,) = folding(samples, matrix=CollisionMatrix(disabled=disabled)).robots
    shoulder, wrist = placed.robot.joints
    robot = replace(
        placed.robot,
        link_names=("base", "arm", "flange", "hand"),
        joints=(shoulder, replace(wrist, child="flange"), last),
        bodies=(*placed.robot.bodies, *bodies),
    )
    return cl.Case("own", (replace(placed, robot=robot),), ())


def test_what_an_srdf_calls_adjacent_is_looked_at_though_a_link_lies_between():
    """A flange with a shape turns on the arm, and the hand is fixed to it."""
    disabled = (("arm", "hand", "Adjacent"), ("arm", "flange", "User"))
    bolts = Joint("bolts", JointKind.FIXED, "flange", "hand", np.eye(4))
    disc = cl.Body("flange", cl.box((0.02, 0.02, 0.02)))
    (told,) = told_of(flanged([0.0, 2.9], disabled, bolts, disc))
    assert "arm - hand, 0.1 m apart at first, touch " in told
    assert float(re.search(r"wrist = (\S+) rad", told)[1]) == pytest.approx(MEETS, abs=2e-3)


def test_two_links_that_one_position_moves_by_two_joints_are_checked_at_the_steps():
    """The flange turns on the arm, and the hand by as much again on the flange."""
    mimic = Mimic("wrist", 1.0, 0.0)
    again = Joint("again", JointKind.REVOLUTE, "flange", "hand", np.eye(4), Z, mimic=mimic)
    case = flanged([0.0, 0.5, 1.45], (("arm", "hand", "Adjacent"),), again)
    (told,) = told_of(case)
    assert "touch at a step, at wrist = 1.45 rad, at 4.000 s" in told
    asked = replace(case, robots=(replace(case.robots[0], trajectory=None),))
    assert cl.Checker(asked).notices == ()


def test_a_configuration_in_which_neighbours_meet_is_warned_of_once(recwarn, monkeypatch):
    checker = cl.Checker(folding(limits=(-3.1, 3.1)))
    asked = []
    monkeypatch.setattr(Neighbours, "gaps", lambda *args: asked.append(args) or gaps(*args))
    for turn in (0.0, 2.2, -2.2):
        checker.distance([0.0, turn])
    checker.distances(np.array([[0.0, 2.2], [0.1, -2.2]]))
    assert not asked and not recwarn.list
    checker.distance({"shoulder": 0.0, "wrist": -2.3})
    (told,) = recwarn.list
    start = "neighbours arm - hand, 0.1 m apart at home (wrist = 0 rad), touch at wrist = -2.3 rad"
    assert str(told.message).startswith(start) and told.filename == __file__
    checker.distances(np.array([[0.0, 2.9]]))
    assert len(recwarn.list) == 1


gaps = Neighbours.gaps


def test_a_joint_that_stays_where_neighbours_meet_is_a_notice_of_the_checker():
    notices = [
        one.text
        for one in cl.Checker(folding(fixed_positions={"wrist": 3.0})).notices
        if one.kind == "neighbours"
    ]
    assert len(notices) == 1 and "touch at wrist = 3 rad" in notices[0]
    assert not cl.Checker(folding(fixed_positions={"wrist": 2.0})).notices


def test_neighbours_on_a_ball_joint_are_checked_at_the_steps():
    """A block 0.2 m out on a ball joint in the middle of another turns on; about z it is a corner further out."""
    parts = chained("ball", "socket", "base", "block", np.eye(4))
    links = ("far", "base", "socket/yaw", "socket/pitch", "block")
    joints = (Joint("rail", JointKind.PRISMATIC, "far", "base", np.eye(4)), *parts)
    long, cube = cl.box((0.1, 1.0, 0.1)), cl.box((0.1, 0.1, 0.1))
    shapes = {
        "far": cube.transformed(at(z=3.0)),
        "base": long,
        "block": cube.transformed(at(x=0.2)),
    }
    bodies = tuple(cl.Body(name, shape) for name, shape in shapes.items())
    names = tuple(one.name for one in parts)
    rows = np.array([[0.0, 0.0, 0.0], [0.0, 0.0, 1.0], [1.5, 0.0, 0.0]])
    robot = cl.Robot("own", links, joints, bodies)
    path = cl.Trajectory(np.arange(3.0), names, rows)
    placed = cl.PlacedRobot(robot, path, self_clearance=cl.SelfClearance())
    (told,) = told_of(cl.Case("own", (placed,), ()))
    assert "base - block, 0.1 m apart at first, touch at a step, at socket/yaw = 1.5 rad" in told
    without_yaw = replace(placed, trajectory=replace(path, positions=rows[[0, 1, 1]]))
    assert told_of(cl.Case("own", (without_yaw,), ())) == []
