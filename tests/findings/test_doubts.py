"""What stands beside findings, as a truth table: a run in doubt is not as good as one that finds as little."""

from __future__ import annotations

import dataclasses
import json

import pytest

import clearance as cl
from clearance.errors import BadInput
from clearance.findings.comparison import compared
from clearance.findings.doubts import DISPUTED, NOT_CHECKED, Doubt
from clearance.findings.findings_file import (
    FindingList,
    findings_text,
    read_findings,
)
from clearance.findings.known_less import known_less
from clearance.report.comparison_text import comparison_text, doubt_lines
from clearance.run import Question, Run, answer
from clearance.world.case import Clock, Limits
from clearance.world.notice import Notice, Severity
from clearance.world.rules import Rule
from clearance.world.timing import Window
from tests.findings.gates import load_gates
from tests.findings.test_waivers import TODAY, waiver
from tests.formats.making_cell import DOOR, load_cell

A = "gate_a"
CLEAR = {A: (-0.5, 0.05), "gate_b": (0.5, 0.05)}
BROKEN = {A: (-0.5, 0.003), "gate_b": (0.5, 0.05)}

SUSPECT = Notice(Severity.SUSPECT, "units", "CHECK UNITS: gate_a is 1000 m long")
OTHER = Notice(Severity.SUSPECT, "units", "CHECK UNITS: gate_b is 1000 m long")
WARNING = Notice(Severity.WARNING, "geometry", "2 solids are left out")


def dropped(file: str) -> Notice:
    return Notice(Severity.WARNING, "geometry", f"{file}: 2 solids are left out")


def far(distance: str) -> Notice:
    return Notice(Severity.WARNING, "units", f"gate_a stays {distance} and more away")


def ruled(between=("box", "gate_b"), **rule) -> Limits:
    return Limits(0.005, 0.02, rules=(Rule(between, name="r", **rule),))


def run_of(folder, gates=CLEAR, *extra: str, certify=True, method="exact", **changes) -> Run:
    case = dataclasses.replace(load_gates(folder, gates, *extra), **changes)
    return answer(Question(case, today=TODAY, certify=certify, method=method))


def listed(folder, *given, **changes) -> FindingList:
    return run_of(folder, *given, **changes).finding_list


