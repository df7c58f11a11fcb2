"""What is expected, against errors drawn at random and differences."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import clearance as cl
from clearance.budget.expected import deviations, expected_of_steps, witness_of
from clearance.budget.sources import slopes
from clearance.report.topics.tolerances import least_expected
from clearance.simulate.measure.measure import measure
from clearance.world.budget import Budget, JointTolerance, PlacementTolerance, RobotTolerance
from tests.budget.budget_cases import (
    pair_names,
    proven_sections,
    random_budget,
    random_case,
    sections_of,
)
from tests.budget.sampled_machine import SampledMachine
from tests.simulate.measure.test_between_steps import PAST, THROUGH, sweeping

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
@pytest.mark.parametrize(("seed", "normal"), [(0, False), (2, False), (6, True)])
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


def test_without_errors_the_clearance_is_expected():
    case = random_case(0)
    (section,) = sections_of(case)
    found = measure(section.in_motion)
    expected = expected_of_steps(case, Budget(), section.phase.motions, section.pairs, found)
    assert np.array_equal(expected, found.clearance)
    loose = random_budget(case, np.random.default_rng(5))
    assert (
        expected_of_steps(case, loose, section.phase.motions, section.pairs, found) < expected
    ).all()


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
