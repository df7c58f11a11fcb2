"""The least clearance of every step, of every pair, or of all: bounds carried from step to step.

Between steps no point of a body moves farther than `displacement` says, so that a bound on a pair's
distance, less what both bodies have moved since, still holds; pairs whose carried bound exceeds the best
are not asked. Where only what is near is asked for, only the bodies are looked at that may have come near (`due`).
"""

from typing import NamedTuple

import numpy as np

from clearance.compile.jit import inline, kernel, shared
from clearance.compile.kernel_table import lend
from clearance.kernels.arithmetic.double_double import frames_of
from clearance.kernels.arithmetic.vec3 import rigid
from clearance.kernels.motion.answer_cache import (
    AnswerCache,
    answer_of,
    no_answers,
    note_answer,
    still_holds,
    was_contact,
)
from clearance.kernels.motion.body_boxes import (
    BodyBoxes,
    bound_of_bodies,
    new_body_boxes,
    place_box,
)
from clearance.kernels.motion.interval_motion_bound import fill_motion_radii
from clearance.kernels.motion.kinematics import Links
from clearance.kernels.motion.pair_order import (
    PairOrder,
    fill_order,
    new_pair_order,
    sort_all,
    sort_first,
    sort_one,
)
from clearance.kernels.motion.placed import PlacedBodies, bring, new_placed_bodies, put_all
from clearance.kernels.motion.schedule import Schedule, all_due, find_due, new_schedule, note_look
from clearance.kernels.motion.sweep_rows import pass_over, write_pair, write_step
from clearance.kernels.search.body_pair import NO_FACE, TO_THE_END, PairQuestion, measure_pair
from clearance.kernels.search.descent import nothing_yet
from clearance.kernels.search.front import KEPT_DOWN, POOL, Fronts, forget, no_fronts
from clearance.kernels.search.scratch import Scratch, new_scratch

LOOK_AHEAD = 2.0
"""Mean displacements between two looks: within so many of them beyond the best a pair is still measured, so that
its bound lasts."""

LITTLE = 0.03
"""Of the best: where bodies move more in a step, nothing is measured beyond it."""


NOT_LESS = 1.0 + 2.0**-50
"""Makes room for what is equally near after its square was rounded."""


class World(NamedTuple):
    """What moves where.

    Attributes:
        frames: (bodies,) link that carries the body, or -1 for one that stands.
        standing: (bodies, 4, 4) poses of the bodies that stand [m].
        pairs: (p, 2) bodies to measure against each other: first one that a link carries, then one that stands.
        links: what moves the links.
    """

    frames: np.ndarray
    standing: np.ndarray
    pairs: np.ndarray
    links: Links


class Goal(NamedTuple):
    """What is asked of a sweep.

    Attributes:
        within: (p,) [m] each pair is measured only where it is not farther apart; the same for all pairs
            unless `each`.
        each: every pair has a best of its own; else all pairs of a step share one.
        lasting: a best holds for the later steps too: only what is nearer than all before is measured.
    """

    within: np.ndarray
    each: bool
    lasting: bool


class FirstLook(NamedTuple):
    """A rough look at a few rows before all others: how near those come, no later one need be farther.

    Attributes:
        rows: (m,) in their order; none if there is to be no such look.
        effort: of `PairQuestion`; what is found with less than `TO_THE_END` is an upper bound.
    """

    rows: np.ndarray
    effort: int


@inline(force=True)
def pair_frames(world, pair, poses):
    """Where both bodies of a pair are, of `poses` (bodies, 4, 4)."""
    return frames_of(rigid(poses[world.pairs[pair, 0]]), rigid(poses[world.pairs[pair, 1]]))


@inline(force=True)
def box_bound(surface, world, pair, placed, boxes, enough):
    """[m] a lower bound on the distance of a pair by the boxes of both bodies; one above `enough` will do."""
    body_a, body_b = world.pairs[pair, 0], world.pairs[pair, 1]
    for body in (body_a, body_b):
        if boxes.moves[body] != placed.moves[body]:
            place_box(surface, body, rigid(placed.poses[body]), boxes)
            boxes.moves[body] = placed.moves[body]
    return bound_of_bodies(boxes, body_a, body_b, enough)


