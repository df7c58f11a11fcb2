"""Programs in case files: the tool's true line is measured, and what cannot be done is refused in one line."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
import yaml
from scipy.spatial.transform import Rotation

import clearance as cl
from clearance.findings.doubts import doubts_of
from clearance.findings.finding_text import finding_line
from clearance.geometry.quaternions import quaternions_of
from clearance.pytest_plugin import assert_clear
from clearance.record.wording import certified_text
from clearance.report.summary import summary_of
from clearance.report.topics.certainty import certified_of
from clearance.report.topics.pairs import PairJudge
from clearance.simulate.measure.sections import section_plan
from clearance.simulate.replay.replay import replay_of
from clearance.world.motion import kinematic_motion
from clearance.world.timeline import timeline_of
from tests.made_cases import at
from tests.programs.arms import FILES, arm
from tests.receipt.receipts import saved

JOINTS = ("joint_1", "joint_2", "joint_3", "joint_4", "joint_5", "joint_6")
START = dict(zip(JOINTS, (-0.5, 0.1, 0.4, 0.1, 1.1, 0.2), strict=True))
BASE = (1.0, -0.5, 0.2)
TURNTABLE = FILES["heron6"].parents[1] / "turntable" / "turntable.urdf"
PLATE = 0.5
"""[m] The height of its plate's frame."""


def tool_at(joints: dict[str, float]) -> np.ndarray:
    """(4, 4) `base_from_tool` with the tool tip at these joints."""
    one = arm("heron6")
    at = np.array([[joints[joint.name] for joint in one.joints]])
    return one.poses(at)[0] @ np.linalg.inv(one.link_from_tool)


def place(at: np.ndarray) -> dict:
    return {"frame": "base", "xyz": [float(value) for value in at]}


def case(folder: Path, moves: list, obstacles: list = (), start: dict = START, **more) -> Path:
    """A case file with a program beside it."""
    program = {"tool": {"link": "tool_tip"}, "start": start, "moves": moves, **more}
    (folder / "program.yaml").write_text(yaml.safe_dump(program))
    content = {
        "robot": {"urdf": str(FILES["heron6"]), "base": {"xyz": list(BASE)}},
        "trajectory": {"program": "program.yaml"},
        "scene": {"obstacles": list(obstacles)},
        "limits": {"fail": 0.0},
    }
    return written(folder, content)


def written(folder: Path, content: dict) -> Path:
    """A case file of a content."""
    (folder / "case.yaml").write_text(yaml.safe_dump(content))
    return folder / "case.yaml"


def far() -> dict:
    return {"name": "far", "box": {"size": [0.1, 0.1, 0.1]}, "pose": {"xyz": [5.0, 5.0, 5.0]}}


def ball(at: np.ndarray, radius: float = 0.01) -> dict:
    """A ball at a place seen from the robot's root."""
    return {
        "name": "ball",
        "sphere": {"radius": radius},
        "pose": {"xyz": (at + np.array(BASE)).tolist()},
    }


def line_and_arc_of_joints() -> tuple[dict, np.ndarray, np.ndarray]:
    """A line across, where the tip is half-way on it, and where it is half-way between the joints of its ends."""
    start = tool_at(START)[:3, 3]
    end = start * np.array([1.0, -1.0, 1.0])
    move = {"lin": {"to": place(end)}}
    return move, 0.5 * (start + end), end


def as_yaml(pose: np.ndarray) -> dict:
    """A pose (4, 4) as files have it."""
    quat = Rotation.from_matrix(pose[:3, :3]).as_quat()
    return {"xyz": pose[:3, 3].tolist(), "quat_xyzw": quat.tolist()}


def cube(name: str, on: str, pose: np.ndarray) -> dict:
    """A box of 2 cm on a link or an obstacle."""
    return {"name": name, "box": {"size": [0.02] * 3}, "on": on, "pose": as_yaml(pose)}


def at_base() -> np.ndarray:
    """(4, 4) where the robot stands."""
    return at(*BASE)


