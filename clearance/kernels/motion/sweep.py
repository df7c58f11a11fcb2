"""The least clearance of every step, of every pair, or of all: bounds carried from step to step.

Between steps no point of a body moves farther than `displacement` says, so that a bound on a pair's
distance, less what both bodies have moved since, still holds; pairs whose carried bound exceeds the best
are not asked. Where only what is near is asked for, only the bodies are looked at that may have come near (`due`).
"""

from typing import NamedTuple

import numpy as np

from clearance.compile.jit import inline, kernel, shared
from clearance.compile.kernel_table import borrow, lend
from clearance.kernels.features.face_pair import Hit, nothing_yet
from clearance.kernels.features.posed_pair import PosedPair
from clearance.kernels.motion.answer_cache import (
    AnswerCache,
    answer_of,
    no_answers,
    note_answer,
    still_holds,
    was_contact,
)
from clearance.kernels.motion.body_boxes import BodyBoxes, new_body_boxes
from clearance.kernels.motion.interval_motion_bound import fill_motion_radii
from clearance.kernels.motion.pair_order import (
    PairOrder,
    fill_order,
    new_pair_order,
    sort_all,
    sort_first,
    sort_one,
)
from clearance.kernels.motion.placed import PlacedBodies, bring, new_placed_bodies, put_all
from clearance.kernels.motion.schedule import (
    Schedule,
    all_due,
    find_due,
    forget_between,
    new_schedule,
    note_between,
    note_look,
)
from clearance.kernels.motion.sweep_goal import SweptSteps
from clearance.kernels.motion.sweep_rows import pass_over, write_pair, write_step
from clearance.kernels.motion.world import box_bound, pair_frames
from clearance.kernels.search.body_pair import NO_FACE, TO_THE_END, PairQuestion, measure_pair
from clearance.kernels.search.front import (
    KEPT_DOWN,
    POOL,
    Fronts,
    PairFront,
    forget,
    no_fronts,
)
from clearance.kernels.search.scratch import Scratch, new_scratch

LOOK_AHEAD = 2.0
"""Mean displacements between two looks: within so many of them beyond the best a pair is still measured, so that
its bound lasts."""

LITTLE = 0.03
"""Of the best: where bodies move more in a step, nothing is measured beyond it."""


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

    within: np.ndarray
    lower_bounds: np.ndarray
    order: PairOrder
    witness_faces: np.ndarray
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
def _spare(world, pair, state, goal):
    """[m] the same, less how near the pair must come where that is another distance for each."""
    return carried(world, pair, state) - (state.within[pair] if goal.each else 0.0)


@inline(force=True)
def _bounded_again(surface, world, pair, state, enough):
    """[m] the better of the carried bound of a pair and that of both bodies' boxes now; it is carried on."""
    by_boxes = box_bound(surface, world, pair, state.placed, state.boxes, enough)
    lower_bound = max(carried(world, pair, state), by_boxes)
    state.lower_bounds[pair] = (lower_bound + moved_by(world, pair, state.placed)) * KEPT_DOWN
    return lower_bound


@inline(force=True)
def nearest_by_boxes(surface, world, bodies, state, winner):
    """The pair to ask first where the last winner has moved farther than it was apart."""
    order = state.order
    nearest = np.inf
    for body in bodies:
        place, end = order.starts[body], order.ends[body]
        while place < end:
            pair = order.pairs[place]
            if carried(world, pair, state) >= nearest:
                break
            lower_bound = _bounded_again(surface, world, pair, state, nearest)
            if lower_bound < nearest:
                nearest = lower_bound
                winner = pair
            place += 1
        sort_first(state.lower_bounds, order, body, place)
        for place in range(end, order.starts[body + 1]):
            pair = order.pairs[place]
            if carried(world, pair, state) < nearest:
                lower_bound = _bounded_again(surface, world, pair, state, nearest)
                if lower_bound < nearest:
                    nearest = lower_bound
                    winner = pair
    return winner


