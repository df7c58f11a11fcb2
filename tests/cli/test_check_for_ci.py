"""`clearance check` with waivers, baseline, summary and annotations; `clearance compare`; the hook's command."""

from __future__ import annotations

import json
import re
import shutil
from pathlib import Path

import pytest

from clearance.cli import run
from clearance.report.withdrawn import withdraw_report
from tests.findings.gates import write_gates
from tests.report.schemas import valid_suite

BROKEN = {"gate_a": (-0.5, 0.003), "gate_b": (0.5, 0.1)}
WORSE = {"gate_a": (-0.5, 0.0025), "gate_b": (0.5, 0.1)}
CLEAR = {"gate_a": (-0.5, 0.05), "gate_b": (0.5, 0.1)}
CELLS = {"broken": BROKEN, "worse": WORSE, "clear": CLEAR}
WAIVER = (
    "- {between: [box, gate_a], at_least: 0.002, reason: gives way, by: N. N., until: 2027-03-31}\n"
)


@pytest.fixture
def place(tmp_path, monkeypatch) -> Path:
    monkeypatch.chdir(tmp_path)
    monkeypatch.delenv("GITHUB_STEP_SUMMARY", raising=False)
    monkeypatch.delenv("GITHUB_WORKSPACE", raising=False)
    for name, gates in CELLS.items():
        write_gates(tmp_path / name, gates)
    (tmp_path / "waivers.yaml").write_text(WAIVER)
    return tmp_path


@pytest.fixture(scope="module")
def reported(tmp_path_factory) -> Path:
    """The reports of the three cells, made once."""
    folder = tmp_path_factory.mktemp("reported")
    for name, gates in CELLS.items():
        write_gates(folder / name, gates)
        check(f"{folder / name}/case.yaml", "--out", f"{folder}/of_{name}", "--quiet")
    return folder


@pytest.fixture
def reports(place, reported) -> Path:
    """The place with the reports beside their cells."""
    for name in CELLS:
        shutil.copytree(reported / f"of_{name}", place / f"of_{name}")
    return place


def check(*arguments: str) -> int:
    return run(["check", *arguments])


def test_waivers_are_inputs_of_the_summary_and_are_not_overwritten(place, refusal, capsys):
    given = ("broken/case.yaml", "--waivers", "waivers.yaml", "--today", "2026-11-01")
    assert check(*given, "--json") == 0
    summary = json.loads(capsys.readouterr().out)
    assert "waivers.yaml" in [one["path"] for one in summary["inputs"]]
    assert "would overwrite" in refusal("check", *given, "--summary", "waivers.yaml")


@pytest.mark.slow
def test_a_baseline_is_told_and_does_not_change_the_exit_code(reports, capsys):
    assert check("broken/case.yaml", "--baseline", "of_broken") == 1
    assert "since the baseline: 1 unchanged" in capsys.readouterr().out
    assert check("worse/case.yaml", "--baseline", "of_broken/findings.json", "--out", "now") == 1
    assert "since the baseline: BREAKS A RULE in 1 finding; 1 worse" in capsys.readouterr().out
    page = (reports / "now" / "report.html").read_text()
    assert "Since the baseline: BREAKS A RULE in 1 finding; 1 worse." in page
    assert "worse, was 3.000 mm" in page
    assert check("clear/case.yaml", "--baseline", "of_broken") == 0
    assert "since the baseline: 1 gone" in capsys.readouterr().out


def test_github_is_told_on_the_row_and_in_the_step_summary(place, capsys, monkeypatch):
    step = place / "step.md"
    step.write_text("before\n")
    monkeypatch.setenv("GITHUB_STEP_SUMMARY", str(step))
    assert check("broken/case.yaml", "--github", "--summary", "own.md") == 1
    lines = capsys.readouterr().out.splitlines()
    (told,) = [line for line in lines if line.startswith("::")]
    assert told.startswith("::error file=broken/way.csv,line=9,")
    assert step.read_text() == "before\n" + (place / "own.md").read_text()
    assert check("broken/case.yaml", "--github", "--json") == 1
    out, err = capsys.readouterr()
    assert json.loads(out)["exit_code"] == 1 and "::error file=" in err


def test_a_step_summary_that_is_not_set_or_cannot_be_written_is_said(place, capsys, monkeypatch):
    assert check("broken/case.yaml", "--github", "--quiet") == 1
    assert "GITHUB_STEP_SUMMARY is not set" in capsys.readouterr().err
    monkeypatch.setenv("GITHUB_STEP_SUMMARY", str(place / "none" / "step.md"))
    assert check("clear/case.yaml", "--github", "--quiet") == 2
    out, err = capsys.readouterr()
    assert out.startswith("::error file=") and "step.md: cannot write here" in err


