"""A turntable that is a robot of its own, moved by the program of the arm that works on it."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import yaml

import clearance as cl
from clearance.case.case_file import load_cell, with_trajectory_file
from clearance.formats.schema.timed import TrajectoryFile
from clearance.geometry.quaternions import quaternions_of
from tests.made_cases import at
from tests.programs.arms import turned
from tests.programs.test_controllers_in_cases import frame_angles
from tests.programs.test_programs_in_cases import (
    BASE,
    PLATE,
    START,
    TURNTABLE,
    beside_a_turntable,
    case,
    cube,
    far,
    tool_at,
    written,
)

AXIS = np.array([2.0, 0.0, PLATE])
"""[m] Where the turntable's plate turns about z; it begins at 0.5 rad."""

TIP = tool_at(START)[:3, 3] + np.array(BASE)
"""[m] Where the tool begins."""


TIME = 2.0 * 0.05**0.5
"""[s] In which the table turns by 0.4 rad: it would reach its greatest speed of 2 rad/s in 0.25 s."""


def on_plate(way=(0.0, 0.0, 0.0)) -> list[float]:
    """A place beside where the tool begins, seen from the plate."""
    x, y, z = TIP + way - AXIS
    cosine, sine = np.cos(0.5), np.sin(0.5)
    return [float(cosine * x + sine * y), float(cosine * y - sine * x), float(z)]


def driving(folder: Path, moves: list, on: str = "turntable/plate", **more) -> dict:
    """What a case file has whose program drives the turntable; it is written to the folder too."""
    path = beside_a_turntable(folder, moves, frames={"jig": {"on": on}}, **more)
    return yaml.safe_load(path.read_text())


def lin(way=(0.0, 0.0, 0.0), **more) -> dict:
    return {"lin": {"to": {"frame": "jig", "xyz": on_plate(way)}, **more}}


def ball(name: str, place: np.ndarray, radius: float) -> dict:
    return {"name": name, "sphere": {"radius": radius}, "pose": {"xyz": place.tolist()}}


@pytest.mark.slow
def test_a_tool_that_stays_on_a_turning_plate_keeps_its_clearance_to_it(tmp_path):
    """It goes round the axis of the table by 0.4 rad, and past a ball that is beside the middle of its way."""
    content = driving(tmp_path, [lin(hold={"turntable/turn": 0.9})])
    tip = tool_at(START)
    turn = turned((0.0, 0.0, -0.5)) @ tip[:3, :3]
    seen = at(*(on_plate() + turn @ [0.0, 0.1, 0.0]), turned=turn)
    out = TIP[:2] - AXIS[:2]
    beside = AXIS[:2] + 1.3 * turned((0.0, 0.0, 0.2))[:2, :2] @ out
    content["scene"]["obstacles"] = [
        cube("torch", "arm/tool_tip", np.eye(4)),
        cube("rides", "turntable/plate", seen),
        ball("stands", np.array([*beside, TIP[2]]), 0.03),
    ]
    content["allow"] = [["arm/*", "*"], ["turntable/*", "*"]]
    run = cl.check(written(tmp_path, content))
    assert np.abs(np.array(run.steps.to_pydict()["clearance"]) - 0.08).max() < 2e-5
    assert run.record.certificate.lower_bound.min() > 0.08 - 1.2e-4
    (passed,) = (one for one in run.pair_minima if (one.link, one.obstacle) == ("torch", "stands"))
    corner = 0.3 * np.linalg.norm(out) - 0.03
    assert corner - 0.01 * 3**0.5 - 2e-4 < passed.clearance < corner - 0.01 + 2e-5
    turn = run.record.case.robots[1].trajectory
    assert turn.positions[-1, 0] == pytest.approx(0.9) and turn.times[-1] == pytest.approx(TIME)
    assert abs(passed.time - 0.5 * TIME) < 0.05


