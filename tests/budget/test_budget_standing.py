"""What stands is proven once, and nothing is taken of it for motion; what moves is seen to move."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import clearance as cl
from clearance.world.body import Body, Obstacle
from clearance.world.budget import Budget, JointTolerance, PlacementTolerance, RobotTolerance
from clearance.world.case import Case
from clearance.world.pose_table import PoseTable
from clearance.world.trajectory import Trajectory
from tests.budget.budget_cases import arm_robot, bar, proven_sections, swinging
from tests.made_cases import at

N_STEPS = 30

STANDING = slice(8, 24)
"""Steps at which nothing moves."""


def about_z(angles: np.ndarray) -> np.ndarray:
    """(n, 4) quaternions."""
    half = 0.5 * angles
    return np.column_stack([0.0 * half, 0.0 * half, np.sin(half), np.cos(half)])


def held(values: np.ndarray) -> np.ndarray:
    """Rows (n, ...) that stand at `STANDING`."""
    values = values.copy()
    values[STANDING] = values[STANDING.start]
    return values


def by_a_cart(arm: Trajectory, places: np.ndarray, angles: np.ndarray) -> Case:
    """The arm, and a bar that moves by a table of its own about (0.5, 0.5)."""
    rng = np.random.default_rng(1)
    placed = replace(swinging(arm_robot(), rng, N_STEPS), trajectory=arm)
    table = PoseTable(arm.times, places, about_z(angles))
    cart = Obstacle(Body("cart", bar(0.3)), moves=table)
    post = Obstacle(Body("post", cl.box([0.1, 0.1, 0.1])), at(0.9, 0.0, 0.5))
    joints = {j.name: JointTolerance(0.001) for j in placed.robot.joints}
    budget = Budget({"arm": RobotTolerance(joints, PlacementTolerance(0.002, 0.001))})
    return Case("cart", (placed,), (cart, post), tolerance=budget)


def swung(scale: float) -> Trajectory:
    """How the arm swings, as much as `scale` says."""
    path = swinging(arm_robot(), np.random.default_rng(1), N_STEPS).trajectory
    return Trajectory(path.times, path.joint_names, scale * path.positions)


@pytest.mark.parametrize("turn", [0.0, 0.4])
def test_all_steps_at_which_nothing_moves_leave_the_same(turn):
    arm = swung(0.3)
    arm = Trajectory(arm.times, arm.joint_names, held(arm.positions))
    places = held(np.array([0.5, 0.5, 0.1]) + 0.03 * arm.times[:, None] * [1.0, 1.0, 0.0])
    case = by_a_cart(arm, places, held(0.5 + turn * arm.times))
    for _, _, _, steps, _ in proven_sections(case):
        left = steps.proven[STANDING][2:]  # the first goes on from what moved, the second from that
        assert (left == left[0]).all()


def test_what_only_turns_is_seen_to_move():
    arm = swung(0.0)
    places = np.tile([0.5, 0.35, 0.1], (N_STEPS, 1))
    case = by_a_cart(arm, places, np.linspace(0.0, -1.0, N_STEPS))
    for _, found, _, steps, _ in proven_sections(case):
        assert (steps.proven <= found.clearance).all()
        assert found.clearance[-1] < found.clearance[0] - 0.05