@pytest.mark.slow
def test_two_runs_side_by_side(reports, refusal, capsys):
    assert run(["compare", "of_broken", "of_worse", "--out", "page"]) == 1
    assert "1 worse" in capsys.readouterr().out
    page = (reports / "page" / "comparison.html").read_text()
    (data,) = re.findall(r'<script id="data" type="application/json">(.*?)</script>', page)
    curves = json.loads(data)["curves"]
    assert [one["name"] for one in curves] == ["A", "B"] and "new, worse or less known" in page
    assert min(curves[1]["clearances"]) < min(curves[0]["clearances"])
    assert run(["compare", "of_worse", "of_clear/findings.json", "--out", "page"]) == 0
    assert "Curves need two report folders" in (reports / "page" / "comparison.html").read_text()
    refusal("compare", "of_worse", "no")
    (reports / "of_worse" / "steps.parquet").write_bytes(b"no")
    assert "no table of steps" in refusal("compare", "of_worse", "of_clear", "--out", "other")


@pytest.mark.slow
def test_side_by_side_it_is_told_what_a_waiver_lets_pass(reports, capsys):
    """A row "new, violated" of a comparison that passes would be taken for a fault of it."""
    asked = ("--waivers", "waivers.yaml", "--today", "2026-11-01", "--quiet")
    check("broken/case.yaml", "--out", "waived", *asked)
    assert run(["compare", "of_clear", "waived", "--out", "page"]) == 0
    assert "violated, waived" in capsys.readouterr().out
    page = (reports / "page" / "comparison.html").read_text()
    assert '<span class="tag violated">violated, waived</span>' in page
    assert run(["compare", "waived", "of_broken"]) == 1
    assert "waived before, and is not now" in capsys.readouterr().out


def test_the_hook_checks_each_file_and_what_it_lists(place, capsys):
    (place / "all.clearance.yaml").write_text("cases: ['*/case.yaml']\n")
    assert run(["pre-commit", "clear/case.yaml"]) == 0
    assert capsys.readouterr() == ("", "")
    assert run(["pre-commit", "all.clearance.yaml"]) == 1
    told = capsys.readouterr().out
    assert "broken/case.yaml: VIOLATED" in told and "3.000 mm" in told and "clear" not in told
    (place / "bad.clearance.yaml").write_text("cases: []\n")
    assert run(["pre-commit", "bad.clearance.yaml", "broken/case.yaml"]) == 2
    out, err = capsys.readouterr()
    assert "broken/case.yaml: VIOLATED" in out and "no list of cases" in err


def test_the_hook_without_files_checks_all_below_the_folder(place, refusal, capsys):
    assert "there is no *.clearance.yaml below this folder" in refusal("pre-commit")
    (place / "clear" / "one.clearance.yaml").write_text("cases: [case.yaml]\n")
    assert run(["pre-commit"]) == 0
    (place / "broken" / "one.clearance.yaml").write_text("cases: [case.yaml]\n")
    assert run(["pre-commit"]) == 1
    assert "broken/case.yaml: VIOLATED" in capsys.readouterr().out


@pytest.mark.slow
@pytest.mark.parametrize("rows_are_left", [True, False])
def test_a_comparison_with_what_an_interrupted_run_left_behind_is_incomplete(
    reports, capsys, rows_are_left
):
    assert run(["compare", "of_broken", "of_clear", "--quiet"]) == 0
    if rows_are_left:
        (reports / ".of_clear.unfinished").mkdir()  # where rows are kept until the report is there
    else:
        withdraw_report(reports / "of_clear")
    for arguments in (
        ["compare", "of_broken", "of_clear"],
        ["compare", "of_clear/findings.json", "of_broken"],
        ["check", "broken/case.yaml", "--baseline", "of_clear"],
    ):
        assert run(arguments) == 4
        told = capsys.readouterr()
        assert told.err.startswith("incomplete: of_clear: a run into this folder was interrupted")
        assert told.out == ""


ASKED = ("--junit", "junit.xml", "--summary", "own.md", "--out", "r", "--quiet")


def stopped(*_: object) -> None:
    raise KeyboardInterrupt


REFUSED = {
    ("--colour", "red"): "No such option",
    ("--need", "no"): "--need",
    ("again.yaml", "more.yaml"): "unexpected extra argument",
    ("--png", "picture.jpg"): "is no .png file",
    ("--baseline", "no"): "there is no file",
}


