"""Long work is never silent: a line every ten seconds of a clock that counts, whatever goes on."""

import sys

import pytest

import clearance as cl
from clearance.cli import progress as shown
from clearance.progress import doing, never_silent
from tests.counted_end import counted_end


def test_the_innermost_line_is_written_with_the_time_so_far(monkeypatch, capsys):
    end = counted_end(monkeypatch, 3)
    parts = iter(["reading", "", "measuring: 5 of 9"])
    with never_silent(lambda: "check"), doing(lambda: next(parts)):
        end.pass_all()
    assert capsys.readouterr().err.splitlines() == [
        "reading, 10 s so far",
        "measuring: 5 of 9, 30 s so far",
    ]


def test_passes_are_told_apart_by_their_counting(monkeypatch, capsys):
    end = counted_end(monkeypatch, 1)
    with never_silent(lambda: "check"):
        with shown.shown_progress(False, ["measuring", "certifying"]) as progress:
            for pair in ((1, 8), (8, 8), (2, 7)):
                progress(*pair)
            end.pass_all()
    assert capsys.readouterr().err == "certifying: 2 of 7, 10 s so far\n"


COMMANDS = {
    "check": ["check", "scenes/box_box/case.yaml"],
    "gain": ["gain", "scenes/box_box/case.yaml", "--kind", "waypoints"],
}


@pytest.mark.parametrize("name", COMMANDS)
def test_commands_are_within_it(name, monkeypatch, capsys):
    """Nothing is done: whoever reads the case sees the lines go on, unless it is quiet."""
    from clearance.cli import ExitCode, run

    def read(path):
        if "--quiet" not in asked:
            end.pass_all()
        raise KeyboardInterrupt

    monkeypatch.setattr("clearance.case.case_file.load_case", read)
    end = counted_end(monkeypatch, 2)
    asked = COMMANDS[name]
    assert run(asked) == ExitCode.INTERRUPTED
    lines = capsys.readouterr().err.splitlines()
    assert lines[0].endswith(", 10 s so far") and lines[1:] == [
        lines[0].replace("10", "20"),
        "interrupted",
    ]
    if name == "check":
        asked = [*asked, "--quiet"]
        assert run(asked) == ExitCode.INTERRUPTED
        assert capsys.readouterr().err == "interrupted\n"


def test_a_part_that_shows_nothing_itself_is_named_by_the_whole(monkeypatch, capsys):
    end = counted_end(monkeypatch, 1)
    with never_silent(lambda: "gain"), never_silent(lambda: "a Checker"):
        with doing(lambda: "searching"):
            pass
        end.pass_all()
    assert capsys.readouterr().err == "a Checker, 10 s so far\n"


def test_a_checker_is_within_it(monkeypatch, capsys):
    end = counted_end(monkeypatch, 1)
    monkeypatch.setattr(
        "clearance.simulate.measure.checker.AskedPositions", lambda *_: sys.exit(end.pass_all())
    )
    with pytest.raises(SystemExit):
        cl.Checker(cl.load_case("scenes/box_box/case.yaml"))
    assert capsys.readouterr().err == "a Checker prepares the bodies of its case, 10 s so far\n"
