"""The state of a sweep from step to step, foremost a lower bound on the distance of each pair.

The displacement bounds the motion of every point of a body. So a bound on a pair's distance, less the motion of
both bodies since, still holds. Not for: which pairs are measured (`row_search`).
"""

from typing import NamedTuple

from clearance.compile.declared import Floats
from clearance.compile.decorators import inline
from clearance.kernels.motion.answer_cache import AnswerCache, no_answers
from clearance.kernels.motion.body_boxes import BodyBoxes, new_body_boxes
from clearance.kernels.motion.pair_order import PairOrder, new_pair_order
from clearance.kernels.motion.placed import PlacedBodies, new_placed_bodies
from clearance.kernels.motion.schedule import Schedule, new_schedule
from clearance.kernels.motion.world import box_bound
from clearance.kernels.search.carried import Carried, carried_bound, carry, nothing_carried
from clearance.kernels.search.front import POOL
from clearance.kernels.search.scratch import Scratch, new_scratch

NOT_LESS = 1.0 + 2.0**-50
"""Admits pairs that are equally near, although squares were rounded."""


class SweepState(NamedTuple):
    """State that lasts from step to step, and scratch for the search.

    Attributes:
        within: (p,) [m] as in `SweepGoal`, lowered by distances found.
        carried: of all pairs. order: of each body's pairs by their bounds, unless each has a best of its own.
        placed: poses of the bodies. schedule: which of them need a visit.
        boxes: of the bodies at their last use.
        answers: the last answers of the pairs.
        scratch: of a search.
    """

    within: Floats
    carried: Carried
    order: PairOrder
    placed: PlacedBodies
    schedule: Schedule
    boxes: BodyBoxes
    answers: AnswerCache
    scratch: Scratch


@inline(force=True)
def spare(world, pair, state, goal):
    """[m] how far the carried bound of a pair exceeds the distance asked for, if each pair has its own."""
    return carried_bound(world.pairs, pair, state.carried) - (
        state.within[pair] if goal.each else 0.0
    )


@inline(force=True)
def bounded_again(surface, world, pair, state, enough):
    """[m] the greater of the carried bound of a pair and the bound by both bodies' boxes now; it is stored."""
    by_boxes = box_bound(surface, world, pair, state.placed, state.boxes, enough)
    lower_bound = max(carried_bound(world.pairs, pair, state.carried), by_boxes)
    carry(world.pairs, pair, lower_bound, state.carried)
    return lower_bound


@inline
def new_sweep_state(world, n_columns, within):
    n_pairs, n_bodies = len(world.pairs), len(world.frames)
    return SweepState(
        within, nothing_carried(n_bodies, n_pairs, POOL), new_pair_order(n_bodies, n_pairs),
        new_placed_bodies(len(world.links.parents), n_bodies), new_schedule(n_bodies, n_columns),
        new_body_boxes(n_bodies), no_answers(n_pairs), new_scratch(),
    )  # fmt: skip