@inline(one_caller=True)
def _asked(world, pair, lower_bound, gap, effort, lent, state, tally, table):
    """The nearest points of a pair, if within `gap` [m], and a proven bound [m]; it is carried on.

    Many arguments: it is inlined into its one caller, whose locals they are.
    """
    placed, answers, witness_faces = state.placed, state.answers, state.witness_faces
    body_a, body_b = world.pairs[pair, 0], world.pairs[pair, 1]
    moves, moved = placed.moves[body_a] + placed.moves[body_b], moved_by(world, pair, placed)
    if still_holds(answers, pair, moves, gap):
        return answer_of(answers, pair)
    ahead = moved / max(1, placed.looks[body_a])
    limit = gap + (LOOK_AHEAD * ahead if ahead < LITTLE * gap else 0.0)
    if lower_bound <= 0.0:
        forget(state.fronts, pair)  # where bodies may meet, nearest first from the roots is best
    apart = lower_bound > 0.0 or effort < TO_THE_END  # an upper bound is one inside, too
    touches = was_contact(answers, pair)
    measured = measure_pair(
        table,
        PosedPair(
            lent,
            world.solids[body_a],
            lent,
            world.solids[body_b],
            pair_frames(world, pair, placed.poses),
        ),
        PairQuestion(
            limit, gap, witness_faces[pair, 0], witness_faces[pair, 1], apart, effort, touches
        ),
        PairFront(state.fronts, pair, moved),
        state.scratch,
    )
    note_answer(answers, pair, moves, measured.hit, measured.lower_bound)
    state.lower_bounds[pair] = (measured.lower_bound + moved) * KEPT_DOWN
    witness_faces[pair, 0], witness_faces[pair, 1] = measured.face_a, measured.face_b
    tally[0] -= 1
    tally[1] += 1
    tally[2] += measured.tally.nodes
    tally[3] += measured.tally.faces
    return measured.hit, measured.lower_bound


@inline(one_caller=True)
def _next_look(world, positions, row, look, within, due, rows, tally):
    """The next row, from `row` on, at which a body is due; writes those before, where nothing comes `within` [m].

    Returns (row, how many bodies are due, [m] how near those can be that are not).
    """
    n_due = 0
    lowest = np.inf
    while n_due == 0 and row < len(positions):
        n_due, lowest = find_due(world, positions, row, look, within, due)
        if n_due == 0:
            pass_over(len(world.pairs), row, lowest, rows, tally)
            row += 1
    return row, n_due, lowest


class RowLook(NamedTuple):
    """What one row asks for.

    Attributes:
        bodies: those that are looked at. row: its place in the results. step: its number.
        first: the pair that is asked before all others, or -1.
        lowest: [m] a bound on the distance of all pairs of all other bodies.
        effort: of `PairQuestion`.
    """

    bodies: np.ndarray
    row: int
    step: int
    first: int
    lowest: float
    effort: int


class RowNearest(NamedTuple):
    """What a row comes to.

    Attributes:
        hit, pair: the nearest points and their pair, or -1. gap: [m] what is farther is not asked.
        lowest: [m] a bound on the distance of all pairs.
    """

    hit: Hit
    pair: int
    gap: float
    lowest: float


@inline(one_caller=True)
def _with_pair(surface, lent, world, pair, look, goal, state, best, pair_rows, tally, table):
    """(the best of a row after a pair, [m] a bound on its distance): it is measured where it may be nearer.

    Many arguments: it is inlined into its one caller, whose locals they are.
    """
    gap = state.within[pair] if goal.each else best.gap
    lower_bound = carried(world, pair, state)
    if lower_bound <= 0.0 or gap < np.inf:
        lower_bound = _bounded_again(surface, world, pair, state, gap)
    if lower_bound <= gap:
        hit, lower_bound = _asked(
            world, pair, lower_bound, gap, look.effort, lent, state, tally, table
        )
        if hit.face_a != 2**62:
            seen = np.sqrt(hit.gap_sq)
            if hit.gap_sq < best.hit.gap_sq or (hit.gap_sq == best.hit.gap_sq and pair < best.pair):
                best = RowNearest(hit, pair, best.gap if goal.each else min(gap, seen), best.lowest)
            if goal.each:
                write_pair(look.row, look.step, pair, hit, pair_rows)
                if goal.lasting:
                    state.within[pair] = min(gap, seen * NOT_LESS)
    return best, lower_bound


@inline(one_caller=True)
def nearest_of(lent, world, look, goal, state, pair_rows, tally, table):
    """The nearest pair of some bodies at a row, as a `RowNearest`; `lent` is the surface of all bodies."""
    surface = borrow(lent)
    order, first = state.order, look.first
    best = RowNearest(nothing_yet(np.inf), -1, state.within[0], look.lowest)
    lowest = look.lowest
    order.pairs[len(world.pairs)] = first
    tally[0] += len(world.pairs)
    forget_between(world.groups, look.bodies, state.due)
    for turn in range(-1 if first >= 0 else 0, len(look.bodies)):
        body = len(world.frames) if turn < 0 else look.bodies[turn]  # the list of one, asked first
        nearest = between = np.inf
        place, end = order.starts[body], order.starts[body + 1]
        in_order, stop = order.ends[body], order.ends[body]
        while place < end:
            pair = order.pairs[place]
            place += 1
            lower_bound = carried(world, pair, state)
            is_beyond = not goal.each and lower_bound > best.gap
            if turn >= 0 and pair == first:
                lower_bound = _spare(world, first, state, goal)
            elif best.hit.gap_sq == 0.0 and pair > best.pair and not goal.each:
                pass  # no nearer, and not the least pair
            elif is_beyond:
                lowest = min(lowest, lower_bound)
                if place <= in_order:  # and so are those after it
                    stop, place = place, in_order
            else:
                best, lower_bound = _with_pair(
                    surface, lent, world, pair, look, goal, state, best, pair_rows, tally, table
                )
                lowest = min(lowest, lower_bound)
                lower_bound = _spare(world, pair, state, goal)
            if place <= in_order:
                nearest = min(nearest, lower_bound)
            else:
                between = min(between, lower_bound)
        if turn >= 0:
            note_look(body, look.row, nearest, state.due)
            note_between(world.groups[body], between, state.due)
        if goal.each:
            continue
        if turn < 0:
            sort_one(state.lower_bounds, order, world.pairs[first, 0], first)
        else:
            sort_first(state.lower_bounds, order, body, stop)
    return RowNearest(best.hit, best.pair, best.gap, lowest)


