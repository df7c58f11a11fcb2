"""What follows from a cell alone is worked out once for all its trajectories, and never for another cell."""

from dataclasses import replace

import numpy as np
import pytest

from clearance.world.case import Limits
from clearance.world.cell import once_a_cell
from clearance.world.rules import Rule
from tests.formats.making_case import load_small


@pytest.fixture
def case(tmp_path):
    return load_small(tmp_path)


def moved(case, positions=((0.0,), (0.4,))):
    return case.with_trajectory(np.arange(len(positions)), np.array(positions))


def test_another_trajectory_name_or_note_is_the_same_cell(case):
    assert moved(case).cell is case.cell
    assert replace(case, name="other", notes=("a note",)).cell is case.cell


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


def test_one_answer_a_cell_and_question(case):
    asked = []

    @once_a_cell(2)
    def answer(case, more=0):
        asked.append((case.name, more))
        return object()

    first = answer(case)
    assert answer(moved(case)) is first and answer(case, 1) is not first
    assert asked == [(case.name, 0), (case.name, 1)]
    answer(replace(case, limits=Limits(0.1)))  # the third: the first is let go
    assert answer(case, 1) is answer(moved(case), 1) and answer(case) is not first
