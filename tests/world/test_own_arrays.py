"""What is made of an array keeps its numbers, whatever the caller does with the array afterwards."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pyarrow as pa
import pytest

import clearance as cl
from clearance.world.body import Mount
from clearance.world.pose_table import PoseTable
from tests.report.cells import slider

CUBE = cl.Body("cube", cl.box((0.1, 0.1, 0.1)))
NO_TURN = np.array([[0.0, 0.0, 0.0, 1.0]])


def placed(base: np.ndarray) -> cl.PlacedRobot:
    return cl.PlacedRobot(slider("axis"), cl.Trajectory([0.0], ["s"], [[0.0]]), base)


MADE: dict[str, tuple[np.ndarray, Callable[[np.ndarray], np.ndarray]]] = {
    "obstacle": (np.eye(4), lambda pose: cl.Obstacle(CUBE, pose).world_from_body),
    "mount": (np.eye(4), lambda pose: Mount("tool", pose).pose),
    "base": (np.eye(4), lambda base: placed(base).world_from_base),
    "trajectory": (np.zeros((1, 1)), lambda x: cl.Trajectory([0.0], ["x"], x).positions),
    "velocities": (
        np.zeros((1, 1)),
        lambda v: cl.Trajectory([0.0], ["x"], [[0.0]], velocities=v).velocities,
    ),
    "pose table": (np.zeros((1, 3)), lambda xyz: PoseTable([0.0], xyz, NO_TURN).positions),
}


@pytest.mark.parametrize("kind", MADE)
def test_an_array_that_is_used_again_changes_nothing_made_before(kind: str) -> None:
    given, make = MADE[kind]
    buffer = given.copy()
    made = make(buffer)
    before = made.copy()
    buffer += 0.25
    assert np.array_equal(made, before)


def test_a_dict_that_is_used_again_changes_no_robot_made_before() -> None:
    given = {"s": 0.5}
    made = cl.PlacedRobot(slider("axis"), fixed_positions=given)
    given["s"] = 0.9
    assert made.fixed_positions == {"s": 0.5}


def test_a_list_that_is_used_again_changes_nothing_made_before() -> None:
    """What is worked out of a case once is asked for again: a list that changes would be answered as it was."""
    robot, motion = slider("axis"), cl.Trajectory([0.0], joints := ["s"], [[0.0]])
    robots = [cl.PlacedRobot(robot, motion, exclude_links=(excluded := []))]
    rules, touch = [cl.Rule(("*", "cube"), fail=0.1)], ["*"]
    carry = cl.Carry("cube", "axis", cl.Window(0.0, 1.0), touch=touch)
    limits, obstacles = cl.Limits(rules=rules), [cl.Obstacle(CUBE)]
    case = cl.Case("case", robots, obstacles, limits)
    own = (
        case.robots,
        case.obstacles,
        limits.rules,
        carry.touch,
        motion.joint_names,
        robots[0].exclude_links,
    )
    before = [*own]
    for given in (robots, obstacles, rules, touch, joints):
        given.clear()
    excluded.append("axis")
    assert all(isinstance(one, tuple) for one in own) and [*own] == before
    assert case.obstacles and replace(robot, joints=[*robot.joints]).joints == robot.joints


@pytest.mark.parametrize(
    ("given", "told"),
    [
        (np.ma.array([[0.0]], mask=[[True]]), "values are masked"),
        (np.array([[0]], "timedelta64[ns]"), "values have the type timedelta64"),
        (np.array([[0j]]), "values have the type complex128"),
        (np.array([[True]]), "values have the type bool"),
    ],
)
def test_numbers_that_are_not_known_are_refused(given: np.ndarray, told: str) -> None:
    with pytest.raises(cl.BadInput, match=told):
        cl.Trajectory([0.0], ["x"], given)


def test_a_table_of_poses_has_the_scalar_last_also_where_it_names_its_columns() -> None:
    """A frame (qw, qx, qy, qz) of length one was read as (x, y, z, w)."""
    rows = {"qw": [1.0], "qx": [0.0], "qy": [0.0], "qz": [0.0]}
    told = "quaternions: the columns are qw, qx, qy, qz; x, y, z, w, in this order"
    with pytest.raises(cl.BadInput, match=told):
        PoseTable([0.0], [[0.0, 0.0, 0.0]], pa.table(rows))
    with pytest.raises(cl.BadInput, match="values are masked"):
        PoseTable([0.0], np.ma.array([[0.0, 0.0, 0.0]], mask=[[True, False, False]]), NO_TURN)
    last = pa.table({name: rows[name] for name in ("qx", "qy", "qz", "qw")})
    assert PoseTable([0.0], [[0.0, 0.0, 0.0]], last).quaternions.tolist() == NO_TURN.tolist()