@pytest.mark.slow
def test_the_verdict_names_the_move(tmp_path):
    move, middle, _ = line_and_arc_of_joints()
    move["lin"]["to"]["name"] = "P1"
    back = {"lin": {"to": place(tool_at(START)[:3, 3])}}
    path = case(tmp_path, [move, {"wait": 0.5}, back], [ball(middle)])
    run = cl.check(path)
    summary = summary_of(run.report)
    assert run.worst["move"] == summary["worst"]["move"] == "LIN 1 → P1"
    middle_of_wait = summary["moves"][1]["from"] + 0.25
    passed = [one["time"] > middle_of_wait for one in summary["events"]]
    named = [one["move"] for one in summary["events"]]
    assert named == [("LIN 1 → P1", "LIN 3")[late] for late in passed] and len({*named}) == 2
    assert [one["moves"] for one in summary["intervals"]["contact"]] == ["LIN 1 → P1", "LIN 3"]
    assert [(one["name"], one["until"]) for one in summary["moves"]][-1] == (
        "LIN 3",
        summary["end"],
    )
    assert {(one.move, one.moves) for one in run.findings if one.broken} >= {
        ("LIN 1 → P1", "LIN 1 → P1"),
        ("LIN 3", "LIN 3"),
    }
    texts = [*run.verdict.reasons, *map(finding_line, run.findings)]
    assert all(" s in LIN 1 → P1, " in one or " s in LIN 3, " in one for one in texts)
    steps = run.steps.to_pydict()
    waits = [t for t, name in zip(steps["time"], steps["move"], strict=True) if name == "WAIT 2"]
    assert waits == [summary["moves"][1]["until"]]
    replay = replay_of(run.session)
    assert [replay.moves[code] for code in replay.move[replay.between == 0]] == steps["move"]


FAULTS = {
    "out of reach": ("{lin: {to: {frame: base, xyz: [4, 0, 0.5]}}}", "the tool cannot go on"),
    "an arc in a line": ("{circ: {via: {frame: base, xyz: MIDDLE}, to: {frame: base, xyz: END}}}", "on one line"),
    "an arc through a point": ("{circ: {via: {frame: base, xyz: END}, to: {frame: base, xyz: END}}}", "coincide"),
    "a circle of 1 km": ("{circ: {via: {frame: base, xyz: [1000, 0, 1]}, to: {frame: base, xyz: [0, 1000, 1]}}}",
                         "the arc's radius is 707.1 m; 100 m or less, or lin"),
    "a zone at the end": ("{lin: {to: {frame: base, xyz: END}, zone: 0.01}}", "without a move after it"),
    "a zone before a wait": ("{ptp: {joints: START, zone: 0.01}}, {wait: 1}", "without a move after it"),
    "an unknown frame": ("{lin: {to: {frame: tabel, xyz: END}}}", "unknown frame 'tabel'"),
    "a way to the moon": ("{lin: {to: {frame: base, xyz: [4.0e+8, 0, 0]}}}", "a way of 4e+08 m"),
    "a speed beyond all": ("{lin: {to: {frame: base, xyz: END}, acceleration: 1.0e+20}}", "or equal to 1000000"),
    "no speed": ("{lin: {to: {frame: base, xyz: END}, speed: 0}}", "speed"),
    "an unknown joint": ("{ptp: {joints: {joint_7: 0, joint_1: 0}}}", "unknown joint 'joint_7'"),
    "a joint left out": ("{ptp: {joints: {joint_1: 0}}}", "no target of joint_2"),
    "beyond a limit": ("{ptp: {joints: FAR}}", "beyond its limit"),
    "a corner beyond one": ("{ptp: {joints: NEAR_LIMIT, zone: 0.05}}, {ptp: {joints: START}}", "beyond its limit"),
    "two moves in one": ("{wait: 1, ptp: {joints: START}}", "ptp and wait are given"),
    "time and speed": ("{ptp: {joints: START, time: 2, speed: 0.5}}", "time and speed are given"),
    "time and its speed": ("{ptp: {joints: START, joint_speed: 2, time: 0.5}}", "time and joint_speed are given"),
    "one key of two": ("{ptp: {joints: START, joint_acceleration: 2}}", "joint_acceleration is given alone"),
}  # fmt: skip


@pytest.mark.slow
@pytest.mark.parametrize("fault", FAULTS)
def test_what_cannot_be_done_is_refused_in_one_line(tmp_path, fault):
    _, middle, end = line_and_arc_of_joints()
    moves, told = FAULTS[fault]
    places = {
        "MIDDLE": middle.tolist(),
        "END": end.tolist(),
        "START": START,
        "FAR": START | {"joint_1": 9.0},
        "NEAR_LIMIT": START | {"joint_1": 2.99},
    }
    for name, given in places.items():
        moves = moves.replace(f" {name}", f" {json.dumps(given)}")
    with pytest.raises(cl.ClearanceError) as caught:
        cl.load_case(case(tmp_path, yaml.safe_load(f"[{moves}]"), [far()]))
    said = str(caught.value)
    assert told in said and "program.yaml" in said and "\n" not in said


def test_an_unknown_tool_or_start_is_refused(tmp_path):
    move, _, _ = line_and_arc_of_joints()
    with pytest.raises(cl.ClearanceError, match="no link 'tool'"):
        cl.load_case(case(tmp_path, [move], [far()], tool={"link": "tool"}))
    with pytest.raises(cl.ClearanceError, match="no position of joint_1"):
        cl.load_case(case(tmp_path, [move], [far()], start={}))


