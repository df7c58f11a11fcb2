"""Findings say what the verdict says and keep their names; their file reads back; occurrences part for good."""

from __future__ import annotations

import dataclasses
import functools
import json
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import clearance as cl
from clearance.errors import BadInput, BadSyntax
from clearance.findings.finding import FindingName
from clearance.findings.findings_file import (
    FORMAT,
    FindingList,
    findings_text,
    read_findings,
)
from clearance.findings.occurrences import NearCourse, release_level
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
    made = run("dual_arm_handover", None, "limit")
    rules = [rule.name for rule in made.record.rules]
    assert sorted(one.rule for one in made.findings) == sorted(rules) and len(rules) == 4
    assert {one.status for one in made.findings} == {"clear"}


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


@pytest.mark.slow
def test_where_too_many_steps_are_near_the_nearest_pairs_are_told_and_that_is_said(monkeypatch):
    one = cl.check(case("iiwa_pipe_rack"), limits=RACK)
    whole = run("iiwa_pipe_rack", RACK).findings
    monkeypatch.setattr(rule_pairs, "MOST_NEAR_STEPS", 10)
    found = one.findings
    assert found[0].id == whole[0].id and found[0].clearance == whole[0].clearance
    assert {f.id for f in found} < {f.id for f in whole}
    assert "only the nearest pair" in one.finding_list.incomplete


@functools.cache
def found() -> FindingList:
    case = cl.load_case(SCENES / "box_box" / "case.yaml")
    return cl.check(case, limits=Limits(0.04, 0.06)).finding_list


def test_a_list_reads_back_as_it_was_written(tmp_path):
    (tmp_path / "findings.json").write_text(findings_text(found()))
    assert found().findings[0].broken
    assert read_findings(tmp_path) == read_findings(tmp_path / "findings.json") == found()
    assert findings_text(read_findings(tmp_path)) == findings_text(found())


def changed(**changes: object) -> str:
    return json.dumps(json.loads(findings_text(found())) | changes)


@pytest.mark.parametrize(
    ("damaged", "fault", "told"),
    [
        (lambda text: text[:-40], BadSyntax, "not JSON"),
        (lambda text: "[" * 100_000, BadSyntax, "not JSON"),
        (lambda text: text.replace("0.06", "NaN"), BadSyntax, "NaN"),
        (lambda text: text.replace("0.06", "1e400"), BadSyntax, "1e400 is beyond doubles"),
        (lambda text: text.replace("0.06", '"inf"'), BadInput, "warn"),
        (lambda text: "[]", BadInput, "format None"),
        (lambda text: changed(format=FORMAT + 1), BadInput, f"format {FORMAT + 1}"),
        (lambda text: changed(findings=[{"id": 1}]), BadInput, "findings[0]"),
        (lambda text: changed(measured={}), BadInput, "measured"),
    ],
)
def test_what_is_no_such_file_is_refused_in_one_line(damaged, fault, told, tmp_path):
    path = tmp_path / "findings.json"
    path.write_text(damaged(findings_text(found())))
    with pytest.raises(fault) as error:
        read_findings(path)
    assert told in str(error.value) and str(path) in str(error.value)


FAIL = 0.005
LEVEL = release_level(Limits(FAIL))


def course(clearances, between=None, bridges=()) -> NearCourse:
    """Of the clearances at the steps, and by step of those seen between it and the next; as a rule knows them."""
    seen = {2 * i: c for i, c in enumerate(clearances)}
    seen |= {2 * i + 1: c for i, c in (between or {}).items()}
    near = sorted((position, c) for position, c in seen.items() if c < LEVEL)
    positions, found = (np.array([row[i] for row in near]) for i in (0, 1))
    return NearCourse(
        positions.astype(np.int64), found, found <= 0.0, 2 * np.array(bridges, np.int64)
    )


def spans(found: NearCourse) -> list[tuple[int, int]]:
    return [
        (int(found.positions[rows.start]), int(found.positions[rows.stop - 1]))
        for rows in found.broken(Limits(FAIL))
    ]


FAR, OUT, AT, IN = 0.1, LEVEL + 1e-9, FAIL, FAIL - 1e-9


@pytest.mark.parametrize(
    ("clearances", "between", "expected"),
    [
        ([FAR, FAR], {}, []),
        ([AT, AT], {}, []),
        ([FAR, IN, FAR], {}, [(2, 2)]),
        ([IN, AT, IN, AT, IN], {}, [(0, 8)]),
        ([IN, OUT, IN], {}, [(0, 0), (4, 4)]),
        ([IN, FAR, FAR, IN], {}, [(0, 0), (6, 6)]),
        ([AT, IN, AT], {}, [(0, 4)]),
        ([FAR, FAR], {0: IN}, [(1, 1)]),
        ([FAR, FAR, FAR], {0: IN, 1: IN}, [(1, 1), (3, 3)]),
        ([FAR, AT, FAR], {0: IN, 1: IN}, [(1, 3)]),
        ([AT, FAR], {0: IN}, [(0, 1)]),
        ([AT, FAR, AT], {1: IN}, [(3, 4)]),
        ([0.0], {}, [(0, 0)]),
    ],
)
def test_stretches_are_counted_where_the_pair_parts_for_good(clearances, between, expected):
    assert spans(course(clearances, between)) == expected


IN_FOR = st.integers(0, 5).map(lambda n: [0.001] + [FAIL] * n)
"""Well below the limit once, then at it, where noise takes it to both sides."""


@given(st.lists(IN_FOR | st.just([0.2]), min_size=1, max_size=12), st.integers(0, 2**32 - 1))
def test_noise_below_the_hysteresis_changes_no_number(parts, seed):
    clearances = np.concatenate(parts)
    noise = np.random.default_rng(seed).uniform(-0.0004, 0.0004, len(clearances))
    assert spans(course(clearances)) == spans(course(clearances + noise))


@given(st.lists(st.floats(0.0, 0.02), min_size=1, max_size=60))
def test_occurrences_are_apart_and_hold_all_that_is_below_the_limit(clearances):
    found = spans(course(clearances))
    below = {2 * i for i, c in enumerate(clearances) if c < FAIL or c <= 0.0}
    held = {p for first, last in found for p in range(first, last + 1)}
    assert below <= held
    for (_, last), (first, _) in zip(found, found[1:], strict=False):
        parted = [clearances[i] for i in range(last // 2 + 1, first // 2)]
        assert parted and max(parted) >= LEVEL
