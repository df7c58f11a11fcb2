"""Two runs of a case: what is new, worse, unchanged, better, gone, and what is not comparable and why."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest

import clearance as cl
from clearance.findings.comparison import TOLERANCE, FindingChange, compared
from clearance.findings.finding import JOINT_LIMITS, UNPROVEN
from clearance.findings.findings_file import FindingList
from clearance.findings.measurement_conditions import conditions_of
from clearance.report.comparison import comparison_page
from clearance.report.comparison_text import comparison_cells, gone_text
from tests.findings.gates import load_gates, write_gates, write_way

A, B = "gate_a", "gate_b"
CLEAR = {A: (-0.5, 0.05), B: (0.5, 0.1)}
BEFORE = {A: (-0.5, 0.003), B: (0.5, 0.1)}


def found(
    folder, gates, *extra, need="steps", certify=True, contact="events", **changes
) -> FindingList:
    case = load_gates(folder, gates, *extra, **changes)
    return cl.check(case, need=need, certify=certify, contact=contact).finding_list


@pytest.fixture
def before(tmp_path) -> FindingList:
    return found(tmp_path, BEFORE)


def changes(before: FindingList, now: FindingList) -> list[tuple[str, str]]:
    rows = compared(before, now).rows
    return [(str(row.change), row.finding.body_b) for row in rows]


TABLE = {
    # what: gates of now, rows, passed
    "nothing": (BEFORE, [("unchanged", A)], True),
    "less than the tolerance": ({A: (-0.5, 0.003 - 0.9 * TOLERANCE), B: (0.5, 0.1)}, [("unchanged", A)], True),
    "worse": ({A: (-0.5, 0.0028), B: (0.5, 0.1)}, [("worse", A)], False),
    "contact": ({A: (-0.5, 0.0), B: (0.5, 0.1)}, [("worse", A)], False),
    "better": ({A: (-0.5, 0.004), B: (0.5, 0.1)}, [("better", A)], True),
    "only a near miss": ({A: (-0.5, 0.01), B: (0.5, 0.1)}, [("better", A)], True),
    "gone, and still the nearest": ({A: (-0.5, 0.05), B: (0.5, 0.1)}, [("gone", A)], True),
    "gone": ({A: (-0.5, 0.15), B: (0.5, 0.1)}, [("gone", A)], True),
    "new": ({A: (-0.5, 0.003), B: (0.5, 0.004)}, [("new", B), ("unchanged", A)], False),
    "a new near miss": ({A: (-0.5, 0.003), B: (0.5, 0.012)}, [("new", B), ("unchanged", A)], True),
    "moved along": ({A: (0.3, 0.003), B: (0.5, 0.1)}, [("unchanged", A)], True),
    "a new gate": (BEFORE | {"c": (0.7, 0.001)}, [("not comparable", "c"), ("unchanged", A)], False),
    "a gate less": ({B: (0.5, 0.1)}, [("not comparable", A)], False),
    "a gate less that was clear": ({A: (-0.5, 0.003)}, [("unchanged", A)], False),
    "a clear gate more": (BEFORE | {"c": (0.7, 0.2)}, [("unchanged", A)], True),
}  # fmt: skip


@pytest.mark.parametrize("what", TABLE)
def test_what_became_of_each_finding(what, before, tmp_path):
    gates, rows, passed = TABLE[what]
    now = found(tmp_path / "now", gates)
    comparison = compared(before, now)
    assert changes(before, now) == rows
    assert comparison.passed is passed and not comparison.whole
    page = comparison_page(comparison, [], ("before", "now"))
    is_watched = not passed or any(one in ("new", "worse", "not comparable") for one, _ in rows)
    assert ("nothing is new or worse" in page) is not is_watched
    assert sum(comparison.counts.values()) == len(comparison.rows)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("gate", "change", "why"),
    [
        ((-0.5, -0.005), FindingChange.UNCHANGED, ""),
        ((0.3, -0.005), FindingChange.UNCHANGED, ""),
        ((0.3, -0.005 - 0.5 * TOLERANCE), FindingChange.UNCHANGED, ""),
        ((-0.5, -0.02), FindingChange.WORSE, "20.00 mm deep, and was 5.000 mm deep"),
        ((-0.5, -0.001), FindingChange.BETTER, "1.000 mm deep, and was 5.000 mm deep"),
    ],
)
def test_contacts_are_compared_by_their_depth(gate, change, why, tmp_path):
    before, now = (found(tmp_path / n, {A: at}) for n, at in (("a", (-0.5, -0.005)), ("b", gate)))
    assert [one.penetration for one in now.findings] == [pytest.approx(-gate[1], abs=1e-12)]
    (row,) = compared(before, now).rows
    assert (row.change, row.why) == (change, why)
    assert compared(before, now).passed is (change != FindingChange.WORSE)


def test_contacts_at_another_place_are_not_comparable_if_depths_do_not_decide(tmp_path):
    gates = {"before": (-0.5, -0.005), "now": (0.3, -0.005)}
    before, now = (found(tmp_path / n, {A: at}, contact="none") for n, at in gates.items())
    (row,) = compared(before, now).rows
    assert row.change == FindingChange.NOT_COMPARABLE and "how deep" in row.why and row.alarms
    assert compared(before, before).passed
    depths = {"penetration": 0.004, "penetration_at_least": 0.001}
    old = [dataclasses.replace(one, **depths) for one in before.findings]
    depths = {"penetration": 0.006, "penetration_at_least": 0.003}
    new = [dataclasses.replace(one, **depths) for one in now.findings]
    (row,) = compared(
        dataclasses.replace(before, findings=tuple(old)),
        dataclasses.replace(now, findings=tuple(new)),
    ).rows
    assert row.change == FindingChange.NOT_COMPARABLE and "3.000 to 6.000 mm deep" in row.why


def waived_found(folder, gates) -> FindingList:
    """With a waiver of the first gate."""
    folder.mkdir()
    row = f"- {{between: [box, {A}], at_least: 0.002, reason: it gives way, by: N. N., until: 9999-12-31}}"
    (folder / "waivers.yaml").write_text(row)
    return found(folder, gates, "waivers: [waivers.yaml]")


@pytest.mark.slow
@pytest.mark.parametrize("least", [0.003, 0.004])
def test_what_lost_its_waiver_is_worse_however_near_it_is(least, before, tmp_path):
    waived = waived_found(tmp_path / "waived", BEFORE)
    now = BEFORE | {A: (-0.5, least)}
    comparison = compared(waived, found(tmp_path / "now", now))
    (row,) = comparison.rows
    assert (row.change, row.why) == (FindingChange.WORSE, "waived before, and is not now")
    assert row.alarms and not comparison.passed
    assert compared(waived, waived_found(tmp_path / "still", now)).passed
    assert compared(before, waived).passed


@pytest.mark.parametrize(
    ("changed", "why"),
    [
        ({"need": "minimum"}, "need was steps, and is minimum"),
        ({"certify": False}, "basis was motion, and is samples"),
    ],
)
def test_what_is_measured_in_another_way_is_not_comparable(changed, why, before, tmp_path):
    comparison = compared(before, found(tmp_path / "now", BEFORE, **changed))
    assert comparison.whole == why and not comparison.passed
    assert {row.change for row in comparison.rows} == {FindingChange.NOT_COMPARABLE}


def test_another_gap_of_the_certificate_is_told_in_millimetres(before):
    measured = dataclasses.replace(before.measured, certify_gap=1e-3)
    coarser = dataclasses.replace(before, measured=measured)
    assert compared(before, coarser).whole == "certify gap was 0.1 mm, and is 1 mm"


def test_a_simulation_in_which_obstacles_push_back_is_another_motion(before, tmp_path):
    record = cl.check(load_gates(tmp_path / "now", BEFORE)).record
    through = dataclasses.replace(record, motion_kind="simulated")
    responding = dataclasses.replace(record.case, contact_response=True)
    of_through, of_pushed = (
        dataclasses.replace(before, measured=conditions_of(one))
        for one in (through, dataclasses.replace(through, case=responding))
    )
    comparison = compared(of_through, of_pushed)
    assert comparison.whole == "motion was simulated, and is simulated, contact_response"
    assert not comparison.passed


def test_other_limits_are_not_comparable(before, tmp_path):
    now = found(tmp_path / "now", BEFORE, limits="{fail: 0.006, warn: 0.02}")
    (row,) = compared(before, now).rows
    assert (row.change, row.why) == (FindingChange.NOT_COMPARABLE, "rule 'default' has changed")


def test_another_warn_limit_changes_nothing_of_what_fails(before, tmp_path):
    now = found(tmp_path / "now", BEFORE, limits="{fail: 0.005, warn: 0.01}")
    comparison = compared(before, now)
    (row,) = comparison.rows
    assert row.change is FindingChange.UNCHANGED and comparison.passed
    near = found(tmp_path / "near", {A: (-0.5, 0.007), B: (0.5, 0.1)})
    (row,) = compared(near, now).rows
    assert (row.change, row.now.status) == (FindingChange.WORSE, "violated")
    (row,) = compared(
        near, found(tmp_path / "none", CLEAR, limits="{fail: 0.005, warn: 0.01}")
    ).rows
    assert (row.change, row.why) == (FindingChange.NOT_COMPARABLE, "rule 'default' has changed")


def test_another_robot_is_not_comparable(before, tmp_path):
    now = found(tmp_path / "now", BEFORE)
    robots = tuple(dataclasses.replace(r, sha256="0" * 64) for r in now.measured.robots)
    now = dataclasses.replace(now, measured=dataclasses.replace(now.measured, robots=robots))
    (row,) = compared(before, now).rows
    assert (row.change, row.why) == (FindingChange.NOT_COMPARABLE, "robot 'gantry_box' has changed")


def test_what_a_list_leaves_out_is_not_known(before, tmp_path):
    now = found(tmp_path / "now", {A: (-0.5, 0.003), B: (0.5, 0.004)})
    for cut in ({"incomplete": "only the least"}, {"not_listed": 7}):
        less = dataclasses.replace(before, **cut)
        assert changes(less, now) == [("not comparable", B), ("unchanged", A)]
        first = compared(less, now).rows[0]
        assert first.alarms and (less.incomplete or "7 findings") in first.why


def test_a_second_occurrence_is_new(before, tmp_path):
    path = write_gates(tmp_path / "now", BEFORE)
    there_and_back = np.concatenate([np.linspace(-1, 1, 41), np.linspace(1, -1, 41)[1:]])
    write_way(tmp_path / "now" / "way.csv", there_and_back)
    now = cl.check(path).finding_list
    rows = compared(before, now).rows
    told = [(str(row.change), row.finding.occurrence) for row in rows]
    assert told == [("new", 1), ("unchanged", 0)]


def test_what_is_proven_says_how_an_unproven_limit_stands(before):
    (one, *_) = before.findings
    unproven = dataclasses.replace(
        one, kind=UNPROVEN, body_a="", body_b="", clearance=0.006, proven=0.0049
    )
    less = dataclasses.replace(unproven, proven=0.001)
    pair = [dataclasses.replace(before, findings=(each,)) for each in (unproven, less)]
    assert [str(row.change) for row in compared(*pair).rows] == ["worse"]
    assert [str(row.change) for row in compared(*pair[::-1]).rows] == ["better"]


def test_joints_that_are_further_beyond_their_limits_are_not_unchanged(before):
    (one, *_) = before.findings
    joints = dataclasses.replace(
        one, kind=JOINT_LIMITS, rule=JOINT_LIMITS, body_a="gantry_box", body_b="", clearance=None,
        proven=None, text="slide_x at 1.1 m",
    )  # fmt: skip
    other = dataclasses.replace(joints, text="slide_x at 9.1 m")
    first, second = (dataclasses.replace(before, findings=(each,)) for each in (joints, other))
    assert [str(row.change) for row in compared(first, first).rows] == ["unchanged"]
    (row,) = compared(first, second).rows
    assert row.change == FindingChange.NOT_COMPARABLE and row.alarms and "in words" in row.why


def test_a_pair_in_contact_has_no_length_that_reads_as_a_graze(before, tmp_path):
    """The box is 10 mm deep in the gate; its clearance of 0 or less is not told as a distance."""
    now = found(tmp_path / "now", {A: (-0.5, -0.01), B: (0.5, 0.1)})
    (row,) = compared(before, now).rows
    _, _, _, was, least, *_ = comparison_cells(row)
    assert (was, least) == ("3.000", "contact")
    (back,) = compared(now, found(tmp_path / "clear", {B: (0.5, 0.1)})).rows
    assert "contact in the baseline" in gone_text(back)
