"""Files of the field that are not what is asked for are answered with one line that says what to do."""

import pytest

from clearance import check
from clearance.case.case_file import load_case
from clearance.errors import BadShape, BadSyntax
from tests.formats.making import CASE
from tests.formats.making_case import changed, load_small
from tests.formats.making_urdf import BOX, link, robot
from tests.formats.refusal import refusal
from tests.formats.test_known_formats import JOINT_TRAJECTORY, SCENE, SDF


@pytest.mark.parametrize(
    ("case", "says", "files"),
    [
        (
            changed("urdf: arm.urdf", "urdf: w.sdf"),
            "robot.urdf: w.sdf: this is an SDF world or model",
            {"w__sdf": SDF},
        ),
        (
            changed("file: path.csv", "file: p.txt"),
            "p.txt: this is a ROS JointTrajectory, not a trajectory; name it in a case file: trajectory:",
            {"p__txt": JOINT_TRAJECTORY},
        ),
        (
            CASE.partition("scene:")[0] + "scene: t.yaml\ntrajectory: path.csv\n",
            "scene: t.yaml: this is a MoveIt scene, not a scene; call it .scene",
            {"t__yaml": SCENE},
        ),
        (SDF, "case.yaml: this is an SDF", {}),
    ],
)
def test_what_a_case_names_is_told_what_it_is(tmp_path, case, says, files):
    assert says in refusal(load_small, tmp_path, case, **files, of=BadSyntax)


def test_a_case_without_a_name_has_that_of_its_file_or_folder(tmp_path):
    unnamed = changed("name: small\n", "")
    folder = tmp_path / "welding_cell"
    folder.mkdir()
    assert load_small(folder, unnamed).name == "welding_cell"
    (folder / "night_shift.yaml").write_text(unnamed)
    assert load_case(folder / "night_shift.yaml").name == "night_shift"


def test_a_robot_without_joints_needs_times_only(tmp_path):
    case = load_small(tmp_path, urdf=robot(link(BOX, "base")), trajectory="time\n0\n1\n")
    assert case.robots[0].trajectory.positions.shape == (2, 0)
    assert check(case).worst["clearance"] == pytest.approx(0.65, abs=1e-12)
    with pytest.raises(BadShape, match="there is no joint column"):
        load_small(tmp_path, trajectory="time\n0\n1\n")
