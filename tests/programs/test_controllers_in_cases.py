"""Programs of controllers in case files: the motion is that of our own form; the robot has to fit the file."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import yaml
from scipy.spatial.transform import Rotation

import clearance as cl
from clearance.formats.plausibility import IN_DEGREES, odd_in_program
from clearance.formats.schema.program import Program
from clearance.formats.schema.program_file import ProgramFile
from clearance.formats.schema.strict_model import validated
from clearance.geometry.quaternions import quaternions_of
from clearance.report.annotations import row_of
from clearance.world.plausibility import notices_of
from tests.programs.arms import FILES
from tests.programs.test_programs_in_cases import START, case, far, tool_at

BEND = {"joint_2": {"offset": "-90deg", "sign": -1}}


def controller_case(folder: Path, name: str, text: str, **asked) -> Path:
    """A case with a program of a controller beside it."""
    (folder / name).write_text(text)
    program = {"file": name, "link": "tool_tip", **asked}
    content = {
        "robot": {"urdf": str(FILES["heron6"]), "base": {"xyz": [1.0, -0.5, 0.2]}},
        "trajectory": {"program": program},
        "scene": {"obstacles": [far()]},
        "limits": {"fail": 0.0},
    }
    (folder / "controller.yaml").write_text(yaml.safe_dump(content))
    return folder / "controller.yaml"


def axes_of(joints: dict[str, float]) -> list[float]:
    """The axes of a controller whose second is `BEND`."""
    found = list(joints.values())
    found[1] = -(found[1] + np.pi / 2)
    return found


def script(off: float = 0.0) -> str:
    """A line across and an arc back; the first target has its axes beside it."""
    at = tool_at(START)
    (x, y, z), turn = at[:3, 3].tolist(), rotation_vector(at)
    pose = lambda *xyz: f"p[{', '.join(map(repr, [*xyz, *turn]))}]"  # noqa: E731
    return f"""set_tcp(p[0, 0, 0, 0, 0, 0])
