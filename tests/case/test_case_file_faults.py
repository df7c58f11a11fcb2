"""Everything in a case file that cannot be meant is refused in one line, with its place: of one robot, of several,
and of what moves, rides or is carried."""

import pytest

from clearance.case.case_file import load_case
from clearance.errors import (
    BadDimension,
    BadInput,
    BadPose,
    BadShape,
    BadSyntax,
    BadTime,
    DuplicateName,
    EmptyMesh,
    MissingFile,
    MissingKey,
    NotFinite,
    NothingToMeasure,
    UnknownJoint,
    UnknownKey,
    UnknownLink,
    UnknownObstacle,
)
from clearance.formats.schema import case as schema
from clearance.formats.schema import obstacle as obstacle_schema
from clearance.formats.schema.strict_model import validated
from clearance.plain_yaml import plain_data
from tests.formats.making import ARM, CASE
from tests.formats.making_case import TWO_JOINTS, changed, load_small, with_obstacle
from tests.formats.making_cell import write_cell

HALF = "pipe: {inner_radius: 0, outer_radius: 1"


def without_obstacles() -> str:
    head, _, tail = CASE.partition("scene:\n")
    return f"{head}scene: {{}}\n{tail[tail.index('trajectory') :]}"


OF_THE_MODEL = [
    (changed("name: small", "nmae: small"), UnknownKey, "unknown key 'nmae'; did you mean 'name'?"),
    (changed("robot: {urdf: arm.urdf}\n", ""), MissingKey, "'robot' is missing"),
    (changed("trajectory: {file: path.csv}\n", ""), MissingKey, "'trajectory' is missing"),
    (changed("robot: {urdf: arm.urdf}", "robot: arm.urdf"), BadInput, "robot: 'arm.urdf' is given; a mapping"),
    (changed("robot: {urdf: arm.urdf}", "robots: []"), BadShape, "robots: [] is given"),
    (changed("urdf: arm.urdf", "urdf: arm.urdf, trajectory: path.csv"), BadInput, "is given here and in robot"),
    (changed("urdf: arm.urdf", "urdf: arm.urdf, geometry: hull"), BadInput, "robot.geometry: 'hull' is given"),
    (changed("urdf: arm.urdf", "urdf: a, joints: {b: .nan}"), NotFinite, "robot.joints.b: nan"),
    (changed("file: path.csv", "file: 7"), BadInput, "trajectory.file: 7 is given"),
    (changed("fail: 0.005", "fail: -0.005"), BadInput, "limits.fail: -0.005 is given"),
    (changed("fail: 0.005", "fail: .inf"), NotFinite, "limits.fail: inf is given"),
    (changed("fail: 0.005", "fail: true"), BadInput, "limits.fail: True is given"),
    (changed("fail: 0.005", "fail: 5 mm"), BadInput, "limits.fail: '5 mm' is given"),
    (changed("scene:\n", "scene:\n  obstacle: []\n"), UnknownKey, "scene: unknown key 'obstacle'; did you"),
    (changed("scene:\n", "obstacles: []\nscene:\n"), UnknownKey, "`scene: {obstacles: …}` or `tolerance: {"),
    (changed("limits:", "fail: 1\nlimits:"), UnknownKey, "did you mean `limits: {fail: …}`?"),
    (without_obstacles(), MissingKey, "scene: 'obstacles' is missing; `obstacles: []` for an empty scene"),
    (changed("    box:", "    bxo:"), UnknownKey, "did you mean 'box'?"),
    (changed("    box: {size: [0.1, 0.1, 1]}\n", ""), BadInput, "scene.obstacles[0]: it has no shape"),
    (changed("    box:", "    sphere: {radius: 1}\n    box:"), BadInput, "box and sphere are given"),
    (changed("{size: [", "{sizes: ["), UnknownKey, "scene.obstacles[0].box: unknown key 'sizes'"),
    (changed("[0.1, 0.1, 1]", "[0.1, 0, 1]"), BadDimension, "scene.obstacles[0].box.size[1]: 0 is given"),
    (changed("[1.2, 0, 0]", "[2, 0]"), BadShape, "scene.obstacles[0].pose.xyz: [2, 0] is given; 3 values"),
    (changed("xyz: [1.2, 0, 0]", "quat_xyzw: [0, 0, 0, 2]"), BadPose, "scene.obstacles[0].pose.quat_xyzw"),
    (changed("xyz: [1.2, 0, 0]", "quat_xyzw: [0, 0, 0, 1], rpy: [0, 0, 0]"), BadInput, "both quat_xyzw and rpy"),
    (with_obstacle(f"{HALF}, length: 1, sections: 2}}"), BadInput, "sections"),
    (with_obstacle("mesh: {file: a.stl, scale: 0}"), BadDimension, "scene.obstacles[0].mesh.scale: 0 is"),
    (with_obstacle("mesh: {file: a.stl, scale: [1, 2]}"), BadDimension, "mesh.scale: [1, 2]"),
    (CASE + "allow: [[base]]\n", BadShape, "allow[0]: ['base'] is given; 2 values are needed"),
    (CASE + "allow: [base, post]\n", BadInput, "allow[0]: 'base' is given; rows of two patterns: [["),
    (CASE + "contact_response: 1\n", BadInput, "contact_response: 1 is given"),
    (CASE + "clock: comon\n", BadInput, "clock: 'comon' is given; did you mean 'common'?"),
    (CASE + "clock:\n", BadInput, "clock: nothing is given; common, unsynchronised or"),
    (CASE + "clock: {slack: -1}\n", BadInput, "clock.slack: -1 is given"),
    (CASE + "carry: [{part: a, by: b}]\n", MissingKey, "carry[0]: 'from' is missing"),
    (CASE + "carry: [{part: a, by: b, from: 2, until: 1}]\n", BadTime, "carry[0]: from 2 s until 1 s"),
    ("", BadInput, "nothing is given; a mapping is needed, with keys name, robot, robots, scene"),
]  # fmt: skip


