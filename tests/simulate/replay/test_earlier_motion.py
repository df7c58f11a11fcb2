"""The motion before a change, for the replay of the one after it."""

from dataclasses import replace

import numpy as np
import pytest

import clearance as cl
from clearance.simulate.replay.replay import replay_of
from tests.gains.gantries import crossing, slot


def session_of(case):
    return cl.check(case, certify=False).session


def test_only_what_was_elsewhere_is_drawn_twice():
    case = slot()
    base = np.eye(4)
    base[1, 3] = -0.01
    moved = replace(case.robots[0], world_from_base=base)
    after = replay_of(session_of(replace(case, robots=(moved,))))
    (body,) = session_of(case).earlier_motion(after)
    assert after.bodies[body.i_body].name == "tool" and body.shown.all()
    assert body.poses[:, 1] == pytest.approx(after.poses[body.i_body][:, 1] + 0.01, abs=1e-6)
    assert not session_of(case).earlier_motion(replay_of(session_of(case)))


def test_a_run_that_ended_earlier_stands_at_its_end():
    """One of two that cross begins a second later: at each moment it was where it is a second later."""
    case = crossing()
    late = replace(case.robots[0], timing=replace(case.robots[0].timing, start=1.0))
    after = replay_of(session_of(replace(case, robots=(late, case.robots[1]))))
    (body,) = session_of(case).earlier_motion(after)
    expected = np.interp(after.times, [0.0, 1.0], [-1.0, 1.0])
    assert body.poses[:, 0] == pytest.approx(expected, abs=1e-6)
