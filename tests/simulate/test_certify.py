"""Certified bounds: never above the densely sampled truth, tight as asked, and nothing slips through."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import clearance as cl
from clearance.errors import BadDimension
from clearance.world.body import Body, Obstacle
from clearance.world.case import Case, Limits, PlacedRobot
from clearance.world.robot import Joint, JointKind, Robot
from clearance.world.trajectory import Trajectory
from tests.shared_cases import shared_case
from tests.simulate.certified import assert_as_tight_as_asked, assert_never_above_samples

SCENES = Path(__file__).parents[2] / "scenes"
pytestmark = pytest.mark.shared


def finer(case, first, n_parts):
    """The case on one interval, sampled `n_parts` times."""
    placed = case.robots[0]
    asked = placed.trajectory
    share = np.linspace(0.0, 1.0, n_parts + 1)[:, None]
    before, after = asked.positions[first], asked.positions[first + 1]
    times = asked.times[first] + share[:, 0] * (asked.times[first + 1] - asked.times[first])
    part = Trajectory(times, asked.joint_names, before + share * (after - before))
    return replace(case, robots=(replace(placed, trajectory=part),))


def cases():
    yield from (SCENES / name / "case.yaml" for name in ("box_pipe", "hot_cell", "iiwa_pipe_rack"))
    yield from ("fetch_cage_planned", "lbr_puzzle_grinder")


def name_of(case):
    return case if isinstance(case, str) else case.parent.name


@pytest.fixture(scope="module", params=cases(), ids=name_of)
def certified(request):
    path = shared_case(request.param) if isinstance(request.param, str) else request.param
    return cl.check(cl.load_case(path), certify=True)


def test_the_bound_is_never_above_a_thousand_samples(certified):
    assert_never_above_samples(certified, finer, 3)


def test_the_bound_is_as_tight_as_asked(certified):
    assert_as_tight_as_asked(certified)


def test_the_column_and_the_verdict_come_from_the_bound(certified):
    bound = certified.steps["lower_bound"].to_numpy()
    assert np.array_equal(bound, certified.record.certificate.lower_bound)
    limit = float(np.nextafter(bound.min(), np.inf)) + 1e-4
    stricter = cl.check(certified.record.case, certify=True, limits=Limits(limit, limit))
    assert not stricter.passed


def one_joint_case(kind, shape, obstacle, pose, positions, axis=(0.0, 0.0, 1.0)):
    joint = Joint("joint", kind, "base", "tool", np.eye(4), np.array(axis))
    robot = Robot("robot", ("base", "tool"), (joint,), (Body("tool", shape),))
    times = np.arange(len(positions), dtype=float)
    asked = Trajectory(times, ("joint",), np.array(positions, dtype=float)[:, None])
    placed = PlacedRobot(robot, asked)
    return Case("crossing", (placed,), (Obstacle(Body("plate", obstacle), pose),))


def at(x=0.0, y=0.0, z=0.0):
    pose = np.eye(4)
    pose[:3, 3] = x, y, z
    return pose


def test_a_thin_plate_crossed_in_one_step_is_contact():
    case = one_joint_case(
        JointKind.PRISMATIC,
        cl.box((0.05, 0.05, 0.05)),
        cl.box((1.0, 1.0, 1e-4)),
        at(z=0.37),
        [0.0, 1.0],
    )
    assert cl.check(case, certify=False).passed
    run = cl.check(case, certify=True)
    assert run.status == "contact"
    assert run.record.certificate.lower_bound[0] == 0.0
    assert run.record.certificate.upper_bound[0] == 0.0


def test_a_blade_swung_through_a_thin_plate_is_contact():
    blade = cl.Polyhedron.merged([cl.box((0.002, 0.02, 0.02)).transformed(at(x=0.8))])
    plate = cl.box((0.4, 1e-4, 0.4))
    case = one_joint_case(JointKind.CONTINUOUS, blade, plate, at(x=-0.8), [2.5, 3.8])
    assert cl.check(case, certify=False).passed
    assert cl.check(case, certify=True).status == "contact"


def test_passing_a_plate_by_a_tenth_of_a_millimetre_is_proven_not_to_touch():
    box = cl.box((0.05, 0.05, 0.05))
    case = one_joint_case(
        JointKind.PRISMATIC, box, cl.box((0.1, 0.1, 0.1)), at(x=0.0751, z=0.5), [0.0, 1.0]
    )
    certificate = cl.check(case, certify=True).record.certificate
    assert 0.0 < certificate.lower_bound[0] <= 1e-4 + 1e-15
    assert certificate.upper_bound[0] == pytest.approx(1e-4, abs=1e-9)


def test_a_whole_turn_about_the_own_axis_costs_nothing():
    case = one_joint_case(
        JointKind.CONTINUOUS, cl.cylinder(radius=0.1, length=1.0), cl.box((0.1, 0.1, 0.1)), at(x=0.3),
        [0.0, 2.0 * np.pi],
    )  # fmt: skip
    certificate = cl.check(case, certify=True).record.certificate
    assert certificate.lower_bound[0] >= 0.15 - 2e-4 - 1e-4
    assert certificate.lower_bound[0] <= 0.15


def test_a_gap_that_is_no_length_is_refused():
    case = one_joint_case(
        JointKind.PRISMATIC, cl.box((0.1, 0.1, 0.1)), cl.box((0.1, 0.1, 0.1)), at(z=2.0), [0.0, 1.0]
    )
    for gap in (0.0, -1.0, np.nan, np.inf):
        with pytest.raises(BadDimension):
            cl.answer(cl.Question(case, certify=True, certify_gap=gap))


def test_the_papers_method_certifies_nothing_and_the_verdict_says_so():
    case = one_joint_case(
        JointKind.PRISMATIC, cl.box((0.1, 0.1, 0.1)), cl.box((0.1, 0.1, 0.1)), at(z=2.0), [0.0, 1.0]
    )
    run = cl.answer(cl.Question(case, certify=True, method="paper"))
    assert run.certificate is None and run.verdict.text() == "clear at the samples only"