@pytest.mark.parametrize(("text", "fault", "says"), OF_THE_MODEL)
def test_the_model_refuses_in_one_line_with_the_place(text, fault, says):
    with pytest.raises(fault) as caught:
        validated(schema.Case, plain_data(text.encode()), "case.yaml")
    told = str(caught.value)
    assert told.startswith("case.yaml: ") and says in told


OF_ITS_FILES = [
    (changed("warn: 0.02", "warn: 0.002"), BadDimension, "the warn limit 2 mm is below the fail limit 5 mm"),
    (with_obstacle(f"{HALF}}}"), BadDimension, "length and path"),
    (with_obstacle(f"{HALF}, length: 1, bend_radius: 2}}"), BadInput, "without path"),
    (with_obstacle("pipe: {inner_radius: 2, outer_radius: 1, length: 1}"), BadDimension, "obstacles[0]"),
    (with_obstacle("mesh: {file: path.csv}"), BadSyntax, "mesh: path.csv: unknown mesh format '.csv'"),
    (with_obstacle("mesh: {file: empty.stl}"), EmptyMesh, "mesh: empty.stl: the mesh has no faces"),
    (changed("path.csv", "no.csv"), MissingFile, "trajectory.file: there is no file 'no.csv'"),
    (changed("arm.urdf", "."), MissingFile, "is a folder"),
    (changed("arm.urdf", "path.csv"), BadSyntax, "robot.urdf: path.csv: this is a table, not a URDF file"),
    (changed("arm.urdf", "arm.urdf, package_dirs: [nowhere]"), MissingFile, "[0]: there is no folder"),
    (changed("arm.urdf", "arm.urdf, exclude_links: [bass]"), UnknownLink, "[0]: unknown link 'bass'; did you"),
    (changed("arm.urdf", "arm.urdf, exclude_links: [base, upper]"), NothingToMeasure, "no link-obstacle pair"),
    (changed("arm.urdf", "arm.urdf, joints: {elbow: 1}"), UnknownJoint, "robot.joints: unknown joint 'elbow'"),
    (changed("arm.urdf", "arm.urdf, joints: {flange: 1}"), UnknownJoint, "joint 'flange' is fixed"),
    (changed("arm.urdf", "arm.urdf, joints: {shoulder: 1}"), DuplicateName, "also a column of the trajectory"),
    (CASE + "allow: [[base, post], [base, pots]]\n", UnknownObstacle, "allow[1]: unknown obstacle 'pots'"),
    (CASE + "allow: [['arm_*', post]]\n", UnknownLink, "no link matches 'arm_*'"),
    (CASE + "allow: [[post, bse]]\n", UnknownLink, "allow[0]: unknown link 'bse'; did you mean 'base'?"),
    (CASE + "name: again\n", DuplicateName, "line 10: key 'name' is there twice"),
    (CASE + "  - [", BadSyntax, "case.yaml: line"),
    ("a: 1\n---\nb: 2\n", BadSyntax, "another document"),
    ("a: !!python/object:os.system x", BadSyntax, "line 1: not YAML"),
    (changed("  - name: post\n", "  - {name: post, sphere: {radius: 1}}\n  - name: post\n"),
     DuplicateName, "obstacles[1]: two obstacles"),
    (changed("- name: post", "- name: base") + "carry: [{part: base, by: tip, from: 0.1}]\n",
     BadInput, "an obstacle and a link of robot 'arm' are both called 'base'"),
    (CASE + "carry: [{part: post, by: upper, from: 0.1, touch: [post, bsae]}]\n",
     UnknownLink, "carry[0].touch: [1]: unknown body 'bsae'; did you mean 'base'?"),
]  # fmt: skip


