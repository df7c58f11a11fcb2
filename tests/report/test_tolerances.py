"""Tolerances in every answer: verdict, exit code, lines, findings, JUnit, tables; none where there are none."""

from __future__ import annotations

import dataclasses

import numpy as np
import pyarrow.csv
import pytest

import clearance as cl
from clearance.findings.comparison import compared
from clearance.findings.finding import TOLERANCES
from clearance.findings.findings_file import findings_text, read_findings
from clearance.record.budget import ErrorSource
from clearance.report import curves
from clearance.report.annotations import annotation_lines
from clearance.report.curves import more_curves
from clearance.report.topics.tolerances import largest_text, source_lines
from clearance.world.budget import Budget, ObstacleTolerance, PlacementTolerance, RobotTolerance
from clearance.world.case import Limits
from clearance.world.trajectory import UnprovenSpan
from tests.budget.part_cases import passing
from tests.findings.test_verdict import UNITS, made
from tests.made_cases import at
from tests.profiles.moving import slab, turning
from tests.report.cells import box, with_a_hole
from tests.report.made import (
    finding_list_of,
    findings_of,
    model_of,
    page_of,
    printed,
    run_of,
    summary_of,
    verdict_of,
    write,
    write_junit,
)
from tests.report.records import record, with_budget
from tests.report.schemas import valid_suite

LIMITS = Limits(warn=0.02)
NEAR = made(LIMITS)
"""0.376 mm at least: near."""

KEPT = with_budget(NEAR, 0.0001)
OPEN = with_budget(NEAR, 0.0025)
ACCEPTED = with_budget(NEAR, 0.0025, ok=True)
NO_ANSWER = dataclasses.replace(OPEN, budget=None)
BROKEN = with_budget(record(limits=Limits(fail=0.01, warn=0.06)))
NOT_RULED_OUT = "limit not proven with tolerances (contact not ruled out, 0 mm required)"
NOTHING = "limit not proven with tolerances (nothing proven, 0 mm required)"
SAMPLES = ", measured at the samples only"
SUSPECT = dataclasses.replace(OPEN, notices=(UNITS,))


@pytest.mark.parametrize(
    ("one", "status", "exit_code", "text"),
    [
        (KEPT, "near", 0, "NEAR with tolerances at the samples only"),
        (OPEN, "not proven", 1, f"FAIL: {NOT_RULED_OUT}{SAMPLES}"),
        (ACCEPTED, "not proven", 0, f"ACCEPTED: {NOT_RULED_OUT}{SAMPLES}"),
        (NO_ANSWER, "not proven", 1, f"FAIL: {NOTHING}{SAMPLES}"),
        (BROKEN, "contact", 1, "CONTACT, measured at the samples only"),
        (SUSPECT, "suspect", 2, f"SUSPECT (would be FAIL: {NOT_RULED_OUT}{SAMPLES})"),
    ],
)  # fmt: skip
def test_every_answer_says_the_same(one, status, exit_code, text, tmp_path):
    verdict, run = verdict_of(one), run_of(one)
    assert (verdict.status, verdict.exit_code) == (status, exit_code)
    assert (verdict.shade == "violated") == (status == "not proven")
    assert verdict.headline(str.upper) == text
    assert (run.status, run.passed) == (status, exit_code == 0)
    summary = summary_of(one)
    assert (summary["verdict"], summary["exit_code"]) == (status, exit_code)
    assert printed(one)[0].startswith(text)
    write_junit(one, tmp_path / "junit.xml")
    cases = valid_suite(tmp_path / "junit.xml").iter("testcase")
    failing = {case.get("classname") for case in cases if case.find("failure") is not None}
    assert ("verdict" in failing) == bool(exit_code)
    assert ("tolerances" in failing) == (text.startswith("FAIL") or status == "suspect")


