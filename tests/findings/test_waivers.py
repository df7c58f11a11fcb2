"""Waivers as a truth table: what is waived, what fails, and what the verdict says."""

from __future__ import annotations

import dataclasses
import itertools
from datetime import date

import numpy as np
import pytest

from clearance.batch.rows import row_of
from clearance.case.waiver_file import load_waivers
from clearance.errors import BadInput
from clearance.findings.comparison import compared
from clearance.report.comparison_text import comparison_text, doubt_lines
from clearance.report.glb import glb_of
from clearance.report.model import PageContent
from clearance.report.moveit_moments import moments_of
from clearance.report.still import still_of
from clearance.report.topics.verdict import header
from clearance.run import Question, Run, answer
from clearance.simulate.measure import refine
from clearance.world.case import Limits
from clearance.world.rules import Rule, Waiver
from tests.findings.gates import load_gates
from tests.report.made import page_of, printed
from tests.report.test_page import data_in

TODAY = date(2026, 11, 1)
FAIL = 0.005
A, B = "gate_a", "gate_b"
NEAR_A = {A: (-0.5, 0.003)}
NEAR_BOTH = {A: (-0.5, 0.003), B: (0.5, 0.004)}
A_CLEAR = {A: (-0.5, 0.1)}
A_WARNS = {A: (-0.5, 0.015)}
TOUCHES = {A: (-0.5, 0.0)}
TOGETHER = {A: (0.0, 0.003), B: (0.05, 0.0045)}
"""At the same times; that b is below the limit as well, a is nearer."""


def waiver(gate: str = A, at_least: float = 0.002, until: str = "2027-03-31", **changes) -> Waiver:
    given = {"reason": "the gate gives way", "by": "N. N."} | changes
    return Waiver(("box", gate), at_least=at_least, until=date.fromisoformat(until), **given)


def checked(folder, gates, *waivers: Waiver, limits: Limits | None = None, **changes) -> Run:
    case = dataclasses.replace(load_gates(folder, gates), waivers=waivers)
    case = case if limits is None else dataclasses.replace(case, limits=limits)
    return answer(Question(case, today=TODAY, **changes))


CLEAR, VIOLATED, CONTACT, UNUSED_WAIVER = "clear", "violated", "contact", "unused waiver"

TABLE = {
    # what: gates, waivers, status, exit code, n waivers, names of waived, a word of a reason
    "no waiver": (NEAR_A, [], VIOLATED, 1, 0, [], "below the fail limit"),
    "covered": (NEAR_A, [waiver()], CLEAR, 0, 1, [A], ""),
    "to its last day": (NEAR_A, [waiver(until="2026-11-01")], CLEAR, 0, 1, [A], ""),
    "expired": (NEAR_A, [waiver(until="2026-10-31")], VIOLATED, 1, 0, [], "has expired on 2026-10-31"),
    "expired and not needed": (A_CLEAR, [waiver(until="2026-10-31")], UNUSED_WAIVER, 1, 0, [], "has expired"),
    "not needed": (A_CLEAR, [waiver()], UNUSED_WAIVER, 1, 0, [], "is not needed"),
    "not needed for a near miss": (A_WARNS, [waiver()], UNUSED_WAIVER, 1, 0, [], "is not needed"),
    "worse than it": (NEAR_A, [waiver(at_least=0.0035)], VIOLATED, 1, 0, [], "less occurs"),
    "exactly it": (NEAR_A, [waiver(at_least=0.003)], CLEAR, 0, 1, [A], ""),
    "contact": (TOUCHES, [waiver(at_least=0.0)], CONTACT, 1, 0, [], "does not cover contact"),
    "another is worse": (NEAR_BOTH, [waiver()], VIOLATED, 1, 1, [A], "box - gate_b"),
    "both covered": (NEAR_BOTH, [waiver(), waiver(B)], CLEAR, 0, 2, [A, B], ""),
    "one for both": (NEAR_BOTH, [waiver("gate_*")], CLEAR, 0, 1, [A, B], ""),
    "the last counts": (NEAR_A, [waiver(at_least=0.004), waiver()], UNUSED_WAIVER, 1, 1, [A], "a later waiver"),
    "the last counts and fails": (NEAR_A, [waiver(), waiver(at_least=0.004)], VIOLATED, 1, 0, [], "less occurs"),
    "an expired one counts for nothing": (
        NEAR_A, [waiver(), waiver(at_least=0.0, until="2026-10-31")], UNUSED_WAIVER, 1, 1, [A], "has expired",
    ),
    "hides nothing behind it": (TOGETHER, [waiver()], VIOLATED, 1, 1, [A], "box - gate_b"),
    "of another case": (NEAR_A, [waiver(case="weld_*")], VIOLATED, 1, 0, [], "below the fail limit"),
    "of this case": (NEAR_A, [waiver(case="gat*")], CLEAR, 0, 1, [A], ""),
    "of another case, clear": (A_CLEAR, [waiver(case="weld_*")], CLEAR, 0, 0, [], ""),
    "of its rule": (NEAR_A, [waiver(rule="default")], CLEAR, 0, 1, [A], ""),
    "of another rule": (NEAR_A, [waiver(rule="fence")], VIOLATED, 1, 0, [], "no rule is called 'fence'"),
    "a misspelt body": (NEAR_A, [waiver("gate_aa")], VIOLATED, 1, 0, [], "did you mean 'gate_a'?"),
    "bodies in the other order": (
        NEAR_A, [dataclasses.replace(waiver(), between=(A, "box"))], CLEAR, 0, 1, [A], "",
    ),
}  # fmt: skip


