"""Files of the field that are not what is asked for are answered with one line that says what to do."""

import pytest

from clearance import check
from clearance.case.case_file import load_case
from clearance.errors import BadInput, BadShape, BadSyntax
from tests.formats.making import ARM, CASE, cube_stl
from tests.formats.making_case import changed, load_small
from tests.formats.making_urdf import BOX, link, robot

SRDF = """<?xml version="1.0"?><!-- made by an assistant -->
<robot name="arm"><group name="g"><link name="base"/><joint name="shoulder"/></group>
<disable_collisions link1="base" link2="upper" reason="Adjacent"/></robot>"""
SDF = '<?xml version="1.0" ?>\n<sdf version="1.7"><world name="w"><model name="m"/></world></sdf>'
MJCF = '<mujoco model="arm"><worldbody/></mujoco>'
SCENE = "(noname)+\n* box\n0.4 0 0.5\n0 0 0 1\n1\nbox\n0.1 0.1 0.1\n.\n"
JOINT_TRAJECTORY = """header: {frame_id: base}
joint_names: [shoulder]
points:
- positions: [0.0]
  time_from_start: {secs: 0, nsecs: 0}
"""
PLANNING_SCENE = "name: x\nworld:\n  collision_objects:\n  - id: box\n"

GIVEN = [
    (
        "arm.urdf",
        ARM,
        "this is a URDF robot, not a case file; name it in a case file: robot: {urdf: arm.urdf}",
    ),
    ("arm.xacro", ARM.replace("<link", "<xacro:arm/><link", 1), "xacro: true"),
    ("arm.srdf", SRDF, "this is a MoveIt SRDF, not a case file; .*srdf: arm.srdf"),
    ("world.sdf", SDF, "this is an SDF world or model"),
    ("arm.xml", MJCF, "this is a MuJoCo model"),
    ("table.scene", SCENE, "this is a MoveIt scene"),
    ("scene.txt", SCENE, "this is a MoveIt scene"),
    ("path.yaml", JOINT_TRAJECTORY, "this is a ROS JointTrajectory, .*trajectory: path.yaml"),
    ("scene.yaml", PLANNING_SCENE, "this is a MoveIt planning scene"),
    ("post.stl", cube_stl(), "this is a mesh.*mesh: {file: post.stl"),
    ("path.csv", "time,shoulder\n0,0\n", "this is a table.*trajectory: path.csv"),
]


@pytest.mark.parametrize(("name", "content", "says"), GIVEN, ids=[name for name, *_ in GIVEN])
def test_what_is_no_case_file_is_told_what_it_is(tmp_path, name, content, says):
    (tmp_path / name).write_bytes(content if isinstance(content, bytes) else content.encode())
    with pytest.raises(BadSyntax, match=says) as caught:
        load_case(tmp_path / name)
    told = str(caught.value)
    assert told.startswith(f"{name}: ") and "\n" not in told


@pytest.mark.parametrize(
    ("case", "says", "files"),
    [
        (
            changed("urdf: arm.urdf", "urdf: w.sdf"),
            "robot.urdf: w.sdf: this is an SDF",
            {"w__sdf": SDF},
        ),
        (
            changed("urdf: arm.urdf", "urdf: a.srdf"),
            "a.srdf: this is a MoveIt SRDF",
            {"a__srdf": SRDF},
        ),
        (
            changed("file: path.csv", "file: p.txt"),
            "p.txt: this is a ROS JointTrajectory, not a trajectory; name it in a case file: trajectory:",
            {"p__txt": JOINT_TRAJECTORY},
        ),
        (
            changed("file: path.csv", "file: p.yaml"),
            "p.yaml: this is a MoveIt planning scene",
            {"p__yaml": PLANNING_SCENE},
        ),
        (
            CASE.partition("scene:")[0] + "scene: t.yaml\ntrajectory: path.csv\n",
            "t.yaml: this is a MoveIt scene, not a scene; call it .scene",
            {"t__yaml": SCENE},
        ),
        (
            changed("urdf: arm.urdf", "urdf: other.yaml"),
            "robot.urdf: other.yaml: this is a case file, not a URDF file; `clearance check other.yaml`",
            {"other__yaml": CASE},
        ),
        (
            CASE.partition("scene:")[0] + "scene: other.yaml\ntrajectory: path.csv\n",
            "other.yaml: this is a case file, not a scene; `clearance check other.yaml` checks it",
            {"other__yaml": CASE},
        ),
    ],
)
def test_so_is_what_a_case_names(tmp_path, case, says, files):
    with pytest.raises(BadSyntax) as caught:
        load_small(tmp_path, case, **files)
    assert says in str(caught.value)


def test_case_files_of_all_kinds_are_case_files(tmp_path):
    assert load_small(tmp_path, "\ufeff# a comment\n---\n" + CASE).name == "small"


def test_a_trajectory_is_named_by_its_path_alone(tmp_path):
    case = load_small(tmp_path, changed("trajectory: {file: path.csv}", "trajectory: path.csv"))
    assert case.robots[0].trajectory.n_steps == 3


def test_a_case_without_a_name_has_that_of_its_file_or_folder(tmp_path):
    unnamed = changed("name: small\n", "")
    folder = tmp_path / "welding_cell"
    folder.mkdir()
    assert load_small(folder, unnamed).name == "welding_cell"
    (folder / "night_shift.yaml").write_text(unnamed)
    assert load_case(folder / "night_shift.yaml").name == "night_shift"


@pytest.mark.parametrize(
    "content", [b"<!--" * 20_000, b"<?x" * 20_000, b"<" * 60_000, b"a-" * 30_000, b"<!DOCTYPE "]
)
def test_what_does_not_end_is_not_looked_at_again_and_again(tmp_path, content):
    (tmp_path / "case.yaml").write_bytes(content)
    with pytest.raises(BadInput, match=r"^case\.yaml"):
        load_case(tmp_path / "case.yaml")


def test_a_robot_without_joints_needs_times_only(tmp_path):
    case = load_small(tmp_path, urdf=robot(link(BOX, "base")), trajectory="time\n0\n1\n")
    assert case.robots[0].trajectory.positions.shape == (2, 0)
    assert check(case).worst["clearance"] == pytest.approx(1.45, abs=1e-12)
    with pytest.raises(BadShape, match="there is no joint column"):
        load_small(tmp_path, trajectory="time\n0\n1\n")