def test_the_table_goes_where_moves_say_and_stands_as_the_world_does(tmp_path):
    """Its joint begins where the case has it; on a table that stands a line is that in the world."""
    to = {"frame": "jig", "xyz": on_plate((0.0, 0.1, 0.0))}
    content = driving(tmp_path, [{"lin": {"to": to, "hold": {"turntable/turn": 0.5}}}])
    loaded = cl.load_case(written(tmp_path, content))
    arm, table = loaded.robots
    with pytest.raises(
        cl.BadInput, match="'arm' moves turntable too; kind obstacle with far, which"
    ):
        cl.gain(loaded, "timing", robot="turntable")
    riding = replace(loaded, obstacles=tuple(one for one in loaded.obstacles if one.mount))
    with pytest.raises(cl.BadInput, match="another program: all obstacles ride on something"):
        cl.gain(riding, "base", robot="arm")
    world = {"lin": {"to": {"xyz": (TIP + [0.0, 0.1, 0.0]).tolist()}}}
    same = cl.load_case(case(tmp_path, [world], [far()])).robots[0].trajectory
    assert np.abs(arm.trajectory.positions - same.positions).max() < 1e-9
    assert (table.trajectory.positions == 0.5).all() and not table.fixed_positions
    assert np.array_equal(arm.trajectory.times, table.trajectory.times)
    assert arm.trajectory.drives == ("turntable",) and table.timing == arm.timing


@pytest.mark.slow
@pytest.mark.parametrize(
    ("hold", "on"), [({"turntable/turn": 0.6}, "base"), ({}, "turntable/plate"), ({}, "part")]
)
def test_a_robot_that_a_program_counts_on_is_given_no_other_motion(tmp_path, hold, on):
    """It moves the table, has a frame on it, or on a part there: the arm would go where the table is no more."""
    content = driving(tmp_path, [{"lin": {"to": {"xyz": TIP.tolist()}, "hold": hold}}], on)
    content["robots"][0]["trajectory"]["program"] = program = yaml.safe_load(
        (tmp_path / "program.yaml").read_text()
    )
    program["moves"] += [{"lin": {"to": {"frame": "jig", "xyz": near(on)}}}]
    path = written(tmp_path, content)
    with pytest.raises(cl.BadInput, match="program of robot 'arm' was followed with robot 'turn"):
        cl.load_case(path).with_trajectory(
            [0.0, 1.0], [[0.5], [0.7]], joint_names=["turn"], robot="turntable"
        )
    (tmp_path / "turn.csv").write_text("time,turn\n0,0.5\n1,0.7\n")
    asked = TrajectoryFile(file="turn.csv")
    with pytest.raises(cl.BadInput, match="program of robot 'arm' was followed with robot 'turn"):
        with_trajectory_file(load_cell(path), asked, "other", "turntable")


def near(on: str) -> list[float]:
    """Where the tool begins, seen from what a frame is on."""
    if on == "base":
        return (TIP - BASE).tolist()
    return (np.array(on_plate()) - ([0.1, 0.0, 0.3] if on == "part" else [0.0] * 3)).tolist()


def rapid(turn: np.ndarray, via: list[float], to: list[float]) -> str:
    """A line and an arc on a work object that a mechanical unit moves, 0.1 m out and 20 mm above its frame."""
    q = np.roll(quaternions_of(turn[None])[0], 1).tolist()
    axes = np.degrees(list(START.values())).tolist()
    at = lambda xyz, angle: (  # noqa: E731
        f"[{[1e3 * xyz[0] - 100.0, 1e3 * xyz[1], 1e3 * xyz[2] - 20.0]},{q},[0,0,0,0],"
        f"[{np.degrees(angle)},9E9,9E9,9E9,9E9,9E9]]"
    )
    return f"""MODULE Weld
  PERS tooldata tip:=[TRUE,[[0,0,0],[1,0,0,0]],[1,[0,0,1],[1,0,0,0],0,0,0]];
  PERS wobjdata jig:=[FALSE,FALSE,"stn_1",[[7,8,9],[1,0,0,0]],[[100,0,20],[1,0,0,0]]];
  PROC main()
    MoveAbsJ [{axes},[{np.degrees(0.5)},9E9,9E9,9E9,9E9,9E9]],v100,fine,tip;
    MoveL {at(via, 0.6)},v100,fine,tip\\WObj:=jig;
    MoveC {at(on_plate((0.03, 0.06, 0.0)), 0.6)},{at(to, 0.7)},v100,fine,tip\\WObj:=jig;
  ENDPROC
ENDMODULE
"""


