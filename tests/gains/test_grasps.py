"""Rows of parts that change hands, and of obstacles that move and are turned, as exact distances say."""

from dataclasses import replace

import numpy as np
import pytest

import clearance as cl
from clearance.gains.offsets import joint_offsets
from clearance.gains.path_change import PathChange
from clearance.gains.search import Search
from clearance.gains.shift import base_shift, obstacle_shift
from clearance.gains.turn import Turn
from clearance.simulate.answers.approaches import approaches
from clearance.world.pose_table import PoseTable
from clearance.world.timing import Timing
from tests.gains.gantries import along_x, gantry, standing
from tests.gains.test_bounds_that_do_not_follow import part_over_to


def ways(case):
    """A base, one that is turned too, and offsets of the joint."""
    yield base_shift(case, 0)
    yield base_shift(case, 0, turn=Turn("z", (0.3, 0.2, 0.0)))
    yield PathChange((joint_offsets(case, 0, 12, ()),))


@pytest.mark.parametrize("until", [0.9, np.inf])
@pytest.mark.parametrize("i_way", [0, 1, 2])
def test_rows_go_through_the_grasp(until, i_way):
    ball = standing("ball", cl.PointCloud([[0.0, 0.0, 0.0]], 0.05), (-1.2, 0.05, 0.02))
    case = replace(part_over_to(ball, until=until), limits=cl.Limits(fail=0.12))
    way = list(ways(case))[i_way]
    rng = np.random.default_rng(4)
    size = len(way.first_reach)
    x, step = 0.005 * rng.normal(size=size), 1e-6 * rng.normal(size=size)
    search = Search(way, 0.3)
    states = [search.state_at(x + side * step) for side in (-1.0, 0.0, 1.0)]
    n_compared = 0
    for one in states[1].near:
        if not way.transfers.has(one):
            continue
        foretold = way.gradient(one, states[1].record.timeline) @ step
        for step_of, grows in zip(one.steps.tolist(), foretold, strict=True):
            both = [clearance_at(state, one, step_of) for state in (states[0], states[2])]
            if None in both:
                continue
            assert (both[1] - both[0]) / 2.0 == pytest.approx(grows, abs=2e-10)
            n_compared += 1
    assert n_compared > 5


def clearance_at(state, approach, step):
    """[m] of the same pair and phase at a step; None where it is not near."""
    for one in state.near:
        same = one.pair == approach.pair and one.section.number == approach.section.number
        if same and step in one.steps:
            return float(one.clearances[list(one.steps).index(step)])
    return None


def swinging(n=41, timing=None):
    """A table that goes along y and turns about an axis of its own."""
    rng = np.random.default_rng(7)
    axis = rng.normal(size=3)
    angles = np.linspace(0.3, 1.4, n)[:, None]
    turns = np.hstack([np.sin(angles / 2) * axis / np.linalg.norm(axis), np.cos(angles / 2)])
    places = np.column_stack([np.zeros(n), np.linspace(-1.0, 1.0, n), np.zeros(n)])
    return PoseTable(np.linspace(0.0, 1.0, n), places, turns, timing or Timing())


def past_a_swing(timing=None):
    """A block that goes along x past a long bar that goes along y and turns."""
    bar = cl.Obstacle(cl.Body("bar", cl.box((0.3, 0.1, 0.1))), moves=swinging(timing=timing))
    return cl.Case("swing", (along_x(gantry()),), (bar,), cl.Limits(fail=0.05))


@pytest.mark.slow
@pytest.mark.parametrize("x", [np.zeros(4), np.array([0.02, -0.01, 0.03, 0.1])])
@pytest.mark.parametrize("timing", [None, Timing(start=-0.4, rate=1.5, after="loop")])
def test_the_gradient_of_a_turned_motion_is_that_of_distances(x, timing):
    shift = obstacle_shift(past_a_swing(timing), "bar", turn=Turn("z", about=(0.1, 0.2, 0.0)))

    def clearances(at):
        run = cl.check(shift.case_of(at), certify=False)
        return run.record, next(
            one
            for one in approaches(run.session.rules, 0.5)
            if {body.name_in(one.case) for body in one.pair} == {"tool", "bar"}
        )

    record, here = clearances(x)
    told, n_compared = shift.gradient(here, record.timeline), 0
    for i in range(4):
        step = 1e-6 * np.eye(4)[i]
        (_, up), (_, down) = clearances(x + step), clearances(x - step)
        for row, at in enumerate(here.steps.tolist()):
            if here.clearances[row] > 0.02 and at in up.steps and at in down.steps:
                found = [one.clearances[one.steps == at][0] for one in (up, down)]
                assert (found[0] - found[1]) / 2e-6 == pytest.approx(told[row, i], abs=2e-3)
                n_compared += 1
    assert n_compared > 20
