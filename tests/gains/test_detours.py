"""Paths that pass above something, where no small step to the side is any farther from it."""

import numpy as np
import pytest

import clearance as cl
from clearance.gains.obstruction import NOT_MOVED
from clearance.gains.search import FINE
from clearance.simulate.answers.point_motion import has_joint_between
from clearance.world.pairs import OBSTACLE, BodyIndex, Pair
from tests.gains.gantries import along_x, gantry, standing

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


def test_a_path_across_a_beam_goes_round_it():
    found = cl.gain(above_a_beam(0.2), "waypoints")
    assert found.kept and found.size > 2.0 * (0.05 + 0.06 + ASIDE) - FINE


def test_what_is_too_wide_to_go_beside_is_not_said_to_be_impossible():
    found = cl.gain(above_a_beam(4.0, wide=2.0), "waypoints", keep_ends=False)
    assert not found.kept and found.blocked.why != NOT_MOVED


def test_a_joint_that_carries_both_bodies_does_not_move_them_apart():
    robot = gantry()
    bodies = (cl.Body("cart", cl.box((0.1, 0.1, 0.1))), *robot.bodies)
    placed = along_x(cl.Robot("both", robot.link_names, robot.joints, bodies))
    case = cl.Case("both", (placed,), above_a_beam(4.0).obstacles)
    cart, tool = (BodyIndex(0, i) for i in range(2))
    beam = BodyIndex(OBSTACLE, 0)
    assert not has_joint_between(case, Pair(cart, tool), [0]) and has_joint_between(
        case, Pair(cart, tool), [1]
    )
    assert has_joint_between(case, Pair(cart, beam), [0]) and not has_joint_between(
        case, Pair(cart, beam), [1]
    )
