"""The table of formats: what follows from a row, what files hold, what the guide and the schema say of all."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from clearance import check
from clearance.case.case_file import load_case
from clearance.errors import BadInput, BadShape, BadSyntax
from clearance.extras import LIBRARIES
from clearance.formats import known_formats
from clearance.formats.conversion import kind_of
from clearance.formats.files.input_files import InputFiles
from clearance.formats.known_formats import (
    ANY,
    FORMATS,
    Kind,
    format_of,
    function_at,
    names_of,
    refuse_foreign,
    written_as,
)
from clearance.formats.schema.json_schema import case_schema
from tests.formats import making_messages, making_moveit
from tests.formats.making import ARM, CASE, PATH, cube_stl
from tests.formats.making_case import changed, load_small
from tests.formats.making_cell import DOOR
from tests.formats.making_messages import display_trajectory
from tests.formats.making_mjcf import mjcf
from tests.formats.making_sdf import sdf
from tests.formats.making_urdf import BOX, link, robot
from tests.formats.motion.test_poses_in_files import STAMPED, pose
from tests.formats.refusal import refusal

GUIDE = Path(__file__).resolve().parents[2] / "scripts" / "docs" / "case_file.md"

SRDF = """<?xml version="1.0"?><!-- made by an assistant -->
<robot name="arm"><group name="g"><link name="base"/><joint name="shoulder"/></group>
<disable_collisions link1="base" link2="upper" reason="Adjacent"/></robot>"""
XACRO = ARM.replace("<link", "<xacro:arm/><link", 1)
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
POSES = "time,x,y,z,qx,qy,qz,qw\n0,0,0,0,0,0,0,1\n"

FOREIGN = [
    (Kind.CASE, "arm.urdf", ARM, "a URDF robot, not a case file; .*robot: {urdf: arm.urdf}"),
    (Kind.CASE, "arm.xacro", XACRO, "a xacro robot, .*xacro: true"),
    (Kind.CASE, "arm.srdf", SRDF, "a MoveIt SRDF, not a case file; .*srdf: arm.srdf"),
    (Kind.CASE, "world.sdf", SDF, "an SDF world or model"),
    (Kind.CASE, "arm.xml", MJCF, "a MuJoCo model"),
    (Kind.CASE, "table.scene", SCENE, "a MoveIt scene"),
    (Kind.CASE, "scene.txt", SCENE, "a MoveIt scene"),
    (Kind.CASE, "path.yaml", JOINT_TRAJECTORY, "a ROS JointTrajectory, .*trajectory: path.yaml"),
    (Kind.CASE, "scene.yaml", PLANNING_SCENE, "a MoveIt planning scene"),
    (Kind.CASE, "post.stl", cube_stl(), "a mesh, .*mesh: {file: post.stl"),
    (Kind.CASE, "a.gltf", "{}", "a mesh, not a case file; export it as .glb"),
    (Kind.CASE, "run.mcap", "", "a ROS bag, not a case file; .*trajectory: run.mcap"),
    (Kind.CASE, "scan.pcd", "", "a scan, not a case file; .*points: {file: scan.pcd"),
    (Kind.CASE, "path.csv", "time,shoulder\n0,0\n", "a table, .*trajectory: path.csv"),
    (Kind.CASE, "door.csv", POSES, "a table of poses, not a case file; .*moves: door.csv"),
    (Kind.ROBOT, "w.sdf", SDF, "an SDF world or model, not a URDF file"),
    (Kind.ROBOT, "a.srdf", SRDF, "a MoveIt SRDF, not a URDF file"),
    (Kind.ROBOT, "a.urdf", MJCF, "a MuJoCo model, not a URDF file; call it .xml"),
    (Kind.ROBOT, "other.yaml", CASE, "a case file, not a URDF file; `clearance check other.yaml`"),
    (Kind.SCENE, "other.yaml", CASE, "a case file, not a scene; `clearance check other.yaml`"),
    (Kind.SCENE, "t.yaml", SCENE, "a MoveIt scene, not a scene; call it .scene"),
    (Kind.TRAJECTORY, "p.txt", JOINT_TRAJECTORY, "a ROS JointTrajectory, not a trajectory"),
    (Kind.TRAJECTORY, "p.yaml", PLANNING_SCENE, "a MoveIt planning scene, not a trajectory"),
]


@pytest.mark.parametrize(("kind", "name", "content", "says"), FOREIGN)
def test_a_file_of_another_format_is_told_what_it_is(kind, name, content, says):
    data = content if isinstance(content, bytes) else content.encode()
    with pytest.raises(BadSyntax, match=f"this is {says}") as caught:
        refuse_foreign(data, f"folder/{name}", kind)
    told = str(caught.value)
    assert told.startswith(f"folder/{name}: ")


@pytest.mark.parametrize(
    ("kind", "name", "content"),
    [
        (Kind.CASE, "case.yaml", "\ufeff# a comment\n---\n" + CASE),
        (Kind.CASE, "anything", "a: 1\n"),
        (Kind.ROBOT, "arm.txt", ARM),
        (Kind.ROBOT, "arm.urdf", XACRO),
        (Kind.SCENE, "cell.txt", PLANNING_SCENE),
        (Kind.TRAJECTORY, "path.json", JOINT_TRAJECTORY),
        (Kind.TRAJECTORY, "door.csv", POSES),
        (Kind.POSES, "door.csv", POSES),
    ],
)
def test_what_its_own_reader_takes_is_left_to_it(kind, name, content):
    refuse_foreign(content.encode(), name, kind)


@pytest.mark.parametrize(
    ("kind", "name", "content", "format_name"),
    [
        (Kind.MESH, "A.STP", "", "STEP"),
        (Kind.ROBOT, "arm.xml", ARM, "URDF"),
        (Kind.ROBOT, "arm.xml", MJCF, "MJCF robot"),
        (Kind.ROBOT, "arm.urdf", MJCF, "URDF"),
        (Kind.ROBOT, "arm", "", "URDF"),
        (Kind.SCENE, "cell.WORLD", "", "SDF"),
        (Kind.SCENE, "cell", POSES, "MoveIt PlanningScene"),
        (Kind.TRAJECTORY, "path.txt", POSES, "CSV"),
        (Kind.TRAJECTORY, "path.json", "", "JointTrajectory in JSON"),
        (Kind.POSES, "path.yml", JOINT_TRAJECTORY, "stamped poses in YAML"),
        (Kind.CLOUD, "a.ply", "", "points of a PLY"),
    ],
)
def test_a_file_is_read_as_its_suffix_says_and_then_its_content(kind, name, content, format_name):
    known = format_of(kind, name, content.encode())
    assert known is not None and known.name == format_name


def test_what_cannot_be_written_is_refused():
    assert written_as(Kind.SCENE, "a.YML").name == "YAML"
    with pytest.raises(BadInput, match=r"'a.sdf' has no suffix to write for a scene; one of .yaml"):
        written_as(Kind.SCENE, "a.sdf")


def test_every_reader_and_writer_is_there():
    for one in FORMATS:
        for place in filter(None, (one.read, one.write)):
            assert callable(function_at(place)), place
        assert not one.extra or one.extra in LIBRARIES
        assert one.kind in known_formats.WANTED or not one.write


def test_names_are_of_one_format_of_a_kind():
    assert len({(one.kind, one.name) for one in FORMATS}) == len(FORMATS)


def test_the_guide_has_a_row_of_each_format():
    rows = [
        f"| {one.kind} | {one.name} | {' '.join(f'`{s}`' for s in one.suffixes if s != ANY)} | "
        f"{f'`{one.extra}`' if one.extra else ''} | {'yes' if one.write else ''} |"
        for one in FORMATS
        if one.read
    ]
    assert "\n".join(rows) + "\n\n" in GUIDE.read_text()


def test_the_schema_names_every_format():
    told = json.dumps(case_schema())
    for kind in (Kind.SCENE, Kind.POSES, Kind.TRAJECTORY):
        assert names_of(kind) in told


@pytest.mark.parametrize(
    ("case", "content", "says"),
    [
        (changed("urdf: arm.urdf", "urdf: f.txt"), SDF, "robot.urdf: f.txt: this is an SDF world or model"),
        (changed("file: path.csv", "file: f.txt"), JOINT_TRAJECTORY,
         "f.txt: this is a ROS JointTrajectory, not a trajectory; name it in a case file: trajectory:"),
        (changed("scene:\n  obstacles:\n  - name: post\n    pose: {xyz: [1.2, 0, 0]}\n"
                 "    box: {size: [0.1, 0.1, 1]}\n", "scene: f.txt\n"), SCENE,
         "scene: f.txt: this is a MoveIt scene, not a scene; call it .scene"),
        (SDF, "", "case.yaml: this is an SDF"),
    ],
)  # fmt: skip
def test_what_a_case_names_is_told_what_it_is(tmp_path, case, content, says):
    assert says in refusal(load_small, tmp_path, case, f__txt=content, of=BadSyntax)


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


OURS = "# what stands there, pose: none\nobstacles:\n- {name: a, sphere: {radius: 1}, pose: {xyz: [0, 0, 1]}}\n"
HELD_STATE = {"joint_state": {"name": ["a"], "position": [0.0]}, "attached_collision_objects": []}
MOVED = {"header": {}, "child_frame_id": "door", "transform": {}}


def kind_told(folder, name: str, text: str) -> Kind:
    (folder / name).write_text(text)
    return kind_of(folder / name, InputFiles(folder))


@pytest.mark.parametrize(
    ("kind", "name", "text"),
    [
        ("scene", "a.yaml", OURS),
        ("scene", "a.yaml", making_moveit.MESSAGE),
        ("scene", "a.json", json.dumps({"name": "", "robot_state": HELD_STATE, "world": {}})),
        ("scene", "a.scene", making_moveit.FIRST),
        ("scene", "a.world", sdf()),
        ("scene", "a.xml", mjcf("")),
        ("trajectory", "a.yaml", making_messages.ROS2),
        ("trajectory", "a.json", json.dumps(display_trajectory(making_messages.MESSAGE))),
        ("trajectory", "a.csv", PATH),
        ("trajectory", "a.csv", "time;qx;qy;qz;qw\n0;0;0;0;1\n"),
        ("trajectory", "a.bag", ""),
        ("poses", "a.yaml", STAMPED),
        ("poses", "a.json", json.dumps({"header": {}, "poses": [pose(0.0, 1)]})),
        ("poses", "a.json", json.dumps({"transforms": [MOVED]}, indent=2)),
        ("poses", "a.csv", DOOR),
        ("poses", "a.txt", "time [ms];z;y;x_mm;qw;qx;qy;qz\n0;0;0;0;1;0;0;0\n"),
    ],
)
def test_a_file_says_what_it_holds(tmp_path, kind, name, text):
    assert kind_told(tmp_path, name, text) == kind


@pytest.mark.parametrize(
    ("name", "text", "fault", "says"),
    [
        ("a.yaml", "", BadShape, "a.yaml: the file is empty; a trajectory, a scene or poses"),
        ("a.yaml", "- 1\n- 2\n", BadInput, "the content of this file is not recognised; --kind says it"),
        ("a.yaml", CASE, BadInput, "this is a case file, not a trajectory, a scene or poses"),
    ],
)  # fmt: skip
def test_what_does_not_is_asked_for_or_refused(tmp_path, name, text, fault, says):
    assert says in refusal(kind_told, tmp_path, name, text, of=fault)
