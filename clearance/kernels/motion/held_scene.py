"""A scene asked about at one configuration after another: what a look has found is held for the next one.

Surfaces, bodies and all that is known are written down once, and a call from Python hands over the address, as in
`pair_query`. Not for: many steps that are known beforehand (`sweep`, whose answers these are).
"""

from typing import NamedTuple

import numpy as np

from clearance.compile.calls import Written
from clearance.compile.declared import Floats2, Integers
from clearance.compile.decorators import inline, kernel
from clearance.compile.lending import lend
from clearance.kernels.mesh.surface import Surface
from clearance.kernels.motion.pair_order import fill_order, sort_all
from clearance.kernels.motion.placed import bring, put_all
from clearance.kernels.motion.row_search import RowLook, nearest_by_boxes, nearest_of
from clearance.kernels.motion.schedule import all_due
from clearance.kernels.motion.sweep_goal import Goal
from clearance.kernels.motion.sweep_rows import PairRows, StepRows, write_step
from clearance.kernels.motion.sweep_state import SweepState, new_sweep_state
from clearance.kernels.motion.world import World, box_bound
from clearance.kernels.search.body_pair import TO_THE_END
from clearance.kernels.search.carried import carried_bound

LOOK, WINNER = 0, 1

AFRESH = 2**21
"""Looks after which nothing is carried on: displacements are bounded for twice as many (`placed.GROWTH`)."""


class HeldScene(NamedTuple):
    """A scene and what is known of it.

    Attributes:
        surface, world: all bodies, and what moves them.
        goal, pair_rows: of `sweep`: the nearest pair of all, at any distance; no rows for pairs.
        state: what is carried from look to look.
        at: (2,) looks that came to their end since all was begun afresh, and the pair that was nearest.
    """

    surface: Surface
    world: World
    goal: Goal
    pair_rows: PairRows
    state: SweepState
    at: Integers


class Scene:
    """A scene as Python holds it: written down once, so that a question hands over one address."""

    def __init__(self, surface, world, pair_rows, n_columns) -> None:
        self._goal = Goal(np.full(len(world.pairs), np.inf), False, False)
        self._given = surface, world, pair_rows, n_columns
        self._at = np.zeros(2, dtype=np.int64)
        self._begin_afresh()

    def _begin_afresh(self) -> None:
        surface, world, pair_rows, n_columns = self._given
        state = new_sweep_state(world, n_columns, self._goal.within.copy())
        self._at[LOOK] = 0
        held = HeldScene(surface, world, self._goal, pair_rows, state, self._at)
        self._held = Written(held, HeldScene)

    def always_at(self, positions, rows, tally):
        """`nearest_at` with these arrays for all times, (1, columns): their addresses are written down once."""
        of, ask = None, None

        def nearest() -> None:
            nonlocal of, ask
            if self._at[LOOK] == 0 or self._at[LOOK] >= AFRESH:
                self._begin_afresh()
            if of is not self._held:
                of = self._held
                ask = nearest_at_positions.prepared(of, positions, 0, rows, tally)
            tally[:] = 0
            ask()

        return nearest

    def nearest_at(self, positions, rows, tally) -> None:
        """Fills `rows` for the joints at `positions` (k, columns) [rad or m]; `tally` as in `sweep`.

        A call that did not come to its end leaves nothing to carry on: the next one begins afresh.
        """
        tally[:] = 0
        done = 0
        while done < len(positions):
            if self._at[LOOK] == 0 or self._at[LOOK] >= AFRESH:
                self._begin_afresh()
            done = nearest_at_positions(self._held, positions, done, rows, tally)


@kernel
def nearest_at_positions(
    held: HeldScene, positions: Floats2, first: int, rows: StepRows, tally: Integers
) -> int:
    """Fills `rows` from row `first` on, until all are done or all must begin afresh; the next row."""
    row = first
    while row < len(positions) and held.at[LOOK] < AFRESH:
        _look(
            held.surface, held.world, held.goal, held.pair_rows, held.state, held.at, positions[row], row, rows,
            tally,
        )  # fmt: skip
        row += 1
    return row


@inline
def _look(surface, world, goal, pair_rows, state, at, positions, row, rows, tally):
    """Writes the nearest pair with the joints at `positions` (columns,), as `sweep` does for a step.

    Many arguments: what belongs together is in tuples already.
    """
    look = at[LOOK]
    at[LOOK] = 0
    bodies = state.due.bodies[: all_due(world.frames, state.due)]
    if look == 0:
        put_all(world, positions, state.placed)
        for pair in range(len(world.pairs)):
            bound = box_bound(surface, world, pair, state.placed, state.boxes, np.inf)
            state.carried.lower_bounds[pair] = bound
        at[WINNER] = np.argmin(state.carried.lower_bounds)
        fill_order(world.pairs, world.frames, state.order)
        sort_all(state.carried.lower_bounds, state.order)
    else:
        bring(surface, world, bodies, positions, look, state.placed, state.carried.moved)
    first = at[WINNER]
    if carried_bound(world.pairs, first, state.carried) <= 0.0:
        first = nearest_by_boxes(surface, world, bodies, state, first)
    asked = RowLook(bodies, row, row, first, -1, np.inf, TO_THE_END)
    best = nearest_of(lend(surface), world, asked, goal, state, pair_rows, tally)
    at[WINNER] = best.pair
    at[LOOK] = look + 1
    write_step(row, best.pair, best.hit, best.lowest, rows)