@pytest.mark.parametrize("what", TABLE)
@pytest.mark.parametrize("need", ["steps", "limit"])
def test_truth_table(what, need, tmp_path):
    gates, waivers, status, exit_code, n_waivers, waived, told = TABLE[what]
    run = checked(tmp_path, gates, *waivers, need=need)
    verdict = run.verdict
    assert (verdict.status, verdict.exit_code, verdict.n_waivers) == (status, exit_code, n_waivers)
    assert run.passed is (exit_code == 0)
    assert any(told in reason for reason in verdict.reasons) if told else not verdict.reasons
    found = run.findings
    assert sorted(f.body_b for f in found if f.waived is not None) == sorted(waived)
    assert len(verdict.waived) == len(waived)
    assert any(f.fails for f in found) == (verdict.measured in (VIOLATED, CONTACT))
    for line in verdict.waived:
        assert ("the gate gives way" in line and "N. N." in line and "2027" in line) or waived
    if n_waivers:
        assert f"with {n_waivers} waiver" in verdict.headline()


@pytest.mark.parametrize("certify", [True, False])
def test_what_is_waived_keeps_its_name_and_says_what_is_proven(certify, tmp_path):
    plain = checked(tmp_path, NEAR_BOTH, certify=certify).findings
    waived = checked(tmp_path, NEAR_BOTH, waiver(), certify=certify).findings
    assert {f.id for f in plain} == {f.id for f in waived} and len(plain) == 2
    (one,) = [f for f in waived if f.waived is not None]
    assert one.broken and not one.fails
    if certify:
        assert 0.0029 <= one.waived.proven <= 0.003 + 1e-9
    else:
        assert one.waived.proven is None


def test_a_level_that_is_seen_to_be_kept_and_not_proven_to_be_covers_nothing(tmp_path, monkeypatch):
    monkeypatch.setattr(refine, "MOST_QUERIES", -1)
    run = checked(tmp_path, NEAR_A, waiver(at_least=0.00299))
    (finding,) = run.findings
    assert finding.proven < 0.00299 < finding.clearance and finding.waived is None
    assert run.verdict.status == VIOLATED and "which is not proven" in run.verdict.reasons[-1]


TEXT = """
- {between: [box, gate_a], at_least: 0.002, reason: "gives  way", by: N. N., until: 2027-03-31}
- {case: "weld_*", rule: fence, between: ["*", gate_b], at_least: 0, reason: r, by: b, until: "2027-01-01"}
"""


def test_what_fails_beside_a_waiver_is_told_first(tmp_path):
    """Gate b fails with 4 mm; gate a is nearer with 3 mm, and waived."""
    run = checked(tmp_path, NEAR_BOTH, waiver())
    headline, *lines = printed(run)
    assert "4.000 mm, below the fail limit of 5 mm: box - gate_b" in headline
    assert next(line for line in lines if line.startswith("  worst")).endswith("box - gate_b")
    assert any(line.startswith("  nearest") and "gate_a" in line for line in lines)
    summary, head = run.summary, repr(header(PageContent(run.summary, run.verdict)))
    assert summary["worst"]["obstacle"] == B and summary["nearest"]["obstacle"] == A
    assert "box and gate_b" in head and "4.000" in head
    assert "gate_b" in repr(run)
    shown = data_in(page_of(run))
    pair = shown["pairs"][shown["worst_pair"]]
    assert [shown["bodies"][i]["name"] for i in pair["bodies"]] == ["box", B]
    assert printed(checked(tmp_path / "alone", NEAR_A))[0].endswith("): box - gate_a")
    near = checked(tmp_path / "near", NEAR_A | {B: (0.5, 0.015)}, waiver())
    assert (near.status, near.worst["obstacle"]) == ("near", B)
    assert "15.00 mm, below the warn limit of 20 mm: box - gate_b" in printed(near)[0]