TABLE = {
    # what: before, now, passed, word of the headline, line
    "nothing": ({}, {}, True, "", ""),
    "suspect now": ({}, {"notices": (SUSPECT,)}, False, "NEW suspect input;", "new: suspect units: CHECK UNITS"),
    "suspect before": ({"notices": (SUSPECT,)}, {}, True, "", "gone: suspect units: CHECK UNITS"),
    "suspect as before": (
        {"notices": (SUSPECT,)}, {"notices": (SUSPECT,)}, True, "suspect input as before", "as before: suspect",
    ),
    "suspect otherwise": ({"notices": (SUSPECT,)}, {"notices": (OTHER,)}, False, "NEW suspect input", "gate_b"),
    "two suspect": ({}, {"notices": (SUSPECT, OTHER)}, False, "NEW suspect input (2)", "gate_b"),
    "suspect and accepted": (
        {}, {"notices": (SUSPECT,), "accept": ("units",)}, True, "", "new: accepted: CHECK UNITS",
    ),
    "accepted no more": (
        {"notices": (SUSPECT,), "accept": ("units",)}, {"notices": (SUSPECT,)}, False, "NEW suspect input",
        "gone: accepted",
    ),
    "input dropped": ({}, {"notices": (WARNING,)}, False, "NEW warning", "new: warning geometry: 2 solids"),
    "input dropped before": ({"notices": (WARNING,)}, {}, True, "", "gone: warning"),
    "input dropped in both": ({"notices": (WARNING,)}, {"notices": (WARNING,)}, True, "", ""),
    "a note": ({}, {"notes": ("units are mm",)}, True, "", "new: note: units are mm"),
    "many notes, as of a file with another name": (
        {"notes": tuple("abc")}, {"notes": tuple("defgh")}, True, "", "notes: 5 new, 3 gone",
    ),
    "proven no more": ({}, {"certify": False}, False, "LESS IS KNOWN", "less is known: the motion was proven"),
    "proven now": ({"certify": False}, {}, True, "", ""),
    "by the paper's method": (
        {}, {"method": "paper", "certify": False}, False, "LESS IS KNOWN", "without guarantee",
    ),
    "clocks are let go": ({}, {"clock": Clock(0.5)}, True, "", ""),
    "clocks are tied": ({"clock": Clock(0.5)}, {}, False, "LESS IS KNOWN", "clock slack was 0.5 s, and is 0 s"),
    "clocks are bounded": (
        {"clock": Clock(float("inf"))}, {"clock": Clock(0.5)}, False, "LESS IS KNOWN",
        "was not tied, and is 0.5 s",
    ),
    "a pair is let off": (
        {}, {"extra": "allow: [[box, gate_b]]"}, False, "LESS IS KNOWN",
        "not measured as before: box - gate_b",
    ),
    "limits are softer": (
        {}, {"limits": Limits(0.001, 0.02)}, False, "LESS IS KNOWN",
        "fail limit of box - gate_a and 1 more: now 1 mm, and was 5 mm",
    ),
    "less is called near": ({}, {"limits": Limits(0.005, 0.01)}, True, "", ""),
    "limits are stricter": ({}, {"limits": Limits(0.006, 0.03)}, True, "", ""),
    "joints beyond their limits only warn": (
        {"limits": Limits(0.005, 0.02, "fail")}, {}, False, "LESS IS KNOWN", "beyond their limits no longer",
    ),
    "joints beyond their limits fail": ({}, {"limits": Limits(0.005, 0.02, "fail")}, True, "", ""),
    "a softer rule": (
        {}, {"limits": ruled(fail=0.0)}, False, "LESS IS KNOWN", "fail limit of box - gate_b: now 0 mm",
    ),
    "a stricter rule": ({}, {"limits": ruled(fail=0.01)}, True, "", ""),
    "a stricter rule is gone": (
        {"limits": ruled(fail=0.01)}, {}, False, "LESS IS KNOWN", "now 5 mm, and was 10 mm",
    ),
    "a softer rule holds longer": (
        {"limits": ruled(fail=0.0, window=Window(0.0, 0.5))},
        {"limits": ruled(fail=0.0, window=Window(0.0, 1.5))},
        False, "LESS IS KNOWN",
        "now 0 mm from 0 s until 1.5 s, else 5 mm, and was 0 mm from 0 s until 0.5 s, else 5 mm",
    ),
    "a rule of the same limit": ({}, {"limits": ruled(between=("gate_?", "box"), fail=0.005)}, True, "", ""),
    "a file has another name": (
        {"notices": (dropped("a.stl"),)}, {"notices": (dropped("parts/a_v2.STL"),)}, True, "",
        "changed: warning geometry: parts/a_v2.STL: 2 solids",
    ),
    "a second file": (
        {"notices": (dropped("a.stl"),)}, {"notices": (dropped("a.stl"), dropped("b.stl"))}, False, "NEW warning;",
        "new: warning geometry: b.stl",
    ),
    "a figure is another": (
        {"notices": (far("7.34 m"),)}, {"notices": (far("8 m"),)}, True, "", "changed: warning units",
    ),
    "a waiver is unused or expired": ({}, {"waivers": (waiver(),)}, False, "NEW unused waiver", "is not needed"),
    "a waiver is as stale": (
        {"waivers": (waiver(),)}, {"waivers": (waiver(),)}, True, "unused waiver as before", "is not needed",
    ),
}  # fmt: skip


@pytest.mark.parametrize("what", TABLE)
def test_what_stands_beside_the_findings_of_two_runs(what, tmp_path):
    before, now, passed, word, line = TABLE[what]
    lists = []
    for name, given in (("before", before), ("now", now)):
        extra = [given[key] for key in given if key == "extra"]
        changes = {key: value for key, value in given.items() if key != "extra"}
        run = run_of(tmp_path / name, CLEAR, *extra, **changes)
        lists.append(run.finding_list)
        assert run.passed is not (
            any(one.fails for one in (*lists[-1].doubts, *lists[-1].findings))
        )
    comparison = compared(*lists)
    assert comparison.passed is passed
    assert word in comparison_text(comparison)
    assert line in "\n".join(doubt_lines(comparison))
    assert bool(line) == bool(doubt_lines(comparison))


