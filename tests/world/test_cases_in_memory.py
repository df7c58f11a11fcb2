"""Cases that are made in Python: the same answers as from files, and the same care about bad input."""

import dataclasses

import numpy as np
import pytest

import clearance as cl
from clearance.errors import (
    BadDimension,
    BadShape,
    BadTime,
    Contradiction,
    DuplicateName,
    NotFinite,
    NothingToMeasure,
    NoTrajectory,
    UnknownJoint,
    UnknownRobot,
)
from tests.made_cases import arm, at

KUKA = "pybullet_data:kuka_iiwa/model.urdf"


def kuka():
    from clearance.formats.files.input_files import resolved

    return cl.load_robot(resolved(KUKA, "."))


@pytest.fixture(scope="module")
def given():
    return cl.load_case("scenes/iiwa_pipe_rack/case.yaml")


def test_without_a_trajectory_there_is_nothing_to_check(given):
    resting = dataclasses.replace(given.robots[0], trajectory=None)
    with pytest.raises(NoTrajectory, match="with_trajectory"):
        cl.check(dataclasses.replace(given, robots=(resting,)))


def test_whatever_is_changed_is_another_cell(given):
    robot, obstacle, pose = given.robots[0], given.obstacles[0], at(0.1)
    changes = [
        {"obstacles": ()},
        {"obstacles": (dataclasses.replace(obstacle, world_from_body=pose),)},
        *(
            {"robots": (dataclasses.replace(robot, **change),)}
            for change in (
                {"world_from_base": pose},
                {"padding": {robot.robot.link_names[-1]: 0.01}},
                {"robot": dataclasses.replace(robot.robot)},
                {"exclude_links": robot.robot.link_names[-1:]},
            )
        ),
        {"limits": cl.Limits(0.1)},
        {"limits": cl.Limits(0.0, rules=(cl.Rule(("*", "*"), fail=0.1),))},
        {"allow": ((robot.robot.link_names[-1], obstacle.name),)},
    ]
    cells = [given.cell, *(dataclasses.replace(given, **change).cell for change in changes)]
    assert len(set(cells)) == len(cells)


def test_a_trajectory_is_replaced_in_the_order_of_the_one_before(given):
    asked = given.robots[0].trajectory
    later = given.with_trajectory(asked.times + 1.0, asked.positions)
    assert later.robots[0].trajectory.joint_names == asked.joint_names
    assert later.robots[0].trajectory.times[0] == asked.times[0] + 1.0
    assert given.robots[0].trajectory is asked


def test_a_note_says_the_order_of_columns_where_it_is_not_that_of_the_robots_file(given):
    """A table has its columns in any order. Who gives a planner's edge has the joints in that of the robot."""
    names = given.robots[0].trajectory.joint_names
    rows = np.zeros((2, len(names)))
    assert given.with_trajectory([0.0, 1.0], rows).notes == given.notes
    turned = given.with_trajectory([0.0, 1.0], rows, joint_names=names[::-1])
    assert turned.notes == given.notes
    again = turned.with_trajectory([0.0, 1.0], rows)
    (note,) = set(again.notes) - set(given.notes)
    said = f"columns are taken in the order of the trajectory before: {', '.join(names[::-1])}; "
    assert note.startswith(said) and note.endswith("`joint_names` says which is meant")
    assert again.with_trajectory([0.0, 1.0], rows).notes == again.notes


@pytest.mark.parametrize(
    ("times", "positions", "options", "fault"),
    [
        ([0.0, 0.0], np.zeros((2, 7)), {}, BadTime),
        ([0.0, 1.0], np.zeros((2, 6)), {}, BadShape),
        ([0.0], np.zeros((2, 7)), {}, BadShape),
        ([], np.zeros((0, 7)), {}, BadShape),
        ([0.0, np.inf], np.zeros((2, 7)), {}, NotFinite),
        ([0.0, 1.0], np.full((2, 7), np.nan), {}, NotFinite),
        (["now"], np.zeros((1, 7)), {}, BadShape),
        ([0.0, 1.0], np.zeros((2, 1)), {"joint_names": ["nobody"]}, UnknownJoint),
        ([0.0, 1.0], np.zeros((2, 7)), {"robot": "nobody"}, UnknownRobot),
        ([0.0, 1.0], np.zeros((2, 7)), {"velocities": np.zeros((2, 6))}, BadShape),
    ],
)
def test_what_is_no_trajectory_is_refused(given, times, positions, options, fault):
    with pytest.raises(fault):
        given.with_trajectory(times, positions, **options)


def posts(*names):
    return tuple(cl.Obstacle(cl.Body(name, cl.box((0.1, 0.1, 1.0)))) for name in names)