class SweepState(NamedTuple):
    """What is carried from step to step, and room for the search.

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
def carried(world, pair, state):
    """[m] what is left of the bound of a pair: only its first body moves."""
    return state.lower_bounds[pair] - state.placed.displacements[world.pairs[pair, 0]]


@inline(force=True)
def _spare(world, pair, state, goal):
    """[m] the same, less how near the pair must come where that is another distance for each."""
    return carried(world, pair, state) - (state.within[pair] if goal.each else 0.0)


@inline(force=True)
def _bounded_again(surface, world, pair, state, enough):
    """[m] the better of the carried bound of a pair and that of both bodies' boxes now; it is carried on."""
    by_boxes = box_bound(surface, world, pair, state.placed, state.boxes, enough)
    lower_bound = max(carried(world, pair, state), by_boxes)
    state.lower_bounds[pair] = (
        lower_bound + state.placed.displacements[world.pairs[pair, 0]]
    ) * KEPT_DOWN
    return lower_bound


@inline(force=True)
def nearest_by_boxes(surface, world, bodies, state, winner):
    """The pair to ask first where the last winner has moved farther than it was apart."""
    order = state.order
    nearest = np.inf
    for body in bodies:
        place = order.starts[body]
        while place < order.starts[body + 1]:
            pair = order.pairs[place]
            if carried(world, pair, state) >= nearest:
                break
            lower_bound = _bounded_again(surface, world, pair, state, nearest)
            if lower_bound < nearest:
                nearest = lower_bound
                winner = pair
            place += 1
        sort_first(state.lower_bounds, order, body, place)
    return winner


@inline(one_caller=True)
def _asked(world, pair, lower_bound, gap, effort, lent, state, tally, table):
    """The nearest points of a pair, if within `gap` [m], and a proven bound [m]; it is carried on."""
    placed, answers, witness_faces = state.placed, state.answers, state.witness_faces
    body_a, body_b = world.pairs[pair, 0], world.pairs[pair, 1]
    moves, moved = placed.moves[body_a], placed.displacements[body_a]
    if still_holds(answers, pair, moves, gap):
        return answer_of(answers, pair)
    ahead = moved / max(1, placed.looks[body_a])
    limit = gap + (LOOK_AHEAD * ahead if ahead < LITTLE * gap else 0.0)
    if lower_bound <= 0.0:
        forget(state.fronts, pair)  # where bodies may meet, nearest first from the roots is best
    apart = lower_bound > 0.0 or effort < TO_THE_END  # an upper bound is one inside, too
    measured = measure_pair(
        lent, body_a, lent, body_b, pair_frames(world, pair, placed.poses),
        PairQuestion(
            limit, gap, witness_faces[pair, 0], witness_faces[pair, 1], apart, effort, was_contact(answers, pair)
        ),
        state.fronts, pair, moved, state.scratch, table,
    )  # fmt: skip
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
        n_due, lowest = find_due(world.frames, positions, row, look, within, due)
        if n_due == 0:
            pass_over(len(world.pairs), row, lowest, rows, tally)
            row += 1
    return row, n_due, lowest


@inline(one_caller=True)
def nearest_of(
    surface, world, bodies, first, row, step, lowest, goal, effort, lent, state, pair_rows, tally, table
):  # fmt: skip
    """The nearest pair of some bodies at a row, one of which is asked before all others unless it is -1.

    Returns (its nearest points, the pair or -1, [m] a bound on the distance of all pairs where `lowest` is one on
    that of all other bodies').
    """
    within, lower_bounds, order = state.within, state.lower_bounds, state.order
    best, best_pair = nothing_yet(np.inf), -1
    gap = within[0]
    order.pairs[len(world.pairs)] = first
    tally[0] += len(world.pairs)
    for turn in range(-1 if first >= 0 else 0, len(bodies)):
        body = (
            len(world.frames) if turn < 0 else bodies[turn]
        )  # the list of one that is asked first
        nearest = np.inf
        if first >= 0 and body == world.pairs[first, 0]:
            nearest = _spare(world, first, state, goal)
        place, end = order.starts[body], order.starts[body + 1]
        while place < end:
            pair = order.pairs[place]
            place += 1
            if turn >= 0 and pair == first:
                continue
            lower_bound = carried(world, pair, state)
            if (
                best.gap_sq == 0.0 and pair > best_pair and not goal.each
            ):  # no nearer, and not the least pair
                nearest = min(nearest, lower_bound)
                continue
            if goal.each:
                gap = within[pair]
            elif lower_bound > gap:  # and so are those after it
                lowest, nearest = min(lowest, lower_bound), min(nearest, lower_bound)
                break
            if lower_bound <= 0.0 or gap < np.inf:
                lower_bound = _bounded_again(surface, world, pair, state, gap)
            if lower_bound > gap:
                lowest, nearest = (
                    min(lowest, lower_bound),
                    min(nearest, _spare(world, pair, state, goal)),
                )
                continue
            hit, lower_bound = _asked(
                world, pair, lower_bound, gap, effort, lent, state, tally, table
            )
            lowest, nearest = (
                min(lowest, lower_bound),
                min(nearest, _spare(world, pair, state, goal)),
            )
            if hit.face_a == 2**62:
                continue
            if hit.gap_sq < best.gap_sq or (hit.gap_sq == best.gap_sq and pair < best_pair):
                best, best_pair = hit, pair
                if not goal.each:
                    gap = min(gap, np.sqrt(hit.gap_sq))
            if goal.each:
                write_pair(row, step, pair, hit, pair_rows)
                if goal.lasting:
                    within[pair] = min(gap, np.sqrt(hit.gap_sq) * NOT_LESS)
        if turn >= 0:
            note_look(body, row, nearest, state.due)
        if goal.each:
            continue
        if turn < 0:
            sort_one(lower_bounds, order, world.pairs[first, 0], first)
        else:
            sort_first(lower_bounds, order, body, place)
    return best, best_pair, lowest


