"""Steps of more than half a turn of continuous joints: suspect until it is said which way they go."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from clearance import Body, Case, Obstacle, PlacedRobot, Trajectory, box, check
from clearance.errors import BadInput
from clearance.world.motion import kinematic_motion
from clearance.world.notice import Severity
from clearance.world.plausibility import notices_of
from clearance.world.robot import Joint, JointKind, Mimic, Robot
from clearance.world.timing import Timing
from tests.made_cases import at

Z = np.array([0.0, 0.0, 1.0])


def spinner(kind=JointKind.CONTINUOUS) -> Robot:
    """A bar from the hub to 1 m along x, which turns about z; a second above it, half as fast."""
    bars = [Body(name, box((1.0, 0.02, 0.02)).transformed(at(0.5))) for name in ("bar", "upper")]
    joints = (
        Joint("spin", kind, "hub", "bar", np.eye(4), Z),
        Joint("half", kind, "hub", "upper", at(z=1.0), Z, mimic=Mimic("spin", 0.5)),
    )
    return Robot("spinner", ("hub", "bar", "upper"), joints, tuple(bars))


def case_of(positions, wrap=None, velocities=None, robot=None, timing=None, **more) -> Case:
    """The bar among two posts: their faces are 1.3 m from the hub at angle 0, 1.1 m at half a turn."""
    rows = [
        None if one is None else np.array(one, float)[:, None] for one in (positions, velocities)
    ]
    asked = Trajectory(np.arange(float(len(positions))), ("spin",), *rows, wrap=wrap)
    placed = PlacedRobot(robot or spinner(), asked, timing=timing or Timing())
    post = box((0.1, 0.1, 0.1))
    posts = (
        Obstacle(Body("ahead", post), at(1.35)),
        Obstacle(Body("behind", post), at(-1.15)),
    )
    return Case("spin", (placed,), posts, **more)


def suspects(case):
    return [one for one in notices_of(case) if one.severity is Severity.SUSPECT]


def least(case):
    return check(case, need="minimum").worst["clearance"]


def test_a_step_of_more_than_half_a_turn_is_suspect_and_both_readings_are_measured():
    """As written the bar points at one post on its way, 300 mm off; the shortest way at the other, 100 mm off."""
    run = check(case_of([2.9, -2.9]))
    assert run.verdict.status == "suspect" and run.verdict.exit_code == 2
    (one,) = run.verdict.suspects
    assert one.kind == "wrap"
    says, _, answers = one.text.partition("; least clearance as written: ")
    assert says == (
        "joint 'spin' turns by more than half a turn in one step, from 2.9 to -2.9 rad between 0 s and 1 s: "
        "-5.8 rad as written, 0.483 rad the shortest way; say which with trajectory: {wrap: as_written} or "
        "{wrap: shortest}"
    )
    figures = [float(answer.split(" mm")[0]) for answer in answers.split(", the shortest way: ")]
    assert figures == pytest.approx([1e3 * run.worst["clearance"], 100.0], abs=0.11)
    assert (
        run.worst["obstacle"] == "behind" and figures[0] > 101.0
    )  # at the ends; by the way 300 mm
    assert least(case_of([2.9, -2.9], "shortest")) == pytest.approx(0.1, abs=1e-4)
    accepted = check(case_of([2.9, -2.9], accept=("wrap",)))
    assert accepted.passed and accepted.worst["clearance"] == run.worst["clearance"]


def test_both_readings_say_contact_where_it_is():
    case = case_of([2.9, -2.9])
    wall = Obstacle(Body("wall", box((0.1, 0.1, 0.1))), at(-0.9))
    (one,) = check(replace(case, obstacles=(*case.obstacles, wall))).verdict.suspects
    assert one.text.endswith("the shortest way: contact")


@pytest.mark.parametrize(
    ("positions", "is_suspect"),
    [
        ([0.0, np.pi], False),
        ([0.7, 0.7 - np.pi], False),
        ([0.0, np.pi + 1e-6], True),
        ([-1.6, 1.6], True),
        ([0.0, 3.0, 6.0, 9.0], False),
        ([0.0, 2 * np.pi], True),
    ],
)
def test_half_a_turn_is_as_long_either_way(positions, is_suspect):
    assert bool(suspects(case_of(positions))) == is_suspect
    assert suspects(case_of(positions, "shortest")) == []
    assert suspects(case_of(positions, "as_written")) == []
    if not is_suspect:
        again = case_of(positions, "shortest").robots[0].trajectory
        assert again.positions[:, 0].tolist() == positions


def test_joints_with_limits_have_no_other_way():
    robot = spinner(JointKind.REVOLUTE)
    assert suspects(case_of([2.9, -2.9], robot=robot)) == []
    asked = case_of([2.9, -2.9], "shortest", robot=robot).robots[0].trajectory
    assert asked.positions[:, 0].tolist() == [2.9, -2.9]


def test_a_wrap_that_is_none_is_refused():
    with pytest.raises(BadInput, match="wrap is 'short'; one of shortest, as_written"):
        case_of([0.0, 1.0], "short")


def test_a_table_that_begins_again_elsewhere_is_suspect_and_one_that_closes_is_not():
    (notice,) = suspects(case_of([0.0, 3.0, 6.0], timing=Timing(after="loop")))
    assert "ends elsewhere: joint 'spin' by 0.283 rad, joint 'half' by 3 rad;" in notice.text
    closed = [0.0, 3.0, 6.0, 9.0, 12.0, 4.0 * np.pi]
    assert suspects(case_of(closed, timing=Timing(after="loop"))) == []
    assert suspects(case_of([0.0, 3.0, -0.28], timing=Timing(after="loop")))


def test_another_trajectory_says_so_itself():
    case = case_of([0.0, 1.0]).with_trajectory([0.0, 1.0], [[2.9], [-2.9]])
    assert [one.kind for one in suspects(case)] == ["wrap"]
    case = case.with_trajectory([0.0, 1.0], [[2.9], [-2.9]], wrap="shortest")
    assert suspects(case) == []
    assert case.robots[0].trajectory.positions[1, 0] == pytest.approx(2 * np.pi - 2.9)


@st.composite
def turned(draw):
    """A course by hand, with steps of half a turn at most, and the same with whole turns put on at random."""
    steps = draw(st.lists(st.floats(-np.pi + 1e-6, np.pi - 1e-6), min_size=1, max_size=6))
    course = draw(st.floats(-3.0, 3.0)) + np.cumsum([0.0, *steps])
    turns = draw(st.lists(st.integers(-2, 2), min_size=len(steps), max_size=len(steps)))
    return course, course + 2.0 * np.pi * np.array([0, *turns])


@settings(max_examples=30)
@given(turned())
def test_by_the_shortest_way_a_table_goes_as_the_one_unwrapped_by_hand(made):
    course, written = made
    case = case_of(written)
    steps = np.abs(np.diff(written))
    assert bool(suspects(case)) == bool((steps > np.pi + 1e-9).any())
    shortest, as_written = (case_of(written, wrap).robots[0] for wrap in ("shortest", "as_written"))
    assert shortest.trajectory.positions[:, 0] == pytest.approx(course, abs=1e-12)
    assert as_written.trajectory.positions[:, 0].tolist() == written.tolist()
    again = PlacedRobot(shortest.robot, shortest.trajectory)
    assert again.trajectory.positions.tolist() == shortest.trajectory.positions.tolist()
    by_hand = kinematic_motion(case_of(course).robots[0])
    poses = kinematic_motion(shortest).poses()  # of what follows at half the speed too
    assert np.abs(poses - by_hand.poses()).max() < 1e-11