def still(name):
    """A small arm that stands."""
    case = arm("arm", [cl.box((0.2, 0.1, 0.1))] * 2, [], np.zeros((2, 2)))
    (placed,) = case.robots
    return dataclasses.replace(placed, robot=dataclasses.replace(placed.robot, name=name))


def test_a_case_that_no_table_could_tell_apart_is_refused():
    with pytest.raises(NothingToMeasure, match="no robot"):
        cl.Case("empty", (), posts("post"))
    with pytest.raises(DuplicateName, match="two robots have the name 'left'"):
        cl.Case("twins", (still("left"), still("left")), posts("post"))
    with pytest.raises(DuplicateName, match="two obstacles have the name 'post'"):
        cl.Case("posts", (still("left"),), posts("post", "post"))
    with pytest.raises(cl.BadInput, match="'a/b' has a '/' in its name"):
        cl.Case("strokes", (still("left"), still("a/b")), posts("post"))
    for name in ("left", "left/l1"):
        with pytest.raises(cl.BadInput, match="another name for the obstacle"):
            cl.Case("names", (still("left"), still("right")), posts(name))


@pytest.mark.parametrize("name", ["post\x1b[31m", "post\nCLEAR", "post\uffff"])
def test_names_that_no_line_can_show_are_refused(name):
    with pytest.raises(cl.BadInput):
        cl.Case("case", (still("left"),), posts(name))
    with pytest.raises(cl.BadInput):
        cl.Case(name, (still("left"),), posts("post"))


def test_a_trajectory_is_held_against_its_robot():
    asked = cl.Trajectory(np.zeros(1), ("nobody",), np.zeros((1, 1)))
    with pytest.raises(UnknownJoint, match="nobody"):
        cl.PlacedRobot(kuka(), asked)
    with pytest.raises(DuplicateName, match="joint 'a' is there twice"):
        cl.Trajectory(np.zeros(1), ("a", "a"), np.zeros((1, 2)))


def test_a_joint_is_fixed_or_moved_and_not_both():
    with pytest.raises(NotFinite, match=r"fixed_positions\.lbr_iiwa_joint_1: a position is NaN"):
        cl.PlacedRobot(kuka(), fixed_positions={"lbr_iiwa_joint_1": np.nan})
    asked = cl.Trajectory(np.zeros(1), ("lbr_iiwa_joint_1",), np.zeros((1, 1)))
    with pytest.raises(Contradiction, match="which is fixed too"):
        cl.PlacedRobot(kuka(), asked, fixed_positions={"lbr_iiwa_joint_1": 1.5})
    fixed = {"lbr_iiwa_joint_1": 1.5, "lbr_iiwa_joint_2": 0.5}
    robot = cl.PlacedRobot(kuka(), fixed_positions=fixed)
    case = cl.Case("one", (robot,), posts("post"))
    moved = case.with_trajectory([0.0], [[0.0]], joint_names=["lbr_iiwa_joint_1"])
    assert moved.robots[0].fixed_positions == {"lbr_iiwa_joint_2": 0.5}


def test_limits_are_numbers_of_metres():
    assert cl.Limits(0, 1) == cl.Limits(0.0, 1.0) and type(cl.Limits(0, 1).warn) is float
    case = dataclasses.replace(cl.load_case("scenes/box_box/case.yaml"), limits=cl.Limits(0, 1))
    assert cl.check(case).status == "suspect"  # a limit of a metre
    with pytest.raises(BadDimension, match="'5'"):
        cl.Limits(fail="5")
    with pytest.raises(BadDimension, match="limit fail is True"):
        cl.Limits(fail=True)
    with pytest.raises(cl.BadInput):
        cl.check(case, limits=(0.1, 0.2))
    with pytest.raises(cl.BadInput):
        cl.Question(case, certify_gap="a")
    with pytest.raises(cl.BadInput):
        cl.Resources(jobs="2")


def test_what_is_printed_of_a_case_is_a_line():
    case = cl.load_case("scenes/box_box/case.yaml")
    placed = case.robots[0]
    assert repr(placed.robot) == "<Robot 'gantry_box': links with shapes 1, moving joints 6>"
    assert repr(case) == f"<Case 'box_box': {placed.robot!r}, obstacles 1>"
    assert repr(placed.trajectory) == "<Trajectory: samples 301, joints 6, 0 to 6 s>"
    assert repr(cl.box((1.0, 1.0, 1.0))) == "<Polyhedron: vertices 8, polygons 6>"
    assert repr(cl.Checker(case)) == f"<Checker of {case!r}, pairs 1>"
