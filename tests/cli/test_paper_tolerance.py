"""Rule 1's tolerance of the first paper, set by the user: what it leaves out, and what the report says of it."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path

import pytest

import clearance as cl

SCENE = Path(__file__).parents[2] / "scenes" / "box_box" / "case.yaml"


def checked(*arguments: str) -> subprocess.CompletedProcess:
    command = [sys.executable, "-m", "clearance", "check", str(SCENE), *arguments]
    return subprocess.run(command, capture_output=True, text=True)


def test_the_tolerance_is_in_the_summary_and_the_report(tmp_path: Path) -> None:
    done = checked(
        "--method",
        "paper",
        "--paper-tolerance-mm",
        "2500",
        "--json",
        "--out",
        str(tmp_path / "out"),
    )
    summary = json.loads(done.stdout)
    assert done.returncode == 0 and summary["paper_tolerance"] == 2.5
    page = (tmp_path / "out" / "report.html").read_text()
    assert "with a tolerance of 2500 mm for its first rejection rule" in page


def test_a_report_without_one_says_so(tmp_path: Path) -> None:
    cl.answer(cl.Question(cl.load_case(SCENE), method="paper")).save(tmp_path / "out")
    page = (tmp_path / "out" / "report.html").read_text()
    assert (
        "with no tolerance for its first rejection rule" in page
        and "with its tolerance" not in page
    )


def test_what_is_farther_than_the_tolerance_is_left_out() -> None:
    case = cl.load_case(SCENE)
    all_in, some = (
        cl.answer(cl.Question(case, method="paper", paper_tolerance=t)).record.tally
        for t in (100.0, 0.4)
    )
    assert (
        all_in["cut_by_rule_1"] == 0 < some["cut_by_rule_1"]
        and some["measured"] < all_in["measured"]
    )
    with pytest.raises(cl.BadInput, match=r"a tolerance above 0\.01 m may do"):
        cl.answer(cl.Question(case, method="paper", paper_tolerance=0.01))


@pytest.mark.parametrize(
    "arguments", [("--method", "paper", "--paper-tolerance-mm", "0"), ("--paper-tolerance-mm", "5")]
)
def test_a_tolerance_that_cannot_be_used_is_refused_in_one_line(arguments: tuple[str, ...]) -> None:
    done = checked(*arguments)
    assert done.returncode == 2 and done.stderr.count("\n") == 1 and "Traceback" not in done.stderr
