"""A scene asked about at one configuration after another: each question begins with the results of the last one.

Surfaces, bodies and state are written once, and a call from Python passes one address, as in `pair_query`. Not
for: many steps that are known beforehand (`sweep`, which gives the same answers).
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
from clearance.kernels.motion.row_search import RowQuestion, nearest_by_boxes, nearest_of
from clearance.kernels.motion.schedule import all_due
from clearance.kernels.motion.sweep_goal import SweepGoal
from clearance.kernels.motion.sweep_rows import PairRows, StepRows, write_step
from clearance.kernels.motion.sweep_state import SweepState, new_sweep_state
from clearance.kernels.motion.world import World, box_bound
from clearance.kernels.search.body_pair import TO_THE_END
from clearance.kernels.search.carried import carried_bound

VISIT, WINNER = 0, 1

AFRESH = 2**21
"""Questions after which the state is made anew: displacements are bounded for twice as many (`placed.GROWTH`)."""


class TrackedScene(NamedTuple):
    """A scene and its state.

    Attributes:
        surface, world: all bodies, and what moves them.
        goal, pair_rows: of `sweep`: the nearest pair of all, at any distance; no rows for pairs.
        state: of the sweep, from question to question.
        at: (2,) by `VISIT` the questions answered since the state was made, by `WINNER` the pair that was nearest.
    """

    surface: Surface
    world: World
    goal: SweepGoal
    pair_rows: PairRows
    state: SweepState
    at: Integers


class Scene:
    """A scene for Python: written once, so that a question passes one address."""

    def __init__(self, surface, world, pair_rows, n_columns) -> None:
        self._goal = SweepGoal(np.full(len(world.pairs), np.inf), False, False)
        self._given = surface, world, pair_rows, n_columns
        self._at = np.zeros(2, dtype=np.int64)
        self._begin_afresh()

    def _begin_afresh(self) -> None:
        surface, world, pair_rows, n_columns = self._given
        state = new_sweep_state(world, n_columns, self._goal.within.copy())
        self._at[VISIT] = 0
        tracked = TrackedScene(surface, world, self._goal, pair_rows, state, self._at)
        self._tracked = Written(tracked, TrackedScene)

    def always_at(self, positions, rows, tally):
        """`nearest_at` with the same arrays each time, (1, columns): their addresses are written once."""
        of, ask = None, None

        def nearest() -> None:
            nonlocal of, ask
            if self._at[VISIT] == 0 or self._at[VISIT] >= AFRESH:
                self._begin_afresh()
            if of is not self._tracked:
                of = self._tracked
                ask = nearest_at_positions.prepared(of, positions, 0, rows, tally)
            tally[:] = 0
            ask()

        return nearest

    def nearest_at(self, positions, rows, tally) -> None:
        """Fills `rows` for the joints at `positions` (k, columns) [rad or m]; `tally` as in `sweep`.

        After a call that was interrupted the state is made anew.
        """
        tally[:] = 0
        done = 0
        while done < len(positions):
            if self._at[VISIT] == 0 or self._at[VISIT] >= AFRESH:
                self._begin_afresh()
            done = nearest_at_positions(self._tracked, positions, done, rows, tally)


@kernel
def nearest_at_positions(
    tracked: TrackedScene, positions: Floats2, first: int, rows: StepRows, tally: Integers
) -> int:
    """Fills `rows` from row `first` on, until all are done or the state must be made anew; the next row."""
    row = first
    while row < len(positions) and tracked.at[VISIT] < AFRESH:
        _visit(
            tracked.surface, tracked.world, tracked.goal, tracked.pair_rows, tracked.state, tracked.at,
            positions[row], row, rows, tally,
        )  # fmt: skip
        row += 1
    return row


@inline
def _visit(surface, world, goal, pair_rows, state, at, positions, row, rows, tally):
    """Writes the nearest pair with the joints at `positions` (columns,), as `sweep` does for a step.

    Many arguments: they are grouped in tuples already.
    """
    visit = at[VISIT]
    at[VISIT] = 0
    bodies = state.schedule.bodies[: all_due(world.frames, state.schedule)]
    if visit == 0:
        put_all(world, positions, state.placed)
        for pair in range(len(world.pairs)):
            bound = box_bound(surface, world, pair, state.placed, state.boxes, np.inf)
            state.carried.lower_bounds[pair] = bound
        at[WINNER] = np.argmin(state.carried.lower_bounds)
        fill_order(world.pairs, world.frames, state.order)
        sort_all(state.carried.lower_bounds, state.order)
    else:
        bring(surface, world, bodies, positions, visit, state.placed, state.carried.moved)
    first = at[WINNER]
    if carried_bound(world.pairs, first, state.carried) <= 0.0:
        first = nearest_by_boxes(surface, world, bodies, state, first)
    asked = RowQuestion(bodies, row, row, first, -1, np.inf, TO_THE_END)
    best = nearest_of(lend(surface), world, asked, goal, state, pair_rows, tally)
    at[WINNER] = best.pair
    at[VISIT] = visit + 1
    write_step(row, best.pair, best.hit, best.lowest, rows)
