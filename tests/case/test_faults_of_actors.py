"""What of several robots, and of what moves, rides or is carried, cannot be meant is refused in one line."""

import pytest

from clearance.case.case_file import load_case
from clearance.errors import (
    BadDimension,
    BadInput,
    BadTime,
    DuplicateName,
    MissingFile,
    MissingKey,
    UnknownJoint,
    UnknownLink,
    UnknownObstacle,
)
from tests.formats.making import CASE
from tests.formats.making_case import load_small
from tests.formats.making_cell import write_cell

RIGHT = "base: {xyz: [6, 0, 0]}"
AGAIN = "  - {part: workpiece, by: right/tip, from: 0.5}\nlimits:"
LATER = "  - {part: door, by: right/tip, from: 0.6}\nlimits:"
GONE = "{file: door.csv, after: absent, start: -0.5}"

FAULTS = [
    # robots
    (("name: right", "name: left"), DuplicateName, "robots[1]: two robots have the name 'left'"),
    (("name: right", "name: ri/ght"), BadInput, "robots[1].name: 'ri/ght' is given; no '/'"),
    (("name: post", "name: right"), BadInput, "both called 'right'; another name for the obstacle"),
    (("name: post", "name: right/tip"), BadInput, "both called 'right/tip'"),
    (("name: post", "name: tip"), BadInput, "both called 'tip'; another name for the obstacle"),
    (("{shoulder: 0.2}", "{sholder: 0.2}"), UnknownJoint, "robots[1].joints: unknown joint 'sholder'; did you"),
    ((RIGHT, "base: {on: left/tipp}"), UnknownLink, "robots[1].base.on: nothing is called 'left/tipp'; did you"),
    ((RIGHT, "base: {on: tip}"), UnknownLink, "robots[1].base.on: nothing is called 'tip'"),
    ((RIGHT, "base: {on: right/base}"), BadInput, "right on right: a ring"),
    ((RIGHT, "base: {on: door}", "door.csv}", "door.csv, on: right/tip}"), BadInput, "a ring"),
    ((RIGHT, "padding: {uper: 0.1}"), UnknownLink, "robots[1].padding: no link matches 'uper'; did"),
    ((RIGHT, "srdf: arm.srdf, self_clearance: true"), BadInput, "srdf: arm.srdf: none of its 1 rows speaks"),
    ((RIGHT, "trust_never: true"), BadInput, "robots[1].trust_never: it excuses pairs"),
    (("limits:", "trajectory: path.csv\nlimits:"), BadInput, "trajectory: a trajectory beside 2 robots"),
    (("limits:", "robot: {urdf: arm.urdf}\nlimits:"), BadInput, "both robot and robots are given"),
    (("path.csv", "no.csv"), MissingFile, "robots[0].trajectory.file: there is no file 'no.csv'"),
    (("path.csv", "{file: path.csv, start: 1.0e+30}"), BadTime, "trajectory: path.csv: times from 0 s to"),
    (("path.csv", "{file: row.csv, after: loop}"), BadTime, "trajectory: row.csv: one sample where"),
    # obstacles
    (("moves: door.csv", "moves: no.csv"), MissingFile, "obstacles[0]: moves.file: there is no file 'no.csv'"),
    (("door.csv", "door.csv, pose: {xyz: [1, 0, 0]}"), BadInput, "obstacles[0]: both pose and moves are"),
    (("moves: door.csv", "moves: path.csv"), MissingKey, "moves.file: path.csv: there is no column 'x'"),
    (("on: left/base", "on: left/bose"), UnknownLink, "scene.obstacles[1].on: nothing is called 'left/bose'; did"),
    (("on: left/base", "on: fixture"), BadInput, "fixture on fixture: a ring"),
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


@pytest.mark.parametrize(("changes", "fault", "says"), FAULTS)
def test_each_fault_is_one_line_with_its_place(tmp_path, changes, fault, says):
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
