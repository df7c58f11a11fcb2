"""What is worked out of one cell is never taken for another."""

from dataclasses import replace

import numpy as np
import pytest

from clearance.world.case import Limits
from clearance.world.rules import Rule
from tests.formats.making_case import load_small


@pytest.fixture
def case(tmp_path):
    return load_small(tmp_path)


def test_whatever_else_is_changed_is_another_cell(case):
    robot, obstacle = case.robots[0], case.obstacles[0]
    pose = np.eye(4)
    pose[0, 3] = 0.1
    changes = [
        replace(case, obstacles=()),
        replace(case, obstacles=(replace(obstacle, world_from_body=pose),)),
        replace(case, robots=(replace(robot, world_from_base=pose),)),
        replace(case, robots=(replace(robot, padding={"upper": 0.01}),)),
        replace(case, robots=(replace(robot, robot=replace(robot.robot)),)),
        replace(case, robots=(replace(robot, exclude_links=("base",)),)),
        replace(case, limits=Limits(0.1)),
        replace(case, limits=Limits(0.0, rules=(Rule(("*", "*"), fail=0.1),))),
        replace(case, allow=(("upper", "post"),)),
    ]
    cells = [case.cell, *(changed.cell for changed in changes)]
    assert len(set(cells)) == len(cells)
