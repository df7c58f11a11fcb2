"""The proof of one pair of a sweep: a kernel by itself, for both sweeps.

So the search of a pair is compiled once. Not for: the search (`proof`), and choosing pairs (`sweep`).
"""

from typing import NamedTuple

from clearance.compile.declared import Integers
from clearance.compile.decorators import kernel
from clearance.kernels.arithmetic.double_double import frames_of
from clearance.kernels.arithmetic.vec3 import turn
from clearance.kernels.budget.error_rows import error_rows_of
from clearance.kernels.budget.sweep_state import (
    BudgetScene,
    fill_body,
)
from clearance.kernels.features.posed_pair import PosedPair
from clearance.kernels.motion.world import pose_of
from clearance.kernels.search.carried import front_of, no_front
from clearance.kernels.search.proof import Proof, ProofGoal, ProofStart, prove


class PairPart(NamedTuple):
    """A pair, and a part of the motion.

    Attributes:
        pair: its number. half: [s] half of the part, 0 at a step.
        number: of the part; rows and boxes are made once for each number.
        goes_on: True to use and update the front of the pair: at steps and over whole intervals.
    """

    pair: int
    half: float
    number: int
    goes_on: bool


@kernel
def prove_pair(
    lent: BudgetScene, part: PairPart, start: ProofStart, goal: ProofGoal, tally: Integers
) -> Proof:
    """A `Proof` of a pair under its errors and its motion in the part."""
    asked, pair = lent, part.pair
    surface, world, state = asked.surface, asked.world, asked.state
    body_a, body_b = world.pairs[pair, 0], world.pairs[pair, 1]
    fill_body(lent, body_a, part.half, part.number)
    fill_body(lent, body_b, part.half, part.number)
    poses = state.middle.state.poses
    pose = pose_of(world, body_a, poses)
    frames = frames_of(pose, pose_of(world, body_b, poses))
    root_a, root_b = surface.roots[world.solids[body_a]], surface.roots[world.solids[body_b]]
    roots = PosedPair(surface, root_a, surface, root_b, frames)
    carried = state.carried
    front = front_of(world.pairs, pair, carried) if part.goes_on else no_front(carried)
    rows = error_rows_of(state.seen, roots, body_a, body_b)
    proof = prove(roots, rows, start, goal, front, state.scratch)
    tally[1] += 1
    tally[2] += proof.n_nodes
    tally[3] += proof.n_faces
    tally[4] += proof.n_cut
    u = turn(pose, proof.u)
    state.directions[pair, 0], state.directions[pair, 1], state.directions[pair, 2] = u.x, u.y, u.z
    return proof