def test_a_dispute_and_a_part_that_is_not_checked_are_new_once(tmp_path):
    before = listed(tmp_path)
    for doubt, word in (
        (Doubt(DISPUTED, "FCL", "FCL disagrees at 2 of 9 steps"), "NEW dispute with a peer"),
        (Doubt(NOT_CHECKED, "", "surroundings (the scene is empty)"), "NEW part not checked"),
    ):
        now = dataclasses.replace(before, doubts=(doubt, *before.doubts))
        assert not compared(before, now).passed and word in comparison_text(compared(before, now))
        assert compared(now, before).passed and compared(now, now).passed


def test_a_shorter_run_and_fewer_moves_are_told_and_fail_nothing(tmp_path):
    moved = dataclasses.replace(listed(tmp_path).measured, moving=("rod", "cart"))
    before = dataclasses.replace(listed(tmp_path), duration=20.6, n_moves=6, measured=moved)
    still = dataclasses.replace(moved, moving=("rod",))
    now = dataclasses.replace(before, duration=12.25, n_moves=4, measured=still)
    assert compared(before, now).passed and doubt_lines(compared(now, before)) == []
    assert doubt_lines(compared(before, now)) == [
        "shorter: what moved before has no motion any more: cart",
        "shorter: the run takes 12.250 s, and took 20.600 s",
        "shorter: programs make 4 moves, and made 6",
    ]
    assert listed(tmp_path).duration == 2.0 and len(listed(tmp_path).measured.moving) == 1


def test_an_obstacle_that_is_smaller_is_named_and_one_that_is_larger_is_not(tmp_path):
    case = load_gates(tmp_path, CLEAR)
    gate = case.obstacles[0]
    narrow = dataclasses.replace(gate.body, shape=cl.box((0.06, 0.1, 0.1)))
    wide = dataclasses.replace(gate.body, shape=cl.box((0.1, 0.1, 0.1)))
    obstacles = [
        (dataclasses.replace(gate, body=one), *case.obstacles[1:]) for one in (wide, narrow)
    ]
    before, now = (
        cl.check(dataclasses.replace(case, obstacles=one)).finding_list for one in obstacles
    )
    told = "smaller: gate_a 60 x 100 x 100 mm, was 100 x 100 x 100 mm"
    assert doubt_lines(compared(before, now)) == [told]
    assert doubt_lines(compared(now, before)) == []


def test_smaller_tolerances_are_less_known_and_greater_ones_are_not(tmp_path):
    case = load_gates(tmp_path, CLEAR)
    bases = ({"xyz": 0.002, "angle": 0.001}, {"xyz": 1e-4, "angle": 0.001})
    found = [cl.check(case, tolerance={"base": base}).finding_list for base in bases]
    assert compared(*found[::-1]).passed and not compared(*found).passed
    assert doubt_lines(compared(*found)) == [
        "less is known: tolerances are smaller (m, rad, s): place of base of gantry_box 0.0001, was 0.002"
    ]


def test_less_padding_is_less_known_and_more_is_not(tmp_path):
    found = []
    for i, padding in enumerate((0.01, 0.004)):
        case = load_gates(tmp_path / str(i), CLEAR)
        first, *others = case.obstacles
        obstacles = (dataclasses.replace(first, padding=padding), *others)
        found.append(answer(Question(dataclasses.replace(case, obstacles=obstacles))).finding_list)
    assert compared(*found[::-1]).passed and not compared(*found).passed
    assert doubt_lines(compared(*found)) == [
        "less is known: padding of gate_a: now 4 mm, and was 10 mm"
    ]


