"""What a sweep carries from step to step, foremost a lower bound on the distance of each pair.

Between steps no point of a body moves farther than its displacement says, so that a bound on a pair's distance,
less what both bodies have moved since, still holds. Not for: which pairs are measured (`row_search`).
"""

from typing import NamedTuple

import numpy as np

from clearance.compile.declared import Floats, Integers2
from clearance.compile.decorators import inline
from clearance.kernels.motion.answer_cache import AnswerCache, no_answers
from clearance.kernels.motion.body_boxes import BodyBoxes, new_body_boxes
from clearance.kernels.motion.pair_order import PairOrder, new_pair_order
from clearance.kernels.motion.placed import PlacedBodies, new_placed_bodies
from clearance.kernels.motion.schedule import Schedule, new_schedule
from clearance.kernels.motion.world import box_bound
from clearance.kernels.search.body_pair import NO_FACE
from clearance.kernels.search.front import KEPT_DOWN, POOL, Fronts, no_fronts
from clearance.kernels.search.scratch import Scratch, new_scratch

NOT_LESS = 1.0 + 2.0**-50
"""Makes room for what is equally near after its square was rounded."""


class SweepState(NamedTuple):
    """What is carried from step to step, and scratch for the search.

    Attributes:
        within: (p,) [m] as in `Goal`, less where that is found.
        lower_bounds: (p,) [m] a bound on each pair's distance plus the displacements of both bodies then.
        order: of each body's pairs by `lower_bounds`, unless each has a best of its own.
        witness_faces: (p, 2) the faces that were nearest, or NO_FACE.
        placed: where the bodies are. due: which of them need a look.
        boxes: of the bodies where they were last asked for.
        answers: the last ones of the pairs.
        fronts, scratch: of `descend`.
    """

    within: Floats
    lower_bounds: Floats
    order: PairOrder
    witness_faces: Integers2
    placed: PlacedBodies
    due: Schedule
    boxes: BodyBoxes
    answers: AnswerCache
    fronts: Fronts
    scratch: Scratch


@inline(force=True)
def moved_by(world, pair, placed):
    """[m] no less than what both bodies of a pair have moved in all; `placed.GROWTH` covers the rounding."""
    return placed.displacements[world.pairs[pair, 0]] + placed.displacements[world.pairs[pair, 1]]


@inline(force=True)
def carried(world, pair, state):
    """[m] what is left of the bound of a pair after what its bodies have moved."""
    return state.lower_bounds[pair] - moved_by(world, pair, state.placed)


@inline(force=True)
def spare(world, pair, state, goal):
    """[m] the same, less how near the pair must come where that is another distance for each."""
    return carried(world, pair, state) - (state.within[pair] if goal.each else 0.0)


@inline(force=True)
def bounded_again(surface, world, pair, state, enough):
    """[m] the better of the carried bound of a pair and that of both bodies' boxes now; it is carried on."""
    by_boxes = box_bound(surface, world, pair, state.placed, state.boxes, enough)
    lower_bound = max(carried(world, pair, state), by_boxes)
    state.lower_bounds[pair] = (lower_bound + moved_by(world, pair, state.placed)) * KEPT_DOWN
    return lower_bound


@inline
def new_sweep_state(world, n_columns, within):
    n_pairs, n_bodies = len(world.pairs), len(world.frames)
    return SweepState(
        within, np.empty(n_pairs), new_pair_order(n_bodies, n_pairs), np.full((n_pairs, 2), NO_FACE),
        new_placed_bodies(len(world.links.parents), n_bodies), new_schedule(n_bodies, n_columns),
        new_body_boxes(n_bodies), no_answers(n_pairs), no_fronts(n_pairs, POOL), new_scratch(),
    )  # fmt: skip