P1 = {pose(x, y, z)}
movej({axes_of({**START, "joint_1": -0.4})})
movej(get_inverse_kin(P1, qnear={(np.array(axes_of(START)) + off).tolist()}), v=0.8)
movel({pose(x, y + 0.1, z)}, a=0.5, v=0.1)
movec({pose(x + 0.03, y + 0.05, z)}, {pose(x, y, z)}, a=0.5, v=0.1)
"""


def rotation_vector(pose: np.ndarray) -> list[float]:
    return list(map(float, Rotation.from_matrix(pose[:3, :3]).as_rotvec()))


@pytest.mark.slow
def test_a_script_moves_the_robot_as_our_own_form_does(tmp_path):
    found = cl.load_case(controller_case(tmp_path, "a.script", script(), axes=BEND))
    x, y, z = tool_at(START)[:3, 3].tolist()
    place = lambda *xyz: {"frame": "base", "xyz": list(xyz)}  # noqa: E731
    moves = [
        {"ptp": {"joints": START, "joint_speed": 0.8, "joint_acceleration": 1.4}},
        {"lin": {"to": place(x, y + 0.1, z), "acceleration": 0.5, "speed": 0.1}},
        {
            "circ": {
                "via": place(x + 0.03, y + 0.05, z),
                "to": place(x, y, z),
                "acceleration": 0.5,
                "speed": 0.1,
            }
        },
    ]
    own = cl.load_case(case(tmp_path, moves, [far()], start={**START, "joint_1": -0.4}))
    one, two = (each.robots[0].trajectory for each in (found, own))
    assert np.abs(one.times - two.times).max() < 1e-9
    assert np.abs(one.positions - two.positions).max() < 1e-9
    assert [move.name for move in one.moves] == ["PTP 3", "PTP 4 → P1", "LIN 5", "CIRC 6"]
    told = "\n".join(found.notes)
    assert not [one for one in notices_of(found) if one.kind == "program"]
    assert "with axes beside them agree" in told and "taken for the controller's base" in told
    waits = controller_case(tmp_path, "b.script", script() + "grip()\n", axes=BEND, skip=["grip"])
    assert cl.load_case(waits).robots[0].trajectory.left_out == ("grip (line 7)",)


def test_degrees_and_millimetres_beside_a_program_are_suspect(tmp_path):
    base = {"on": "base", "rpy": [0, 0, 360]}
    path = controller_case(tmp_path, "a.script", script(), axes=BEND, base=base)
    odd, axes = [one.text for one in notices_of(cl.load_case(path)) if one.severity == "suspect"]
    assert axes.startswith("CHECK AXES: a.script: line 4: the axes beside P1 have the tool ")
    assert odd == f"CHECK UNITS: a.script: base has an angle of 360 rad in its rpy; {IN_DEGREES}"
    bent = {"joint_2": {"offset": -90, "sign": -1}}
    path = controller_case(tmp_path, "b.script", script(), axes=bent)
    odd = "; axes.joint_2.offset is -90 rad; angles are in radians"
    with pytest.raises(cl.ClearanceError, match=f"joint_2.* limit.*{odd}"):
        cl.load_case(path)
    given = {"file": "a", "tools": {"TCP": {"rpy": [0, 0, 90]}}, "zones": {"CNT": 50.0}}
    assert odd_in_program(validated(ProgramFile, given, "program")) == [
        f"tools.TCP has an angle of 90 rad in its rpy; {IN_DEGREES}",
        "zones.CNT is 50 m; lengths are in metres, is this millimetres?",
    ]


def test_degrees_in_a_program_of_our_own_are_suspect(tmp_path):
    there = {"frame": "base", "xyz": tool_at(START)[:3, 3].tolist()}
    held = {"lin": {"to": there, "hold": {"turn": 5}}}
    turns = {"lin": {"to": there, "hold": {"turn": 12.57, "slide": 0.5}}}
    table = validated(Program, {"tool": {"link": "tip"}, "moves": [held, turns]}, "program")
    assert odd_in_program(table) == [f"moves[0].lin.hold has turn go to 5 rad; {IN_DEGREES}"]
    moves = [
        {"ptp": {"joints": {**START, "joint_1": 0.1}}},
        {"lin": {"to": there | {"rpy": [0, 0, 45]}}},
    ]
    own = cl.load_case(case(tmp_path, moves, [far()]))
    (told,) = [one.text for one in notices_of(own) if one.severity == "suspect"]
    assert "moves[1].lin.to has an angle of 45 rad" in told


def blended(first: float, second: float) -> str:
    """Two lines of 100 mm and one of 50 mm, around corners of such radii [m]."""
    at = tool_at(START)
    x, y, z = at[:3, 3].tolist()
    pose = lambda *xyz: f"p[{', '.join(map(repr, [*xyz, *rotation_vector(at)]))}]"  # noqa: E731
    return f"""set_tcp(p[0, 0, 0, 0, 0, 0])
