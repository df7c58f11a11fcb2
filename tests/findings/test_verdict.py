"""One verdict: exit code, page, terminal, JUnit, JSON and `Run.passed` say the same; tolerances of whole runs."""

from __future__ import annotations

import dataclasses
from dataclasses import replace
from datetime import date
from pathlib import Path

import pytest

import clearance as cl
from clearance.findings.finding import NOT_PROVEN, TOLERANCES, WAIVED_TOLERANCES
from clearance.record.record import ProfileAnswer, Record
from clearance.report.topics.verdict import header
from clearance.simulate.measure import refine
from clearance.world.case import Limits
from clearance.world.notice import Notice, Severity
from clearance.world.rules import Waiver
from tests.findings.gates import load_gates
from tests.report.made import (
    content_of,
    page_of,
    printed,
    run_of,
    summary_of,
    verdict_of,
    write_junit,
)
from tests.report.records import disagreeing, record, with_steps
from tests.report.schemas import valid_suite
from tests.report.test_page import data_in

NO_LIMITS = Limits()
UNITS = Notice(Severity.SUSPECT, "units", "post.stl: 589 m away; is its scale missing?")
RULE = Notice(Severity.VIOLATED, "joint limits", "elbow leaves its limits by 0.1 rad")
FAR = Notice(Severity.WARNING, "units", "gate is 40 m from the arm, 20 times its reach")
WARNING = Notice(Severity.WARNING, "geometry", "links without a collision shape: antenna")
NOT_KEPT = ProfileAnswer(
    "floor", "xy", None, "outside", 0.02, False, False, -0.003, 1e-4, (0, 0), (0, 0), "fore", 7
)


def made(limits=NO_LIMITS, notices=(), accept=(), strict=False, **changes) -> Record:
    """The swing, stopped before it touches."""
    whole = record(limits=limits, **changes)
    if limits.fail > 0.0:
        return whole
    case = dataclasses.replace(whole.case, accept=tuple(accept), fail_on_warning=strict)
    short = with_steps(whole, whole.rows.at(slice(8)))
    return dataclasses.replace(short, case=case, notices=tuple(notices))


CASES = {
    "clear": (made(), "clear", 0),
    "near": (made(Limits(warn=0.2)), "near", 0),
    "contact": (record(limits=Limits(fail=0.01, warn=0.06)), "contact", 1),
    "profile": (made(profiles=(NOT_KEPT,)), "violated", 1),
    "suspect": (made(notices=(UNITS,)), "suspect", 2),
    "suspect and contact": (
        dataclasses.replace(record(), notices=(UNITS,)), "suspect", 2,
    ),
    "rule": (made(notices=(RULE,)), "violated", 1),
    "accepted": (made(notices=(UNITS,), accept=("units",)), "clear", 0),
    "another accepted": (made(notices=(UNITS,), accept=("limits",)), "suspect", 2),
    "warned": (made(notices=(WARNING,)), "clear", 0),
    "warned where that fails": (made(notices=(WARNING,), strict=True), "warning", 1),
    "warned and accepted": (made(notices=(WARNING,), accept=("geometry",), strict=True), "clear", 0),
    "accepted where warnings fail": (made(notices=(UNITS,), accept=("units",), strict=True), "clear", 0),
    "warned and accepted by code": (made(notices=(FAR,), accept=("CL120",), strict=True), "clear", 0),
    "suspect of an accepted code": (
        made(notices=(FAR, UNITS), accept=("CL120",), strict=True), "suspect", 2,
    ),
    "accepted by kind, both": (
        made(notices=(FAR, UNITS), accept=("units",), strict=True), "clear", 0,
    ),
    "suspect and warned": (made(notices=(UNITS, WARNING), strict=True), "suspect", 2),
    "disputed": (made(cross_check=disagreeing()), "clear", 3),
    "disputed and suspect": (made(notices=(UNITS,), cross_check=disagreeing()), "suspect", 3),
}  # fmt: skip


