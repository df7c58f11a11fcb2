"""What errors leave of one pair of a sweep: a kernel by itself, which both sweeps call by address.

So the search of a pair is compiled once. Not for: the search (`left`), and which pairs are asked (`sweep`).
"""

import math
from typing import NamedTuple

from clearance.compile.declared import Integers
from clearance.compile.decorators import kernel
from clearance.kernels.arithmetic.double_double import frames_of
from clearance.kernels.arithmetic.vec3 import Vec3, turn
from clearance.kernels.budget.face_left import Aim
from clearance.kernels.budget.left import PairRemainder, Start, least_left
from clearance.kernels.budget.sweep_state import (
    BudgetScene,
    fill_body,
    moved_of_pair,
    pose_of,
)


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


@kernel
def pair_left(
    lent: BudgetScene, look: Look, start: Start, aim: Aim, tally: Integers
) -> PairRemainder:
    """`pair_left`, compiled by itself."""
    asked, pair = lent, look.pair
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
