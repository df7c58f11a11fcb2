"""What is worked out once for a robot stays, whatever is asked of it in between."""

from __future__ import annotations

import numpy as np

from clearance.world import kinematics
from tests.made_cases import random_robot


def test_positions_of_one_robot_are_found_with_one_entry_of_the_cache() -> None:
    robot = random_robot(np.random.default_rng(5), 8, mimics=0.5)
    assert any(joint.mimic for joint in robot.joints)
    moving = np.random.default_rng(4).normal(size=(5, len(robot.moving_joints)))
    kinematics._moving_links.cache_clear()
    for _ in range(20):
        kinematics.positions_by_link(robot, moving)
    links = kinematics.links_of_robot(robot)
    kept = kinematics._moving_links.cache_info()
    assert (kept.misses, kept.currsize) == (1, 1)
    rate = kinematics.positions_by_link(robot, moving) - kinematics.positions_by_link(
        robot, np.zeros_like(moving)
    )
    assert np.allclose(kinematics.rates_by_link(links, moving), rate, rtol=0, atol=1e-15)
