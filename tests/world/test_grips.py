"""The errors that a part has of its carriers put it where a machine that is off so puts it."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from clearance.world.budget import Budget, JointTolerance, RobotTolerance
from clearance.world.motion import kinematic_motion
from clearance.world.mount import Mount
from clearance.world.timeline import timeline_of
from tests.budget.part_cases import carried, cube, gantry, off_by, slid
from tests.budget.sampled_machine import HandlingMachine, pose_of
from tests.budget.test_parts_sampled import handling
from tests.made_cases import at


def with_joint_errors(case):
    """The case whose joints alone are off, by some hundredths, and no grasp exact."""
    off = {
        placed.robot.name: RobotTolerance(
            {joint.name: JointTolerance(tracking=0.03) for joint in placed.robot.joints}
        )
        for placed in case.robots
    }
    obstacles = {one.name: case.tolerance.obstacles[one.name] for one in case.obstacles}
    exact = {name: replace(own, place=type(own.place)()) for name, own in obstacles.items()}
    carries = tuple(replace(one, exact_grasp=False) for one in case.carries)
    return replace(case, tolerance=Budget(off, exact), carries=carries)


def phases_of(case):
    """The phases of a case."""
    return timeline_of(case, [kinematic_motion(placed) for placed in case.robots]).phases


def moved(one, errors) -> np.ndarray:
    """(4, 4) what one error of a joint does, which others follow, as the part sees it."""
    q = one.sign * sum(float(value[0]) for value in errors)
    if one.slides:
        return pose_of(q * one.axis, np.zeros(3))
    there = pose_of(one.origin, np.zeros(3))
    return there @ pose_of(np.zeros(3), q * one.axis) @ np.linalg.inv(there)


@pytest.mark.parametrize("seed", range(4))
def test_errors_one_after_the_other_put_the_part_where_it_is(seed):
    case = with_joint_errors(handling(seed))
    machine, rng = HandlingMachine(case), np.random.default_rng(seed)
    for phase in phases_of(case)[1:]:
        start = float(phase.times[0])
        moments = [*machine.moments(start), machine.NOW]
        errors = {moment: machine.random(rng) for moment in moments}
        _, real = machine.parts_at(start, errors)["part"]
        part = next(one for one in phase.case.obstacles if one.name == "part")
        found = part.world_from_body if part.mount is None else part.mount.pose
        robots = {placed.robot.name: placed.robot for placed in case.robots}
        for one in reversed(part.past):
            if one.axis is not None:
                mimic = next(j for j in robots[one.owner].joints if j.name == one.joint).mimic
                assert mimic is None
                found = found @ moved(one, [errors[one.time]["joint", one.owner, one.joint]])
        assert found == pytest.approx(real, abs=1e-12)


def past_of(case, phase: int):
    """What the part has in a phase."""
    return next(o.past for o in phases_of(case)[phase].case.obstacles if o.name == "part")


def test_the_first_is_the_first_and_the_base_comes_before_the_gripper():
    case = slid(off_by(0.004), carried("bar", 0.0, 1.0), robots=(gantry("arm", 0.0, -0.5, 0.0),))
    reported = [(one.moment, one.joint, one.axis is not None, one.sign) for one in past_of(case, 1)]
    grasp = [("", False), ("j", False), ("j", True)]
    assert reported == [
        *(("grasp (0 s)", joint, is_joint, -1.0) for joint, is_joint in grasp),
        *(("release (1 s)", joint, is_joint, 1.0) for joint, is_joint in reversed(grasp)),
    ]


def test_what_one_moment_does_and_undoes_is_omitted():
    case = slid(off_by(0.004), obstacles=(cube(mount=Mount("base", at(0.9))),))
    assert [(one.joint, one.axis is not None) for one in past_of(case, 0)] == [
        ("j", False),
        ("j", True),
    ]


def test_from_hand_to_hand_of_one_robot_the_base_is_off_with_both():
    own = carried("bar", 0.0, 1.0), carried("base", 1.0)
    case = slid(off_by(0.004), *own, robots=(gantry("arm", 0.0, -0.5, 0.0),))
    reported = [(one.moment, one.joint) for one in past_of(case, 1)]
    assert reported == [
        ("grasp (0 s)", ""),
        ("grasp (0 s)", "j"),
        ("grasp (0 s)", "j"),
        ("release (1 s)", "j"),
        ("release (1 s)", "j"),
    ]


def test_without_tolerances_and_of_exact_grasps_nothing_is_kept():
    case = slid(off_by(0.004), carried("bar", 0.0, exact_grasp=True))
    assert past_of(case, 0) == ()
    assert past_of(replace(slid(off_by(0.004)), tolerance=None), 0) == ()