movej({axes_of(START)})
movel({pose(x, y + 0.1, z)}, r={first})
movel({pose(x, y + 0.1, z - 0.1)}, r={second})
movel({pose(x, y + 0.05, z - 0.1)})
"""


@pytest.mark.parametrize(("first", "second"), [(0.06, 0.045), (0.02, 0.06), (0.11, 0.0)])
def test_a_script_whose_blends_overlap_is_refused(tmp_path, first, second):
    path = controller_case(tmp_path, "a.script", blended(first, second), axes=BEND)
    with pytest.raises(cl.ClearanceError, match=r"line [345]: blends overlap .*skips a move"):
        cl.load_case(path)


@pytest.mark.slow
@pytest.mark.parametrize(("first", "is_cut"), [(0.07, True), (0.05, False)])
def test_a_blend_of_more_than_half_of_a_move_stands_in_the_headline(tmp_path, first, is_cut):
    path = controller_case(tmp_path, "a.script", blended(first, 0.02), axes=BEND)
    told = [one.text for one in notices_of(cl.load_case(path)) if "half of a move" in one.text]
    assert len(told) == is_cut and all("LIN 3: a blend of 70 mm" in one for one in told)


def frame_angles(pose: np.ndarray) -> str:
    """A, B and C of a pose in degrees, as KRL has them."""
    angles = Rotation.from_matrix(pose[:3, :3]).as_euler("ZYX", degrees=True)
    return ", ".join(f"{key} {float(value)!r}" for key, value in zip("ABC", angles, strict=True))


def test_how_it_comes_to_its_first_point_is_not_measured(tmp_path):
    path = controller_case(tmp_path, "a.script", script(), axes=BEND)
    run = cl.check(path)
    assert any("not measured: how robot" in notice.text for notice in run.record.case.notices)


def test_axes_beside_a_pose_may_be_a_seed_that_confirms_nothing(tmp_path):
    found = cl.load_case(controller_case(tmp_path, "a.script", script(0.02), axes=BEND))
    assert np.abs(found.robots[0].trajectory.positions[-1] - list(START.values())).max() < 1e-6
    base, seed = [one.text for one in notices_of(found) if one.kind == "program"]
    assert "taken for the controller's base" in base
    assert "line 4: the axes beside P1 have the tool" in seed and "for a seed" in seed


def test_faults_of_the_motion_have_the_line(tmp_path):
    path = controller_case(
        tmp_path, "a.script", script() + "movel(p[9, 0, 0, 0, 0, 0])\n", axes=BEND
    )
    with pytest.raises(cl.ClearanceError, match=r"a.script: line 7: the tool cannot go on"):
        cl.load_case(path)


def test_keys_for_controllers_are_refused_beside_our_own_form(tmp_path):
    path = case(tmp_path, [{"wait": 1.0}], [far()])
    content = yaml.safe_load(path.read_text())
    content["trajectory"]["program"] = {"file": "program.yaml", "skip": ["WaitDI"]}
    path.write_text(yaml.safe_dump(content))
    with pytest.raises(cl.ClearanceError, match="skip: it is for the language of a controller"):
        cl.load_case(path)


NONE = "[9E9,9E9,9E9,9E9,9E9,9E9]"


def rapid(flags: str, work: str = "wobj0") -> str:
    """A joint move by its axes, one to a pose by flags of its configuration, and a line with another tool."""
    at = tool_at(START)
    axes = np.degrees(list({**START, "joint_1": -0.4}.values())).tolist()
    x, y, z = (1e3 * at[:3, 3]).tolist()
    q = np.roll(quaternions_of(at[None, :3, :3])[0], 1).tolist()
    target = f"[[{x},{y},{z}],{q},{flags},{NONE}]"
    return f"""MODULE Weld
  PERS tooldata tip:=[TRUE,[[0,0,0],[1,0,0,0]],[1,[0,0,1],[1,0,0,0],0,0,0]];
  PERS tooldata pin:=[TRUE,[[50,0,0],[1,0,0,0]],[1,[0,0,1],[1,0,0,0],0,0,0]];
  PERS wobjdata near:=[FALSE,TRUE,"",[[0,0,0],[1,0,0,0]],[[0,0,0],[1,0,0,0]]];
  PROC main()
    MoveAbsJ [{axes},{NONE}],v100,fine,tip;
    MoveJ {target},v100,fine,tip\\WObj:={work};
    MoveL RelTool({target},50,0,0),v100,z5,pin;
    MoveL RelTool({target},50,20,0),v100,fine,pin;
  ENDPROC