def with_zone(folder: Path, radius: float) -> Path:
    """A case whose tool passes a zone near a ball of a radius [m]."""
    start = tool_at(START)[:3, 3]
    corner, end = start + [0.0, 0.15, 0.0], start + [0.0, 0.02, -0.05]
    moves = [{"lin": {"to": place(corner), "zone": 0.01}}, {"lin": {"to": place(end)}}]
    return case(folder, moves, [ball(start + [0.0, 0.35, 0.0], radius)])


@pytest.mark.slow
def test_what_a_zone_takes_is_violated_and_no_contact(tmp_path):
    run = cl.check(with_zone(tmp_path, 0.01))
    (phase,) = [one for one in run.record.timeline.phases if one.case.robots[0].padding]
    padding = phase.case.robots[0].padding[run.record.worst.link]
    run = cl.check(with_zone(tmp_path, 0.01 + run.record.worst.clearance + 0.5 * padding))
    assert -padding < run.record.worst.clearance < 0.0 and not run.record.worst.touches
    told = certified_text(certified_of(run.record, run.record.certificate))
    assert "corner zones of its program" in told
    with pytest.warns(UserWarning, match="corner zones of robot 'heron6' pad its links"):
        cl.Checker(cl.load_case(tmp_path / "case.yaml"))
    judge = PairJudge.of(run.record)
    assert {judge.status_of(one) for one in run.pair_minima} == {"violated", "clear"}


def test_zones_of_two_robots_count_whatever_their_clocks(tmp_path):
    with_zone(tmp_path, 0.01)
    robots = [
        {
            "name": name,
            "urdf": str(FILES["heron6"]),
            "base": {"xyz": xyz},
            "trajectory": {"program": "program.yaml", "start": start},
        }
        for name, xyz, start in (("left", [0, 0, 0], 0.0), ("right", [0, 3, 0], 5.0))
    ]
    content = {
        "robots": robots,
        "limits": {"fail": 0.0},
        "scene": {"obstacles": []},
        "clock": "unsynchronised",
    }
    (tmp_path / "two.yaml").write_text(yaml.safe_dump(content))
    two = cl.load_case(tmp_path / "two.yaml")
    timeline = timeline_of(two, [kinematic_motion(placed) for placed in two.robots])
    plan, seen = section_plan(timeline), set()
    for section in plan.sections:
        if section.other is None:
            continue
        cases = section.phase.case, section.other.case
        for pair in section.pairs:
            own = [body.padding_in(one) for body, one in zip((pair.a, pair.b), cases, strict=True)]
            assert section.padding == pytest.approx(sum(own) + timeline.path_error, abs=1e-15)
            seen.add(tuple(padding > 0.0 for padding in own))
    assert seen == {(False, False), (False, True), (True, False), (True, True)}


def test_what_is_of_files_of_samples_is_refused_beside_a_program(tmp_path):
    path = case(tmp_path, [{"wait": 1.0}], [far()])
    content = yaml.safe_load(path.read_text())
    content["trajectory"]["period"] = 0.1
    path.write_text(yaml.safe_dump(content))
    with pytest.raises(cl.ClearanceError, match="period belongs to a file, not to a program"):
        cl.load_case(path)


def test_a_fault_of_a_program_within_a_case_names_its_field(tmp_path):
    path = case(tmp_path, [{"wait": 1.0}], [far()])
    content = yaml.safe_load(path.read_text())
    content["trajectory"]["program"] = {"tool": {"link": "tool_tip"}, "moves": [{"wait": -1.0}]}
    path.write_text(yaml.safe_dump(content))
    with pytest.raises(cl.ClearanceError, match=r"trajectory.program: moves\[0\]\.wait"):
        cl.load_case(path)
    content["trajectory"]["program"] |= {"moves": [{"wait": 1.0}], "start": START}
    path.write_text(yaml.safe_dump(content))
    assert cl.load_case(path).robots[0].trajectory.times[-1] == 1.0


def near_singular(folder: Path) -> Path:
    """A line on which the wrist of the arm passes a hundredth of a radian from where it is straight."""
    start = dict(zip(JOINTS, (-0.3, 0.1, 0.6, 0.0, -0.01, 0.2), strict=True))
    first, turned = tool_at(start), tool_at({**start, "joint_5": 0.31})
    to = place(first[:3, 3] + [0.0, 0.1, 0.05])
    to["quat_xyzw"] = quaternions_of(turned[None, :3, :3])[0].tolist()
    return case(folder, [{"lin": {"to": to}}], [far()], start=start)


