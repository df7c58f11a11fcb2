"""Certified bounds: never above samples a thousand times finer, tight as asked, and nothing slips through."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import clearance as cl
from clearance.errors import BadDimension
from clearance.world.trajectory import Trajectory
from tests.made_cases import WORST, dented, flying
from tests.simulate.measure.certified import assert_as_tight_as_asked, assert_never_above_samples

SCENES = sorted((Path(__file__).parents[3] / "scenes").glob("*/trajectory.csv"))
N_STEPS = 60
"""Taken of each scene, before two fifths of it: what is proven of a step does not depend on the others, and in
contact, which comes later, no bound can be wrong."""


def on(case, times, positions, velocities=None):
    """The case on another trajectory of the same joints."""
    (placed,) = case.robots
    asked = Trajectory(times, placed.trajectory.joint_names, positions, velocities)
    return replace(case, robots=(replace(placed, trajectory=asked),))


def stretch(case, first, last):
    """The case from one step to another."""
    asked = case.robots[0].trajectory
    velocities = None if asked.velocities is None else asked.velocities[first : last + 1]
    return on(case, asked.times[first : last + 1], asked.positions[first : last + 1], velocities)


def finer(case, first, n_parts):
    """One interval in parts, linearly; what has velocities is in `test_certify_cubic`."""
    asked = case.robots[0].trajectory
    assert asked.velocities is None
    share = np.linspace(0.0, 1.0, n_parts + 1)[:, None]
    before, after = asked.positions[first], asked.positions[first + 1]
    times = asked.times[first] + share[:, 0] * (asked.times[first + 1] - asked.times[first])
    return on(case, times, before + share * (after - before))


@pytest.mark.slow
@pytest.mark.parametrize("path", SCENES, ids=lambda path: path.parent.name)
def test_the_bound_holds_on_every_scene(path):
    case = cl.load_case(path.parent / "case.yaml")
    last = 2 * case.robots[0].trajectory.n_steps // 5
    run = cl.check(stretch(case, last - N_STEPS, last), certify=True)
    assert run.record.clearances.min() > 0.0
    assert_never_above_samples(run, finer, 2)
    assert_as_tight_as_asked(run)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("name", "fineness"),
    [("facing_plates", 6), ("linked_tori", 8), ("nested_shells", 2), ("everything_equidistant", 6)],
)
def test_the_bound_holds_where_all_is_near(name, fineness):
    run = cl.check(WORST[name](fineness, 3), certify=True)
    assert_never_above_samples(run, finer, 1)
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
    run = cl.check(case, certify=True)
    assert run.record.clearances.min() > 0.0
    assert_never_above_samples(run, finer, 3)
    assert_as_tight_as_asked(run)


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
    run = cl.check(
        crossing(thickness, [-0.3, 0, 0, 0, 0, 0], [0.4, 0.05, 0, turn, -turn, turn]), certify=True
    )
    assert (run.record.clearances > 0.0).all()
    assert run.status == "contact" and not run.passed
    assert run.record.certificate.lower_bound[0] == 0.0
    sampled = cl.check(finer(run.record.case, 0, 1000)).record.clearances
    assert sampled.min() <= 1e-3


def test_the_shortest_touch_between_two_steps_is_found():
    """The edge of the cube dips 20 picometres into a plate, for about two thousandths of the way."""
    floor = cl.box((4.0, 0.1, 0.1))
    lowest = 0.05 + 0.01 * np.sqrt(2) - 2e-11  # where the cube stands on an edge
    start, end = [-1.0, 0, lowest, np.pi / 4 - 0.03, 0, 0], [1.0, 0, lowest, np.pi / 4 + 0.07, 0, 0]
    run = cl.check(crossing(0.0, start, end, floor), certify=True)
    assert (run.record.clearances > 0.0).all()
    assert run.record.certificate.lower_bound[0] == 0.0
    assert not run.passed


def test_a_gap_that_is_no_length_is_refused():
    for gap in (0.0, -1.0, np.nan, np.inf):
        with pytest.raises(BadDimension):
            cl.answer(cl.Question(crossing(0.1, [-1.0] * 6, [1.0] * 6), certify_gap=gap))


def test_the_papers_method_certifies_nothing_and_the_verdict_says_so():
    case = crossing(0.1, [-0.3, 0, 0, 0, 0, 0], [-0.2, 0, 0, 0, 0, 0])
    run = cl.answer(cl.Question(case, certify=True, method="paper"))
    assert run.certificate is None and run.verdict.headline() == "clear at the samples only"
