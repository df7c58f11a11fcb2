"""Rows of parts that change hands: through the grasp, as differences of exact distances say."""

from dataclasses import replace

import numpy as np
import pytest

import clearance as cl
from clearance.gains.offsets import joint_offsets
from clearance.gains.path_change import PathChange
from clearance.gains.search import Search
from clearance.gains.shift import base_shift
from clearance.gains.turn import Turn
from tests.gains.gantries import standing
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