@pytest.mark.parametrize("lost", ["profile", "tolerances"])
def test_a_check_that_is_asked_no_more_is_less(lost, tmp_path):
    now = listed(tmp_path)
    measured = dataclasses.replace(now.measured, tolerances="c0ffee")
    outline = dataclasses.replace(now.findings[0], kind="profile", rule="door", status="clear")
    before = {
        "profile": dataclasses.replace(now, findings=(*now.findings, outline)),
        "tolerances": dataclasses.replace(now, measured=measured),
    }[lost]
    assert not compared(before, now).passed and compared(before, before).passed
    (line,) = doubt_lines(compared(before, now))
    assert lost in line and line.startswith("less is known")


@pytest.mark.parametrize(
    ("was", "is_now", "line"),
    [
        (("outside, xy", 0.02), ("outside, xy, only l1", 0.02),
         "profile door: outside, xy, only l1; and was outside, xy"),
        (("outside, xy, only nearest_link", 0.02), ("outside, xy, only nearest_link", 0.01),
         "limit of profile door: now 10 mm, and was 20 mm"),
        (("nearest, xy", 0.02), ("nearest, xy", 0.03), "limit of profile door: now 30 mm, and was 20 mm"),
    ],
)  # fmt: skip
def test_a_profile_that_is_judged_by_less_is_known_less(was, is_now, line, tmp_path):
    now = listed(tmp_path)
    outline = dataclasses.replace(now.findings[0], kind="profile", rule="door", status="clear")
    before, after = (
        dataclasses.replace(
            now, findings=(*now.findings, dataclasses.replace(outline, text=text, fail=fail))
        )
        for text, fail in (was, is_now)
    )
    assert not compared(before, after).passed
    assert f"less is known: {line}" in doubt_lines(compared(before, after))
    if was[1] != is_now[1]:
        assert compared(after, before).passed


def test_what_is_not_listed_hides_what_is_broken(tmp_path):
    before, now = listed(tmp_path / "a"), listed(tmp_path / "b", BROKEN)
    as_broken = dataclasses.replace(before, findings=now.findings)
    assert compared(as_broken, now).passed
    for cut in (
        dataclasses.replace(now, incomplete="only the least"),
        dataclasses.replace(now, not_listed=7),
    ):
        assert not compared(as_broken, cut).passed and compared(cut, cut).passed


def test_doubts_read_back_as_they_were_written(tmp_path):
    found = listed(tmp_path, notices=(SUSPECT, WARNING), clock=Clock(float("inf")))
    (tmp_path / "findings.json").write_text(findings_text(found))
    told = json.loads(findings_text(found))
    assert [one["code"] for one in told["doubts"]] == ["CL120", "CL531", "CL221", "CL130"]
    assert {one["code"] for one in told["findings"]} == {"CL501"}
    assert read_findings(tmp_path) == found and found.measured.clock_slack == "not tied"
    assert [one.kind for one in found.doubts][:2] == ["suspect", "not checked"]


def test_pairs_beyond_any_cell_are_refused(tmp_path):
    found = listed(tmp_path)
    names = tuple(map(str, range(1500)))
    block = dataclasses.replace(found.measured.pairs[0], a=names, b=names)
    measured = dataclasses.replace(found.measured, unmeasured=(block,))
    (tmp_path / "findings.json").write_text(
        findings_text(dataclasses.replace(found, measured=measured))
    )
    with pytest.raises(BadInput, match=r"measured\.unmeasured.*2,250,000 pairs"):
        read_findings(tmp_path)


def test_what_is_in_the_cell_for_less_time_is_known_less(tmp_path):
    """The door's table was cut short: it is gone after 0.4 s, which says nothing of the rest."""
    absent = "moves: door.csv", "moves: {file: door.csv, after: absent}"
    cut = "\n".join(DOOR.splitlines()[:-1]) + "\n"
    runs = [
        cl.check(load_cell(tmp_path, *absent, door=door), certify=False) for door in (DOOR, cut)
    ]
    whole, short = (run.finding_list for run in runs)
    assert whole.measured.present == {} and short.measured.present == {"door": 0.4}
    (line,) = [one for one in known_less(whole, short) if "in the cell" in one]
    assert line == "door is in the cell for 0.400 s, and was for 1.000 s"
    assert not any("in the cell" in one for one in known_less(short, whole))
    assert not any("in the cell" in one for one in known_less(short, short))
