"""No output goes over an input of the run, by whatever name or link; nor where nobody meant it to go."""

from __future__ import annotations

import os
import shutil
from collections.abc import Callable
from pathlib import Path

import pytest

from clearance.cli import run
from clearance.errors import Unwritable
from clearance.files import refuse_inputs
from tests.cli.test_check_command import CASE, PATH, ROOT, URDF, files


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A case, standing in its folder; its trajectory has the name of one of the report's files."""
    place = tmp_path / "cell"
    place.mkdir()
    (place / "cart.urdf").write_text(URDF)
    (place / "case.yaml").write_text(CASE.replace("path.csv", "steps.csv"))
    (place / "steps.csv").write_text(PATH)
    monkeypatch.chdir(place)
    return place


def refused(arguments: list[str], said: str, capsys: pytest.CaptureFixture) -> None:
    before = files(Path.cwd().parent)
    assert run(arguments) == 2
    told = capsys.readouterr()
    assert told.out == "" and told.err.count("\n") == 1 and said in told.err
    assert files(Path.cwd().parent) == before


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


@pytest.mark.parametrize(
    "spelt", [str, by_a_detour, by_a_link, by_a_link_to_the_folder, by_a_hard_link]
)
def test_an_input_is_known_by_any_name(folder: Path, spelt: Callable[[Path], str]) -> None:
    name = Path(spelt(folder / "steps.csv"))
    with pytest.raises(Unwritable, match="which this run reads"):
        refuse_inputs([Path("new.csv"), name], ["cart.urdf", folder / "steps.csv"])


@pytest.mark.parametrize("name", ["case.yaml", "cart.urdf", "steps.csv"])
def test_junit_over_an_input_is_refused(
    folder: Path, capsys: pytest.CaptureFixture, name: str
) -> None:
    refused(["check", "case.yaml", "--junit", name], "which this run reads", capsys)


def test_a_report_over_the_trajectory_is_refused(
    folder: Path, capsys: pytest.CaptureFixture
) -> None:
    for out in (".", "../cell", str(folder)):
        refused(["check", "case.yaml", "--out", out], "steps.csv", capsys)
    Path("../out").mkdir()
    os.link("steps.csv", "../out/steps.csv")
    refused(["check", "case.yaml", "--out", "../out"], "which this run reads", capsys)


def test_an_input_far_from_the_case_is_one_as_well(
    folder: Path, capsys: pytest.CaptureFixture, tmp_path_factory: pytest.TempPathFactory
) -> None:
    """Its path is shown without its folder where it shares nothing with the case's but the root."""
    far = tmp_path_factory.mktemp("far")
    shutil.move("steps.csv", far / "steps.csv")
    Path("case.yaml").write_text(CASE.replace("path.csv", str(far / "steps.csv")))
    before = files(far)
    refused(["check", "case.yaml", "--out", str(far)], "which this run reads", capsys)
    assert files(far) == before


@pytest.mark.parametrize("option", ["--out", "--junit"])
def test_an_empty_place_is_refused(
    folder: Path, capsys: pytest.CaptureFixture, option: str
) -> None:
    refused(["check", "case.yaml", option, ""], "an empty path", capsys)


def test_junit_among_the_files_of_the_report_is_refused(
    folder: Path, capsys: pytest.CaptureFixture
) -> None:
    refused(
        ["check", "case.yaml", "--out", "../out", "--junit", "../out/summary.json"],
        "a file of the report", capsys,
    )  # fmt: skip


def test_a_workspace_over_a_mesh_is_refused(folder: Path, capsys: pytest.CaptureFixture) -> None:
    text = CASE.replace("path.csv", "steps.csv").replace(
        "box: {size: [0.2, 1, 1]}", "mesh: {file: workspace.stl}"
    )
    Path("case.yaml").write_text(text)
    corners = ["0 0 0", "1 0 0", "0 1 0", "0 0 1"]
    faces = [(0, 2, 1), (0, 1, 3), (1, 2, 3), (0, 3, 2)]
    loops = ["".join(f"vertex {corners[i]}\n" for i in face) for face in faces]
    facets = "".join(f"facet normal 0 0 0\nouter loop\n{loop}endloop\nendfacet\n" for loop in loops)
    Path("workspace.stl").write_text(f"solid\n{facets}endsolid\n")
    refused(["workspace", "case.yaml", "case.yaml", "--out", "."], "workspace.stl", capsys)
    refused(["workspace", "case.yaml", "case.yaml", "--out", ""], "an empty path", capsys)


def test_a_profile_over_its_case_is_refused(folder: Path, capsys: pytest.CaptureFixture) -> None:
    refused(
        ["profile", "sweep", "case.yaml", "--out", "./case.yaml"], "which this run reads", capsys
    )
    refused(["profile", "sweep", "case.yaml", "--out", ""], "an empty path", capsys)


def test_a_fit_over_its_sketch_or_its_outline_is_refused(
    folder: Path, capsys: pytest.CaptureFixture
) -> None:
    for name in ("keep_in_zone.yaml", "port_bar.yaml"):
        shutil.copy(next((ROOT / "scenes").rglob(name)), name)
    both = ["keep_in_zone.yaml", "port_bar.yaml"]
    for name in both:
        refused(["profile", "fit", *both, "--out", f"./{name}"], "which this run reads", capsys)
    shutil.copy(both[1], "outline.svg")
    given = ["profile", "fit", both[0], "outline.svg", "--out", "new.yaml", "--picture"]
    refused([*given, "../cell/outline.svg"], "which this run reads", capsys)
    refused([*given, ""], "an empty path", capsys)


def test_a_comparison_over_an_outline_is_refused(
    folder: Path, capsys: pytest.CaptureFixture
) -> None:
    for name in ("a.yaml", "comparison.json"):
        Path(name).write_text("not read before this is refused")
    refused(
        ["profile", "compare", "a.yaml", "a.yaml", "--out", "a.yaml"],
        "which this run reads",
        capsys,
    )
    refused(
        ["profile", "compare", "a.yaml", "comparison.json", "--out", "."],
        "which this run reads",
        capsys,
    )
    refused(["profile", "compare", "a.yaml", "a.yaml", "--out", ""], "an empty path", capsys)
