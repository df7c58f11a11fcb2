"""No output goes over an input, nor where nobody meant it; what --png, --glb and --trajectory write."""

from __future__ import annotations

import os
import shutil
from collections.abc import Callable
from pathlib import Path

import pytest

from clearance import check
from clearance.case.case_file import load_case
from clearance.cli import run
from clearance.errors import Unwritable
from clearance.files import refuse_inputs
from tests.cart import CASE, ROOT, files, write_cart
from tests.formats.making import cube_stl

WITH_MESH = CASE.replace("box: {size: [0.2, 1, 1]}", "mesh: {file: workspace.stl}")


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A case, standing in its folder, and what other commands read; some have names of files that are written."""
    place = tmp_path / "cell"
    write_cart(place, CASE.replace("path.csv", "steps.csv"))
    (place / "path.csv").rename(place / "steps.csv")
    (place / "meshed.yaml").write_text(WITH_MESH.replace("path.csv", "steps.csv"))
    (place / "workspace.stl").write_bytes(cube_stl())
    for name in ("keep_in_zone.yaml", "port_bar.yaml"):
        shutil.copy(next((ROOT / "scenes").rglob(name)), place / name)
    shutil.copy(place / "port_bar.yaml", place / "outline.svg")
    for name in ("a.yaml", "comparison.json"):
        (place / name).write_text("not read before this is refused")
    (tmp_path / "out").mkdir()
    os.link(place / "steps.csv", tmp_path / "out" / "steps.csv")
    monkeypatch.chdir(place)
    return place


def by_a_detour(path: Path) -> str:
    return f"../{path.parent.name}/./{path.name}"


def by_a_link(path: Path) -> str:
    Path("link").symlink_to(path)
    return "link"


def by_a_link_to_the_folder(path: Path) -> str:
    Path("../other").symlink_to(path.parent, target_is_directory=True)
    return f"../other/{path.name}"


def by_a_hard_link(path: Path) -> str:
    os.link(path, "hard")
    return "hard"


@pytest.mark.parametrize("spelt", [by_a_detour, by_a_link, by_a_link_to_the_folder, by_a_hard_link])
def test_an_input_is_known_by_any_name(folder: Path, spelt: Callable[[Path], str]) -> None:
    name = Path(spelt(folder / "steps.csv"))
    with pytest.raises(Unwritable, match="which this run reads"):
        refuse_inputs([Path("new.csv"), name], ["cart.urdf", folder / "steps.csv"])


FIT = "profile fit keep_in_zone.yaml"
READS = "which this run reads"


@pytest.mark.parametrize(
    ("words", "said"),
    [
        ("check case.yaml --junit cart.urdf", READS),
        ("check case.yaml --out .", "steps.csv"),
        ("check case.yaml --baseline a.yaml --junit a.yaml", READS),
        ("check case.yaml --out ../out", READS),
        ("check case.yaml --out ''", "an empty path"),
        ("check case.yaml --junit ''", "an empty path"),
        ("check case.yaml --out ../new --junit ../new/summary.json", "a file of the report"),
        ("workspace meshed.yaml meshed.yaml --out .", "workspace.stl"),
        ("workspace meshed.yaml meshed.yaml --out ''", "an empty path"),
        ("profile sweep case.yaml --out ./case.yaml", READS),
        ("profile sweep case.yaml --out ''", "an empty path"),
        (f"{FIT} port_bar.yaml --out ./port_bar.yaml", READS),
        (f"{FIT} outline.svg --out new.yaml --picture ../cell/outline.svg", READS),
        (f"{FIT} outline.svg --out new.yaml --picture ''", "an empty path"),
        ("profile compare a.yaml comparison.json --out .", READS),
        ("profile compare a.yaml a.yaml --out ''", "an empty path"),
    ],
)
def test_a_command_that_would_write_over_its_input_or_nowhere_is_refused(
    folder: Path, refusal: Callable[..., str], words: str, said: str
) -> None:
    assert said in refusal(*(word if word != "''" else "" for word in words.split()))


TWO = """robots:
- {name: left, urdf: cart.urdf, trajectory: path.csv}
- {name: right, urdf: cart.urdf, base: {xyz: [0, 2, 0]}, trajectory: {file: path.csv, start: 0.5}}
scene:
  obstacles:
  - {name: wall, box: {size: [0.2, 1, 1]}, pose: {xyz: [1, 0, 0]}}
"""


@pytest.fixture
def rail(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    write_cart(tmp_path)
    monkeypatch.chdir(tmp_path)
    return tmp_path


@pytest.mark.slow
def test_all_are_written_and_named_and_nothing_else(rail, capsys):
    wanted = ["--png", "a/worst.png", "--glb", "worst.glb", "--trajectory", "back.json"]
    assert run(["check", "case.yaml", *wanted]) == 0
    told = capsys.readouterr().out.splitlines()[-3:]
    names = ("a/worst.png", "worst.glb", "back.json")
    assert told == [f"  written     {name}" for name in names]
    given = {"cart.urdf", "case.yaml", "path.csv"}
    assert set(files(rail)) == {*given, *names}


def test_several_robots_are_documents_in_the_order_of_the_case(rail, refusal):
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
    rail, refusal, monkeypatch, given, said
):
    def measured(*_):
        raise AssertionError("measured")

    monkeypatch.setattr("clearance.run.answer", measured)
    Path("folder.png").mkdir()
    assert said in refusal("check", "case.yaml", *given)
