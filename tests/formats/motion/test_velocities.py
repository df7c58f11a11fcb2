"""Velocities and accelerations in a trajectory file: what is followed, told, refused and written."""

from dataclasses import replace

import numpy as np
import pytest

from clearance import check, load_case
from clearance.errors import MissingKey
from clearance.formats.motion.requests import parse_trajectory
from clearance.formats.motion.trajectory_writer import written
from clearance.world.cubic import positions_along
from clearance.world.joint_limits import notices_on_joints
from clearance.world.placed_robot import PlacedRobot
from clearance.world.plausible_motion import notices_on_motion
from clearance.world.quintic import with_accelerations
from clearance.world.robot import Joint, JointKind, Robot
from clearance.world.trajectory import Trajectory
from tests.formats.making import write_case
from tests.formats.making_messages import POINTS, dumped, with_points


def notes(positions, velocities, kind=JointKind.REVOLUTE, accelerations=None):
    joint = Joint("elbow", kind, "a", "b", np.eye(4), lower=-1.0, upper=1.0)
    robot = Robot("robot", ("a", "b"), (joint,), ())
    columns = [np.array(values, dtype=float)[:, None] for values in (positions, velocities)]
    asked = Trajectory(np.arange(len(positions), dtype=float), ("elbow",), *columns)
    if accelerations is not None:
        asked = with_accelerations(asked, np.array(accelerations, dtype=float)[:, None])
    placed = PlacedRobot(robot, asked)
    return [
        notice.text for notice in (*notices_on_motion(placed), *notices_on_joints(placed, "warn"))
    ]


def test_a_cubic_that_leaves_the_limits_between_samples_is_told():
    assert notes([0.9, 0.9, 0.0], [0.8, -0.8, -1.0]) == [
        "joint 'elbow' leaves its limits -1 to 1 rad by up to 0.1 rad between two samples, "
        "on the cubic that its velocities make, in 1 of 2 intervals"
    ]


@pytest.mark.parametrize(
    ("positions", "velocities"),
    [([0.9, 0.9, 0.0], [0.3, -0.3, -1.0]), ([-1.0, 1.0], [0.0, 0.0]), ([0.5], [9.0])],
)
def test_what_stays_within_its_limits_is_not(positions, velocities):
    assert notes(positions, velocities) == []


def test_degrees_a_second_are_told():
    positions = np.sin(np.linspace(0.0, 3.0, 20))
    velocities = np.gradient(positions)
    assert not any("CHECK UNITS" in note for note in notes(positions, velocities))
    told = notes(positions, np.degrees(velocities))
    assert any("velocities of joint 'elbow'" in note and "degrees/s" in note for note in told)
    told = notes(positions, np.degrees(velocities), accelerations=np.zeros(20))
    assert any("velocities of joint 'elbow'" in note and "degrees/s" in note for note in told)
    told = notes(positions, velocities, accelerations=np.gradient(velocities))
    assert not any("CHECK UNITS" in note for note in told)
    told = notes(positions, 1000.0 * velocities, JointKind.PRISMATIC)
    assert any("is this mm/s?" in note for note in told)
    assert notes([0.0, 0.0], [1e-4, 1e-4]) == []


def test_a_case_file_is_certified_on_the_cubics_of_its_trajectory(tmp_path):
    rows = "time,shoulder,shoulder/velocity\n0,0.3,0.8\n1,0.3,-0.8\n"
    case = load_case(write_case(tmp_path, trajectory=rows))
    asked = case.robots[0].trajectory
    assert asked.velocities.tolist() == [[0.8], [-0.8]]
    run = check(case, certify=True)
    times = np.linspace(0.0, 1.0, 501)
    sampled = Trajectory(times, asked.joint_names, positions_along(asked, times))
    finer = replace(case, robots=(replace(case.robots[0], trajectory=sampled),))
    least = check(finer).record.clearances.min()
    bound = run.record.certificate.lower_bound[0]
    assert least < run.record.clearances.min() - 1e-3
    assert least - 2e-4 <= bound <= least


def test_accelerations_without_velocities_are_refused():
    points = [
        {key: value for key, value in point.items() if key != "velocities"}
        | {"accelerations": [0, 1]}
        for point in POINTS
    ]
    with pytest.raises(MissingKey, match="points: accelerations without velocities; velocities in"):
        parse_trajectory(dumped(with_points(*points)).encode(), "path.json")


@pytest.mark.parametrize("name", ["out.yaml", "out.json"])
def test_points_with_accelerations_are_written_as_they_were_read(name):
    points = [{**point, "accelerations": [0.1, -1e-3 / 3]} for point in POINTS]
    asked = parse_trajectory(dumped(with_points(*points)).encode(), "path.json")
    back = parse_trajectory(written(asked, name).content, name)
    for key in ("times", "positions", "velocities", "accelerations"):
        assert (getattr(back.points, key) == getattr(asked.points, key)).all()
    assert (back.positions == asked.positions).all() and back.path_error == asked.path_error
    made = written(asked, "out.csv")
    (told,) = made.notes
    assert told.startswith("its cubics are up to 1e-08 rad or m off the motion asked for")
    table = parse_trajectory(made.content, "out.csv")
    assert (table.positions == asked.positions).all() and table.points is None
