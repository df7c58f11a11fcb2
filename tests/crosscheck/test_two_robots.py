"""Two robots whose links have the same names: the peer knows them apart as the record does."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import clearance as cl
from clearance.world.case import PlacedRobot
from tests.made_cases import at, flying

pytestmark = pytest.mark.peer


def two_robots(**changes) -> cl.Case:
    positions = np.zeros((12, 6))
    positions[:, 0] = np.linspace(0.0, 0.5, 12)
    obstacles = [(cl.box((0.3, 0.3, 0.3)), at(1.2)), (cl.box((0.1, 0.1, 0.1)), at(0.0, 1.0))]
    case = flying("two", cl.box((0.2, 0.2, 0.2)), obstacles, positions)
    (one,) = case.robots
    second = replace(one.robot, name="second")
    other = PlacedRobot(second, one.trajectory, at(0.0, -0.9, 0.2), **changes)
    return replace(case, robots=(one, other))


def test_every_step_agrees_and_links_have_their_robots_names() -> None:
    run = cl.check(two_robots(), cross_check=True)
    assert run.cross_check.agrees and run.cross_check.n_steps == 12
    assert run.cross_check.worst_witness_error < 1e-12
    assert set(run.steps["body_a"].to_pylist()) <= {"flying/l6", "second/l6"}


def test_a_wrong_clearance_of_either_robot_is_found() -> None:
    from clearance.crosscheck import cross_check

    run = cl.check(two_robots())
    wrong = run.record.rows.with_columns({"clearance": run.record.clearances + 1e-6})
    check = cross_check(replace(run.record, table=wrong))
    assert len(check.disagreements) == 12
    assert {row.peer_link for row in check.disagreements} <= {"flying/l6", "second/l6"}