def assert_move_alike(robots, others):
    """Asserts that robots of two cases move in the same way, but for the rounding of numbers in a program."""
    for one, same in zip(robots, others, strict=True):
        assert np.abs(one.trajectory.times - same.trajectory.times).max() < 1e-9
        assert np.abs(one.trajectory.positions - same.trajectory.positions).max() < 1e-8


@pytest.mark.slow
def test_a_work_object_that_a_mechanical_unit_moves_is_a_frame_on_it(tmp_path):
    turn = turned((0.0, 0.0, -0.5)) @ tool_at(START)[:3, :3]
    via, to = on_plate((0.0, 0.05, 0.0)), on_plate((0.06, 0.05, 0.0))
    quat = quaternions_of(turn[None])[0].tolist()
    place = lambda xyz: {"frame": "jig", "xyz": xyz, "quat_xyzw": quat}  # noqa: E731
    more = {"speed": 0.1, "turn_speed": float(np.radians(500.0))}
    bulge = {"frame": "jig", "xyz": on_plate((0.03, 0.06, 0.0))}
    moves = [
        {"lin": {"to": place(via), "hold": {"turntable/turn": 0.6}, **more}},
        {"circ": {"via": bulge, "to": place(to), "hold": {"turntable/turn": 0.7}, **more}},
    ]
    content = driving(tmp_path, moves)
    ours = cl.load_case(written(tmp_path, content)).robots
    (tmp_path / "weld.mod").write_text(rapid(turn, via, to))
    program = {"file": "weld.mod", "link": "tool_tip", "base": {"on": "base"}, "axes_as": "plain"}
    content["robots"][0]["trajectory"] = {"program": program}
    with pytest.raises(cl.ClearanceError, match="line 6: mechanical unit 'stn_1' moves the work"):
        cl.load_case(written(tmp_path, content))
    program["units"] = {"STN_1": {"on": "turntable/plate"}}
    with pytest.raises(cl.ClearanceError, match="line 6: external axis E1 moves, and no joint"):
        cl.load_case(written(tmp_path, content))
    program["axes"] = {"turntable/turn": {"axis": "E1"}}
    assert_move_alike(cl.load_case(written(tmp_path, content)).robots, ours)


@pytest.mark.slow
def test_a_base_of_krl_on_another_machine_is_a_frame_on_what_carries_it(tmp_path):
    """Base 1 is 0.1 m out and 20 mm above the plate's frame; the machine turns by 0.1 rad along the line."""
    turn, to = turned((0.0, 0.0, -0.5)) @ tool_at(START)[:3, :3], on_plate((0.0, 0.05, 0.0))
    quat, pose = quaternions_of(turn[None])[0].tolist(), at(turned=turn)
    place = {"frame": "jig", "xyz": to, "quat_xyzw": quat}
    move = {"lin": {"to": place, "hold": {"turntable/turn": 0.6}, "speed": 0.1}}
    content = driving(tmp_path, [move])
    ours = cl.load_case(written(tmp_path, content)).robots
    axes = [f"A{i} {float(np.degrees(value))!r}" for i, value in enumerate(START.values(), 1)]
    x, y, z = (1e3 * np.array(to) - [100.0, 0.0, 20.0]).tolist()
    body = f"""BAS(#INITMOV,0)
$TOOL=$NULLFRAME
PTP {{{", ".join(axes)}, E1 {float(np.degrees(0.5))!r}}}
BAS(#BASE,1)
$VEL.CP=0.1
LIN {{X {x!r}, Y {y!r}, Z {z!r}, {frame_angles(pose)}, E1 {float(np.degrees(0.6))!r}}}
"""
    (tmp_path / "weld.src").write_text(f"DEF weld()\n{body}END\n")
    data = "BASE_DATA[1]={X 100,Y 0,Z 20,A 0,B 0,C 0}\nMACHINE_FRAME_DAT[1]={MACH_DEF_INDEX 2}\n"
    (tmp_path / "weld.dat").write_text(
        f"DEFDAT weld\n{data}MACHINE_DEF[2]={{MECH_TYPE #EASYS}}\nENDDAT\n"
    )
    program = {"file": "weld.src", "link": "tool_tip", "axes_as": "plain"}
    program["axes"] = {"turntable/turn": {"axis": "E1"}}
    content["robots"][0]["trajectory"] = {"program": program}
    with pytest.raises(cl.ClearanceError, match="base 1 is on machine 2, which may move it"):
        cl.load_case(written(tmp_path, content))
    program["units"] = {"MACHINE_DEF[2]": {"on": "turntable/plate"}}
    assert_move_alike(cl.load_case(written(tmp_path, content)).robots, ours)


