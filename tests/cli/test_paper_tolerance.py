"""Rule 1's tolerance of the first paper, set by the user: what it leaves out, and what the report says of it."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

import clearance as cl
from clearance.cli import run

SCENE = Path(__file__).parents[2] / "scenes" / "box_box" / "case.yaml"


@pytest.mark.parametrize(
    ("tolerance", "told"),
    [
        (2.5, "with a tolerance of 2500 mm for its first rejection rule"),
        (None, "with no tolerance for its first rejection rule"),
    ],
)
def test_the_tolerance_is_in_the_summary_and_the_report(tmp_path, capsys, tolerance, told):
    own = [] if tolerance is None else ["--paper-tolerance-mm", str(1000.0 * tolerance)]
    asked = ["check", str(SCENE), "--method", "paper", "--json", "--out", str(tmp_path / "out")]
    assert run([*asked, *own]) == 0
    assert json.loads(capsys.readouterr().out)["paper_tolerance"] == tolerance
    assert told in (tmp_path / "out" / "report.html").read_text()


def test_what_is_farther_than_the_tolerance_is_left_out() -> None:
    case = cl.load_case(SCENE)
    all_in, some = (
        cl.answer(cl.Question(case, method="paper", paper_tolerance=t)).record.tally
        for t in (100.0, 0.4)
    )
    assert all_in["cut_by_rule_1"] == 0 < some["cut_by_rule_1"]
    assert some["measured"] < all_in["measured"]
    with pytest.raises(cl.BadInput, match=r"a tolerance above 0\.01 m may do"):
        cl.answer(cl.Question(case, method="paper", paper_tolerance=0.01))
