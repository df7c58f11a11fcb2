"""What a run with tolerances tells: its record, its steps, its worst moments; and a run without is as it was."""

from __future__ import annotations

import json
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import clearance as cl
from clearance.budget.columns import columns_of
from clearance.budget.sources import SourceKey, with_sizes
from clearance.errors import BadInput
from clearance.record.budget import RuleBudget
from clearance.world.budget import Budget, RobotTolerance
from clearance.world.case import Clock
from tests.budget.budget_cases import random_case

SCENES = Path(__file__).parents[2] / "scenes"


@pytest.fixture(scope="module")
def run():
    case = replace(random_case(0, n_steps=12), limits=cl.Limits(0.02, 0.03))
    return cl.check(case)


def test_a_case_without_tolerances_has_no_budget():
    before = set(sys.modules)
    run = cl.check(replace(random_case(0), tolerance=None))
    assert run.record.budget is None
    assert not {"proven", "expected"} & set(run.record.steps.column_names)
    assert not any(name.startswith("clearance.budget") for name in set(sys.modules) - before)


def least_sources(run):
    """What each error takes at the moment at which the first rule is left least."""
    return run.session.error_sources(run.record.budget[0]).sources


def test_columns_of_steps_are_those_of_the_rule(run):
    (budget,) = run.record.budget
    steps = run.record.steps
    assert steps["proven"].to_pylist() == budget.proven.tolist()
    assert np.array_equal(steps["expected"].to_numpy(), budget.expected, equal_nan=True)
    assert (budget.proven < budget.expected).all()
    assert (budget.expected < steps["clearance"].to_numpy()).all()


def test_no_estimate_is_below_what_is_proven(run):
    """Three deviations of a single error are 1.7 times what it can come to."""
    case = run.record.case
    only = Budget({"arm": RobotTolerance(surfaces={"right_finger": 0.002})})
    once = cl.check(replace(case, tolerance=only))
    (budget,) = once.record.budget
    clearance = run.record.steps["clearance"].to_numpy()
    assert np.array_equal(budget.expected, budget.proven)
    assert budget.proven == pytest.approx(clearance - 0.002, abs=1e-9)
    worst = once.session.least_left(budget)[0]
    assert worst.expected == pytest.approx(worst.proven, abs=1e-12)


def test_the_motion_is_proven_no_better_than_its_ends(run):
    (budget,) = run.record.budget
    ends = np.minimum(budget.proven[:-1], budget.proven[1:])
    assert (budget.between[:-1] <= ends + 1e-12).all()
    assert (budget.between[:-1] >= ends - 0.01).all()


def test_the_worst_moment_is_the_least_and_its_sources_make_it_up(run):
    (budget,) = run.record.budget
    worst = run.session.error_sources(budget)
    assert worst.proven <= budget.proven.min()
    assert worst.proven >= budget.least - 1e-12
    taken = sum(source.proven for source in worst.sources)
    assert taken == pytest.approx(worst.moment.clearance - worst.proven, rel=0.05)
    assert [s.proven for s in worst.sources] == sorted(
        (s.proven for s in worst.sources), reverse=True
    )


@pytest.mark.slow
def test_no_moment_is_told_to_leave_less_than_is_proven_of_all():
    """At a moment a late clock takes up to twice what it can; the interval around it is looked into closer."""
    late = {"timing": {"arm": 0.05}}
    found = cl.check(SCENES / "turntable_cell" / "case.yaml", tolerance=late)
    for one in found.record.budget:
        moments = found.session.least_left(one)
        assert len(moments)
        assert all(worst.proven >= one.least for worst in moments)


@pytest.mark.parametrize("room", [0.002, -0.001])
def test_the_largest_tolerance_keeps_the_limit_and_little_more_does_not(run, room):
    """Where there is room before the limit, and where one error alone would have to be smaller."""
    (budget,) = run.record.budget
    case, limit = run.record.case, budget.least - room
    limited = replace(case, limits=cl.Limits(limit, limit), notices=())
    found = cl.check(limited)
    assert found.record.budget[0].keeps == (room > 0.0)
    told = [one for one in least_sources(found) if None not in one.largest]
    for source in {len(one.largest): one for one in reversed(told)}.values():
        key = SourceKey(source.owner, source.kind, source.part)
        for place, largest in enumerate(source.largest):
            for factor, keeps in ((1.0, True), (2.0 if place else 1.01, False)):
                sizes = [size for size, _ in source.tolerances]
                sizes[place] = factor * largest
                loose = replace(limited, tolerance=with_sizes(case.tolerance, key, sizes))
                (other,) = cl.check(loose).record.budget
                assert other.keeps is keeps


def test_what_even_none_of_an_error_does_not_keep_has_no_largest(run):
    case = replace(run.record.case, limits=cl.Limits(10.0, 10.0), notices=())
    run = cl.check(case)
    assert not run.record.budget[0].keeps
    assert all(number is None for source in least_sources(run) for number in source.largest)


def test_a_budget_of_nothing_takes_nothing():
    case = random_case(0)
    run = cl.check(replace(case, tolerance=Budget()))
    (budget,) = run.record.budget
    assert budget.proven == pytest.approx(run.record.clearances, abs=1e-9)
    assert budget.expected == pytest.approx(run.record.clearances, abs=1e-12)
    assert not least_sources(run)


def test_contact_is_never_kept():
    case = random_case(3)
    run = cl.check(case)
    (budget,) = run.record.budget
    assert budget.least < 0.0
    assert not budget.keeps
    assert np.isnan(budget.expected[budget.proven < -1.0]).all()
    assert least_sources(run)


@pytest.mark.slow
def test_a_report_of_bodies_that_touch_tells_no_deviation(tmp_path):
    """No direction leads from one body to the other there; the report is written, and says nothing of it."""
    arm = SCENES / "panda_shelf" / "case.yaml"
    touching = cl.check(arm, tolerance={"base": {"xyz": 0.002}, "joints": {"all": 0.0005}})
    touching.save(tmp_path)
    summary = json.loads((tmp_path / "summary.json").read_text(encoding="utf-8"))
    worst = summary["tolerances"]["rules"][0]["worst"][0]
    assert (worst["clearance"], worst["expected"]) == (0.0, None)
    assert {source["expected"] for source in worst["sources"]} == {None}


def test_clocks_that_are_not_tied_are_refused():
    case = replace(random_case(3), clock=Clock(0.1))
    with pytest.raises(BadInput, match="clocks are not tied"):
        cl.check(case)


def test_a_step_tells_of_the_rule_with_the_least_margin_to_its_own_limit():
    """0.05 m before a limit of 0, and 0.12 m before one of 0.1: the second."""
    rules = [
        RuleBudget(name, cl.Limits(fail, fail), np.array([proven]), np.array([proven + 0.01]), None)
        for name, fail, proven in (("far", 0.0, 0.05), ("near", 0.1, 0.12))
    ]
    for told in (rules, rules[::-1]):
        proven, expected = columns_of(told)
        assert (proven[0], expected[0]) == (0.12, pytest.approx(0.13))
