"""Certified bounds: never above samples a thousand times finer, tight as asked, and nothing slips through.

Bodies beyond all reach, and joints that spin between steps, are refused before any arithmetic overflows.
"""

from dataclasses import replace

import numpy as np
import pytest
from scipy.interpolate import CubicHermiteSpline

import clearance as cl
from clearance.errors import BadDimension, BadPose
from clearance.world.body import Body, Obstacle
from clearance.world.case import Case
from clearance.world.robot import Joint, JointKind, Mimic
from tests.made_cases import WORST, at, dented, driven, flying, resampled
from tests.simulate.measure.wandering import case_of

CUBE = cl.box((0.1, 0.1, 0.1))


def assert_as_tight_as_asked(run):
    """The bound is within the gap of what was seen, and never above the steps at its ends."""
    certificate = run.record.certificate
    assert (certificate.upper_bound - certificate.lower_bound).max() <= certificate.gap
    clearances = run.record.clearances
    assert (certificate.lower_bound <= clearances).all()
    assert (certificate.lower_bound[:-1] <= clearances[1:]).all()
    assert certificate.lower_bound[-1] == clearances[-1]


def assert_never_above_samples(run, n_worst):
    """The bound of the worst and some other intervals is not above a thousand samples of them."""
    certificate = run.record.certificate
    rng = np.random.default_rng(4)
    n_intervals = len(certificate.lower_bound) - 1
    worst = np.argsort(certificate.lower_bound[:-1])[:n_worst]
    for first in {*worst.tolist(), *rng.choice(n_intervals, n_worst).tolist()}:
        sampled = cl.check(finer(run.record.case, first, 1000), certify=False).record.clearances
        assert certificate.lower_bound[first] <= sampled.min()
        assert sampled.min() <= certificate.upper_bound[first] + 1e-4


def finer(case, first, n_parts):
    """One interval in parts: on lines, or on the cubics, which are scipy's."""
    asked = case.robots[0].trajectory
    times = np.linspace(*asked.times[first : first + 2], n_parts + 1)
    if asked.velocities is None:
        return resampled(case, times)
    spline = CubicHermiteSpline(asked.times, asked.positions, asked.velocities)
    return case.with_trajectory(times, spline(times))


@pytest.mark.slow
@pytest.mark.parametrize(
    ("name", "fineness"),
    [("facing_plates", 6), ("linked_tori", 8), ("nested_shells", 2), ("everything_equidistant", 6)],
)
def test_the_bound_holds_where_all_is_near(name, fineness):
    run = cl.check(WORST[name](fineness, 3))
    assert_never_above_samples(run, 1)
    assert_as_tight_as_asked(run)


@pytest.mark.parametrize("seed", range(6))
def test_the_bound_holds_for_dented_bodies_that_turn(seed):
    """A rotation of up to 0.9 rad a step: what is turned away at its middle may face the other at its ends."""
    random = np.random.default_rng(seed)
    turns = random.uniform(-0.3, 0.3, (8, 3)).cumsum(axis=0)
    gap = 10.0 ** random.uniform(-4, -2)
    away = np.column_stack([np.linspace(-0.05, 0.05, 8), np.full(8, 0.28 + gap), np.zeros(8)])
    one, other = (
        dented(np.random.default_rng(s), 2, depth=0.4, radius=0.1) for s in (seed, seed + 100)
    )
    case = flying("turning", one, [(other, np.eye(4))], np.hstack([away, turns]))
    run = cl.check(case)
    assert run.record.clearances.min() > 0.0
    assert_never_above_samples(run, 3)
    assert_as_tight_as_asked(run)


@pytest.mark.slow
@pytest.mark.parametrize("seed", [3, 7])
def test_the_bound_holds_on_cubics_with_joints_that_follow_others(seed):
    run = cl.check(case_of(seed, 1, cubic=True))
    assert_never_above_samples(run, 2)
    assert_as_tight_as_asked(run)


def on_a_slide(post, **motion):
    """A cube on a slide along z, and a post."""
    return Case(
        "crossing", (driven(CUBE, JointKind.PRISMATIC, **motion),), (post,), accept=("units",)
    )


def test_a_slide_that_overshoots_comes_as_near_as_the_closed_form_says():
    """Its velocities take it up and down between samples that are all at 0."""
    plate = Obstacle(Body("post", cl.box((1.0, 1.0, 0.02))), at(z=0.05 + 0.25 + 0.002 + 0.01))
    run = cl.check(on_a_slide(plate, positions=[0.0] * 4, velocities=[1.0, -1.0, 0.5, 0.0]))
    heights = np.array([0.25, 0.0, 0.5 * 4 / 27])  # q = v s (1 - s)^2 is highest at s = 1/3
    lower = run.certificate.lower_bound
    assert (lower[:-1] <= 0.252 - heights + 1e-15).all()
    assert (lower[:-1] >= 0.252 - heights - run.certificate.gap).all()
    assert lower[-1] == run.record.clearances[-1]


