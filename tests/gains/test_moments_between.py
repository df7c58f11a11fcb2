"""Contact that occurs between coarse samples only is parted all the same."""

from dataclasses import replace

import numpy as np
import pytest

import clearance as cl
from clearance.gains.shortfalls import with_moments
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


@pytest.mark.parametrize("timing", [None, Timing(0.5, 0.8)])
@pytest.mark.parametrize("rates", [False, True])
def test_a_path_bends_around_what_it_meets_between_samples(rates, timing):
    found = cl.gain(leaping(rates=rates, timing=timing), "waypoints")
    assert found.kept and found.after.passed
    assert np.abs(found.change[:, 1]).max() >= 0.04


@pytest.mark.parametrize("rates", [False, True])
def test_moments_are_steps_of_the_same_motion(rates):
    case = leaping(rates=rates, timing=Timing(0.5, 0.8))
    moments = np.array([0.2, 1.0, 2.03, 9.0])
    finer = with_moments(case, moments)
    assert finer.robots[0].given_trajectory.n_steps == 6
    times = np.linspace(0.5, 4.2, 100)
    for one in (case, finer):
        placed = one.robots[0]
        own = (times - 0.5) * 0.8
        at = np.interp(own, placed.given_trajectory.times, placed.given_trajectory.positions[:, 0])
        assert at == pytest.approx(-0.9 + 0.6 * np.clip(own, 0.0, 3.0), abs=1e-12)
    assert with_moments(case, np.zeros(0)) is case
