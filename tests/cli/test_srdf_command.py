"""`clearance srdf` from outside: what it tells, proposes, refuses, and its exit codes."""

import json
from pathlib import Path

import pytest

from clearance.cli import run
from clearance.formats.robot.request import load_robot
from clearance.formats.robot.srdf import load_srdf
from tests.report.schemas import objections


def _box(name, x, size):
    shape = f'<origin xyz="{x} 0 0"/><geometry><box size="{size}"/></geometry>'
    return f'<link name="{name}"><collision>{shape}</collision></link>'


def _turn(name, parent, child, limit):
    ends = f'<parent link="{parent}"/><child link="{child}"/><axis xyz="0 0 1"/>'
    limits = f'<limit lower="-{limit}" upper="{limit}" effort="1" velocity="1"/>'
    return f'<joint name="{name}" type="revolute">{ends}{limits}</joint>'


URDF = f"""<robot name="arm">
  {_box("base", 1, "0.2 0.2 1")}{_box("lower", 0.2, "0.4 0.1 0.1")}<link name="flange"/>
  {_box("upper", "{upper}", "0.3 0.1 0.1")}
  {_turn("shoulder", "base", "lower", 3)}{_turn("elbow", "flange", "upper", 2)}
  <joint name="bolts" type="fixed"><parent link="lower"/><child link="flange"/>
    <origin xyz="0.4 0 0"/></joint>
</robot>"""

SRDF = """<robot name="arm">
  <disable_collisions link1="base" link2="lower" reason="Adjacent"/>
  <disable_collisions link1="lower" link2="upper" reason="Adjacent"/>
  <disable_collisions link1="base" link2="upper" reason="Never"/>
</robot>"""


@pytest.fixture
def robot(tmp_path):
    def write(upper=0.15, srdf=SRDF):
        (tmp_path / "arm.urdf").write_text(URDF.format(upper=upper))
        (tmp_path / "arm.srdf").write_text(srdf)
        return str(tmp_path / "arm.urdf"), str(tmp_path / "arm.srdf")

    return write


@pytest.mark.slow
def test_pairs_that_never_meet_are_proven(robot, capsys):
    assert run(["srdf", "audit", *robot()]) == 0
    told = capsys.readouterr().out.splitlines()
    assert told[0] == "of 1 pair excused as Never: 1 proven separate"
    assert told[1].startswith("  base - upper   Never     proven separate: at least ")
    assert any(line.startswith("  lower - upper  Adjacent  can meet") for line in told)


@pytest.mark.slow
def test_a_pair_that_can_meet_fails_an_audit_and_is_told_first(robot, capsys):
    assert run(["srdf", "audit", *robot(upper=0.4)]) == 1
    told = capsys.readouterr().out.splitlines()
    assert told[0] == "of 1 pair excused as Never: 1 can meet"
    assert told[1].startswith("  base - upper   Never     can meet at shoulder ")
    assert run(["srdf", "audit", *robot(upper=0.4), "--json"]) == 1
    found = json.loads(capsys.readouterr().out)
    assert objections("audit", found) == [] and found["never_refuted"] == 1
    (worst,) = [pair for pair in found["pairs"] if pair["reason"] == "Never"]
    assert worst["status"] == "meets" and worst["least"] == 0.0


@pytest.mark.slow
def test_a_proposal_excuses_what_is_proven_and_reads_back(robot, tmp_path, capsys):
    urdf, _ = robot()
    out = tmp_path / "made.srdf"
    assert run(["srdf", "make", urdf, "--out", str(out)]) == 0
    told = capsys.readouterr()
    assert told.err.strip() == (
        "3 pairs: 1 proven never to meet, 2 adjacent; to be measured: 0 can meet, 0 undecided"
    )
    matrix = load_srdf(out, load_robot(urdf))
    assert matrix.reason("base", "upper") == "Never"
    assert matrix.reason("upper", "lower") == "Adjacent"
    assert run(["srdf", "audit", urdf, str(out)]) == 0


