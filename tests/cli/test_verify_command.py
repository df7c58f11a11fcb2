"""`clearance check --receipt` and `clearance verify`, as a person meets them."""

from __future__ import annotations

import shutil
import sys
from pathlib import Path

import pytest

from clearance.cli import ExitCode, run
from clearance.receipt.search import too_many
from tests.receipt.test_forged_report import hashed

SCENE = Path(__file__).parents[2] / "scenes" / "box_box"
ROBOT = Path(__file__).parents[2] / "robots" / "gantry_box"


@pytest.fixture(scope="module")
def cell(tmp_path_factory):
    """A copy of a scene with its robot, and its report with a receipt beside it."""
    home = tmp_path_factory.mktemp("home")
    shutil.copytree(SCENE, home / "scenes" / "box_box")
    shutil.copytree(ROBOT, home / "robots" / "gantry_box")
    case = home / "scenes" / "box_box" / "case.yaml"
    assert run(["check", str(case), "--out", str(home / "out"), "--receipt", "--quiet"]) == 0
    return home


@pytest.fixture
def home(cell, tmp_path):
    return Path(shutil.copytree(cell, tmp_path / "home"))


@pytest.mark.slow
def test_the_receipt_of_a_run_is_proven(home, capsys):
    assert run(["verify", str(home / "out")]) == ExitCode.CLEAR
    told = capsys.readouterr().out
    assert told.startswith("PROVEN: at least 34.977 mm (default) between all 1 pairs over 300 ")
    assert (
        "; verdict clear; self-collision not checked [CL531]; every byte of the report matches a fresh run; "
        "3 inputs of ../scenes/" in told
    )
    assert "  links and pairs left out, as in the report: 6\n" in told
    assert run(["verify", str(home / "out"), "--inputs"]) == ExitCode.CLEAR
    assert capsys.readouterr().out.count("trajectory.csv") == 1


@pytest.mark.slow
def test_a_report_that_says_something_else_exits_1(home, capsys):
    table = home / "out" / "steps.csv"
    table.write_text(table.read_text() + "\n")
    hashed(home / "out", "steps.csv")
    assert run(["verify", str(home / "out")]) == ExitCode.VIOLATED
    assert "steps.csv" in capsys.readouterr().out


@pytest.mark.slow
def test_the_bound_is_proven_where_no_report_can_be_written(home, capsys, monkeypatch):
    """The report's files are not made anew there, which the headline says; its verdict is held against a run's."""
    monkeypatch.setitem(sys.modules, "pyarrow", None)
    assert run(["verify", str(home / "out")]) == ExitCode.CLEAR
    told = capsys.readouterr().out
    assert told.startswith(
        "PROVEN, NOT VERIFIED: contacts.csv, findings.json, report.html, and 4 more (not compared: "
    )
    assert (
        "a fresh report needs pyarrow, which is not installed; pip install 'clearance[report]')"
        in told
    )
    assert "at least 34.977 mm (default) between all 1 pairs" in told and "every byte" not in told
    summary = home / "out" / "summary.json"
    summary.write_text(summary.read_text().replace('"verdict": "clear"', '"verdict": "near"'))
    hashed(home / "out", "summary.json")
    assert run(["verify", str(home / "out")]) == ExitCode.VIOLATED
    assert "summary.json says 'near', a fresh run says clear" in capsys.readouterr().out


def test_an_input_that_was_changed_is_named(home, refusal):
    path = home / "robots" / "gantry_box" / "gantry_box.urdf"
    path.write_bytes(path.read_bytes() + b"\n")
    assert "gantry_box.urdf: it has changed" in refusal("verify", home / "out")
    assert "gantry_box.urdf: it has changed" in refusal("pack", home / "out", home / "r.zip")


def test_a_case_that_is_elsewhere_is_given(home, refusal, capsys):
    moved = home.parent / "elsewhere"
    (home / "out").rename(moved)
    assert "--case CASE.yaml" in refusal("verify", moved)
    case = home / "scenes" / "box_box" / "case.yaml"
    assert run(["verify", str(moved), "--case", str(case), "--quiet"]) == ExitCode.CLEAR
    assert capsys.readouterr() == ("", "")


@pytest.mark.parametrize(
    "options",
    [
        ["--receipt"],
        ["--samples-only", "--out", "out", "--receipt"],
        ["--method", "paper", "--out", "out", "--receipt"],
    ],
)
def test_a_receipt_of_what_is_not_proven_is_refused_before_anything_is_measured(
    options, home, monkeypatch, refusal
):
    monkeypatch.chdir(home.parent)
    assert "receipt" in refusal("check", home / "scenes" / "box_box" / "case.yaml", *options)


WAIVER = """- {between: ["*", block], at_least: 0.03, reason: a, by: b, until: 2900-01-01}
"""


