"""Contact that occurs between coarse samples only is parted all the same."""

from dataclasses import replace

import numpy as np
import pytest

import clearance as cl
from clearance.gains.obstruction import KEPT_STILL
from clearance.gains.search import FINE
from clearance.gains.sentences import lines_of
from clearance.world.timing import Timing
from tests.gains.gantries import along_x, gantry, standing


def leaping(y=0.07, n=4, rates=False, timing=None):
    """A block goes past a thin post in one leap: at all samples it is far from it."""
    placed = along_x(gantry(), np.linspace(0.0, 3.0, n), start=-0.9, end=0.9)
    if rates:
        asked = placed.given_trajectory
        speeds = np.tile([0.6, 0.0], (n, 1))
        placed = replace(placed, trajectory=replace(asked, velocities=speeds))
    if timing is not None:
        placed = replace(placed, timing=timing)
    post = standing("post", cl.box((0.02, 0.1, 1.0)), (0.02, y, 0.0))
    return cl.Case("leap", (placed,), (post,), cl.Limits(fail=0.01))


@pytest.mark.slow
@pytest.mark.parametrize("y, missing", [(0.07, 0.04), (0.105, 0.005)])
@pytest.mark.parametrize("kind", ["obstacle", "base"])
def test_a_shift_parts_what_meets_between_samples(kind, y, missing):
    found = cl.gain(leaping(y), kind)
    assert found.kept and found.after.passed
    assert abs(found.change[1]) == pytest.approx(missing, abs=5e-5)


def test_a_margin_is_kept_between_samples_too():
    """The block passes the post at 12 mm, which keeps the limit of 10 mm, and not 5 mm more."""
    found = cl.gain(leaping(0.112), "base", margin=0.005)
    assert found.kept and found.after.worst["clearance"] >= 0.015
    assert abs(found.change[1]) == pytest.approx(0.003, abs=5e-5)


@pytest.mark.slow
@pytest.mark.parametrize("timing", [None, Timing(0.5, 0.8)])
@pytest.mark.parametrize("rates", [False, True])
def test_a_path_bends_around_what_it_meets_between_samples(rates, timing):
    found = cl.gain(leaping(rates=rates, timing=timing), "waypoints")
    assert found.kept and found.after.passed
    assert np.abs(found.change[:, 1]).max() >= 0.04


LIMIT, GAP = 0.04, 0.03
"""[m] What is to be kept above a beam, and what is."""

ASIDE = np.sqrt(LIMIT**2 - GAP**2)
"""[m] How far beside the beam's edge a block is far enough."""


def above_a_beam(length, wide=0.12):
    """A block on slides goes along x, 30 mm above a beam that is 120 mm wide."""
    beam = standing("beam", cl.box((length, wide, 0.1)), (0.0, 0.0, -0.1 - GAP))
    return cl.Case("above", (along_x(gantry()),), (beam,), cl.Limits(fail=LIMIT))


def test_a_path_along_a_beam_goes_beside_it():
    """All steps are above it, so that no joint changes the clearance at any: it is not said that none can."""
    found = cl.gain(above_a_beam(4.0), "waypoints", keep_ends=False)
    assert found.kept
    assert found.size == pytest.approx(2.0 * (0.05 + 0.06 + ASIDE), abs=10.0 * FINE)


@pytest.mark.slow
@pytest.mark.parametrize("timing", [None, Timing(0.5, 0.8)])
@pytest.mark.parametrize("rates", [False, True])
def test_a_path_of_two_samples_whose_ends_are_kept_is_said_to_stay_as_it_is(rates, timing):
    """It is clear at both ends, and has no sample between that may change."""
    case = leaping(n=2, rates=rates, timing=timing)
    found = cl.gain(case, "waypoints")
    assert not found.kept and found.blocked.why == KEPT_STILL
    told = dict(lines_of(found))["not kept"]
    assert told.endswith("while the ends of the path are kept (--free-ends frees them)")
    assert cl.gain(case, "waypoints", keep_ends=False).kept
