"""The search of one step: the nearest pair of some bodies, or the distance of each pair that is near enough.

Pairs whose carried bound exceeds the best are not measured. Not for: which steps and bodies are visited (`sweep`),
one pair (`search.body_pair`).
"""

from typing import NamedTuple

import numpy as np

from clearance.compile.decorators import inline
from clearance.kernels.features.face_pair import Hit, nothing_yet
from clearance.kernels.features.posed_pair import PosedPair
from clearance.kernels.motion.answer_cache import (
    answer_of,
    is_still_valid,
    note_answer,
    was_contact,
)
from clearance.kernels.motion.pair_order import sort_first, sort_one
from clearance.kernels.motion.schedule import forget_between, note_between, note_visit
from clearance.kernels.motion.sweep_rows import write_pair
from clearance.kernels.motion.sweep_state import (
    NOT_LESS,
    bounded_again,
    spare,
)
from clearance.kernels.motion.world import pair_frames
from clearance.kernels.search.body_pair import TO_THE_END, PairQuestion, search
from clearance.kernels.search.carried import (
    carried_bound,
    carry,
    carry_faces,
    front_of,
    moved_of,
)
from clearance.kernels.search.front import forget_front

STEPS_AHEAD = 2.0
"""A pair is measured up to this many mean displacements beyond the best, so that its bound lasts."""

LITTLE = 0.03
"""Share of the best: where bodies move more in a step, no pair is measured beyond the best."""


class RowQuestion(NamedTuple):
    """The question of one row.

    Attributes:
        bodies: to visit. row: its place in the results. step: its number.
        first: the pair to ask first, or -1. known: a pair that is not measured, or -1.
        lowest: [m] a bound on the distance of all pairs of all other bodies.
        effort: of `PairQuestion`.
    """

    bodies: np.ndarray
    row: int
    step: int
    first: int
    known: int
    lowest: float
    effort: int


class RowNearest(NamedTuple):
    """The answer of a row.

    Attributes:
        hit, pair: the nearest points and their pair, or -1. gap: [m] pairs with a greater bound are skipped.
        lowest: [m] a bound on the distance of all pairs.
    """

    hit: Hit
    pair: int
    gap: float
    lowest: float


@inline(force=True)
def nearest_by_boxes(surface, world, bodies, state, winner):
    """The pair to ask first if the motion of the last nearest pair exceeds its distance."""
    order, bounds = state.order, state.carried.lower_bounds
    nearest = np.inf
    for body in bodies:
        place, end = order.starts[body], order.ends[body]
        while place < end:
            pair = order.pairs[place]
            if carried_bound(world.pairs, pair, state.carried) >= nearest:
                break
            lower_bound = bounded_again(surface, world, pair, state, nearest)
            if lower_bound < nearest:
                nearest = lower_bound
                winner = pair
            place += 1
        sort_first(bounds, order, body, place)
        for place in range(end, order.starts[body + 1]):
            pair = order.pairs[place]
            if carried_bound(world.pairs, pair, state.carried) < nearest:
                lower_bound = bounded_again(surface, world, pair, state, nearest)
                if lower_bound < nearest:
                    nearest = lower_bound
                    winner = pair
    return winner


@inline
def _measured_pair(world, pair, lower_bound, gap, effort, lent, state, tally):
    """The nearest points of a pair, if within `gap` [m], and a proven bound [m], which is stored.

    Many arguments: it is inlined into its one caller, whose locals they are.
    """
    placed, answers, carried = state.placed, state.answers, state.carried
    body_a, body_b = world.pairs[pair, 0], world.pairs[pair, 1]
    moves, moved = placed.moves[body_a] + placed.moves[body_b], moved_of(world.pairs, pair, carried)
    if is_still_valid(answers, pair, moves, gap):
        return answer_of(answers, pair)
    ahead = moved / max(1, placed.visits[body_a])
    limit = gap + (STEPS_AHEAD * ahead if ahead < LITTLE * gap else 0.0)
    if lower_bound <= 0.0:
        forget_front(carried.fronts, pair)  # where bodies may meet, a search from the roots is best
    not_nested = (
        lower_bound > 0.0 or effort < TO_THE_END
    )  # an upper bound holds for nested bodies too
    touches = was_contact(answers, pair)
    measured = search(
        PosedPair(
            lent,
            world.solids[body_a],
            lent,
            world.solids[body_b],
            pair_frames(world, pair, placed.poses),
        ),
        PairQuestion(
            limit, gap, carried.faces[pair, 0], carried.faces[pair, 1], not_nested, effort, touches
        ),
        front_of(world.pairs, pair, carried),
        state.scratch,
    )
    note_answer(answers, pair, moves, measured.hit, measured.lower_bound)
    carry(world.pairs, pair, measured.lower_bound, carried)
    carry_faces(pair, measured, carried)
    tally[0] -= 1
    tally[1] += 1
    tally[2] += measured.tally.nodes
    tally[3] += measured.tally.faces
    return measured.hit, measured.lower_bound


