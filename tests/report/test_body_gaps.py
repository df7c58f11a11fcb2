"""Gaps that people may be caught in: which are told, with which source, and that no verdict follows."""

import dataclasses
import functools

import clearance as cl
from clearance.cli import run
from clearance.record.record import Record
from clearance.report.topics.body_gaps import WIDTHS, body_gaps_of
from tests.findings.test_verdict import made
from tests.formats.making import CASE, write_case
from tests.report.made import run_of


@functools.cache
def swing() -> Record:
    return dataclasses.replace(made(), body_gaps=True)


def test_a_gap_may_catch_what_needs_more(tmp_path):
    near = [one for one in run_of(swing()).pair_minima if one.clearance < 0.5]
    told = body_gaps_of(run_of(swing()).pair_minima, frozenset({"post", "table", "wall </script>"}))
    assert len(told) == len(near)
    for one, minimum in zip(told, near, strict=True):
        assert one["gap"] == minimum.clearance
        assert one["may_catch"] == [
            part for part, width in WIDTHS.items() if minimum.clearance < width
        ]


def test_pairs_that_both_stand_are_left_out(tmp_path):
    text = CASE.replace("xyz: [1.2, 0, 0]", "xyz: [0.2, 0.3, 0]")
    assert text != CASE
    file = write_case(tmp_path, text)
    found = cl.answer(cl.Question(cl.load_case(file), body_gaps=True))
    told = body_gaps_of(found.pair_minima, found.session.standing_bodies)
    pairs = {(one["body_a"], one["body_b"]) for one in told}
    nearest = {(one.link, one.obstacle): one.clearance for one in found.pair_minima}
    assert ("base", "post") in nearest and nearest["base", "post"] < 0.5
    assert pairs == {("upper", "post")}


def test_on_the_command_line(tmp_path, refusal, capsys):
    file = write_case(tmp_path, CASE.replace("xyz: [1.2, 0, 0]", "xyz: [0.2, 0.6, 0]"))
    run(["check", str(file), "--body-gaps"])
    assert "body gaps   " in capsys.readouterr().out
    told = refusal("check", file, "--body-gaps", "--need", "minimum")
    assert "body gaps need the least of every pair" in told