@pytest.mark.slow
def test_what_was_asked_beside_the_case_is_asked_again_and_said(home, refusal, capsys):
    waivers, out = home / "more.yaml", home / "asked"
    waivers.write_text(WAIVER)
    case = str(home / "scenes" / "box_box" / "case.yaml")
    asked = (
        "--fail-mm 40 --today 2027-03-31 --need pairs --certify-mm 0.5 --contact none --body-gaps"
    )
    asked = [*asked.split(), "--accept", "units", "--waivers", str(waivers)]
    assert run(["check", case, *asked, "--out", str(out), "--receipt", "--quiet"]) == ExitCode.CLEAR
    capsys.readouterr()
    assert run(["verify", str(out)]) == ExitCode.CLEAR
    line = capsys.readouterr().out.partition("\n")[0]
    assert "BELOW ITS LIMIT of 40 mm" in line and "every byte of the report" in line
    assert "with 1 waiver (fail 40 mm, not the case's " in line
    assert "; accepted for this run: units; with ../more.yaml; waivers as of 2027" in line
    waivers.rename(home / "moved.yaml")
    assert "--waivers FILE" in refusal("verify", out)


@pytest.mark.slow
def test_tolerances_that_no_receipt_covers_are_told_in_a_line_of_their_own(home, capsys):
    """Clocks that may be off are no part of the proof: the receipt is nominal, and says so at once."""
    case = home / "scenes" / "box_box" / "case.yaml"
    tolerances, out = home / "tol.yaml", home / "late"
    tolerances.write_text("timing: {all: 0.001}\n")
    given = ["--tolerance", str(tolerances), "--unproven-ok", "--quiet"]
    run(["check", str(case), *given, "--out", str(out), "--receipt"])
    told = capsys.readouterr().err
    assert told.count("\n") == 1 and "proves the bound without tolerances" in told
    assert run(["verify", str(out)]) == ExitCode.CLEAR
    told = capsys.readouterr().out
    assert told.startswith("NOMINAL ONLY, tolerances are not taken off: PROVEN: at least ")


@pytest.mark.parametrize(
    ("stopped_by", "code", "said"),
    [
        (KeyboardInterrupt(), ExitCode.INTERRUPTED, "the report is whole, and has no receipt\ninter"),
        (too_many(9_400_000, 8_000_000), ExitCode.BAD_INPUT, "at most; --receipt sampled [CL631]\n"),
    ],
    ids=["interrupted", "too many proofs"],
)  # fmt: skip
def test_who_does_not_get_a_receipt_keeps_the_answer(
    home, monkeypatch, capsys, stopped_by, code, said
):
    def stopped(*args):
        raise stopped_by

    monkeypatch.setattr("clearance.receipt.writing.write_receipt", stopped)
    out, case = home / "out", home / "scenes" / "box_box" / "case.yaml"
    assert run(["check", str(case), "--out", str(out), "--receipt"]) == code
    told = capsys.readouterr()
    assert told.out.startswith("CLEAR  box_box") and said in told.err
    assert (out / "summary.json").is_file() and not (out / "receipt.bin").exists()


@pytest.mark.slow
def test_a_packed_report_is_verified_and_shown_where_nothing_of_the_cell_is(
    home, tmp_path, monkeypatch, capsys
):
    tolerances = home / "tol.yaml"
    tolerances.write_text("joints: {all: 0.0001}\n")
    case, report, packed = home / "scenes" / "box_box" / "case.yaml", home / "r", tmp_path / "r.zip"
    cell = tmp_path / "cell.zip"
    for arguments in (
        ["pack", str(case), str(cell)],
        ["check", str(cell), "--tolerance", str(tolerances), "--out", str(report), "--receipt"],
        ["pack", str(report), str(packed)],
    ):
        assert run(arguments) == ExitCode.CLEAR
    assert "clearance verify" in capsys.readouterr().out
    shutil.rmtree(home)
    again = cell.rename(tmp_path / "again.zip")
    assert run(["verify", str(packed)]) == ExitCode.CLEAR
    told = capsys.readouterr().out
    assert "every byte of the report matches a fresh run" in told
    assert f"inputs of {packed} unchanged" in told
    seen = []
    monkeypatch.setattr("clearance.view.show", lambda name, page: seen.append(page))
    for file in (packed, again):
        assert run(["view", str(file)]) == ExitCode.CLEAR
    assert [page.rstrip().endswith(b"</html>") for page in seen] == [True, True]


@pytest.mark.slow
def test_tolerances_given_beside_the_case_are_not_said_to_be_unchanged(home, refusal):
    tolerances, out = home / "tol.yaml", home / "again"
    tolerances.write_text("joints: {all: 0.0001}\n")
    case = str(home / "scenes" / "box_box" / "case.yaml")
    given = ["--tolerance", str(tolerances), "--unproven-ok", "--quiet"]
    run(["check", case, *given, "--out", str(out), "--receipt"])
    tolerances.write_text("joints: {all: 0.0002}\n")
    assert "tol.yaml: it has changed" in refusal("verify", out)
