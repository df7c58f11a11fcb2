"""What errors leave of one pair of a sweep: a kernel by itself, which both sweeps call by address.

So the search of a pair is compiled once. Not for: the search (`left`), and which pairs are asked (`sweep`).
"""

import math
from typing import NamedTuple

import numpy as np

from clearance.compile.jit import inline
from clearance.compile.kernel_table import BUDGET_PAIR, LentArgument, apart, at_address, borrow
from clearance.kernels.arithmetic.double_double import frames_of
from clearance.kernels.arithmetic.vec3 import Vec3, turn
from clearance.kernels.budget.errors import Errors, Extras
from clearance.kernels.budget.face_left import Aim
from clearance.kernels.budget.left import PairRemainder, Start, least_left
from clearance.kernels.budget.sweep_state import (
    BudgetScene,
    fill_body,
    moved_of_pair,
    new_room,
    new_state,
    pose_of,
)
from clearance.kernels.mesh.surface import surface_like
from clearance.kernels.motion.joint_path import NO_BALLS, JointPath
from clearance.kernels.motion.kinematics import Links
from clearance.kernels.motion.world import World


class Look(NamedTuple):
    """A pair and the part of the motion over which it is looked into.

    Attributes:
        pair: its number. half: half of the part's share of its interval, 0 at a step.
        number: of the part; what is made for one part is not made again for it.
        goes_on: True where the front of the pair is gone on from, and left: at steps and over whole intervals.
    """

    pair: int
    half: float
    number: int
    goes_on: bool


_NOTHING_LEFT = PairRemainder(-math.inf, math.inf, -math.inf, False, Vec3(0.0, 0.0, 0.0))


def _scene_like():
    numbers, places, rows = np.empty(0), np.empty(0, dtype=np.int64), np.empty((0, 0))
    poses = np.empty((0, 0, 0))
    links = Links(places, places, rows, poses, places, numbers, numbers)
    world = World(places, places, places, poses, np.empty((0, 2), dtype=np.int64), links)
    path = JointPath(numbers, rows, rows, np.empty(0, dtype=np.bool_), NO_BALLS)
    extras = Extras(places, rows, numbers, numbers, rows)
    errors = Errors(numbers, numbers, numbers, numbers, places, extras, extras, numbers, 0)
    return BudgetScene(surface_like(), world, path, errors, new_state(world, errors, new_room()))


def _like():
    here = Vec3(0.0, 0.0, 0.0)
    start, aim = Start(here, here, True), Aim(0.0, 0.0, 0.0, 0.0, True, 0, 0.0)
    tally = np.empty(0, dtype=np.int64)
    return LentArgument(_scene_like()), Look(0, 0.0, 0, True), start, aim, tally


@apart(BUDGET_PAIR, _like)
def _pair_left(lent, look, start, aim, tally):
    """`pair_left`, compiled by itself."""
    asked, pair = borrow(lent), look.pair
    world, state = asked.world, asked.state
    body_a, body_b = world.pairs[pair, 0], world.pairs[pair, 1]
    fill_body(lent, body_a, look.half, look.number)
    fill_body(lent, body_b, look.half, look.number)
    pose = pose_of(world, body_a, state)
    frames = frames_of(pose, pose_of(world, body_b, state))
    tally[1] += 1
    moved = moved_of_pair(asked, pair) if look.goes_on else math.inf
    left = least_left(lent, pair, moved, frames, start, aim, tally)
    u = turn(pose, left.u)
    state.directions[pair, 0], state.directions[pair, 1], state.directions[pair, 2] = u.x, u.y, u.z
    return left


@inline
def pair_left(table, lent, look, start, aim, tally):
    """What errors leave of a pair about the middle.

    Args:
        table: of `kernel_table`. lent: a `BudgetScene`. look: `Look`.
    """
    return at_address(table, BUDGET_PAIR, _NOTHING_LEFT, (lent, look, start, aim, tally))
