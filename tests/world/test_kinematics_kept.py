"""What is worked out once for a robot stays, whatever is asked of it in between."""

from __future__ import annotations

import numpy as np

from clearance.world.case import PlacedRobot
from clearance.world.kinematics import link_poses, links_of_robot, rates_by_link, values_by_link
from tests.made_cases import random_robot


def test_links_of_one_robot_take_one_entry_of_the_cache() -> None:
    robot = random_robot(np.random.default_rng(5), 8, mimics=0.5)
    assert any(joint.mimic for joint in robot.joints)
    moving = np.random.default_rng(4).normal(size=(5, len(robot.moving_joints)))
    links_of_robot.cache_clear()
    for _ in range(20):
        link_poses(PlacedRobot(robot), moving)
    links = links_of_robot(robot)
    kept = links_of_robot.cache_info()
    assert (kept.misses, kept.currsize) == (1, 1)
    rate = values_by_link(links, moving) - values_by_link(links, np.zeros_like(moving))
    assert np.allclose(rates_by_link(links, moving), rate, rtol=0, atol=1e-15)
