"""`clearance new` of a robot some of whose links touch at every step: the case has rows of `allow` to uncover."""

import json
from pathlib import Path

import pytest

from clearance.cli import run
from tests.cli.test_self_clearance import URDF

SPOKE = (
    '<collision><origin xyz="-0.45 0 0"/><geometry><box size="0.3 0.3 0.1"/></geometry></collision>'
)
"""A part of the hand that reaches back into the base."""
TOUCHING = URDF.replace('<link name="hand">', f'<link name="hand">{SPOKE}')
FOOT = """obstacles:
- {name: table, box: {size: [1, 1, 0.2]}, pose: {xyz: [0, 0, -0.2]}}
"""
SRDF = (
    '<robot name="folder"><disable_collisions link1="arm" link2="hand" reason="Adjacent"/></robot>'
)


@pytest.fixture(autouse=True)
def folder(tmp_path, monkeypatch):
    (tmp_path / "folder.urdf").write_text(TOUCHING)
    (tmp_path / "plain.urdf").write_text(URDF)
    (tmp_path / "folder.srdf").write_text(SRDF)
    (tmp_path / "scene.yaml").write_text(FOOT)
    (tmp_path / "path.csv").write_text("time,shoulder,elbow\n0,0,0\n1,1,0.1\n2,2,0.2\n")
    monkeypatch.chdir(tmp_path)


def new(*words, robot="folder.urdf"):
    assert run(["new", "out", "--robot", robot, "--trajectory", "path.csv", *words]) == 0
    return Path("out/case.yaml").read_text()


def uncovered(text):
    """The case with the lines of the proposal as the comment above them says."""
    lines = text.splitlines()
    begin = next(i for i, line in enumerate(lines) if "touch at every step" in line)
    end = next(i for i in range(begin, len(lines)) if lines[i].startswith("limits:"))
    lines[begin + 1 : end] = [line.removeprefix("# ") for line in lines[begin + 1 : end]]
    return "\n".join([*lines, ""])


def checked(text, capsys):
    Path("out/case.yaml").write_text(text)
    capsys.readouterr()
    code = run(["check", "out/case.yaml", "--json"])
    return code, json.loads(capsys.readouterr().out)


@pytest.mark.slow
def test_links_that_touch_at_every_step_are_a_comment_and_a_contact_until_it_is_uncovered(capsys):
    text = new()
    says = (
        "these pairs touch at every step: hand - base; where that is meant, case.yaml has the rows"
    )
    assert says in capsys.readouterr().out
    code, told = checked(text, capsys)
    assert (code, told["verdict"]) == (1, "contact")
    far = "obstacles: [{name: far, sphere: {radius: 0.1}, pose: {xyz: [5, 0, 0]}}]"
    code, told = checked(uncovered(text).replace("obstacles: []", far), capsys)
    assert (code, told["verdict"]) == (0, "clear")
    (answer,) = told["self_clearance"]
    assert answer["left_out"] == {"neighbours": 2, "allowed": 1}


def test_where_nothing_touches_or_links_are_not_asked_about_nothing_is_proposed():
    assert "touch at every step" not in new(robot="plain.urdf")
    Path("scene.yaml").write_text(FOOT.replace("-0.2]", "-0.3]"))
    assert "touch at every step" not in new("--scene", "scene.yaml", "--force")