def test_only_the_limit_that_is_not_proven_is_annotated_as_accepted(tmp_path):
    """The base may be 10 mm off: 205 mm to the post may be less than 200, and 300 to the knob are above 100."""
    near, far = (
        box("post", (0.1, 0.1, 0.1), at(0.0, 0.6)),
        box("knob", (0.1, 0.1, 0.1), at(0.0, -0.4)),
    )
    rules = (cl.Rule(("*", "knob"), name="loose", fail=0.1, warn=0.15),)
    given = Budget({"robot": RobotTolerance({}, PlacementTolerance(0.01, 0.0))}, unproven_ok=True)
    case = turning(slab([0.0, -0.05, 0.0], [0.5, 0.05, 0.1]), [0.0, 0.5, 1.0])
    limits = Limits(0.2, 0.21, rules=rules)
    run = cl.check(dataclasses.replace(case, obstacles=(near, far), limits=limits, tolerance=given))
    assert run.verdict.tolerances == "accepted"
    told = [one for one in annotation_lines(run.report, tmp_path) if "proven" in one]
    assert len(told) == 1 and "not proven to keep the fail limit of 200 mm" in told[0]


def test_accepted_it_does_not_fail_and_is_still_told(tmp_path):
    (finding,) = [one for one in findings_of(ACCEPTED) if one.kind == TOLERANCES]
    assert finding.broken and not finding.fails
    write_junit(ACCEPTED, tmp_path / "junit.xml")
    text = (tmp_path / "junit.xml").read_text()
    assert "accepted: what is not proven with the tolerances may pass" in text
    told = annotation_lines(model_of(ACCEPTED), tmp_path)
    first, *others = told
    assert first.startswith("::warning ") and "accepted: not proven to keep the fail limit" in first
    assert not any(line.startswith("::error") for line in others)


def test_what_was_not_worked_out_is_not_clear():
    (finding,) = [one for one in findings_of(NO_ANSWER) if one.kind == TOLERANCES]
    assert finding.text == "the remaining clearance with tolerances was not computed"
    assert finding.fails


def test_findings_are_kept_and_compared(tmp_path):
    for one in (OPEN, ACCEPTED, NEAR):
        path = tmp_path / "findings.json"
        path.write_text(findings_text(finding_list_of(one)))
        assert read_findings(path) == finding_list_of(one)
    less = with_budget(NEAR, 0.0015)
    assert changes_since_open(less)[TOLERANCES].change == "better"
    surface = {"post": ObstacleTolerance(surface=0.001)}
    given = dataclasses.replace(OPEN.case.tolerance, obstacles=surface)
    other = dataclasses.replace(OPEN, case=dataclasses.replace(OPEN.case, tolerance=given))
    row = changes_since_open(other)[TOLERANCES]
    assert (row.change, row.why) == ("not comparable", "its tolerances have changed")
    assert changes_since_open(other)["clearance"].change == "unchanged"


def changes_since_open(now) -> dict:
    rows = compared(finding_list_of(OPEN), finding_list_of(now)).rows
    return {row.finding.kind: row for row in rows}


def test_the_steps_have_columns_of_it(tmp_path):
    certified = with_budget(NEAR, 0.001, between=True)
    table = run_of(certified).steps
    assert table.column_names[-3:] == ["proven", "expected", "proven_between"]
    assert np.array_equal(table["proven"].to_numpy(), certified.budget[0].proven)
    write(certified, tmp_path / "out")
    read = pyarrow.csv.read_csv(tmp_path / "out" / "steps.csv")
    assert np.array_equal(read["expected"].to_numpy(), certified.budget[0].expected)
    assert run_of(KEPT).steps.column_names[-2:] == ["proven", "expected"]


def test_the_report_has_a_table_of_what_takes_it(tmp_path):
    write(OPEN, tmp_path / "out")
    read = pyarrow.csv.read_csv(tmp_path / "out" / "budget.csv").to_pylist()
    assert [row["kind"] for row in read] == ["position", "base", "surface"]
    assert summary_of(OPEN)["tolerances"]["verdict"] == "not proven"
    assert read[1]["tolerance"] == 0.002 and read[1]["second_tolerance"] == 0.001
    assert read[1]["second_unit"] == "rad" and read[1]["second_at_most"] is None


