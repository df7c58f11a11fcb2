"""The findings of a run say what its verdict says, whatever was asked for, and keep their names."""

from __future__ import annotations

import dataclasses
import functools
from pathlib import Path

import numpy as np
import pytest

import clearance as cl
from clearance.findings.finding import FindingName
from clearance.simulate.answers import rule_pairs
from clearance.simulate.measure import refine
from clearance.world.case import Case, Limits
from clearance.world.notice import Notice, Severity
from tests.findings.gates import HALF, load_gates
from tests.report.made import findings_of
from tests.report.records import record

SCENES = Path(__file__).parents[2] / "scenes"
RACK = Limits(0.06, 0.09)
UNPROVEN = 0.0349784
"""[m] A limit that nothing is below, by less than what can be proven."""


@functools.cache
def case(name: str) -> Case:
    return cl.load_case(SCENES / name / "case.yaml")


@functools.cache
def run(name: str, limits: Limits | None = None, need: str = "steps", certify: bool = True):
    return cl.check(case(name), need=need, limits=limits, certify=certify)


@pytest.mark.parametrize("need", ["steps", "limit", "minimum"])
@pytest.mark.parametrize("fail", [0.0, 0.0349, UNPROVEN, 0.04])
def test_a_finding_is_broken_exactly_where_the_run_is(fail, need):
    one = run("box_box", Limits(fail, max(fail, 0.02)), need)
    found = one.findings
    assert any(finding.broken for finding in found) is not one.passed
    assert found[0].status == one.verdict.measured
    (worst, *_) = found
    if worst.kind == "clearance":
        assert worst.clearance == one.record.worst.clearance
        assert worst.proven <= worst.clearance + 1e-9


def test_a_limit_that_is_not_proven_is_a_finding_of_its_own(monkeypatch):
    monkeypatch.setattr(refine, "MOST_QUERIES", -1)
    worst = cl.check(case("box_box"), limits=Limits(UNPROVEN)).findings[0]
    assert (worst.kind, worst.status, worst.body_a, worst.body_b) == (
        "unproven", "violated", "", "",
    )  # fmt: skip
    assert worst.proven < UNPROVEN <= worst.clearance
    assert worst.start < worst.end and "undecided" in worst.text


@pytest.mark.slow
def test_every_rule_that_judges_something_has_a_finding():
    for need in ("steps", "limit"):
        found = run("dual_arm_handover", None, need).findings
        rules = [rule.name for rule in run("dual_arm_handover", None, need).record.rules]
        assert sorted(finding.rule for finding in found) == sorted(rules) and len(rules) == 4
        assert {finding.status for finding in found} == {"clear"}


def test_each_witness_point_is_on_the_body_that_it_is_of(tmp_path):
    (one,) = cl.check(load_gates(tmp_path, {"gate": (0.0, 0.003)})).findings
    assert (one.body_a, one.body_b) == ("box", "gate")
    assert (one.point_a[1], one.point_b[1]) == pytest.approx((HALF, HALF + 0.003), abs=1e-12)


def test_a_name_is_of_case_rule_bodies_and_occurrence_alone():
    name = FindingName("cell", "clearance", "default", ("a", "b"))
    assert name.id == FindingName("cell", "clearance", "default", ("b", "a")).id
    others = [
        dataclasses.replace(name, case="cell 2"),
        dataclasses.replace(name, kind="unproven"),
        dataclasses.replace(name, rule="fence"),
        dataclasses.replace(name, bodies=("a", "c")),
        dataclasses.replace(name, bodies=("a, b",)),
        dataclasses.replace(name, occurrence=1),
    ]
    assert len({name.id, *(other.id for other in others)}) == 7
    assert len(name.id) == 16


@pytest.mark.slow
def test_a_program_that_runs_slower_and_a_little_beside_keeps_its_names():
    """Other times, other coordinates, more samples: the same names."""
    before = run("iiwa_pipe_rack", RACK, "limit")
    (placed,) = before.record.case.robots
    given = placed.given_trajectory
    n = 2 * given.n_steps - 1
    at = np.linspace(0, given.n_steps - 1, n)
    columns = [np.interp(at, np.arange(given.n_steps), c) for c in given.positions.T]
    positions = np.column_stack(columns) + 2e-4
    times = 1.7 * np.interp(at, np.arange(given.n_steps), given.times) + 3.0
    slower = before.record.case.with_trajectory(times, positions)
    after = cl.check(slower, need="limit", limits=RACK)
    names = [{finding.id for finding in findings_of(one)} for one in (before, after)]
    assert names[0] == names[1]


def test_joints_beyond_their_limits_are_a_finding_a_robot():
    notices = tuple(
        Notice(Severity.VIOLATED, "joint limits", f"{name}: elbow by {by} rad", name)
        for name, by in (("left", 0.1), ("right", 0.2))
    )
    one = dataclasses.replace(record(), notices=notices)
    other = dataclasses.replace(record(), notices=notices[1:])
    found, left = (
        {f.id: f for f in findings_of(r) if f.kind == "joint limits"} for r in (one, other)
    )
    assert [f.body_a for f in found.values()] != [] and set(left) < set(found)
    (right,) = left.values()
    assert right.body_a == "right" and right.broken and "0.2 rad" in right.text


def test_where_too_many_steps_are_near_the_nearest_pairs_are_told_and_that_is_said(monkeypatch):
    one = cl.check(case("iiwa_pipe_rack"), limits=RACK)
    whole = run("iiwa_pipe_rack", RACK).findings
    monkeypatch.setattr(rule_pairs, "MOST_NEAR_STEPS", 10)
    found = one.findings
    assert found[0].id == whole[0].id and found[0].clearance == whole[0].clearance
    assert {f.id for f in found} < {f.id for f in whole}
    assert "only the nearest pair" in one.finding_list.incomplete