@shared
def nothing_known(world, n_columns, within):
    n_pairs, n_bodies = len(world.pairs), len(world.frames)
    return SweepState(
        within, np.empty(n_pairs), new_pair_order(n_bodies, n_pairs), np.full((n_pairs, 2), NO_FACE),
        new_placed_bodies(len(world.links.parents), n_bodies), new_schedule(n_bodies, n_columns),
        new_body_boxes(n_bodies), no_answers(n_pairs), no_fronts(n_pairs, POOL), new_scratch(),
    )  # fmt: skip


@kernel
def sweep(surface, world, path, goal, first, found, tally, table):
    """Fills `found` and `tally`: pairs skipped, queries, nodes, faces, steps passed over.

    Ties go to the least pair. What is exact in the rows does not depend on where a sweep starts. Without
    `goal.each`, the rows of pairs are not touched.

    Args:
        path: a `SweptSteps`. found: `SweepRows`.
        first: a `FirstLook`, for a goal that is lasting, with one best for all pairs.
    """
    positions = path.positions
    for i in range(len(tally)):
        tally[i] = 0
    n_columns = positions.shape[1]
    within = goal.within.copy()
    if len(first.rows) > 0:
        few = np.empty((len(first.rows), n_columns))
        for i in range(len(few)):
            for column in range(n_columns):
                few[i, column] = positions[first.rows[i], column]
        state = nothing_known(world, n_columns, within)
        rough = SweptSteps(few, first.rows)
        _sweep(surface, world, rough, goal, first.effort, state, found, tally, table)
    state = nothing_known(world, n_columns, within)
    _sweep(surface, world, path, goal, TO_THE_END, state, found, tally, table)


@kernel(reference_counts=False)
def _sweep(surface, world, path, goal, effort, state, found, tally, table):
    """`sweep`, with the arrays of its state. The rows after a first look are overwritten.

    Many arguments: those of `sweep`, and what it has made; called once a sweep.
    """
    positions, steps, rows = path.positions, path.steps, found.rows
    within, lower_bounds, order = state.within, state.lower_bounds, state.order
    placed, due = state.placed, state.due
    put_all(world, positions[0], placed)
    for pair in range(len(world.pairs)):
        lower_bounds[pair] = box_bound(surface, world, pair, placed, state.boxes, np.inf)
    winner = np.argmin(lower_bounds)
    fill_order(world.pairs, world.frames, order)
    if not goal.each:
        sort_all(lower_bounds, order)
    near_only = within[0] < np.inf
    if near_only:
        fill_motion_radii(surface, world, positions, due.motion_radii, due.noise)
    n_due = all_due(world.frames, due)
    lent = lend(surface)
    lowest = np.inf
    row = 0
    look = 0
    while row < len(steps):
        bodies = due.bodies[:n_due]
        if look > 0:
            bring(surface, world, bodies, positions[row], look, placed)
        first = winner if not near_only or due.looks[world.pairs[winner, 0]] == look else -1
        if (
            first >= 0
            and carried(world, first, state) <= 0.0
            and not was_contact(state.answers, first)
        ):
            first = nearest_by_boxes(surface, world, bodies, state, first)
        asked = RowLook(bodies, row, steps[row], first, lowest, effort)
        best = nearest_of(lent, world, asked, goal, state, found.pair_rows, tally, table)
        lowest = best.lowest
        if best.pair >= 0:
            winner = best.pair
            if goal.lasting and not goal.each:
                within[0] = min(within[0], np.sqrt(best.hit.gap_sq) * NOT_LESS)
        write_step(row, best.pair, best.hit, lowest, rows)
        row += 1
        look += 1
        if (
            goal.lasting and not goal.each and best.hit.gap_sq == 0.0
        ):  # nothing is nearer than contact
            for after in range(row, len(steps)):
                pass_over(len(world.pairs), after, 0.0, rows, tally)
            break
        lowest = np.inf
        if near_only:
            enough = 0.0 if goal.each else within[0]
            row, n_due, lowest = _next_look(world, positions, row, look, enough, due, rows, tally)