def test_a_report_without_tolerances_has_nothing_of_them(tmp_path):
    write(OPEN, tmp_path / "out")
    write(NEAR, tmp_path / "out")
    assert not (tmp_path / "out" / "budget.csv").exists()
    for path in (tmp_path / "out").iterdir():
        if path.suffix in (".json", ".html", ".csv", ".yaml"):
            assert "tolerances" not in path.read_text(), path.name


@pytest.mark.parametrize(
    ("given", "largest", "told"),
    [
        ((0.001, "m"), 0.00345678, "3.45 mm"),
        ((0.001, "rad"), 0.0012, "0.0012 rad"),
        ((0.02, "s"), 0.0, "0 s"),
        ((0.02, "s"), None, ""),
        ((0.02, "s"), np.inf, "any"),
    ],
)
def test_what_it_may_be_is_rounded_down(given, largest, told):
    assert largest_text(ErrorSource("arm", "base", "", (given,), 0.0, 0.0, (largest,))) == told


@pytest.fixture(scope="module")
def run():
    return cl.check(passing(0.2), certify=False)


def test_sources_are_named_by_robot_joint_and_moment(run):
    (one,) = run.record.budget
    worst = one, run.session.error_sources(one)
    told = " ".join(source_lines(run.record, *worst))
    assert "tracking of joint left/j at the grasp (0 s)" in told
    assert "tracking of joint left/j at the release (1 s)" in told


def test_an_exact_grasp_is_said(run):
    exact = cl.check(passing(0.2, exact_grasp=True), certify=False)
    said = "Grasps taken as exact: part by left/bar."
    assert said in exact.verdict.with_tolerances and said not in run.verdict.with_tolerances
    assert exact.summary["carries"][0]["grasp"] == "exact"
    assert said in exact.summary["tolerances"]["lines"] and said in page_of(exact)


@pytest.mark.parametrize(("parts", "least"), [(2000, [3, 1, 2, 2, 4, 4, 6, 7]), (4, [1, 2, 4, 6])])
def test_a_bound_of_the_motion_is_drawn_level_from_step_to_step(parts, least, monkeypatch):
    monkeypatch.setattr(curves, "MOST_PARTS", parts)
    proven, between = (
        np.array(mm) / 1e3 for mm in ([3, 5, 2, 4, 4, 8, 9, 7], [6, 1, 3, 2, 4, 4, 6, 7])
    )
    one = with_budget(NEAR, between=True, proven=proven)
    one = dataclasses.replace(one, budget=(dataclasses.replace(one.budget[0], between=between),))
    bound, expected = more_curves(one)
    times = one.motions[0].times
    for share in (0.01, 0.5, 0.99):
        at = times[:-1] + share * np.diff(times)
        level = np.repeat(least, 8 // len(least))[:-1]
        assert np.interp(at, bound.times, bound.values) == pytest.approx(level / 1e3, abs=1e-12)
    assert bound.times[[0, -1]] == pytest.approx(times[[0, -1]]) and bound.kind == "solid"
    assert np.all(bound.times == expected.times) and np.all(bound.values <= expected.values)
    sampled, _ = more_curves(with_budget(NEAR))
    assert sampled.kind == "dash" and sampled.name == "proven with tolerances, at the samples"


@pytest.mark.parametrize(
    ("changes", "told"),
    [
        ({}, "the motion that is measured"),
        ({"holes": (), "unproven": (UnprovenSpan("movel", 0.3, 1.1, "why"),)},
         "the motion, less its unproven stretches"),
        ({"holes": ()}, "the motion"),
    ],
)  # fmt: skip
def test_a_motion_of_which_a_part_is_not_measured_or_proven_is_not_called_proven(changes, told):
    case = with_a_hole()
    (placed,) = case.robots
    assert placed.trajectory is not None
    asked = dataclasses.replace(placed.trajectory, **changes)
    placed = dataclasses.replace(placed, trajectory=asked)
    errors = Budget(obstacles={"post": ObstacleTolerance(surface=0.001)})
    run = cl.check(dataclasses.replace(case, robots=(placed,), tolerance=errors))
    assert any(f"; proven for {told}." in line for line in run.verdict.with_tolerances)