def test_a_file_of_waivers(tmp_path):
    (tmp_path / "waivers.yaml").write_text(TEXT)
    first, second = load_waivers(tmp_path / "waivers.yaml")
    assert first.between == ("box", "gate_a") and first.until == date(2027, 3, 31)
    assert (first.at_least, first.reason, first.case, first.rule) == (0.002, "gives way", "*", "*")
    assert first.where == "waivers.yaml: waivers[0]" and "waivers[0]" in str(first)
    assert (second.case, second.rule, second.until) == ("weld_*", "fence", date(2027, 1, 1))


def test_a_case_names_its_files_of_waivers(tmp_path):
    (tmp_path / "waivers.yaml").write_text(TEXT)
    case = load_gates(tmp_path, NEAR_A, "waivers: [waivers.yaml]")
    assert len(case.waivers) == 2
    assert "waivers.yaml" in [source.path for source in case.sources]
    run = answer(Question(case, today=TODAY))
    assert run.passed and run.verdict.n_waivers == 1
    assert len(run.judgement.uses) == 1
    assert "waivers of other cases, not used here: 1 waiver" in run.summary["notes"]


@pytest.mark.parametrize(
    ("text", "told"),
    [
        ("a: 1", "no list of waivers"),
        ("- 3", "waivers[0]: 3 is given; a mapping is needed"),
        ("- {between: [a, b], at_least: -0.1, reason: r, by: b, until: 2027-01-01}", "waivers[0].at_least"),
        ("- {between: [a], at_least: 0.1, reason: r, by: b, until: 2027-01-01}", "2 values are needed"),
        ("- {between: [a, b], at_least: 0.1, reason: '', by: b, until: 2027-01-01}", "waivers[0].reason"),
        ("- {between: [a, b], at_least: 0.1, reason: r, by: b}", "'until' is missing"),
        (
            "- {between: [a, b], at_least: 0.1, reason: r, by: b, until: 2027-02-30}",
            "waivers.yaml: waivers[0].until: 2027-02-30 is given; a day, as 2027-03-31",
        ),
        ("- {between: [a, b], at_least: 0.1, reason: r, by: b, until: 7}", "a day, as 2027-03-31"),
        ("- {between: [a, b], atleast: 0.1, reason: r, by: b, until: 2027-01-01}", "did you mean 'at_least'?"),
    ],
)  # fmt: skip
def test_a_bad_file_of_waivers_is_refused_in_one_line(text, told, tmp_path):
    (tmp_path / "waivers.yaml").write_text(text)
    with pytest.raises(BadInput) as error:
        load_waivers(tmp_path / "waivers.yaml")
    assert told in str(error.value)
    with pytest.raises(BadInput, match=r"case\.yaml: waivers"):
        load_gates(tmp_path, NEAR_A, "waivers: [waivers.yaml]")


def test_a_waiver_in_memory_is_checked_too():
    faults = {"at_least": (-1e-9, "0 or more"), "reason": (" ", "no reason"), "by": ("", "no by")}
    for name, (value, told) in faults.items():
        with pytest.raises(BadInput, match=told):
            waiver(**{name: value})


@pytest.mark.slow
def test_what_is_waived_counts_as_if_it_were_not_there(tmp_path):
    """Waived to any distance, pairs that touch nowhere leave the verdict of all others, however many."""
    gaps = (0.003, 0.004, 0.015, 0.002, 0.1)
    gates = {f"gate_{i}": (-0.8 + 0.2 * i, gap) for i, gap in enumerate(gaps)}
    broken = [name for name, (_, gap) in gates.items() if gap < FAIL]
    for n_waived in range(1, len(broken) + 1):
        for names in itertools.combinations(broken, n_waived):
            run = checked(tmp_path, gates, *(waiver(name, at_least=0.0) for name in names))
            left = {name: place for name, place in gates.items() if name not in names}
            alone = checked(tmp_path, left)
            assert run.verdict.measured == alone.verdict.measured
            assert run.verdict.n_waivers == n_waived and run.passed is alone.passed
            assert {f.id for f in run.findings if not f.waived} == {f.id for f in alone.findings}


def test_a_pair_that_only_dips_between_the_steps_while_a_waived_one_is_nearer_is_found(tmp_path):
    """Both gates are passed between two samples, where the certificate of all pairs names the nearer one."""
    gates = {A: (0.0, 0.003), B: (0.02, 0.0045)}
    limits = "{fail: 0.005, warn: 0.005}"
    case = load_gates(tmp_path, gates, limits=limits, n_steps=4)
    plain = answer(Question(case))
    assert [f.body_b for f in plain.findings if f.broken] == [A, B]
    assert all(finding.between for finding in plain.findings)
    run = answer(Question(dataclasses.replace(case, waivers=(waiver(),)), today=TODAY))
    assert not run.passed and run.verdict.n_waivers == 1
    assert [f.body_b for f in run.findings if f.fails] == [B]