@pytest.mark.slow
def test_neighbours_that_lie_apart_at_home_and_can_meet_fail_an_audit_and_are_not_excused(
    robot, capsys
):
    """The hand reaches back over the elbow, 50 mm away from it at home."""
    urdf, srdf = robot(upper=0.25)
    Path(urdf).write_text(Path(urdf).read_text().replace('"-2" upper="2"', '"-3" upper="3"'))
    assert run(["srdf", "audit", urdf, srdf]) == 1
    told = capsys.readouterr().out.splitlines()
    assert told[0].endswith("; 1 excused as Adjacent lies apart at home and can meet")
    assert any(line.startswith("  lower - upper  Adjacent  can meet at elbow") for line in told)
    assert run(["srdf", "audit", urdf, srdf, "--json"]) == 1
    found = json.loads(capsys.readouterr().out)
    assert objections("audit", found) == [] and found["adjacent_refuted"] == 1
    assert run(["srdf", "make", urdf]) == 0
    Path(srdf).write_text(capsys.readouterr().out)
    assert "<!-- measured: lower - upper: can meet at elbow " in Path(srdf).read_text()
    assert load_srdf(srdf, load_robot(urdf)).reason("lower", "upper") is None


def test_bad_input_is_one_line_and_2(robot, refusal):
    urdf, srdf = robot(srdf=SRDF.replace("base", "torso").replace("lower", "arm"))
    line = refusal("srdf", "audit", urdf, srdf)
    assert line.startswith("error: arm.srdf: none of its 3 rows speaks of links of robot 'arm'")
    assert "this is a URDF file" in refusal("srdf", "audit", urdf, urdf)
    assert "would overwrite" in refusal("srdf", "make", urdf, "--out", urdf)


FOLLOWING = """<robot name="gripper">
  <link name="palm"/>{left}{right}
  <joint name="finger" type="{kind}"><parent link="palm"/><child link="left"/><axis xyz="0 1 0"/>
    <limit lower="0" upper="0.045" effort="1" velocity="1"/></joint>
  <joint name="follower" type="prismatic"><parent link="palm"/><child link="right"/><axis xyz="0 1 0"/>
    <limit lower="0" upper="0.02" effort="1" velocity="1"/><mimic joint="finger" multiplier="{factor}"/></joint>
</robot>"""


@pytest.mark.parametrize(
    ("kind", "factor", "told"),
    [
        ("prismatic", -1, "'finger' from 0.00 mm to 0.00 mm of 0.00 mm to 45.00 mm"),
        ("continuous", 1, "'finger' from 0.00° to 1.15° of any position"),
    ],
)
def test_a_leader_that_its_followers_hold_is_told(kind, factor, told, tmp_path, capsys):
    """`Never` was proven for one position of a finger that has 45 mm, without a word."""
    parts = {
        "left": _box("left", 0, "0.01 0.01 0.01"),
        "right": _box("right", 0.1, "0.01 0.01 0.01"),
    }
    urdf, out = tmp_path / "gripper.urdf", tmp_path / "made.srdf"
    urdf.write_text(FOLLOWING.format(kind=kind, factor=factor, **parts))
    assert run(["srdf", "make", str(urdf), "--out", str(out)]) == 0
    told = f"{told}, by the limits of 'follower'; other programs may move it farther"
    assert f"  <!-- checked: {told} -->" in out.read_text().splitlines()
    assert f"note: checked: {told}" in capsys.readouterr().err.splitlines()
    run(["srdf", "audit", str(urdf), str(out)])
    assert f"note: checked: {told}" in capsys.readouterr().out.splitlines()
    run(["srdf", "audit", str(urdf), str(out), "--json"])
    found = json.loads(capsys.readouterr().out)
    assert objections("audit", found) == [] and found["narrowed"] == [told]


def test_a_proposal_leaves_what_can_meet_to_be_measured(robot, tmp_path, capsys):
    urdf, _ = robot(upper=0.4)
    assert run(["srdf", "make", urdf]) == 0
    told = capsys.readouterr().out
    assert "<!-- measured: base - upper: can meet at shoulder " in told
    (tmp_path / "made.srdf").write_text(told)
    assert load_srdf(tmp_path / "made.srdf", load_robot(urdf)).reason("base", "upper") is None