ENDMODULE
"""


def test_flags_choose_the_configuration_and_tools_change(tmp_path):
    # -0.5, 0.1, 0.4, 0.1, 1.1, 0.2: quarters -1, 0 and 0 of axes 1, 4 and 6, axis 5 above 0
    found = cl.load_case(controller_case(tmp_path, "a.mod", rapid("[-1,0,0,0]")))
    trajectory = found.robots[0].trajectory
    assert [one.name for one in trajectory.moves] == ["PTP 6", "PTP 7", "LIN 9"]
    arrived = np.searchsorted(trajectory.times, trajectory.moves[1].end)
    assert np.abs(trajectory.positions[arrived] - list(START.values())).max() < 1e-9
    last = tool_at(dict(zip(START, trajectory.positions[-1], strict=True)))
    way = (last - tool_at(START))[:3, 3]
    assert np.allclose(way, 0.02 * tool_at(START)[:3, 1], atol=1e-9)
    assert "joint moves whose speed is the tool's" in "\n".join(found.notes)
    assert trajectory.left_out == ("the speed of joint moves that no file gives for joints",)


@pytest.mark.parametrize("is_said", [False, True])
def test_the_base_and_how_axes_count_stand_in_the_headline_unless_said(tmp_path, is_said):
    asked = {"base": {"on": "base"}, "axes_as": "abb"} if is_said else {}
    found = cl.load_case(controller_case(tmp_path, "a.mod", rapid("[-1,0,0,0]"), **asked))
    told = [one.text for one in notices_of(found) if one.kind == "program"]
    about = () if is_said else ("poses are seen from link 'base_link'", "axis 3 is taken to count")
    assert len(told) == len(about)
    assert all(f"assumed: a.mod: {one}" in text for one, text in zip(about, told, strict=True))


def test_moves_of_handlers_stand_in_the_headline(tmp_path):
    away = "ERROR (50)\nback;\nRETRY;\nENDPROC\nPROC back()\nMoveL p10,v5,fine,tool0;\nUNDO\nRETURN;\nENDPROC"
    text = rapid("[-1,0,0,0]").replace("ENDPROC", away, 1)
    case = controller_case(tmp_path, "a.mod", text, base={"on": "base"}, axes_as="abb")
    (told,) = [one.text for one in notices_of(cl.load_case(case)) if one.kind == "program"]
    line = 1 + text[: text.index("MoveL p10,v5")].count("\n")
    assert told == (
        f"assumed: a.mod: line {line}: the ERROR handler of main does not run: its moves are not measured"
    )


@pytest.mark.slow
@pytest.mark.parametrize(
    ("flags", "why"),
    [
        ("[1,0,0,0]", "asks for joint_1 at -31.51 to -25.78 deg, or whole turns off, and at 89.9 to 180"),
        ("[-1,0,0,4]", "asks for joint_1 at -211.5 to -205.8 deg, or whole turns off, and at -90.1 to 0.1"),
        ("[-1,1,0,0]", "joint_4 5.73 deg"),
        ("[3,0,0,0]", "asks for joint_1 269.9 deg to 360.1 deg, beyond its limits: joint_1 -"),
    ],
)  # fmt: skip
def test_flags_that_no_configuration_has_are_refused_with_what_to_do(tmp_path, flags, why):
    path = controller_case(tmp_path, "a.mod", rapid(flags))
    with pytest.raises(cl.ClearanceError) as caught:
        cl.load_case(path)
    told = str(caught.value)
    assert "a.mod: line 7: the" in told
    assert why in told and r"ConfJ\Off" in told


def test_a_finding_is_annotated_on_the_line_of_its_move_in_its_file(tmp_path):
    """Lines by hand: the joint move that takes time is on 7, the line that does is on 5 of the other module."""
    text = rapid("[-1,0,0,0]")
    lines = "".join(line for line in text.splitlines(keepends=True) if "MoveL" in line)
    sub = f"MODULE Sub\n  PROC away()\n    ! out and on\n{lines}  ENDPROC\nENDMODULE\n"
    (tmp_path / "sub.mod").write_text(sub)
    main = text.replace(lines, "    away;\n")
    case = controller_case(tmp_path, "a.mod", main, beside=["sub.mod"])
    case.write_text(case.read_text().replace("fail: 0.0", "fail: 9.0\n  warn: 9.0"))
    run = cl.check(case, certify=False)
    rows = [
        row_of(run.record, replace(run.findings[0], time=(one.start + one.end) / 2))
        for one in run.record.case.robots[0].trajectory.moves
        if one.end > one.start
    ]
    assert [(Path(row.path).name, row.line) for row in rows] == [("a.mod", 7), ("sub.mod", 5)]