def test_every_answer_of_one_moment_is_of_what_fails(tmp_path):
    """Gate b fails with 4.5 mm while gate a, nearer and waived, is beside it: slopes are of b alone."""
    run = checked(tmp_path, TOGETHER, waiver())
    assert (run.worst["obstacle"], run.worst["status"]) == (B, VIOLATED)
    assert run.verdict.reservations[0].startswith("nearest of all 3.000 mm")
    assert run.worst["clearance"] == run.worst_sample["clearance"] == pytest.approx(0.0045)
    row, (moment, *_) = row_of(run), moments_of(run.report)["moments"]
    assert (row["body_b"], row["clearance"]) == (B, run.worst["clearance"])
    assert [body.get("id") for body in moment["bodies"]] == [None, B]
    slopes = run.summary["sensitivity"]
    assert slopes["pairs"] == [["box", B]]
    rates = [one for one in slopes["rates"] if one["kind"] == "obstacle"]
    of_gates = {(one["of"], one["name"]): one["more"] for one in rates}
    assert of_gates == pytest.approx({(B, "x"): 0.0, (B, "y"): 1.0, (B, "z"): 0.0}, abs=1e-6)
    still, replay = still_of(run.replay()), run.replay()
    assert [still.bodies[i].name for i in still.nearest] == ["box", B]
    assert np.linalg.norm(still.line[1] - still.line[0]) == pytest.approx(0.0045)
    assert f'"bodies":["box","{B}"]'.encode() in glb_of(run.record, replay, run.verdict.worst)


def test_the_nearest_moment_is_the_least_clearance_whatever_judges_or_waives_it(tmp_path):
    gates = {A: (-0.5, 0.003), B: (0.0, 0.020), "fence": (0.5, 0.050)}
    limits = Limits(0.005, 0.01, rules=(Rule(("box", "fence"), name="wide", fail=0.1),))
    for waivers in ((), (waiver(),)):  # `wide` is broken by 50 mm, the default limits by 2
        run = checked(tmp_path, gates, *waivers, limits=limits)
        found = [(one["obstacle"], one["clearance"]) for one in (run.worst, run.nearest)]
        assert found == [("fence", pytest.approx(0.05)), (A, pytest.approx(0.003))]
    rest = checked(tmp_path, {A: (-0.5, 0.003), B: (0.0, 0.004)}, waiver())
    assert (rest.worst["obstacle"], rest.nearest["obstacle"]) == (B, A)


def test_a_comparison_names_what_is_newly_waived(tmp_path):
    bare, waived, lower = (
        checked(tmp_path, NEAR_A, *waivers).finding_list
        for waivers in ((), (waiver(),), (waiver(at_least=0.001),))
    )
    line = "newly waived: box - gate_a: to at least {} mm until 2027-03-31 by N. N.: the gate gives way"
    for before, now, level in ((bare, waived, 2), (bare, lower, 1), (waived, lower, 1)):
        found = compared(before, now)
        assert found.passed and doubt_lines(found) == [line.format(level)]
        assert comparison_text(found).startswith("since the baseline: 1 finding newly waived; ")
    for before, now in ((waived, bare), (lower, waived), (lower, lower)):
        assert compared(before, now).excused == ()


@pytest.mark.slow
def test_a_waiver_of_every_pair_is_warned_of_and_one_of_some_pairs_is_not(tmp_path):
    every = dataclasses.replace(waiver(), between=("*", "*"))
    told = {one: checked(tmp_path, NEAR_A, one).verdict.warnings for one in (every, waiver("*"))}
    line = "waiver * - * is for every pair: it waives later faults too, down to 2 mm [CL512]"
    assert told == {every: (line,), waiver("*"): ()}
    gate_rule = Rule(("box", A), name="gate", fail=0.0045)
    two_rules = Limits(FAIL, rules=(gate_rule,))
    gates = {**NEAR_A, B: (0.5, 0.2)}
    for rule, limits, is_told in (
        ("?*", None, True),
        ("default", None, True),
        ("*t*", two_rules, True),
        ("default", two_rules, False),
        ("gate", two_rules, False),
    ):
        of_rule = dataclasses.replace(every, rule=rule)
        told_of = checked(tmp_path, gates, of_rule, limits=limits).verdict.warnings
        assert any("is for every pair" in one for one in told_of) is is_told
    for between, is_told in ((("b*", "gate_?"), True), (("b*", "gate_[a]"), False)):
        one = dataclasses.replace(every, between=between)
        gates = {**NEAR_A, B: (0.5, 0.2)}
        assert bool(checked(tmp_path, gates, one).verdict.warnings) is is_told
