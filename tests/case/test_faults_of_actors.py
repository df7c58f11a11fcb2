"""What of several robots, and of what moves, rides or is carried, cannot be meant is refused in one line."""

import pytest

from clearance.case.case_file import load_case
from clearance.cli import run
from clearance.errors import (
    BadDimension,
    BadInput,
    BadPose,
    BadShape,
    BadSyntax,
    BadTime,
    DuplicateName,
    MissingFile,
    MissingKey,
    NotFinite,
    UnknownJoint,
    UnknownKey,
    UnknownLink,
    UnknownObstacle,
)
from tests.formats.making import CASE
from tests.formats.making_case import changed, load_small
from tests.formats.making_cell import write_cell

ONE_ROW = "time,x,y,z,qx,qy,qz,qw\n0,4,0,0,0,0,0,1\n"
RIGHT = "base: {xyz: [6, 0, 0]}"

FAULTS = [
    # robots
    (("name: right", "name: left"), DuplicateName, "robots[1]: two robots have the name 'left'"),
    (("name: right", "name: ri/ght"), BadInput, "robots[1].name: 'ri/ght' is given; no '/'"),
    (("name: right", "name: ~"), BadInput, "robots[1].name: nothing is given"),
    (("name: post", "name: right"), BadInput, "both called 'right'; another name for the obstacle"),
    (("name: post", "name: right/tip"), BadInput, "both called 'right/tip'"),
    (("name: post", "name: tip"), BadInput, "both called 'tip'; another name for the obstacle"),
    (("name: right, urdf", "name: right, urfd"), UnknownKey, "robots[1]: unknown key 'urfd'"),
    (
        ("arm.urdf, base", "no.urdf, base"),
        MissingFile,
        "robots[1].urdf: there is no file 'no.urdf'",
    ),
    (
        ("{shoulder: 0.2}", "{sholder: 0.2}"),
        UnknownJoint,
        "robots[1].joints: unknown joint 'sholder'; did you",
    ),
    (
        (RIGHT, "base: {on: left/tipp}"),
        UnknownLink,
        "robots[1].base.on: nothing is called 'left/tipp'; did you mean",
    ),
    ((RIGHT, "base: {on: tip}"), UnknownLink, "robots[1].base.on: nothing is called 'tip'"),
    ((RIGHT, "base: {on: ~}"), BadInput, "robots[1].base.on: nothing is given"),
    ((RIGHT, "base: {on: right/base}"), BadInput, "right on right: a ring"),
    ((RIGHT, "base: {on: door}", "door.csv}", "door.csv, on: right/tip}"), BadInput, "a ring"),
    (
        (RIGHT, "padding: {uper: 0.1}"),
        UnknownLink,
        "robots[1].padding: no link matches 'uper'; did you mean 'upper'",
    ),
    ((RIGHT, "padding: {upper: -0.1}"), BadInput, "robots[1].padding.upper: -0.1 is given"),
    ((RIGHT, "padding: {upper: .nan}"), NotFinite, "robots[1].padding.upper: nan is given"),
    (
        (RIGHT, "srdf: arm.srdf, self_clearance: true"),
        BadInput,
        "robots[1].srdf: arm.srdf: none of its 1 rows speaks",
    ),
    ((RIGHT, "trust_never: true"), BadInput, "robots[1].trust_never: it excuses pairs"),
    (
        (RIGHT, "exclude_links: [bsae]"),
        UnknownLink,
        "robots[1].exclude_links: [0]: unknown link 'bsae'; did you",
    ),
    (
        ("limits:", "trajectory: path.csv\nlimits:"),
        BadInput,
        "trajectory: a trajectory beside 2 robots",
    ),
    (("limits:", "robot: {urdf: arm.urdf}\nlimits:"), BadInput, "both robot and robots are given"),
    (
        (", trajectory: path.csv", ", trajectory: ~"),
        BadInput,
        "robots[0].trajectory: nothing is given",
    ),
    (("path.csv", "no.csv"), MissingFile, "robots[0].trajectory.file: there is no file 'no.csv'"),
    (
        ("path.csv", "{file: path.csv, after: stop}"),
        BadInput,
        "robots[0].trajectory.after: 'stop' is given; 'hold'",
    ),
    (
        ("path.csv", "{file: path.csv, rate: 0}"),
        BadDimension,
        "robots[0].trajectory.rate: 0 is given",
    ),
    (
        ("path.csv", "{file: path.csv, rate: 1.0e-320}"),
        BadTime,
        "robots[0].trajectory: path.csv: times from 0 s to",
    ),
    (
        ("path.csv", "{file: path.csv, start: 1.0e+30}"),
        BadTime,
        "robots[0].trajectory: path.csv: times from 0 s to",
    ),
    (
        ("path.csv", "{file: path.csv, start: .inf}"),
        NotFinite,
        "robots[0].trajectory.start: inf is given",
    ),
    (
        ("path.csv", "{file: row.csv, after: loop}"),
        BadTime,
        "robots[0].trajectory: row.csv: one sample where",
    ),
    # obstacles
    (
        ("moves: door.csv", "moves: no.csv"),
        MissingFile,
        "obstacles[0]: moves.file: there is no file 'no.csv'",
    ),
    (("moves: door.csv", "moves: ~"), BadInput, "scene.obstacles[0].moves: nothing is given"),
    (
        ("moves: door.csv", "moves: door.csv, pose: {xyz: [1, 0, 0]}"),
        BadInput,
        "obstacles[0]: both pose and moves are",
    ),
    (
        ("moves: door.csv", "moves: path.csv"),
        MissingKey,
        "moves.file: path.csv: there is no column 'x'",
    ),
    (
        ("moves: door.csv", "moves: {file: one.csv, after: loop}"),
        BadTime,
        "moves: one.csv: one sample where",
    ),
    (
        ("on: left/base", "on: left/bose"),
        UnknownLink,
        "scene.obstacles[1].on: nothing is called 'left/bose'; did you",
    ),
    (("on: left/base", "on: fixture"), BadInput, "fixture on fixture: a ring"),
    (("on: left/base", "on: post", "[2, 0, 2]}", "[2, 0, 2]}, on: fixture"), BadInput, "a ring"),
    (("on: left/base", "padding: -0.1"), BadInput, "scene.obstacles[1].padding: -0.1 is given"),
    # what is carried
    (
        ("part: workpiece", "part: workpeace"),
        UnknownObstacle,
        "carry[0].part: there is no part 'workpeace'; did you",
    ),
    (
        ("by: left/tip", "by: left/tap"),
        UnknownLink,
        "carry[0].by: nothing is called 'left/tap'; did you mean",
    ),
    (("by: left/tip", "by: workpiece"), BadInput, "carry[0]: part 'workpiece' carries itself"),
    (("from: 0.25, ", ""), MissingKey, "carry[0]: 'from' is missing"),
    (("from: 0.25", "from: 0.75"), BadTime, "carry[0]: from 0.75 s until 0.75 s"),
    (
        ("until: 0.75", "until: 1.75"),
        BadTime,
        "carry[0]: 1.75 s is outside the run; a time from 0 s to 1 s",
    ),
    (("until: 0.75", "until: ~"), BadInput, "carry[0].until: nothing is given"),
    (("from: 0.25", "from: -0.25"), BadTime, "carry[0]: -0.25 s is outside the run"),
    (('["left/*"]', '["lift/*"]'), UnknownLink, "carry[0].touch: [0]: no body matches 'lift/*'"),
    (
        ("limits:", "  - {part: workpiece, by: right/tip, from: 0.5}\nlimits:"),
        BadInput,
        "carry[1]: part 'workpiece' is carried by 'left/tip'",
    ),
    (
        (
            "limits:",
            "  - {part: door, by: right/tip, from: 0.6}\nlimits:",
            "door.csv",
            "{file: door.csv, after: absent, start: -0.5}",
        ),
        BadTime,
        "carry[1]: part 'door' is not in the cell from 0.6 s to",
    ),
    # rules and allowances
    (
        ('["left/*", fixture]', '["left/*", fixtur]'),
        UnknownLink,
        "limits.rules[0].between: no body is called 'fixtur'",
    ),
    (
        ('["left/*", fixture]', '["left/*", "left/*"]'),
        BadInput,
        "limits.rules[0].between: no pair is of",
    ),
    (
        ('["left/*", fixture]', '["left/*"]'),
        BadShape,
        "limits.rules[0].between: ['left/*'] is given; 2 values",
    ),
    (("fail: 0.001, from", "from"), BadInput, "limits.rules[0]: neither fail nor warn is given"),
    (
        ("fail: 0.001", "fail: 0.001, warn: 0.0001"),
        BadDimension,
        "limits.rules[0]: the warn limit 0.1 mm is below the fail limit 1 mm of rule 'at the fixture'",
    ),
    (
        ("warn: 0.03", "warn: 0.003"),
        BadDimension,
        "limits: the warn limit 3 mm is below the fail limit 5 mm of rule 'workpiece - *'",
    ),
    (("fail: 0.001", "fail: -0.001"), BadInput, "limits.rules[0].fail: -0.001 is given"),
    (
        ("at the fixture", "workpiece - *"),
        DuplicateName,
        "limits: rules[1]: two rules have the name",
    ),
    (("at the fixture", "default"), BadInput, "limits.rules[0]: a rule is called 'default'"),
    (
        ("while_carried: workpiece", "while_carried: workpeace"),
        UnknownObstacle,
        "limits.rules[1].while_carried: 'workpeace' is never carried; did you mean 'workpiece'?",
    ),
    (
        ("while_carried: workpiece", "while_carried: post"),
        UnknownObstacle,
        "'post' is never carried",
    ),
    (
        ("from: 0.5, until: 1}", "from: 0.5, until: 2}"),
        BadTime,
        "limits.rules[0]: 2 s is outside the run",
    ),
    (
        ("from: 0.5, until: 1}", "from: 0.5, until: 0.1}"),
        BadTime,
        "limits.rules[0]: from 0.5 s until 0.1 s",
    ),
    (("until: 0.5}", "until: 5}"), BadTime, "allow[1]: 5 s is outside the run"),
    (
        ("until: 0.5}", "untill: 0.5}"),
        UnknownKey,
        "allow[1]: unknown key 'untill'; did you mean 'until'?",
    ),
    (
        ("[left/base, post]", "[left/bas, post]"),
        UnknownLink,
        "allow[0]: unknown body 'left/bas'; did you mean",
    ),
    (
        ("[door, post]", "[door, pst]"),
        UnknownObstacle,
        "allow[1]: unknown body 'pst'; did you mean 'post'?",
    ),
    # clocks
    (
        ("allow:", "clock: comon\nallow:"),
        BadInput,
        "clock: 'comon' is given; did you mean 'common'?",
    ),
    (("allow:", "clock: {slack: -1}\nallow:"), BadInput, "clock.slack: -1 is given"),
    (("allow:", "clock: {slack: .nan}\nallow:"), BadInput, "clock.slack: nan is given"),
    (("allow:", "clock: {slak: 1}\nallow:"), UnknownKey, "clock: unknown key 'slak'"),
    (("allow:", "clock:\nallow:"), BadInput, "clock: nothing is given; common, unsynchronised or"),
    (
        ("allow:", "clock: unsynchronised\nallow:"),
        BadInput,
        "limits.rules[0]: a window of time where clocks are",
    ),
]

