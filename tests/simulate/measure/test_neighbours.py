"""Links that one joint joins, apart at home or at first: where on the whole way they meet, worked out by hand.

An arm of 0.6 m is 0.05 m thick, and a hand as thick turns about a joint 0.05 m beyond its end, from 0.05 m on. With
s, c of the angle from folded flat, the end corner of one meets the corner of the other where 0.05 s - 0.025 c = 0.025,
so s = 0.8: at a turn of pi - asin 0.8 either way.
"""

import re
from dataclasses import replace

import numpy as np
import pytest

import clearance as cl
from clearance.errors import BadInput
from clearance.world.collision_matrix import CollisionMatrix
from tests.made_cases import at

Z = np.array([0.0, 0.0, 1.0])
MEETS = np.pi - np.arcsin(0.8)
BAR = (0.5, 0.05, 0.05)


def folding(samples=None, velocities=None, limits=(-np.inf, np.inf), **placed):
    """The arm on a base far from both, whose hand goes from sample to sample [rad] in 2 s each."""
    joints = (
        cl.Joint("shoulder", "prismatic", "base", "arm", np.eye(4)),
        cl.Joint("wrist", "revolute", "arm", "hand", at(0.65), Z, *limits),
    )
    shapes = {"base": ((0.1, 0.1, 0.1), (0, 0, 3)), "arm": (BAR, (0.35, 0, 0)), "hand": (BAR, (0.3, 0, 0))}
    bodies = tuple(cl.Body(name, cl.box(size).transformed(at(*place))) for name, (size, place) in shapes.items())
    path = None
    if samples is not None:
        rows = np.array(samples, dtype=float)[:, None]
        speeds = None if velocities is None else np.array(velocities, dtype=float)[:, None]
        path = cl.Trajectory(2.0 * np.arange(len(rows)), ("wrist",), rows, velocities=speeds)
    robot = cl.Robot("own", ("base", "arm", "hand"), joints, bodies)
    one = cl.PlacedRobot(robot, path, self_clearance=cl.SelfClearance(), **placed)
    return cl.Case("own", (one,), (), accept=("wrap",))


def told_of(case):
    return [one for one in cl.check(case).verdict.warnings if one.startswith("neighbours")]


@pytest.mark.parametrize(
    ("samples", "velocities", "angle", "time"),
    [
        ([0.0, 2.9], None, MEETS, 2.0 * MEETS / 2.9),
        ([0.5, -2.2, -2.6], None, -MEETS, 2.0 + 2.0 * (MEETS - 2.2) / 0.4),
        ([0.0, 2.0 * np.pi - 0.5], None, MEETS, 2.0 * MEETS / (2.0 * np.pi - 0.5)),  # free at both samples
        ([0.0, 0.0], [6.0, -6.0], MEETS, 1.0 - np.sqrt(1.0 - MEETS / 3.0)),  # 3 t (2 - t) rad on its cubic
        ([0.0, 2.2], None, None, None),
        ([0.0, 0.0], [4.4, -4.4], None, None),  # 2.2 rad at 1 s
    ],
)
def test_the_first_moment_between_samples_at_which_neighbours_meet_is_told(samples, velocities, angle, time):
    told = told_of(folding(samples, velocities))
    assert len(told) == (angle is not None)
    for one in told:
        assert one.startswith("neighbours arm - hand, 0.1 m apart at first, touch ") or samples[0] == 0.5
        found = re.search(r"wrist = (\S+) rad, at (\S+) s", one)
        assert float(found[1]) == pytest.approx(angle, abs=2e-3)
        assert float(found[2]) == pytest.approx(time, abs=3e-3)


def test_neighbours_that_begin_folded_are_told_of_where_they_are_apart_at_home():
    (told,) = told_of(folding([2.9, 3.3]))
    assert "arm - hand, 0.1 m apart at home (wrist = 0 rad), touch at the first step already, at wrist = 2.9 rad" in told
