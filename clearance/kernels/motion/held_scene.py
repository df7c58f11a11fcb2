"""A scene asked about at one configuration after another: what a look has found is held for the next one.

Surfaces, bodies and all that is known lie in one structure on the heap, of which a call from Python hands over the
address, as in `pair_query`. Not for: many steps that are known beforehand (`sweep`, whose answers these are).
"""

from typing import NamedTuple

import numpy as np

from clearance.compile.heap import HeapHandle
from clearance.compile.jit import DISABLED, inline, kernel, lie_on_heap
from clearance.compile.kernel_table import lend
from clearance.kernels.motion.pair_order import fill_order, sort_all
from clearance.kernels.motion.placed import bring, put_all
from clearance.kernels.motion.row_search import RowLook, nearest_by_boxes, nearest_of
from clearance.kernels.motion.schedule import all_due
from clearance.kernels.motion.sweep_goal import Goal
from clearance.kernels.motion.sweep_rows import write_step
from clearance.kernels.motion.sweep_state import carried, new_sweep_state
from clearance.kernels.motion.world import box_bound
from clearance.kernels.search.body_pair import TO_THE_END

LOOK, WINNER = 0, 1

AFRESH = 2**21
"""Looks after which nothing is carried on: displacements are bounded for twice as many (`placed.GROWTH`)."""

_FIELDS = ("surface", "world", "goal", "pair_rows", "state", "at")


class HeldScene(NamedTuple):
    """A scene and what is known of it.

    Attributes:
        surface, world: all bodies, and what moves them.
        goal, pair_rows: of `sweep`: the nearest pair of all, at any distance; no rows for pairs.
        state: what is carried from look to look.
        at: (2,) looks that came to their end since all was begun afresh, and the pair that was nearest.
    """

    surface: object
    world: object
    goal: object
    pair_rows: object
    state: object
    at: np.ndarray


if not DISABLED:

    class HeldScene(HeapHandle):
        """The handle that Python has of a scene on the heap; fields as above."""

    lie_on_heap(HeldScene, _FIELDS)


@kernel
def hold_scene(surface, world, pair_rows, n_columns):
    """A scene of which nothing is known yet; `n_columns` of joint positions."""
    goal = Goal(np.full(len(world.pairs), np.inf), False, False)
    state = new_sweep_state(world, n_columns, goal.within.copy())
    return HeldScene(surface, world, goal, pair_rows, state, np.zeros(2, dtype=np.int64))


@kernel
def nearest_at_positions(held, positions, rows, tally, table):
    """Fills `rows` for the joints at `positions` (k, columns) [rad or m]; `tally` as in `sweep`.

    A call that did not come to its end leaves nothing to carry on: the next one begins afresh.
    """
    n_columns = positions.shape[1]
    for i in range(len(tally)):
        tally[i] = 0
    for row in range(len(positions)):
        if held.at[LOOK] == 0 or held.at[LOOK] >= AFRESH:
            held.state = new_sweep_state(held.world, n_columns, held.goal.within.copy())
            held.at[LOOK] = 0
        _look(
            held.surface, held.world, held.goal, held.pair_rows, held.state, held.at, positions[row], row, rows,
            tally, table,
        )  # fmt: skip


@inline(reference_counts=False)
def _look(surface, world, goal, pair_rows, state, at, positions, row, rows, tally, table):
    """Writes the nearest pair with the joints at `positions` (columns,), as `sweep` does for a step.

    Many arguments: what belongs together is in tuples already, which numba passes array by array.
    """
    look = at[LOOK]
    at[LOOK] = 0
    bodies = state.due.bodies[: all_due(world.frames, state.due)]
    if look == 0:
        put_all(world, positions, state.placed)
        for pair in range(len(world.pairs)):
            state.lower_bounds[pair] = box_bound(
                surface, world, pair, state.placed, state.boxes, np.inf
            )
        at[WINNER] = np.argmin(state.lower_bounds)
        fill_order(world.pairs, world.frames, state.order)
        sort_all(state.lower_bounds, state.order)
    else:
        bring(surface, world, bodies, positions, look, state.placed)
    first = at[WINNER]
    if carried(world, first, state) <= 0.0:
        first = nearest_by_boxes(surface, world, bodies, state, first)
    asked = RowLook(bodies, row, row, first, -1, np.inf, TO_THE_END)
    best = nearest_of(lend(surface), world, asked, goal, state, pair_rows, tally, table)
    at[WINNER] = best.pair
    at[LOOK] = look + 1
    write_step(row, best.pair, best.hit, best.lowest, rows)
