"""`clearance demo`: what comes with the package is checked, listed and copied, with nothing else at hand."""

from __future__ import annotations

import os
from pathlib import Path

import pytest

import clearance as cl
from clearance.cli import run
from clearance.cli.demo import FOLDER, SCENES
from tests.cart import ROOT, files


@pytest.fixture(autouse=True)
def folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    return tmp_path


def demo(capsys, *arguments: str) -> tuple[int, str, str]:
    """Exit code, output and errors."""
    capsys.readouterr()
    code = run(["demo", *arguments])
    return (code, *capsys.readouterr())


def without_reports(monkeypatch):
    monkeypatch.setattr("clearance.extras.is_installed", lambda library: library != "meshcat")


def test_the_arm_is_that_of_the_repository():
    assert files(FOLDER / "heron6") == files(ROOT / "robots" / "heron6")


@pytest.mark.slow
def test_the_second_scene_is_violated_between_its_rows_only(capsys, monkeypatch):
    without_reports(monkeypatch)
    code, out, _ = demo(capsys, "post")
    assert code == 1 and "between the steps 1 and 2" in out.splitlines()[0]
    assert cl.check(FOLDER / "post.yaml", certify=False).verdict.exit_code == 0


@pytest.mark.slow
def test_without_the_extra_it_is_checked_and_one_line_says_what_a_report_needs(
    folder, capsys, monkeypatch
):
    without_reports(monkeypatch)
    code, out, err = demo(capsys)
    assert (code, err) == (0, "") and out.startswith("CLEAR  seam: ")
    (line,) = [line for line in out.splitlines() if "meshcat" in line]
    assert " ".join(line.split()) == (
        "no report the report needs meshcat, which is not installed; pip install 'clearance[report]'"
    )
    assert list(folder.iterdir()) == []


def test_the_scenes_are_listed(capsys):
    code, out, err = demo(capsys, "--list")
    assert (code, err) == (0, "") and [line.split()[0] for line in out.splitlines()] == [*SCENES]


@pytest.mark.slow
@pytest.mark.parametrize("scene", SCENES)
def test_a_copy_is_the_whole_case_and_stands_alone(folder, capsys, monkeypatch, scene):
    code, out, err = demo(capsys, scene, "--copy", "my cell")
    assert (code, err) == (0, "") and "clearance check 'my cell/case.yaml'" in out
    copied = files(folder / "my cell")
    assert copied.pop("case.yaml") == (FOLDER / f"{scene}.yaml").read_bytes()
    assert {name.partition("/")[0].partition("_")[0] for name in copied} == {"heron6", scene}
    case, original = cl.load_case("my cell/case.yaml"), cl.load_case(FOLDER / f"{scene}.yaml")
    read = {Path(os.path.realpath(path)) for path in case.files_read}
    assert len(read) > 20 and all(path.is_relative_to(folder.resolve()) for path in read)
    ours, theirs = case.robots[0].trajectory, original.robots[0].trajectory
    assert ours.positions.tobytes() == theirs.positions.tobytes()


def test_a_copy_goes_over_nothing(folder, refusal):
    (folder / "mine").mkdir()
    (folder / "mine" / "case.yaml").write_text("mine")
    (folder / "file").write_text("mine")
    for place, said in (("mine", "is not empty"), ("file", "is a file"), ("", "an empty path")):
        err = refusal("demo", "--copy", place)
        assert said in err and "--copy" in err


def test_one_thing_is_asked_for_at_a_time_and_of_a_scene_that_there_is(refusal):
    for arguments in (["--copy", "a", "--out", "b"], ["--list", "--out", "b"]):
        assert "exclude each other" in refusal("demo", *arguments)
    assert all(scene in refusal("demo", "weld") for scene in SCENES)