def test_what_is_refused_or_stopped_leaves_nothing_green(place, monkeypatch):
    assert check("clear/case.yaml", *ASKED) == 0
    green = {file: file.read_bytes() for file in place.rglob("*") if file.is_file()}

    def require_told(text: str) -> None:
        (fault,) = valid_suite(place / "junit.xml").iter("error")
        assert text in fault.get("message")
        assert (place / "own.md").read_text().startswith("### case.yaml: ERROR\n")
        assert not (place / "r/summary.json").exists()
        assert "what follows is older" in (place / "r/report.html").read_text()
        (place / "r/summary.older.json").unlink()
        for file, content in green.items():
            file.write_bytes(content)

    for more, told in REFUSED.items():
        assert check("clear/case.yaml", *ASKED, *more) == 2
        require_told(told)
    for step in ("clearance.case.case_file.load_case", "clearance.run.answer"):
        with monkeypatch.context() as during:
            during.setattr(step, stopped)
            assert check("clear/case.yaml", *ASKED) == 130
        require_told("has not come to an end")


def test_what_is_refused_makes_no_file_of_a_word_that_is_not_understood(place, capsys):
    before = sorted(place.rglob("*"))
    assert check("clear/case.yaml", "--junit", "--summary", "own.md", "more") == 2
    assert sorted(place.rglob("*")) == before
    assert check("clear/case.yaml", "--colour", "--github") == 2
    assert capsys.readouterr().err.count("::error file=clear/case.yaml") == 1


def test_warnings_that_fail_are_told_as_what_fails(place, capsys, monkeypatch):
    text = (place / "clear" / "case.yaml").read_text()
    (place / "clear" / "case.yaml").write_text(text.replace("xyz: [0.5,", "xyz: [18,"))
    assert run(["pre-commit", "clear/case.yaml"]) == 0
    assert run(["pre-commit", "clear/case.yaml", "--fail-on-warning"]) == 1
    first, line = capsys.readouterr().out.splitlines()
    assert first == "clear/case.yaml: WARNING (would be CLEAR)"
    assert line.startswith("  warning units: ") and line.endswith("[CL120]")
    assert check("clear/case.yaml", "--fail-on-warning", "--github", "--quiet") == 1
    assert capsys.readouterr().out.startswith("::error title=clearance%3A")
    accepted = ("clear/case.yaml", "--fail-on-warning", "--accept", "CL120", "--github", "--quiet")
    assert check(*accepted) == 0 and capsys.readouterr().out.startswith("::warning ")


def test_a_refused_case_leaves_nothing_green(place, capsys, monkeypatch):
    step = place / "step.md"
    monkeypatch.setenv("GITHUB_STEP_SUMMARY", str(step))
    asked = ("--junit", "junit.xml", "--summary", "own.md", "--github", "--quiet")
    assert check("clear/case.yaml", *asked) == 0
    case = place / "clear" / "case.yaml"
    case.write_text(case.read_text().replace("limits:", "limit:"))
    capsys.readouterr()
    for given, code in ((case, "CL103"), (place / "none.yaml", "CL101")):
        assert check(str(given), *asked) == 2
        out, err = capsys.readouterr()
        told = err.removeprefix("error: ").rstrip("\n")
        assert f"[{code}]" in told
        assert out.startswith("::error file=") and f"clearance%3A {given.name}::{told}\n" in out
        suite = valid_suite(place / "junit.xml")
        (fault,) = suite.iter("error")
        assert suite.get("errors") == "1" and fault.get("message") == told
        for summary in (place / "own.md", step):
            assert summary.read_text().splitlines()[-3] == f"### {given.name}: ERROR"


def test_the_hook_tells_all_that_fails(place, capsys):
    text = (place / "broken" / "case.yaml").read_text()
    text = text.replace("xyz: [0.5,", "xyz: [5000,") + "waivers: [../waivers.yaml]\n"
    (place / "broken" / "case.yaml").write_text(text)
    (place / "waivers.yaml").write_text(WAIVER.replace("2027", "2020"))
    assert run(["pre-commit", "broken/case.yaml"]) == 2
    first, *lines = capsys.readouterr().out.splitlines()
    assert first == "broken/case.yaml: SUSPECT (would be VIOLATED)"
    assert lines[0].startswith("  3.000 mm, below the fail limit of 5 mm: box - gate_a")
    assert lines[1].startswith("  suspect units: CHECK UNITS: obstacle 'gate_b'")
    assert lines[2].startswith("  unused waiver: waiver box - gate_a") and len(lines) == 3
