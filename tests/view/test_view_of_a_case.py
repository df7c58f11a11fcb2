"""`clearance view CASE.yaml`: the verdict of its check is printed, since the page shows a replay alone."""

from __future__ import annotations

from clearance.cli import view


def test_the_verdict_of_a_case_is_printed_before_its_replay_is_shown(monkeypatch, capsys, tmp_path):
    class Run:
        report = "report"

        def replay(self):
            return "replay"

    monkeypatch.setattr("clearance.run.check", lambda file: Run())
    monkeypatch.setattr("clearance.report.terminal.print_answer", lambda *given: print(*given))
    assert view._checked(tmp_path / "case.yaml") == "replay"
    assert capsys.readouterr().out == "report None\n"
