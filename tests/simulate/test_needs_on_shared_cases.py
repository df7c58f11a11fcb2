"""What each need leaves undone on the shared cases, by its counters."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import clearance as cl
from tests.shared_cases import SHARED_NAMES, shared_case


@pytest.fixture(scope="module", params=SHARED_NAMES)
def runs(request):
    case = cl.load_case(shared_case(request.param))
    needs = ("steps", "pairs", "limit", "minimum")
    return {
        need: cl.check(case, need=need, certify=False, resources=cl.Resources(jobs=1))
        for need in needs
    }


def cut_to(placed, n_steps):
    """A placed robot that stops after so many steps."""
    asked = placed.trajectory
    kept = replace(
        asked, times=asked.times[:n_steps], positions=asked.positions[:n_steps], velocities=None
    )
    return replace(placed, trajectory=kept)


def tally(runs, need):
    return runs[need].record.tally


def test_all_needs_agree(runs):
    truth = runs["steps"].steps["clearance"].to_numpy()
    assert runs["pairs"].steps.equals(runs["steps"].steps)
    assert runs["minimum"].worst["clearance"] == truth.min()
    assert runs["minimum"].worst["step"] == truth.argmin()
    limit = runs["limit"].steps["clearance"].to_numpy()
    below = truth < runs["limit"].record.case.limits.warn
    assert (limit[below] == truth[below]).all()
    for need in ("limit", "minimum"):
        assert (runs[need].steps["lower_bound"].to_numpy() <= truth).all()


def test_pairs_asks_every_pair_at_every_step_and_steps_a_quarter_at_most(runs):
    every = len(runs["steps"].record.clearances) * len(runs["steps"].pair_minima)
    pairs = tally(runs, "pairs")
    assert pairs["queries"] + pairs["pairs_skipped"] == every
    steps = tally(runs, "steps")
    assert steps["queries"] + steps["pairs_skipped"] == every
    assert steps["queries"] < 0.25 * every


def test_what_is_not_asked_for_is_not_done(runs):
    """Of the polygon and node pairs that all pairs take, the steps take less than half, the others a fifth."""
    for counter in ("polygon_tests", "node_tests"):
        every = tally(runs, "pairs")[counter]
        assert tally(runs, "steps")[counter] < every / 2
        assert tally(runs, "minimum")[counter] < every / 5
        assert tally(runs, "limit")[counter] < every / 5


def test_the_minimum_leaves_most_pairs_unasked(runs):
    counted = tally(runs, "minimum")
    assert counted["queries"] < 0.25 * tally(runs, "pairs")["queries"]
    known = ~np.isnan(runs["minimum"].steps["clearance"].to_numpy())
    assert known.sum() == 1


def test_the_minimum_tests_fewer_polygons_than_the_first_tenth_of_the_steps_where_one_place_is_nearest():
    case = cl.load_case(shared_case("panda_bookshelf_thin_planned"))
    least = cl.check(case, need="minimum", certify=False, resources=cl.Resources(jobs=1)).record
    n_steps = len(least.clearances)
    begun = replace(case, robots=tuple(cut_to(placed, n_steps // 10) for placed in case.robots))
    tenth = cl.check(begun, need="steps", certify=False, resources=cl.Resources(jobs=1)).record
    assert len(tenth.clearances) == n_steps // 10
    assert least.tally["polygon_tests"] < tenth.tally["polygon_tests"]
