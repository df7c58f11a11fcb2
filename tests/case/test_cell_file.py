"""A cell given one trajectory after another is what its file would be with each of them in it."""

import pytest

from clearance.case.case_file import load_case, load_cell, with_trajectory_file
from clearance.errors import BadInput, MissingFile, UnknownRobot
from clearance.formats.schema.timed import TrajectoryFile
from tests.formats.making import CASE, write_case

CELL = CASE.replace("trajectory: {file: path.csv}\n", "")


@pytest.fixture
def folder(tmp_path):
    write_case(tmp_path, CASE)
    (tmp_path / "cell.yaml").write_text(CELL)
    return tmp_path


def asked(text: str = "path.csv") -> TrajectoryFile:
    return TrajectoryFile(file=text)


def test_a_cell_with_a_trajectory_is_the_case_with_it(folder):
    case, cell = load_case(folder / "case.yaml"), load_cell(folder / "cell.yaml")
    made = with_trajectory_file(cell, asked(), case.name)
    assert (made.name, made.limits, made.notes, made.notices) == (
        case.name, case.limits, case.notes, case.notices)  # fmt: skip
    assert {s.path for s in made.sources} == {
        s.path.replace("case.yaml", "cell.yaml") for s in case.sources}  # fmt: skip
    one, other = made.robots[0].given_trajectory, case.robots[0].given_trajectory
    assert one.joint_names == other.joint_names and (one.positions == other.positions).all()


def test_what_is_wrong_with_one_trajectory_is_told_with_its_file(folder):
    cell = load_cell(folder / "cell.yaml")
    with pytest.raises(MissingFile, match=r"cell\.yaml: trajectory\.file: .*gone\.csv"):
        with_trajectory_file(cell, asked("gone.csv"), "gone")


def test_a_robot_that_has_a_trajectory_is_given_no_other(folder):
    with pytest.raises(BadInput, match="gives a trajectory to the robot itself"):
        with_trajectory_file(load_cell(folder / "case.yaml"), asked(), "other")


def test_an_unknown_robot_is_named(folder):
    with pytest.raises(UnknownRobot, match="no one robot 'nobody'"):
        with_trajectory_file(load_cell(folder / "cell.yaml"), asked(), "one", "nobody")