@pytest.mark.parametrize(("case", "fault", "says"), OF_ITS_FILES)
def test_each_fault_is_one_line_with_its_place(tmp_path, case, fault, says):
    with pytest.raises(fault) as caught:
        load_small(tmp_path, case, empty__stl=bytes(84))
    assert says in str(caught.value)
    assert str(caught.value).startswith("case.yaml: ")


MIMIC = TWO_JOINTS.replace('<limit lower="0" upper="0.1"/>', '<mimic joint="shoulder"/>')


@pytest.mark.parametrize(
    ("trajectory", "urdf", "fault", "says"),
    [
        ("time,sholder\n0,1\n", ARM, UnknownJoint, "unknown joint 'sholder'; did you mean 'shoulder'?"),
        ("time,flange\n0,1\n", ARM, UnknownJoint, "joint 'flange' is fixed; moving joints: shoulder"),
        ("time,lift\n0,1\n", MIMIC, UnknownJoint, "joint 'lift' mimics 'shoulder' and cannot be set"),
        ("time,shoulder\n0\n", ARM, BadShape, "line 2: 1 columns; the header has 2"),
    ],
)  # fmt: skip
def test_faults_of_the_trajectory_name_case_field_and_file(tmp_path, trajectory, urdf, fault, says):
    with pytest.raises(fault) as caught:
        load_small(tmp_path, trajectory=trajectory, urdf=urdf)
    assert str(caught.value).startswith("case.yaml: trajectory.file: path.csv: ")
    assert says in str(caught.value)


def test_a_scale_beyond_doubles_is_refused():
    for scale in (10**400, [1.0, 1.0, -(10**400)]):
        with pytest.raises(BadDimension, match="a finite number, or three"):
            obstacle_schema.Mesh._number_or_three(scale)


RIGHT = "base: {xyz: [6, 0, 0]}"
AGAIN = "  - {part: workpiece, by: right/tip, from: 0.5}\nlimits:"
LATER = "  - {part: door, by: right/tip, from: 0.6}\nlimits:"
GONE = "{file: door.csv, after: absent, start: -0.5}"

