"""`self_clearance` of a case file: an arm that folds onto its own base."""

from __future__ import annotations

import json

import pytest

from clearance.cli import run

URDF = """<robot name="folder">
  <link name="base"><collision><geometry><box size="0.2 0.2 0.2"/></geometry></collision></link>
  <link name="arm"><collision><origin xyz="0.25 0 0"/>
    <geometry><box size="0.3 0.1 0.1"/></geometry></collision></link>
  <link name="hand"><collision><origin xyz="0.35 0 0"/>
    <geometry><box size="0.2 0.1 0.1"/></geometry></collision></link>
  <joint name="shoulder" type="revolute"><parent link="base"/><child link="arm"/>
    <axis xyz="0 0 1"/><limit lower="-3" upper="3" effort="9" velocity="9"/></joint>
  <joint name="elbow" type="revolute"><parent link="arm"/><child link="hand"/>
    <origin xyz="0.5 0 0"/><axis xyz="0 0 1"/>
    <limit lower="-3.15" upper="3.15" effort="9" velocity="9"/></joint></robot>"""
CASE = """name: fold
robot: {urdf: folder.urdf, self_clearance: true%s}
scene: {obstacles: [{name: far, box: {size: [1, 1, 1]}, pose: {xyz: [5, 0, 0]}}]}
%s
trajectory: {file: path.csv}
limits: {fail: 0.01}
"""
PATH = "time,shoulder,elbow\n0,0,0\n1,1,1.5\n2,2,3.14159265358979\n"
SRDF = """<robot name="folder">
  <disable_collisions link1="base" link2="arm" reason="Adjacent"/>
  <disable_collisions link1="arm" link2="hand" reason="Adjacent"/>
  <disable_collisions link1="base" link2="hand" reason="Never"/></robot>"""


@pytest.fixture
def folder(tmp_path):
    (tmp_path / "folder.urdf").write_text(URDF)
    (tmp_path / "folder.srdf").write_text(SRDF)
    (tmp_path / "path.csv").write_text(PATH)
    return tmp_path


def check(folder, capsys, robot="", allow=""):
    (folder / "case.yaml").write_text(CASE % (robot, allow))
    code = run(["check", str(folder / "case.yaml"), "--json", "--cross-check"])
    captured = capsys.readouterr()
    return code, captured.out, captured.err


def test_a_hand_that_folds_onto_the_base_is_found(folder, capsys):
    code, out, _ = check(folder, capsys)
    told = json.loads(out)
    assert code == 1 and told["verdict"] in ("contact", "violated")
    assert (told["worst"]["link"], told["worst"]["obstacle"]) == ("hand", "base")
    assert told["not_checked"] == []
    excused = {(row["link"], row["obstacle"]): row["reason"] for row in told["unmeasured"]}
    assert excused == {("arm", "base"): "excused: Adjacent", ("hand", "arm"): "excused: Adjacent"}
    assert told["cross_check"]["agrees"]


def test_what_was_never_seen_is_measured_unless_it_is_trusted(folder, capsys):
    code, out, _ = check(folder, capsys, ", srdf: folder.srdf")
    assert code == 1 and json.loads(out)["worst"]["obstacle"] == "base"
    code, out, _ = check(folder, capsys, ", srdf: folder.srdf, trust_never: true")
    told = json.loads(out)
    assert code == 0 and told["worst"]["obstacle"] == "far"
    assert "excused: Never" in {row["reason"] for row in told["unmeasured"]}
    (told,) = [line for line in told["warnings"] if "CL434" in line]
    assert "(base - hand)" in told and "taken to keep their limits too" in told
    code, out, _ = check(
        folder, capsys, ", srdf: folder.srdf, trust_never: true, geometry: collision_or_visual"
    )
    assert code == 2 and "with geometry: collision_or_visual" in json.loads(out)["reasons"][0]


@pytest.mark.parametrize(
    ("asked", "told"),
    [
        ("srdf: folder.srdf, self_clearance: false", "robot.srdf: it excuses pairs of links"),
        ("self_clearance: true, trust_never: true", "robot.trust_never: it applies to the pairs that"),
        ("self_clearance: perhaps", "robot.self_clearance"),
    ],
)  # fmt: skip
def test_what_cannot_be_meant_is_refused_in_one_line(folder, refusal, asked, told):
    text = (CASE % ("", "")).replace("self_clearance: true", asked)
    (folder / "case.yaml").write_text(text)
    assert told in refusal("check", folder / "case.yaml")
