"""A scene that hits something, and what touches but for rounding."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import clearance as cl
from clearance.world.body import Body, Obstacle
from clearance.world.case import Case
from clearance.world.placed_robot import PlacedRobot
from clearance.world.robot import Joint, JointKind, Robot
from clearance.world.trajectory import Trajectory
from tests.made_cases import at

ROOT = Path(__file__).parents[3]


@pytest.fixture(scope="module")
def shelf():
    return cl.check(cl.load_case(ROOT / "scenes" / "panda_shelf" / "case.yaml"), contact="every")


@pytest.mark.slow
def test_the_scene_in_contact_has_depth_and_volume_at_its_22_steps(shelf):
    rows = shelf.steps.to_pylist()
    hit = [row for row in rows if row["clearance"] == 0.0]
    assert [row["step"] for row in hit] == list(range(136, 158))
    assert all(row["penetration"] > 0.0 and row["volume"] > 0.0 for row in hit)
    clear = [row for row in rows if row["clearance"] > 0.0]
    assert {(row["penetration"], row["volume"]) for row in clear} == {(None, None)}


@pytest.mark.slow
def test_the_row_of_a_step_is_its_deepest_pair_and_the_sum_of_its_volumes(shelf):
    for step in (136, 148, 157):
        found = [row.known for row in shelf.record.contacts if row.step == step]
        row = shelf.steps.slice(step, 1).to_pylist()[0]
        assert row["penetration"] == max(one.penetration for one in found)
        assert row["volume"] == pytest.approx(sum(one.volume for one in found), rel=1e-15)
    assert {row.link for row in shelf.record.contacts} == {"panda_leftfinger", "panda_rightfinger"}


def test_what_stands_for_a_body_reaches_the_notes(shelf):
    told = [
        note
        for note in shelf.record.contact_notes
        if note.startswith("contact: panda_leftfinger: ")
    ]
    assert len(told) == 1 and "its hull stands for it" in told[0]


def test_a_touch_that_rounding_parts_in_another_frame_is_a_contact_of_depth_0():
    """A slider that ends exactly at a wall: contact in the world, whatever the wall's own frame says."""
    turned = np.eye(4)
    turned[:2, :2] = [[0.8, -0.6], [0.6, 0.8]]
    run = cl.check(touching_case(turned))
    rows = run.steps.to_pylist()
    for row in rows:
        assert (row["clearance"] == 0.0) == (row["penetration"] is not None)
    deepest = [row["penetration"] for row in rows if row["clearance"] == 0.0]
    assert all(depth < 1e-12 for depth in deepest)


def touching_case(world):
    """A cube that slides along x up to a wall at 0.1, both turned and moved by `world`, to rounding."""
    joint = Joint("rail", JointKind.PRISMATIC, "ground", "cube", np.eye(4))
    body = Body("cube", cl.box((0.2, 0.2, 0.2)))
    robot = Robot("cart", ("ground", "cube"), (joint,), (body,))
    near = 0.1 * np.array([1.0, 1e-16, 0.0, -1e-16, -2e-16]) - 0.1
    path = Trajectory(np.arange(5.0), ("rail",), near[:, None])
    wall = Obstacle(Body("wall", cl.box((0.2, 1.0, 1.0))), world @ at(0.2))
    return Case("touch", (PlacedRobot(robot, path, world),), (wall,))
