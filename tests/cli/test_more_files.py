"""`clearance check --png --glb --trajectory`: what is written, what is refused, and the trajectory back again."""

from __future__ import annotations

from pathlib import Path

import pytest

from clearance import check
from clearance.case.case_file import load_case
from clearance.cli import run
from tests.cart import files, write_cart

TWO = """robots:
- {name: left, urdf: cart.urdf, trajectory: path.csv}
- {name: right, urdf: cart.urdf, base: {xyz: [0, 2, 0]}, trajectory: {file: path.csv, start: 0.5}}
scene:
  obstacles:
  - {name: wall, box: {size: [0.2, 1, 1]}, pose: {xyz: [1, 0, 0]}}
"""


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    write_cart(tmp_path)
    monkeypatch.chdir(tmp_path)
    return tmp_path


@pytest.mark.slow
def test_all_are_written_and_named_and_nothing_else(folder, capsys):
    wanted = ["--png", "a/worst.png", "--glb", "worst.glb", "--trajectory", "back.json"]
    assert run(["check", "case.yaml", *wanted]) == 0
    told = capsys.readouterr().out.splitlines()[-3:]
    names = ("a/worst.png", "worst.glb", "back.json")
    assert told == [f"  written     {name}" for name in names]
    given = {"cart.urdf", "case.yaml", "path.csv"}
    assert set(files(folder)) == {*given, *names}


def test_several_robots_are_documents_in_the_order_of_the_case(folder, refusal):
    Path("two.yaml").write_text(TWO)
    assert run(["check", "two.yaml", "--trajectory", "back.yaml"]) == 0
    assert Path("back.yaml").read_text().startswith("# left\njoint_names")
    text = TWO.replace("trajectory: path.csv", "trajectory: {file: back.yaml, which: 1}")
    Path("again.yaml").write_text(
        text.replace("{file: path.csv, start: 0.5}", "{file: back.yaml, which: 2}")
    )
    first, second = (check(load_case(name)).record for name in ("two.yaml", "again.yaml"))
    assert first.steps.equals(second.steps)
    told = refusal("check", "two.yaml", "--trajectory", "back.csv")
    assert "a table holds one robot, the case has 2" in told


@pytest.mark.parametrize(
    "given, said",
    [
        (["--glb", "worst.png"], "is no .glb file; --glb needs one"),
        (["--trajectory", "worst.txt"], "'worst.txt' has no suffix to write for a trajectory; one of .csv"),
        (["--trajectory", "path.csv"], "would overwrite"),
        (["--glb", "cart.urdf/worst.glb"], "cannot be written"),
        (["--png", "folder.png"], "is a folder; --png needs a file"),
        (["--out", "out", "--trajectory", "out/steps.csv"], "is a file of the report; --trajectory"),
        (["--junit", "worst.glb", "--glb", "./worst.glb"], "is the file of --junit; --glb"),
    ],
)  # fmt: skip
def test_what_cannot_be_written_is_refused_before_anything_is_measured(
    folder, refusal, monkeypatch, given, said
):
    def measured(*_):
        raise AssertionError("measured")

    monkeypatch.setattr("clearance.run.answer", measured)
    Path("folder.png").mkdir()
    assert said in refusal("check", "case.yaml", *given)
