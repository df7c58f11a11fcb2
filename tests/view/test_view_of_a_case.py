"""`clearance view CASE.yaml`: the verdict of its check is printed, since the page shows a replay alone."""

from __future__ import annotations

from pathlib import Path

from clearance.cli import view

SCENES = Path(__file__).parents[2] / "scenes"


def test_the_verdict_of_a_case_is_printed_before_its_replay_is_shown(capsys):
    view._checked(SCENES / "box_pipe" / "case.yaml")
    told = capsys.readouterr().out
    assert told.startswith("VIOLATED  box_pipe") and "5.123 mm" in told
