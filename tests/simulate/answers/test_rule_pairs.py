"""The pairs of a rule one by one are the same whatever was asked for, and those of the run with every pair."""

from __future__ import annotations

import functools
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import clearance as cl
from clearance.record.rule_answer import NearRows
from clearance.simulate.measure.measure import NearestPairs, measure, pairs_within
from clearance.simulate.measure.sections import section_plan
from clearance.world.motion import kinematic_motion
from clearance.world.timeline import timeline_of
from tests.cells import cell

SCENES = Path(__file__).parents[3] / "scenes"
WITHIN = 0.08


@functools.cache
def checked(name: str, need: str = "steps") -> cl.Run:
    return cl.check(cl.load_case(SCENES / name / "case.yaml"), need=need, certify=False)


def near_rows(name: str, need: str, within: float = WITHIN) -> list[NearRows]:
    return [rule.pairs.near(within) for rule in checked(name, need).session.rules]


@pytest.mark.slow
@pytest.mark.parametrize("name", ["dual_arm_handover"])
@pytest.mark.parametrize("need", ["steps", "limit"])
def test_near_pairs_are_those_of_a_run_with_every_pair(name, need):
    for found, true in zip(near_rows(name, need), near_rows(name, "pairs"), strict=True):
        assert len(true.steps) > 0
        np.testing.assert_array_equal(found.steps, true.steps)
        np.testing.assert_array_equal(found.pairs, true.pairs)
        np.testing.assert_allclose(found.clearances, true.clearances, rtol=0, atol=1e-12)
        assert not found.nearest_only.any()
        assert (true.clearances < WITHIN).all()


@pytest.mark.parametrize("seed", range(3))
def test_only_what_is_not_known_is_measured_near_a_step(seed):
    case = cell(seed, apart=1.0)
    (section, *_) = section_plan(timeline_of(case, [*map(kinematic_motion, case.robots)])).sections
    what = section.in_motion
    found = measure(what)
    steps = np.arange(len(found.clearance))
    nearest = NearestPairs(found.pair, found.clearance)
    for within in (0.0, float(np.median(found.clearance)), 10.0):
        told = pairs_within(what, steps, within, nearest)
        for one, other in zip(told, pairs_within(what, steps, within), strict=True):
            np.testing.assert_array_equal(one, other)


@pytest.mark.parametrize("need", ["steps", "pairs"])
def test_near_pairs_are_nearer_by_their_padding(need):
    """The nearest of each step is what the table says of the step, which is less by the padding too."""
    case = cl.load_case(SCENES / "box_pipe" / "case.yaml")
    padded = tuple(replace(one, padding=0.004) for one in case.obstacles)
    run = cl.check(replace(case, obstacles=padded), need=need, certify=False)
    told = run.steps["clearance"].to_numpy()
    (rule,) = run.session.rules
    found = rule.pairs.near(WITHIN)
    least = np.full(len(told), np.inf)
    np.minimum.at(least, found.steps, found.clearances)
    assert least[told < WITHIN] == pytest.approx(told[told < WITHIN], abs=1e-15)
    assert (told < WITHIN).any() and np.isinf(least[told >= WITHIN]).all()
