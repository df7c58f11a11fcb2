"""What a run with tolerances tells, what is expected of it; and a run without is as it was."""

from __future__ import annotations

import json
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import clearance as cl
from clearance.budget.columns import columns_of
from clearance.budget.expected import deviations, expected_of_steps, witness_of
from clearance.budget.sources import SourceKey, slopes, with_sizes
from clearance.errors import BadInput
from clearance.record.budget import RuleBudget
from clearance.report.topics.tolerances import least_expected
from clearance.simulate.measure.measure import measure
from clearance.world.budget import Budget, JointTolerance, PlacementTolerance, RobotTolerance
from clearance.world.case import Clock
from tests.budget.budget_cases import (
    pair_names,
    proven_sections,
    random_case,
    sections_of,
)
from tests.budget.sampled_machine import SampledMachine
from tests.simulate.measure.test_between_steps import PAST, THROUGH, sweeping

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


@pytest.mark.slow
def test_contact_is_never_kept_and_its_report_tells_no_deviation(tmp_path):
    """No direction leads from one body to the other there; the report is written, and says nothing of it."""
    run = cl.check(random_case(3))
    (budget,) = run.record.budget
    assert budget.least < 0.0
    assert not budget.keeps
    assert np.isnan(budget.expected[budget.proven < -1.0]).all()
    run.save(tmp_path)
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


COVERAGE = 3.0
N_SAMPLES = 1000


def nearest_points(case, section, step: int):
    """(what was measured, the witness of a step's nearest pair)."""
    found = measure(section.in_motion)
    pair = section.pairs[int(found.pair[step])]
    steps = np.array([step])
    motions = section.phase.motions
    return found, witness_of(
        section.phase.case, case.tolerance, motions, pair, steps, found.points[steps]
    )


def drawn(most: float, n: int, normal: bool, rng: np.random.Generator) -> np.ndarray:
    """One error as the estimate takes it: uniform up to its size, in a ball, or normal."""
    if normal:
        return rng.normal(size=n) * most / 3.0
    if n == 1:
        return rng.uniform(-most, most, 1)
    vector = rng.normal(size=3)
    return vector / np.linalg.norm(vector) * most * rng.random() ** (1.0 / 3.0)


@pytest.mark.slow
@pytest.mark.parametrize(("seed", "normal"), [(0, False), (6, True)])
def test_deviation_is_that_of_drawn_errors(seed, normal):
    """Of points that the bodies carry: the spread of how far they are apart at errors drawn at random."""
    case = random_case(seed)
    case = replace(case, tolerance=replace(case.tolerance, is_normal=normal))
    (section,) = sections_of(case)
    found, witness = nearest_points(case, section, 2)
    machine = SampledMachine(case)
    names = pair_names(case, section)[int(found.pair[2])]
    length = machine.apart(section.phase.times[2], names, witness.points[0])
    rng = np.random.default_rng(seed)
    lengths = np.empty(N_SAMPLES)
    for i in range(N_SAMPLES):
        errors = {key: drawn(most, n, normal, rng) for key, (most, n) in machine.most.items()}
        lengths[i] = length(errors | joint_errors(case, normal, rng))
        for name in names:
            lengths[i] -= _surface(machine.surfaces([name]), normal, rng)
    deviation = float(deviations(case, case.tolerance, witness)[0])
    assert lengths.std() == pytest.approx(deviation, rel=0.05)
    assert found.clearance[2] - COVERAGE * deviation == pytest.approx(
        lengths.mean() - COVERAGE * lengths.std(), abs=0.1 * COVERAGE * deviation
    )


def joint_errors(case, normal: bool, rng: np.random.Generator) -> dict:
    """What joints are off: repeatability and tracking, drawn each by itself."""
    return {
        ("joint", robot, joint): sum(
            drawn(most, 1, normal, rng) for most in (own.position, own.tracking)
        )
        for robot, tolerance in case.tolerance.robots.items()
        for joint, own in tolerance.joints.items()
    }


def _surface(most: float, normal: bool, rng: np.random.Generator) -> float:
    return float(rng.normal() * most / 3.0 if normal else rng.uniform(-most, most))


def test_slopes_are_differences():
    """Each slope against the distance of the points with that error alone."""
    case = random_case(0)
    (section,) = sections_of(case)
    measured, witness = nearest_points(case, section, 1)
    names, step = pair_names(case, section)[int(measured.pair[1])], 1e-6
    length = SampledMachine(case).apart(section.phase.times[1], names, witness.points[0])
    found = slopes(case, case.tolerance, witness)
    assert found
    for slope in found:
        kind = slope.key.kind
        if kind == "surface":
            continue
        is_joint = kind in ("position", "tracking")
        unit = "joint" if is_joint else ("xyz", "angle")[slope.place]
        error = unit, slope.key.owner, slope.key.part
        n = slope.along.shape[1]
        differences = [
            (length({error: step * axis}) - length({error: -step * axis})) / (2 * step)
            for axis in np.eye(n)
        ]
        assert np.linalg.norm(differences) == pytest.approx(
            np.linalg.norm(slope.along[0]), abs=1e-6
        )


def test_nothing_is_expected_of_contact():
    case = random_case(3)
    for section, found, _, _, _ in proven_sections(case):
        expected = expected_of_steps(
            section.phase.case, case.tolerance, section.phase.motions, section.pairs, found
        )
        assert (np.isnan(expected) == (found.clearance <= 0.0)).all()


@pytest.mark.parametrize("height", [1.0, PAST, 0.47])
def test_what_is_expected_of_a_motion_is_never_more_than_what_occurs_in_it(height):
    """Of two samples half a metre away from what the arm passes between them, and of 401."""
    joints = {"shoulder": JointTolerance(1e-3), "elbow": JointTolerance(1e-3)}
    budget = Budget({"arm": RobotTolerance(joints, PlacementTolerance(1e-3))})
    coarse, fine = (
        cl.check(sweeping(positions, height), tolerance=budget).record
        for positions in (THROUGH, np.linspace(*THROUGH, 401))
    )
    found, truth = (least_expected(record.budget[0]) for record in (coarse, fine))
    assert found <= coarse.worst.clearance < 0.02
    assert found == pytest.approx(truth, abs=1e-3)


def test_a_contact_at_samples_leaves_nothing_to_be_expected():
    """The arm is in the post at its first two samples and far from it at the last."""
    budget = Budget({"arm": RobotTolerance({"shoulder": JointTolerance(1e-3)})})
    case = sweeping([[0.0, 0.0], [0.001, 0.0], [1.0, 0.0]])
    assert least_expected(cl.check(case, tolerance=budget).record.budget[0]) <= 0.0