SRDF = '<robot name="other"><disable_collisions link1="a" link2="b" reason="Never"/></robot>'
FILES = {"one__csv": ONE_ROW, "row__csv": "time,shoulder\n0,1\n", "arm__srdf": SRDF}


@pytest.mark.parametrize(("changes", "fault", "says"), FAULTS)
def test_each_fault_is_one_line_with_its_place(tmp_path, changes, fault, says):
    with pytest.raises(fault) as caught:
        load_case(write_cell(tmp_path, *changes, **FILES))
    assert says in str(caught.value)
    assert str(caught.value).startswith("case.yaml: ")
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize("changes", [FAULTS[0][0], FAULTS[10][0], FAULTS[30][0], FAULTS[-1][0]])
def test_the_command_line_ends_with_2_and_one_line(tmp_path, capsys, changes):
    assert run(["check", str(write_cell(tmp_path, *changes, **FILES))]) == 2
    told = capsys.readouterr().err.strip().splitlines()
    assert len(told) == 1 and told[0].startswith("error: case.yaml: ")


@pytest.mark.parametrize(
    ("case", "fault", "says"),
    [
        (
            changed("urdf: arm.urdf", "urdf: arm.urdf, trajectory: path.csv"),
            BadInput,
            "case.yaml: trajectory: a trajectory is given here and in robot; one of them",
        ),
        (
            changed("robot: {urdf: arm.urdf}", "robots: []"),
            BadShape,
            "case.yaml: robots: [] is given",
        ),
        (
            changed("robot: {urdf: arm.urdf}", "robots:"),
            BadInput,
            "robots: nothing is given; a list",
        ),
        (
            changed("trajectory: {file: path.csv}", "trajectory: ~"),
            BadInput,
            "trajectory: nothing is",
        ),
        (
            CASE + "carry: [{part: post, by: upper, from: 0.1, touch: [post, upper, bsae]}]\n",
            UnknownLink,
            "carry[0].touch: [2]: unknown body 'bsae'; did you mean 'base'?",
        ),
        (
            changed("- name: post", "- name: base") + "carry: [{part: base, by: tip, from: 0.1}]\n",
            BadInput,
            "an obstacle and a link of robot 'arm' are both called 'base'",
        ),
    ],
)
def test_faults_of_one_robot(tmp_path, case, fault, says):
    with pytest.raises(fault) as caught:
        load_small(tmp_path, case)
    assert says in str(caught.value)