@pytest.mark.slow
def test_a_stretch_near_a_singularity_is_measured_and_not_proven(tmp_path):
    run = cl.check(near_singular(tmp_path))
    trajectory = run.record.case.robots[0].trajectory
    (span,) = trajectory.unproven
    assert span.move == "LIN 1" and 0.0 < span.start < span.end < 0.2
    assert run.verdict.exit_code == 1 and run.verdict.status == "not proven"
    assert "not proven on part of the motion, clear as measured" in run.verdict.headline()
    told = f"LIN 1, {span.start:.3f}-{span.end:.3f} s: a singularity is too near"
    assert told in run.verdict.reasons[0] and "unproven motion" in {
        doubt.kind for doubt in doubts_of(run.record, run.judgement) if doubt.fails
    }
    certified = certified_text(certified_of(run.record, run.record.certificate))
    assert "at every moment that is proven" in certified
    samples = cl.check(near_singular(tmp_path), certify=False)
    assert samples.passed and any(told in warning for warning in samples.verdict.warnings)


@pytest.mark.slow
def test_a_stretch_that_is_not_proven_is_taken_for_a_proof_nowhere(tmp_path):
    unproven = cl.load_case(near_singular(tmp_path))
    with pytest.raises(AssertionError, match="measured at the samples and not proven: LIN 1"):
        assert_clear(cl.check(unproven), between=("wrist_roll", "far"), at_least=0.01)
    with pytest.raises(cl.BadInput, match="part of the program of robot 'heron6' is not proven"):
        cl.gain(unproven, "obstacle", obstacle="far")
    saved(unproven, tmp_path / "report")
    found = cl.verify(tmp_path / "report", unproven)
    (span,) = unproven.robots[0].trajectory.unproven
    times = unproven.robots[0].trajectory.times
    n = np.count_nonzero((times >= span.start) & (times < span.end))
    assert found.proven
    assert f"PROVEN EXCEPT in {n} intervals, in which a program is not proven: " in found.headline


def beside_a_turntable(folder: Path, moves: list, rows: str = "", **more) -> Path:
    """A case of a program beside a turntable that stands at 0.5 rad, or follows rows of a table."""
    content = yaml.safe_load(case(folder, moves, [far()], **more).read_text())
    table = {"name": "turntable", "urdf": str(TURNTABLE), "base": {"xyz": [2.0, 0.0, 0.0]}}
    if rows:
        (folder / "turn.csv").write_text(f"time,turn\n{rows}")
        table["trajectory"] = "turn.csv"
    else:
        table["joints"] = {"turn": 0.5}
    arm_of = {"name": "arm", **content.pop("robot"), "trajectory": content.pop("trajectory")}
    part = {"name": "part", "box": {"size": [0.1, 0.1, 0.1]}, "on": "turntable/plate"}
    content["robots"] = [arm_of, table]
    content["scene"]["obstacles"].append(part | {"pose": {"xyz": [0.1, 0.0, 0.3]}})
    return written(folder, content)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("rows", "base"), [("", {"on": "far", "xyz": [-3.0, -5.0, -5.0]}), ("0,0.5\n9,0.5\n", {})]
)
def test_a_frame_on_a_link_that_stands_is_where_the_link_is(tmp_path, rows, base):
    start = tool_at(START)[:3, 3] + np.array(BASE)
    turn = np.array([[np.cos(0.5), -np.sin(0.5)], [np.sin(0.5), np.cos(0.5)]])
    to = (start + [0.0, 0.1, 0.0]) - [2.0, 0.0, PLATE]
    local = [*(turn.T @ to[:2] - [0.1, 0.0]).tolist(), float(to[2] - 0.3)]
    move = {"lin": {"to": {"frame": "jig", "xyz": local}}}
    frames = {"jig": {"on": "part"}}
    path = beside_a_turntable(tmp_path, [move], rows, frames=frames)
    content = yaml.safe_load(path.read_text())
    content["robots"][1]["base"] |= base
    path.write_text(yaml.safe_dump(content))
    found = cl.load_case(path).robots[0].trajectory
    world = {"lin": {"to": {"xyz": (start + [0.0, 0.1, 0.0]).tolist()}}}
    same = cl.load_case(case(tmp_path, [world], [far()])).robots[0].trajectory
    assert np.abs(found.positions - same.positions).max() < 1e-9 and found.frames == ("part",)


@pytest.mark.parametrize(
    ("on", "told"),
    [
        ("arm/forearm", "3 joints are free .* a frame on what the arm does not move"),
        ("turntable/late", "'turntable/late' is not there; did you mean 'turntable/plate'"),
    ],
)
def test_a_frame_on_a_link_that_moves_is_refused(tmp_path, on, told):
    move = {"lin": {"to": {"frame": "jig", "xyz": [0.0, 0.0, 0.0]}}}
    path = beside_a_turntable(tmp_path, [move], "0,0.5\n9,0.6\n", frames={"jig": {"on": on}})
    content = yaml.safe_load(path.read_text())
    content["carry"] = [{"part": "far", "by": "turntable/plate", "from": 1.0, "until": 2.0}]
    path.write_text(yaml.safe_dump(content))
    with pytest.raises(cl.ClearanceError, match=told):
        cl.load_case(path)