@shared
def nothing_known(world, n_columns, within):
    n_pairs, n_bodies = len(world.pairs), len(world.frames)
    return SweepState(
        within, np.empty(n_pairs), new_pair_order(n_bodies, n_pairs), np.full((n_pairs, 2), NO_FACE),
        new_placed_bodies(len(world.links.parents), n_bodies), new_schedule(n_bodies, n_columns),
        new_body_boxes(n_bodies), no_answers(n_pairs), no_fronts(n_pairs, POOL), new_scratch(),
    )  # fmt: skip


@kernel
def sweep(surface, world, positions, steps, goal, first, rows, pair_rows, tally, table):
    """Fills `rows` for `steps` (k,) and `tally`: pairs skipped, queries, nodes, faces, steps passed over.

    Ties go to the least pair. What is exact in the rows does not depend on where a sweep starts. Without
    `goal.each`, `pair_rows` is not touched.

    Args:
        positions: (k, columns) of the joints at the steps [rad or m].
        first: a `FirstLook`, for a goal that is lasting, with one best for all pairs.
    """
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
        _sweep(
            surface,
            world,
            few,
            first.rows,
            goal,
            first.effort,
            state,
            rows,
            pair_rows,
            tally,
            table,
        )
    state = nothing_known(world, n_columns, within)
    _sweep(surface, world, positions, steps, goal, TO_THE_END, state, rows, pair_rows, tally, table)


@kernel(reference_counts=False)
def _sweep(surface, world, positions, steps, goal, effort, state, rows, pair_rows, tally, table):
    """`sweep`, with room for what is known. The rows after a first look are overwritten."""
    within, lower_bounds, order, placed, due = (
        state.within,
        state.lower_bounds,
        state.order,
        state.placed,
        state.due,
    )
    put_all(world, positions[0], placed)
    for pair in range(len(world.pairs)):
        lower_bounds[pair] = box_bound(surface, world, pair, placed, state.boxes, np.inf)
    winner = np.argmin(lower_bounds)
    fill_order(world.pairs, order)
    if not goal.each:
        sort_all(lower_bounds, order)
    near_only = within[0] < np.inf
    if near_only:
        fill_motion_radii(
            surface, world.frames, world.links, positions, due.motion_radii, due.noise
        )
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
        best, best_pair, lowest = nearest_of(
            surface, world, bodies, first, row, steps[row], lowest, goal, effort, lent, state, pair_rows, tally,
            table,
        )  # fmt: skip
        if best_pair >= 0:
            winner = best_pair
            if goal.lasting and not goal.each:
                within[0] = min(within[0], np.sqrt(best.gap_sq) * NOT_LESS)
        write_step(row, best_pair, best, lowest, rows)
        row += 1
        look += 1
        if goal.lasting and not goal.each and best.gap_sq == 0.0:  # nothing is nearer than contact
            for after in range(row, len(steps)):
                pass_over(len(world.pairs), after, 0.0, rows, tally)
            break
        lowest = np.inf
        if near_only:
            enough = 0.0 if goal.each else within[0]
            row, n_due, lowest = _next_look(world, positions, row, look, enough, due, rows, tally)
