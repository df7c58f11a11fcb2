"""What a file to convert holds: told by its suffix and its first lines, and asked for where they do not tell."""

import json

import pytest

from clearance.errors import BadInput, BadShape
from clearance.formats.conversion import kind_of
from clearance.formats.files.input_files import InputFiles
from clearance.formats.known_formats import Kind
from tests.formats import making_messages, making_moveit
from tests.formats.making import CASE, PATH
from tests.formats.making_cell import DOOR
from tests.formats.making_messages import display_trajectory
from tests.formats.making_mjcf import mjcf
from tests.formats.making_sdf import sdf
from tests.formats.motion.test_pose_formats import STAMPED, pose
from tests.formats.refusal import refusal

OURS = "# what stands there, pose: none\nobstacles:\n- {name: a, sphere: {radius: 1}, pose: {xyz: [0, 0, 1]}}\n"
STATE = {"joint_state": {"name": ["a"], "position": [0.0]}, "attached_collision_objects": []}
MOVED = {"header": {}, "child_frame_id": "door", "transform": {}}


def told(folder, name: str, text: str) -> Kind:
    (folder / name).write_text(text)
    return kind_of(folder / name, InputFiles(folder))


@pytest.mark.parametrize(
    ("kind", "name", "text"),
    [
        ("scene", "a.yaml", OURS),
        ("scene", "a.json", '{"obstacles": []}'),
        ("scene", "a.yaml", making_moveit.MESSAGE),
        ("scene", "a.json", json.dumps({"name": "", "robot_state": STATE, "world": {}})),
        ("scene", "a.scene", making_moveit.FIRST),
        ("scene", "a.world", sdf()),
        ("scene", "a.xml", mjcf("")),
        ("trajectory", "a.yaml", making_messages.ROS2),
        ("trajectory", "a.json", json.dumps(display_trajectory(making_messages.MESSAGE))),
        ("trajectory", "a.json", json.dumps({"goal": {"trajectory": making_messages.MESSAGE}})),
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
    assert told(tmp_path, name, text) == kind


@pytest.mark.parametrize(
    ("name", "text", "fault", "says"),
    [
        ("a.yaml", "", BadShape, "a.yaml: the file is empty; a trajectory, a scene or poses"),
        ("a.yaml", "- 1\n- 2\n", BadInput, "the content of this file is not recognised; --kind says it"),
        ("a.yaml", CASE, BadInput, "this is a case file, not a trajectory, a scene or poses"),
    ],
)  # fmt: skip
def test_what_does_not_is_asked_for_or_refused(tmp_path, name, text, fault, says):
    assert says in refusal(told, tmp_path, name, text, of=fault)
