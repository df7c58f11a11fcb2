"""`clearance compile` asks what real questions ask, says where the cache lies, and refuses where there is none."""

from __future__ import annotations

import pytest

from clearance.cli import compile_kernels, rehearsal, run
from clearance.kept_files import cache_root
from clearance.load.case.case_file import load_case


@pytest.fixture
def asked(monkeypatch):
    """What is asked, in place of an answer."""
    found = []
    monkeypatch.setattr(compile_kernels, "_ask", lambda questions: found.extend(questions))
    return found


@pytest.mark.parametrize(
    ("options", "questions"),
    [([], rehearsal.EVERYDAY), (["--all"], rehearsal.EVERYDAY + rehearsal.THE_REST)],
)
def test_all_asks_more_than_the_everyday(asked, capsys, options, questions):
    assert run(["compile", *options]) == 0
    assert tuple(asked) == questions
    out = capsys.readouterr().out
    assert out.startswith(f"{cache_root()} holds ") and out.count("\n") == 1


def test_where_nothing_can_be_kept_it_refuses_in_one_line(asked, capsys, monkeypatch):
    monkeypatch.setattr("clearance.kept_files.cache_root", lambda: None)
    assert run(["compile"]) == 2
    err = capsys.readouterr().err
    assert (
        "compiled kernels cannot be kept" in err
        and "NUMBA_CACHE_DIR" in err
        and err.count("\n") == 1
    )
    assert asked == []


def test_every_question_is_about_a_case_that_can_be_loaded(tmp_path):
    rehearsal.write_files(tmp_path)
    for _, (command, case, *_) in rehearsal.EVERYDAY + rehearsal.THE_REST:
        assert command == "check"
        load_case(tmp_path / case)


def test_a_question_that_is_not_answered_is_a_fault_of_the_program(monkeypatch, capsys):
    broken = rehearsal.CommandCall("nothing", ("check", "none.yaml"))
    monkeypatch.setattr(rehearsal, "EVERYDAY", (broken,))
    assert run(["compile"]) == 70
    assert "nothing: 2" in capsys.readouterr().err
