"""Pairs that come near: the same whatever was asked for; what clearances change by, by hand and by differences."""

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
from clearance.world.robot import JointKind
from clearance.world.rules import Rule
from clearance.world.timeline import timeline_of
from tests.cells import cell
from tests.gains.gantries import along_x, gantry, slot, standing
from tests.made_cases import driven

SCENES = Path(__file__).parents[3] / "scenes"
WITHIN = 0.08


@functools.cache
def near_rows(need: str, within: float = 0.3) -> list[NearRows]:
    """Of a cell in which all moves, and of each of its rules."""
    rules = (
        Rule(("left/*", "*"), name="left", fail=0.02),
        Rule(("part", "*"), while_carried="part"),
    )
    case = replace(cell(2, apart=0.5), limits=cl.Limits(0.01, 0.05, rules=rules))
    run = cl.check(case, need=need, certify=False)
    return [rule.pairs.near(within) for rule in run.session.rules]


@pytest.mark.slow
@pytest.mark.parametrize("need", ["steps", "limit"])
def test_near_pairs_are_those_of_a_run_with_every_pair(need):
    for found, true in zip(near_rows(need), near_rows("pairs"), strict=True):
        assert len(true.steps) > 0
        np.testing.assert_array_equal(found.steps, true.steps)
        np.testing.assert_array_equal(found.pairs, true.pairs)
        np.testing.assert_allclose(found.clearances, true.clearances, rtol=0, atol=1e-12)
        assert not found.nearest_only.any()
        assert (true.clearances < 0.3).all()


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


def rates_of(case):
    found = cl.check(case).report.sensitivity
    assert not found.why_not
    return found, {(rate.kind, rate.of, rate.name): rate for rate in found.rates}


def one_sided(case, changed, h=1e-6):
    """(more, less) of the clearance of the worst step, by measuring two changed cases."""
    run = cl.check(case, certify=False)
    step, before = run.record.worst_step, run.worst_sample["clearance"]
    after = [
        cl.check(changed(case, sign * h), certify=False).steps["clearance"][step].as_py()
        for sign in (1, -1)
    ]
    return [(value - before) / h for value in after]


def spinner(off=0.3, tilt=0.2):
    """A bar that turns about z in place of sliding, past a ball."""
    placed = driven(cl.box((0.6, 0.1, 0.1)), JointKind.REVOLUTE, [0.0, tilt], name="spinner")
    post = standing("post", cl.box((0.05, 0.05, 0.4)), (0.28, off, 0.0))
    return cl.Case("spinner", (placed,), (post,), cl.Limits(fail=0.01))


def turned(case, by):
    placed = case.robots[0]
    table = placed.trajectory
    return replace(
        case, robots=(replace(placed, trajectory=replace(table, positions=table.positions + by)),)
    )


def test_a_bar_beside_a_wall_gains_what_it_moves():
    _, rates = rates_of(slot(fail=0.04, off=0.03))
    assert rates["joint", "gantry", "y"].more == pytest.approx(-1.0, abs=1e-7)
    assert rates["joint", "gantry", "y"].both_ways
    assert rates["base", "gantry", "y"].more == pytest.approx(-1.0, abs=1e-7)
    assert rates["obstacle", "left", "y"].more == pytest.approx(1.0, abs=1e-7)
    assert rates["obstacle", "left", "x"].more == 0.0
    assert ("obstacle", "right", "y") not in rates


def test_midway_between_two_walls_every_way_costs():
    found, rates = rates_of(slot(fail=0.04, off=0.0))
    assert len(found.pairs) == 2
    y = rates["joint", "gantry", "y"]
    assert (y.more, y.less) == pytest.approx((-1.0, -1.0), abs=1e-7) and not y.both_ways
    left = rates["obstacle", "left", "y"]
    assert (left.more, left.less) == pytest.approx((0.0, -1.0), abs=1e-7)


def test_parallel_faces_lose_whichever_way_they_turn():
    case = spinner(tilt=0.0)
    _, rates = rates_of(case)
    turn = rates["joint", "spinner", "joint"]
    assert turn.more < 0.0 and not turn.both_ways
    assert (turn.more, turn.less) == pytest.approx(one_sided(case, turned), abs=1e-5)
    assert turn.more == pytest.approx(-0.3, abs=1e-5) and turn.less == pytest.approx(
        0.255, abs=1e-5
    )


def test_two_that_touch_have_none():
    case = cl.Case("hit", (along_x(gantry()),), (standing("post", cl.box((0.1,) * 3), (0, 0, 0)),))
    assert "contact" in cl.check(case).report.sensitivity.why_not


def test_padding_changes_no_slope():
    case = slot(fail=0.01, off=0.03)
    padded = replace(case, obstacles=tuple(replace(one, padding=0.002) for one in case.obstacles))
    assert rates_of(padded)[1] == rates_of(case)[1]