OF_ACTORS = [
    # robots
    (("name: right", "name: left"), DuplicateName, "robots[1]: two robots have the name 'left'"),
    (("name: right", "name: ri/ght"), BadInput, "robots[1].name: 'ri/ght' is given; no '/'"),
    (("name: post", "name: right"), BadInput, "both called 'right'; another name for the obstacle"),
    (("name: post", "name: tip"), BadInput, "both called 'tip'; another name for the obstacle"),
    (("{shoulder: 0.2}", "{sholder: 0.2}"), UnknownJoint, "robots[1].joints: unknown joint 'sholder'; did you"),
    ((RIGHT, "base: {on: left/tipp}"), UnknownLink, "robots[1].base.on: nothing is called 'left/tipp'; did you"),
    ((RIGHT, "base: {on: right/base}"), BadInput, "right on right: a ring"),
    ((RIGHT, "base: {on: door}", "door.csv}", "door.csv, on: right/tip}"), BadInput, "a ring"),
    ((RIGHT, "padding: {uper: 0.1}"), UnknownLink, "robots[1].padding: no link matches 'uper'; did"),
    ((RIGHT, "srdf: arm.srdf, self_clearance: true"), BadInput, "srdf: arm.srdf: none of its 1 rows speaks"),
    ((RIGHT, "trust_never: true"), BadInput, "robots[1].trust_never: it excuses pairs"),
    (("limits:", "trajectory: path.csv\nlimits:"), BadInput, "trajectory: a trajectory beside 2 robots"),
    (("limits:", "robot: {urdf: arm.urdf}\nlimits:"), BadInput, "both robot and robots are given"),
    (("path.csv", "{file: path.csv, start: 1.0e+30}"), BadTime, "trajectory: path.csv: times from 0 s to"),
    (("path.csv", "{file: row.csv, after: loop}"), BadTime, "trajectory: row.csv: one sample where"),
    # obstacles
    (("moves: door.csv", "moves: no.csv"), MissingFile, "obstacles[0]: moves.file: there is no file 'no.csv'"),
    (("door.csv", "door.csv, pose: {xyz: [1, 0, 0]}"), BadInput, "obstacles[0]: both pose and moves are"),
    (("moves: door.csv", "moves: path.csv"), MissingKey, "moves.file: path.csv: there is no column 'x'"),
    (("on: left/base", "on: left/bose"), UnknownLink, "scene.obstacles[1].on: nothing is called 'left/bose'; did"),
    (("on: left/base", "on: post", "[2, 0, 2]}", "[2, 0, 2]}, on: fixture"), BadInput, "a ring"),
    # what is carried
    (("part: workpiece", "part: workpeace"), UnknownObstacle, "carry[0].part: there is no part 'workpeace'; did"),
    (("by: left/tip", "by: left/tap"), UnknownLink, "carry[0].by: nothing is called 'left/tap'; did you mean"),
    (("by: left/tip", "by: workpiece"), BadInput, "carry[0]: part 'workpiece' carries itself"),
    (("until: 0.75", "until: 1.75"), BadTime, "carry[0]: 1.75 s is outside the run; a time from 0 s to 1 s"),
    (('["left/*"]', '["lift/*"]'), UnknownLink, "carry[0].touch: [0]: no body matches 'lift/*'"),
    (("limits:", AGAIN), BadInput, "carry[1]: part 'workpiece' is carried by 'left/tip'"),
    (("limits:", LATER, "door.csv", GONE), BadTime, "carry[1]: part 'door' is not in the cell from 0.6 s to"),
    # rules and allowances
    (('["left/*", fixture]', '["left/*", fixtur]'), UnknownLink, "rules[0].between: no body is called 'fixtur'"),
    (('["left/*", fixture]', '["left/*", "left/*"]'), BadInput, "limits.rules[0].between: no pair matches"),
    (("fail: 0.001, from", "from"), BadInput, "limits.rules[0]: neither fail nor warn is given"),
    (("fail: 0.001", "fail: 0.001, warn: 0.0001"), BadDimension, "rules[0]: the warn limit 0.1 mm is below"),
    (("warn: 0.03", "warn: 0.003"), BadDimension, "the warn limit 3 mm is below the fail limit 5 mm"),
    (("at the fixture", "workpiece - *"), DuplicateName, "limits: rules[1]: two rules have the name"),
    (("at the fixture", "default"), BadInput, "limits.rules[0]: a rule is called 'default'"),
    (("while_carried: workpiece", "while_carried: post"), UnknownObstacle, "'post' is never carried"),
    (("from: 0.5, until: 1}", "from: 0.5, until: 2}"), BadTime, "limits.rules[0]: 2 s is outside the run"),
    (("until: 0.5}", "until: 5}"), BadTime, "allow[1]: 5 s is outside the run"),
    (("[left/base, post]", "[left/bas, post]"), UnknownLink, "allow[0]: unknown body 'left/bas'; did you mean"),
    (("[door, post]", "[door, pst]"), UnknownObstacle, "allow[1]: unknown body 'pst'; did you mean 'post'?"),
    (("allow:", "clock: unsynchronised\nallow:"), BadInput, "limits.rules[0]: a window of time where clocks are"),
]  # fmt: skip

SRDF = '<robot name="other"><disable_collisions link1="a" link2="b" reason="Never"/></robot>'
FILES = {"row__csv": "time,shoulder\n0,1\n", "arm__srdf": SRDF}


@pytest.mark.parametrize(("changes", "fault", "says"), OF_ACTORS)
def test_each_fault_of_several_robots_and_what_moves_is_one_line(tmp_path, changes, fault, says):
    with pytest.raises(fault) as caught:
        load_case(write_cell(tmp_path, *changes, **FILES))
    assert says in str(caught.value)
    assert str(caught.value).startswith("case.yaml: ")


def test_what_a_scene_file_rides_on_is_looked_for(tmp_path):
    scene = "obstacles:\n- {name: post, sphere: {radius: 1}, on: uper}\n"
    case = CASE[: CASE.index("scene:")] + "scene: s.yaml\ntrajectory: path.csv\n"
    with pytest.raises(UnknownLink) as caught:
        load_small(tmp_path, case, s__yaml=scene)
    assert str(caught.value).startswith(
        "case.yaml: scene: s.yaml: obstacles[0].on: nothing is called 'uper'"
    )
