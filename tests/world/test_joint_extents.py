"""How far joints go is what their courses say, to the last bit, and joints within their limits say nothing."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from clearance.world.case import PlacedRobot
from clearance.world.joint_limits import ROUNDING, notices_on_joints
from clearance.world.joint_positions import joint_courses, joint_extents
from clearance.world.robot import Joint, JointKind, Mimic, Robot
from clearance.world.trajectory import Trajectory

NUMBERS = st.floats(-4.0, 4.0)


def arm(limit: float, mimics: list[tuple[float, float]]) -> Robot:
    """Two joints that turn, and those that follow the second: factor and offset each."""
    names = ["a", "b", *(f"m{i}" for i in range(len(mimics)))]
    follows = [None, None, *(Mimic("b", *one) for one in mimics)]
    links = ["base", *(f"link_{name}" for name in names)]
    joints = tuple(
        Joint(name, JointKind.REVOLUTE, above, below, np.eye(4), np.array([0.0, 0.0, 1.0]), -limit, limit, follow)
        for name, above, below, follow in zip(names, links, links[1:], follows, strict=False)
    )  # fmt: skip
    return Robot("arm", tuple(links), joints, ())


@given(
    st.lists(st.tuples(NUMBERS, NUMBERS), min_size=1, max_size=8),
    st.lists(st.tuples(NUMBERS, NUMBERS), max_size=3),
    st.booleans(),
)
def test_ranges_are_the_ends_of_the_courses(samples, mimics, rests):
    positions = np.array(samples)
    names = ("a",) if rests else ("b", "a")
    asked = Trajectory(np.arange(float(len(samples))), names, positions[:, : len(names)])
    resting = {"b": 0.7} if rests else {}
    placed = PlacedRobot(arm(1.0, mimics), asked, fixed_positions=resting)
    for one in (placed, replace(placed, trajectory=None)):
        for course, ends in zip(joint_courses(one), joint_extents(one), strict=True):
            assert course.joint is ends.joint
            assert (ends.least, ends.greatest) == (
                course.at_samples.min(),
                course.at_samples.max(),
            )


@pytest.mark.parametrize(("beyond", "n_reported"), [(0.5, 1), (-0.5, 0), (0.5 * ROUNDING, 0)])
@pytest.mark.parametrize("side", [-1.0, 1.0])
def test_a_joint_is_reported_where_it_is_beyond_a_limit_at_a_sample(beyond, n_reported, side):
    positions = side * np.array([[0.0, 0.0], [0.0, 1.0 + beyond], [0.0, 0.5]])
    asked = Trajectory(np.arange(3.0), ("a", "b"), positions)
    found = notices_on_joints(PlacedRobot(arm(1.0, []), asked), "warn")
    assert len(found) == n_reported
    assert all("'b'" in notice.text and "in 1 of 3 steps" in notice.text for notice in found)