def test_what_a_scene_file_rides_on_is_looked_for(tmp_path):
    scene = "obstacles:\n- {name: post, sphere: {radius: 1}, on: uper}\n"
    case = CASE[: CASE.index("scene:")] + "scene: s.yaml\ntrajectory: path.csv\n"
    with pytest.raises(UnknownLink) as caught:
        load_small(tmp_path, case, s__yaml=scene)
    assert str(caught.value).startswith(
        "case.yaml: scene: s.yaml: obstacles[0].on: nothing is called 'uper'"
    )


HEADER = "time,x,y,z,qx,qy,qz,qw\n"


@pytest.mark.parametrize(
    ("table", "fault", "says"),
    [
        ("", BadSyntax, "the file is empty"),
        (HEADER, BadShape, "there are no rows"),
        ("time,x,y,z,qx,qy,qz\n0,0,0,0,0,0,0\n", MissingKey, "there is no column 'qw'"),
        ("when,x,y,z,qx,qy,qz,qw\n0,0,0,0,0,0,0,1\n", MissingKey, "there is no column 'time'"),
        (
            "time,x,y,z,qx,qy,qz,qw,w\n0,0,0,0,0,0,0,1,2\n",
            UnknownKey,
            "column 'w' is not of a table of poses",
        ),
        ("time,x,x,z,qx,qy,qz,qw\n0,0,0,0,0,0,0,1\n", DuplicateName, "column 'x' is there twice"),
        (
            HEADER + "0,0,0,0,0,0,0,1\n\n1,0,0,0,0,0,0.1,1\n",
            BadPose,
            "line 4: the quaternion [0.0, 0.0, 0.1, 1.0] has",
        ),
        (HEADER + "0,0,0,0,0,0,0,0\n", BadPose, "line 2: the quaternion"),
        (HEADER + "0,0,0,0,1e200,0,0,1\n", BadPose, "line 2: the quaternion"),
        (HEADER + "0,0,0,0,0,0,0,1\n0,0,0,0,0,0,0,1\n", BadTime, "line 3: time 0.0 follows 0.0"),
        (HEADER + "0,0,0,0,0,0,0,1\n-1,0,0,0,0,0,0,1\n", BadTime, "line 3: time -1.0 follows 0.0"),
        (HEADER + "0,0,0,nan,0,0,0,1\n", NotFinite, "line 2: nan in column 'z'"),
        (HEADER + "0,0,0,1e160,0,0,0,1\n", BadPose, "line 2: a position is 1e+160 m away"),
        (HEADER + "0,0,0,0,0,0,0\n", BadShape, "line 2: 7 columns; the header has 8"),
        (HEADER + "0,0,0,a,0,0,0,1\n", BadSyntax, "line 2: 'a' in column 'z' is not a number"),
        ("<robot/>", BadSyntax, "this is a URDF robot, not a table of poses"),
    ],
)
def test_faults_of_a_table_of_poses_name_file_and_row(tmp_path, table, fault, says):
    with pytest.raises(fault) as caught:
        load_case(write_cell(tmp_path, door=table))
    assert str(caught.value).startswith("case.yaml: scene: obstacles[0]: moves.file: door.csv: ")
    assert says in str(caught.value)
