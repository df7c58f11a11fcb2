"""The least clearance of every step, of every pair, or of all: bounds carried from step to step.

`sweep_state` carries the bounds, and `row_search` asks the pairs of a step. If only near pairs are asked for, only
the bodies that may have come near are visited (`schedule`).
"""

import numpy as np

from clearance.compile.declared import Integers
from clearance.compile.decorators import inline, kernel
from clearance.compile.lending import lend
from clearance.kernels.mesh.surface import Surface
from clearance.kernels.motion.answer_cache import was_contact
from clearance.kernels.motion.interval_motion_bound import fill_motion_radii
from clearance.kernels.motion.pair_order import fill_order, sort_all
from clearance.kernels.motion.placed import bring, put_all
from clearance.kernels.motion.row_search import RowQuestion, nearest_by_boxes, nearest_of
from clearance.kernels.motion.schedule import all_due, find_due
from clearance.kernels.motion.sweep_goal import FirstPass, SweepGoal, SweptSteps
from clearance.kernels.motion.sweep_rows import SweepRows, pass_over, write_step
from clearance.kernels.motion.sweep_state import NOT_LESS, new_sweep_state
from clearance.kernels.motion.world import World, box_bound
from clearance.kernels.search.body_pair import TO_THE_END
from clearance.kernels.search.carried import carried_bound


@inline
def _next_visit(world, positions, row, visit, within, schedule, rows, tally):
    """The next row, from `row` on, at which a body is due; writes the rows before, where no pair comes `within`
    [m].

    Returns (row, how many bodies are due, [m] a bound on all others).
    """
    n_due = 0
    lowest = np.inf
    while n_due == 0 and row < len(positions):
        n_due, lowest = find_due(world, positions, row, visit, within, schedule)
        if n_due == 0:
            pass_over(len(world.pairs), row, lowest, rows, tally)
            row += 1
    return row, n_due, lowest


@kernel
def sweep(
    surface: Surface,
    world: World,
    path: SweptSteps,
    goal: SweepGoal,
    first: FirstPass,
    found: SweepRows,
    tally: Integers,
):
    """Fills `found` and `tally`: pairs skipped, queries, nodes, faces, steps skipped.

    Ties go to the least pair. The exact parts of the rows do not depend on where a sweep starts. Without
    `goal.each`, the rows of pairs are not written.

    Args:
        path: a `SweptSteps`. found: `SweepRows`.
        first: a `FirstPass`, for a lasting goal with one best for all pairs.
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
        state = lend(new_sweep_state(world, n_columns, within))
        rough = lend(SweptSteps(few, first.rows, path.known[:0]))
        _sweep(surface, world, rough, goal, first.effort, state, found, tally)
    state = lend(new_sweep_state(world, n_columns, within))
    _sweep(surface, world, path, goal, TO_THE_END, state, found, tally)


@inline
def _sweep(surface, world, path, goal, effort, state, found, tally):
    """`sweep`, with the arrays of its state. The rows of a first pass are overwritten.

    Many arguments: those of `sweep` and its state; called once a sweep.
    """
    positions, steps, rows = path.positions, path.steps, found.rows
    within, carried, order = state.within, state.carried, state.order
    lower_bounds = carried.lower_bounds
    placed, schedule = state.placed, state.schedule
    put_all(world, positions[0], placed)
    for pair in range(len(world.pairs)):
        lower_bounds[pair] = box_bound(surface, world, pair, placed, state.boxes, np.inf)
    winner = np.argmin(lower_bounds)
    fill_order(world.pairs, world.frames, order)
    if not goal.each:
        sort_all(lower_bounds, order)
    near_only = within[0] < np.inf
    if near_only:
        fill_motion_radii(surface, world, positions, schedule.motion_radii, schedule.noise)
    n_due = all_due(world.frames, schedule)
    lent = lend(surface)
    lowest = np.inf
    row = 0
    visit = 0
    while row < len(steps):
        bodies = schedule.bodies[:n_due]
        if visit > 0:
            bring(surface, world, bodies, positions[row], visit, placed, carried.moved)
        first = winner if not near_only or schedule.visits[world.pairs[winner, 0]] == visit else -1
        if (
            first >= 0
            and carried_bound(world.pairs, first, carried) <= 0.0
            and not was_contact(state.answers, first)
        ):
            first = nearest_by_boxes(surface, world, bodies, state, first)
        known = path.known[row] if len(path.known) > 0 else -1
        asked = RowQuestion(bodies, row, steps[row], first, known, lowest, effort)
        best = nearest_of(lent, world, asked, goal, state, found.pair_rows, tally)
        lowest = best.lowest
        if best.pair >= 0:
            winner = best.pair
            if goal.lasting and not goal.each:
                within[0] = min(within[0], np.sqrt(best.hit.gap_sq) * NOT_LESS)
        write_step(row, best.pair, best.hit, lowest, rows)
        row += 1
        visit += 1
        if (
            goal.lasting and not goal.each and best.hit.gap_sq == 0.0
        ):  # nothing is nearer than contact
            for after in range(row, len(steps)):
                pass_over(len(world.pairs), after, 0.0, rows, tally)
            break
        lowest = np.inf
        if near_only:
            enough = 0.0 if goal.each else within[0]
            row, n_due, lowest = _next_visit(
                world, positions, row, visit, enough, schedule, rows, tally
            )