@inline
def _with_pair(surface, lent, world, pair, question, goal, state, best, pair_rows, tally):
    """(the best of a row after a pair, [m] a bound on its distance): the pair is measured if it may be nearer.

    Many arguments: it is inlined into its one caller, whose locals they are.
    """
    gap = state.within[pair] if goal.each else best.gap
    lower_bound = carried_bound(world.pairs, pair, state.carried)
    if lower_bound <= 0.0 or gap < np.inf:
        lower_bound = bounded_again(surface, world, pair, state, gap)
    if lower_bound <= gap:
        hit, lower_bound = _measured_pair(
            world, pair, lower_bound, gap, question.effort, lent, state, tally
        )
        if hit.face_a != 2**62:
            seen = np.sqrt(hit.gap_sq)
            if hit.gap_sq < best.hit.gap_sq or (hit.gap_sq == best.hit.gap_sq and pair < best.pair):
                best = RowNearest(hit, pair, best.gap if goal.each else min(gap, seen), best.lowest)
            if goal.each:
                write_pair(question.row, question.step, pair, hit, pair_rows)
                if goal.lasting:
                    state.within[pair] = min(gap, seen * NOT_LESS)
    return best, lower_bound


@inline
def nearest_of(lent, world, question, goal, state, pair_rows, tally):
    """The nearest pair of some bodies at a row, as a `RowNearest`; `lent` is the surface of all bodies."""
    surface = lent
    order, first = state.order, question.first
    best = RowNearest(nothing_yet(np.inf), -1, state.within[0], question.lowest)
    lowest = question.lowest
    order.pairs[len(world.pairs)] = first
    tally[0] += len(world.pairs)
    forget_between(world.groups, question.bodies, state.schedule)
    for turn in range(-1 if first >= 0 else 0, len(question.bodies)):
        body = (
            len(world.frames) if turn < 0 else question.bodies[turn]
        )  # the list of the first pair
        nearest = between = np.inf
        place, end = order.starts[body], order.starts[body + 1]
        in_order, stop = order.ends[body], order.ends[body]
        while place < end:
            pair = order.pairs[place]
            place += 1
            lower_bound = carried_bound(world.pairs, pair, state.carried)
            is_beyond = not goal.each and lower_bound > best.gap
            if turn >= 0 and pair == first:
                lower_bound = spare(world, first, state, goal)
            elif best.hit.gap_sq == 0.0 and pair > best.pair and not goal.each:
                pass  # no nearer, and not the least pair
            elif pair == question.known:
                lowest = min(lowest, lower_bound)
                lower_bound = spare(world, pair, state, goal)
            elif is_beyond:
                lowest = min(lowest, lower_bound)
                if place <= in_order:  # and so are those after it
                    stop, place = place, in_order
            else:
                best, lower_bound = _with_pair(
                    surface, lent, world, pair, question, goal, state, best, pair_rows, tally
                )
                lowest = min(lowest, lower_bound)
                lower_bound = spare(world, pair, state, goal)
            if place <= in_order:
                nearest = min(nearest, lower_bound)
            else:
                between = min(between, lower_bound)
        if turn >= 0:
            note_visit(body, question.row, nearest, state.schedule)
            note_between(world.groups[body], between, state.schedule)
        if goal.each:
            continue
        if turn < 0:
            sort_one(state.carried.lower_bounds, order, world.pairs[first, 0], first)
        else:
            sort_first(state.carried.lower_bounds, order, body, stop)
    return RowNearest(best.hit, best.pair, best.gap, lowest)