REFUSED = {
    "a trajectory of its own": "'turntable' follows a trajectory of its own",
    "the table on the arm": "'turntable' stands on 'arm/gripper', which may move",
    "the arm on the table": "'arm' stands on 'turntable/plate', which may move",
    "a joint it has not": "unknown joint 'turntable/tilt'",
    "two programs": "the program of another robot moves 'part'",
    "two programs that turn it": "joints of robot 'turntable', and the program of another robot moves them too",
}


def test_a_table_that_a_move_leaves_free_has_the_error_of_the_path(tmp_path):
    move = lin((0.0, -0.05, 0.05), free=["turntable/turn"])
    arm, table = cl.load_case(written(tmp_path, driving(tmp_path, [move]))).robots
    assert abs(table.trajectory.positions[-1, 0] - 0.5) > 1e-3
    assert table.trajectory.path_error == arm.trajectory.path_error > 0.0


@pytest.mark.slow
@pytest.mark.parametrize("fault", REFUSED)
def test_what_a_program_may_not_move_is_refused(tmp_path, fault):
    joint = "turntable/tilt" if fault == "a joint it has not" else "turntable/turn"
    content = driving(tmp_path, [lin(hold={joint: 0.6})])
    arm, table = content["robots"]
    if fault == "a trajectory of its own":
        (tmp_path / "turn.csv").write_text("time,turn\n0,0.5\n9,0.6\n")
        table |= {"trajectory": "turn.csv", "joints": {}}
    elif fault == "the table on the arm":
        table["base"] = {"on": "arm/gripper"}
    elif fault == "the arm on the table":
        arm["base"] = {"on": "turntable/plate"}
    elif fault.startswith("two programs"):
        more = yaml.safe_load((tmp_path / "program.yaml").read_text())
        more["frames"] = {"jig": {"on": "part", "xyz": [-0.1, 0.0, -0.3]}}
        if fault == "two programs":
            del more["moves"][0]["lin"]["hold"]
        (tmp_path / "other.yaml").write_text(yaml.safe_dump(more))
        content["robots"] = [
            arm | {"name": "other", "trajectory": {"program": "other.yaml"}},
            arm,
            table,
        ]
    with pytest.raises(cl.ClearanceError, match=REFUSED[fault]):
        cl.load_case(written(tmp_path, content))


def test_names_with_a_slash_are_of_the_robot_that_has_them(tmp_path):
    """The table's own file has a slash in its joint's name."""
    (tmp_path / "table.urdf").write_text(TURNTABLE.read_text().replace('"turn"', '"axis/turn"'))
    content = driving(tmp_path, [lin(hold={"turntable/axis/turn": 0.6})])
    content["robots"][1] |= {"urdf": "table.urdf", "joints": {"axis/turn": 0.5}}
    arm, table = cl.load_case(written(tmp_path, content)).robots
    assert table.trajectory.joint_names == ("axis/turn",) and len(arm.trajectory.joint_names) == 6
    assert table.trajectory.positions[-1, 0] == pytest.approx(0.6)