@pytest.mark.parametrize("name", CASES)
def test_every_answer_says_the_same(name, tmp_path):
    one, status, exit_code = CASES[name]
    verdict = verdict_of(one)
    assert (verdict.status, verdict.exit_code) == (status, exit_code)
    assert verdict.passed == (exit_code == 0)
    run, summary = run_of(one), summary_of(one)
    assert (run.status, run.passed, run.verdict) == (status, verdict.passed, verdict)
    said = (summary["verdict"], summary["passed"], summary["exit_code"])
    assert said == (status, verdict.passed, exit_code)
    assert summary["verdict_text"] == verdict.headline()
    assert "at the samples only" in verdict.headline()
    assert summary["basis"] == "samples" and summary["not_checked"] == ["self-collision"]
    write_junit(one, tmp_path / "junit.xml")
    suite = valid_suite(tmp_path / "junit.xml")
    assert (int(suite.get("failures")) == 0) == verdict.passed
    whole = suite.find("testcase[@classname='verdict']")
    failure = whole.find("failure")
    assert (failure is None) == verdict.passed
    told = whole.findtext("system-out") if failure is None else failure.get("message")
    assert "at the samples only" in told and "self-collision not checked" in told
    headline, second, *_ = printed(one)
    assert headline.startswith(verdict.headline(str.upper))
    unmeasured = "self-collision not checked [CL531]; not measured: 1 excluded link: base"
    assert second.strip() == unmeasured
    badge = header(content_of(one))
    assert "at the samples only" in badge.badge and "Self-collision not checked" in repr(badge)
    failing = {1: "violated", 3: "violated", 2: "suspect", 0: "near"}[exit_code]
    shade = "contact" if status == "contact" else failing
    assert badge.badge_kind == shade and data_in(page_of(one))["sampled"]
    assert not any(text.endswith(" never") for text in printed(one))
    suspects = [one.line for one in verdict.suspects]
    doubts = [*suspects, *verdict.warnings, "self-collision not checked"]
    assert all(one in text for one in doubts for text in (verdict.text(), str(run)))
    assert "Nothing was left out" not in page_of(one)
    assert "measured against every obstacle; self-collision not checked." in page_of(
        dataclasses.replace(one, unmeasured=())
    )
    for reason in verdict.reasons:
        assert reason in summary["reasons"] and reason in told


BOX = Path(__file__).parents[2] / "scenes" / "box_box" / "case.yaml"


def test_levels_that_no_sample_reaches_are_told_of_the_samples():
    lines = printed(made())
    for label in ("contact", "below fail", "below warn"):
        assert f"  {label:<12}not at the 8 samples" in lines
    whole = printed(cl.check(BOX, limits=NO_LIMITS))
    assert f"  {'contact':<12}never" in whole


def test_a_profile_that_is_not_kept_stands_on_top_beside_a_contact():
    one = dataclasses.replace(record(), profiles=(NOT_KEPT,))
    assert "; floor (outside, xy): NOT KEPT" in printed(one)[0]
    assert "Violated: floor (outside, xy): NOT KEPT" in repr(header(content_of(one)))


def test_the_method_of_the_paper_is_a_warning():
    found = cl.check(BOX, method="paper", paper_tolerance=0.4)
    assert "with a tolerance of 400 mm for its first rejection rule" in page_of(found)
    warnings = found.verdict.warnings
    assert len(warnings) == 1 and "pairs may have been left out" in warnings[0]
    assert warnings[0].endswith("[CL522]")
    assert not any("left out" in text for text in cl.check(BOX).verdict.warnings)


@pytest.mark.parametrize("name", ["fail", "warn"])
def test_a_limit_that_is_only_not_proven_says_so_below_the_headline(name, monkeypatch):
    """Nothing is below the limit, by a nanometre at most: the work of a proof to 0.1 mm does not tell."""
    monkeypatch.setattr(refine, "MOST_QUERIES", -1)
    case = cl.load_case(BOX)
    limit = float(cl.answer(cl.Question(case, certify_gap=1e-9)).certificate.lower_bound.min())
    limits = Limits(limit, limit) if name == "fail" else Limits(0.0, limit)
    run = cl.check(case, limits=limits)
    assert run.status == ("violated" if name == "fail" else "near")
    assert limit <= run.worst["clearance"] and "not proven" in run.verdict.unproven
    lines = printed(run)
    assert lines[2].startswith("  unproven ") and f"the {name} limit" in lines[2]
    assert "Not proven" in repr(header(content_of(run)))


@pytest.mark.parametrize("shown", [True, False])
def test_facets_are_told_where_they_matter(shown):
    """0.1 mm: nothing beside 31 mm, and much beside contact."""
    one = record()
    if not shown:
        one = with_steps(one, one.rows.at(slice(2)))
    bound = [line for line in printed(one) if line.startswith("  facets")]
    assert bool(bound) == (one.worst.clearance < 0.01) == shown
    assert not shown or "0.1 mm" in bound[0]


@pytest.mark.parametrize("name", ["profile", "rule"])
def test_what_decides_beside_clearances_stands_in_the_headline(name):
    one = CASES[name][0]
    verdict, (headline, *_) = verdict_of(one), printed(one)
    assert verdict.reasons[0] == verdict.beside[0]
    assert headline.startswith("VIOLATED")
    assert f": {verdict.beside[0]}; least clearance " in headline