def crossing(thickness, start, end, obstacle=None):
    """A cube of 20 mm on its way past or through a plate across x."""
    plate = obstacle or cl.box((thickness, 0.5, 0.5))
    return flying(
        "crossing", cl.box((0.02, 0.02, 0.02)), [(plate, np.eye(4))], np.array([start, end])
    )


@pytest.mark.parametrize("thickness", [1e-2, 1e-4, 1e-7])
@pytest.mark.parametrize("turn", [0.0, 1.0, 3.0])
def test_what_tunnels_is_found(thickness, turn):
    """Clear at both ends; in between the cube goes through, turning or not."""
    run = cl.check(crossing(thickness, [-0.3, 0, 0, 0, 0, 0], [0.4, 0.05, 0, turn, -turn, turn]))
    assert (run.record.clearances > 0.0).all()
    assert run.status == "contact" and not run.passed
    assert run.record.certificate.lower_bound[0] == 0.0
    sampled = cl.check(finer(run.record.case, 0, 1000), certify=False).record.clearances
    assert sampled.min() <= 1e-3


def test_the_shortest_touch_between_two_steps_is_found():
    """The edge of the cube dips 20 picometres into a plate, for about two thousandths of the way."""
    floor = cl.box((4.0, 0.1, 0.1))
    lowest = 0.05 + 0.01 * np.sqrt(2) - 2e-11  # where the cube stands on an edge
    start, end = [-1.0, 0, lowest, np.pi / 4 - 0.03, 0, 0], [1.0, 0, lowest, np.pi / 4 + 0.07, 0, 0]
    run = cl.check(crossing(0.0, start, end, floor))
    assert (run.record.clearances > 0.0).all()
    assert run.record.certificate.lower_bound[0] == 0.0
    assert not run.passed


def test_a_gap_that_is_no_length_is_refused():
    for gap in (0.0, -1.0, np.nan, np.inf):
        with pytest.raises(BadDimension):
            cl.answer(cl.Question(crossing(0.1, [-1.0] * 6, [1.0] * 6), certify_gap=gap))


def test_the_papers_method_certifies_nothing_and_the_verdict_says_so():
    case = crossing(0.1, [-0.3, 0, 0, 0, 0, 0], [-0.2, 0, 0, 0, 0, 0])
    run = cl.answer(cl.Question(case, method="paper"))
    assert run.certificate is None and run.verdict.headline() == "clear at the samples only"


def post(x=1.0, size=0.1):
    return Obstacle(Body("post", cl.box((size, size, size))), at(x))


def spinning(turns, multiplier=None, velocities=None):
    """A joint that turns so often in a second; with `multiplier`, another that follows it."""
    hand = driven(CUBE, JointKind.CONTINUOUS, [0.0, 2 * np.pi * turns], velocities=velocities)
    robot = hand.robot
    if multiplier is not None:
        mimic = Mimic("joint", multiplier)
        gear = Joint("gear", JointKind.REVOLUTE, "base", "wheel", np.eye(4), mimic=mimic)
        robot = replace(
            robot, link_names=(*robot.link_names, "wheel"), joints=(*robot.joints, gear)
        )
    return Case("spin", (replace(hand, robot=robot),), (post(),))


STILL = {"positions": [0.0, 0.0]}


@pytest.mark.parametrize(
    ("far", "named"),
    [
        (on_a_slide(post(x=1e90), **STILL), "obstacle 'post'"),
        (on_a_slide(post(size=1e90), **STILL), "obstacle 'post'"),
        (on_a_slide(post(), positions=[0.0, -1e200]), "link 'tool'"),
        (
            on_a_slide(post(x=5.0), **STILL, velocities=[1e8, 0.0]),
            "link 'tool'",
        ),  # between its steps
        (spinning(1e7), "joint 'joint' turns by 6.28319e\\+07 rad between 0 s and 1 s"),
        (spinning(0.5, multiplier=-1e4), "joint 'gear' turns by 31415.9 rad"),
        (spinning(0.0, velocities=[0.0, 1e5]), "joint 'joint' turns by 100000 rad"),
    ],
)
def test_a_body_beyond_reach_or_a_joint_that_spins_between_steps_is_named(far, named):
    with pytest.raises(BadDimension, match=named):
        cl.check(far)


def test_coordinates_that_cannot_be_squared_are_refused_everywhere():
    with pytest.raises(BadDimension, match="1e\\+200"):
        cl.Polyhedron(1e200 * np.eye(3), [[0, 1, 2]])
    pose = np.eye(4)
    pose[0, 3] = 1e300
    with pytest.raises(BadPose, match="1e\\+300"):
        cl.distance(cl.box((1, 1, 1)), cl.box((1, 1, 1)), pose_b=pose)
