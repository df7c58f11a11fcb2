"""No error that a budget allows brings bodies nearer than what is proven: at random, and as bad as found."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import clearance as cl
from clearance.budget.proven import PathMoments, proven_of_steps
from clearance.kernels.budget.sweep import FEW, REFINED_OF_MANY
from clearance.world.body import Body, Obstacle
from clearance.world.budget import Budget, JointTolerance, PlacementTolerance, RobotTolerance
from clearance.world.case import Case
from clearance.world.pose_table import PoseTable
from clearance.world.trajectory import Trajectory
from tests.budget.budget_cases import (
    arm_robot,
    bar,
    pair_names,
    proven_sections,
    random_case,
    swinging,
)
from tests.budget.sampled_machine import SampledMachine
from tests.made_cases import at

ROUNDING = 1e-12

NEAREST = 2
"""Pairs that are measured with errors; brute force takes its time."""


def assert_none_below(
    case, section, time: float, proven: float, rng, n_random: int, *, ascend: bool
):
    """`proven` [m] is not above any sample of the pairs that are nearest."""
    machine, names = SampledMachine(case), pair_names(case, section)
    for pair in sorted(names, key=lambda pair: machine.left(time, {}, pair))[:NEAREST]:
        for _ in range(n_random):
            assert proven <= machine.left(time, machine.random(rng), pair) + ROUNDING
        if ascend:
            left = machine.as_bad_as_found(time, pair, machine.random(rng))
            assert proven <= left + ROUNDING


@pytest.mark.slow
@pytest.mark.parametrize("seed", (0, 1, 2, 8))
def test_no_errors_come_below_what_is_proven_of_the_worst_step(seed):
    case = random_case(seed)
    rng = np.random.default_rng(seed)
    for section, found, _, steps, _ in proven_sections(case):
        worst = int(np.argmin(steps.proven))
        if found.clearance[worst] <= 0.0:
            continue
        time = section.phase.times[worst]
        assert steps.proven[worst] < found.clearance[worst]
        assert_none_below(case, section, time, steps.proven[worst], rng, 8, ascend=True)


@pytest.mark.slow
@pytest.mark.parametrize("seed", (1, 2))
def test_no_errors_come_below_what_is_proven_of_many_steps(seed):
    """So many that a search goes on from where the one of the step before has ended."""
    case = random_case(seed, n_steps=FEW + 8)
    rng = np.random.default_rng(seed)
    for section, found, _, steps, _ in proven_sections(case):
        free = np.flatnonzero(found.clearance > 0.0)
        for step in free[np.argsort(steps.proven[free])[:2]]:
            time = section.phase.times[step]
            assert_none_below(case, section, time, steps.proven[step], rng, 4, ascend=False)


def test_many_steps_are_little_looser_than_each_alone_their_least_is_not_and_all_is_the_same_again():
    case = random_case(1, n_steps=FEW + 8)
    for _, found, pairs, steps, _ in proven_sections(case):
        at, alone = pairs.steps, np.empty(len(pairs.steps))
        for i in range(len(at)):
            one = slice(i, i + 1)
            moment = PathMoments(at.intervals[one], at.shares[one])
            alone[i] = pairs.at(moment, found.pair[one], found.clearance[one]).proven[0]
        free = found.clearance > 0.0
        taken = found.clearance - alone
        assert (steps.proven >= alone - 2.0 * REFINED_OF_MANY * taken)[free].all()
        assert steps.proven.min() >= alone.min() - 1e-9
        again = proven_of_steps(pairs, found)  # in a scene that others have worked with
        assert (again.proven == steps.proven).all() and (again.pair == steps.pair).all()


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