def test_pairs_that_the_case_allows_and_links_that_it_excludes_are_counted_by_name(tmp_path):
    near = {"gate_a": (-0.5, 0.003), "gate_b": (0.5, 0.004), "gate_c": (0.0, 0.5)}
    allowed = cl.check(load_gates(tmp_path, near, "allow: [[box, 'gate_[ab]']]"))
    assert allowed.verdict.scope[1:] == (
        "not measured: 2 allowed pairs: box - gate_a, box - gate_b",
    )
    case = load_gates(tmp_path, near, "allow: [{between: [box, gate_a], until: 0.6}]")
    assert cl.check(case).verdict.scope[-1] == "not measured at times: 1 allowed pair: box - gate_a"
    assert len(cl.check(load_gates(tmp_path, near)).verdict.scope) == 1


@pytest.mark.parametrize(
    ("by", "start", "touch", "told"),
    [
        ("box", 0.0, "*", "not measured: 2 allowed pairs: gate_a - gate_c, gate_b - gate_c"),
        ("gate_a", 0.0, "box", "not measured: 1 allowed pair: box - gate_c"),
        ("gate_a", 0.5, "box", "not measured at times: 1 allowed pair: box - gate_c"),
    ],
)
def test_pairs_that_a_carried_part_may_touch_are_counted_as_allowed_ones(
    tmp_path, by, start, touch, told
):
    """What carries it moves with it, and is no allowed pair."""
    near = {"gate_a": (-0.5, 0.003), "gate_b": (0.5, 0.004), "gate_c": (0.0, 0.5)}
    carried = f"carry: [{{part: gate_c, by: {by}, from: {start}, touch: ['{touch}']}}]"
    assert cl.check(load_gates(tmp_path, near, carried)).verdict.scope[1:] == (told,)


GATES = {"left": (-0.5, 0.003), "right": (0.5, 0.008)}
WAIVER = Waiver(("*", "left"), at_least=0.002, reason="known", by="J. Doe", until=date(2999, 1, 1))


def asked(folder, xyz, *, gates=GATES, waivers=(WAIVER,), **others):
    case = replace(load_gates(folder, gates), waivers=tuple(waivers))
    return cl.check(case, tolerance={"base": {"xyz": xyz}, **others})


def kinds(run):
    return [one.kind for one in run.findings if one.status == NOT_PROVEN]


@pytest.mark.parametrize(
    ("xyz", "status", "found"),
    [
        (0.0005, "near", []),
        (0.0015, "not proven", [WAIVED_TOLERANCES]),
        (0.0035, "not proven", [WAIVED_TOLERANCES, TOLERANCES]),
    ],
)
def test_waived_pairs_are_held_against_their_waiver(tmp_path, xyz, status, found):
    run = asked(tmp_path, xyz)
    assert (run.status, sorted(kinds(run)), run.passed) == (status, sorted(found), not found)
    assert run.verdict.n_waivers == 1


def test_what_is_proven_of_a_waiver_is_that_of_its_pairs(tmp_path):
    run = asked(tmp_path, 0.0015)
    (finding,) = [one for one in run.findings if one.kind == WAIVED_TOLERANCES]
    assert (finding.body_a, finding.body_b) == ("*", "left")
    assert finding.proven == pytest.approx(0.0015, abs=1e-4)
    assert "not proven to keep the 2 mm of its waiver with the tolerances" in run.verdict.reasons[0]
    assert "mm proven, 2 mm required by a waiver)" in run.verdict.headline()
    write_junit(run, tmp_path / "junit.xml")
    assert 'classname="tolerances"' in (tmp_path / "junit.xml").read_text()


def test_what_waived_pairs_keep_is_told_against_their_waiver(tmp_path):
    run = asked(tmp_path, 0.0005)  # 3 mm less 0.5 mm, waived to 2 mm; 8 mm less 0.5 mm, of 5 mm
    rows = run.summary["tolerances"]["rules"]
    keys = ("waived", "fail", "keeps", "proven")
    assert [[row[key] for key in keys] for row in rows] == [
        [None, 0.005, True, pytest.approx(0.0075, abs=1e-4)],
        [["*", "left"], 0.002, True, pytest.approx(0.0025, abs=1e-4)],
    ]
    (base,) = rows[1]["worst"][0]["sources"]
    assert 0.0009 < base["largest"][0] <= 0.001  # a proof is off by 0.1 mm at most
    lines = printed(run)
    assert any("keeps the 2 mm of its waiver, others as given: base of" in one for one in lines)
    assert not any("not enough" in one for one in lines)
