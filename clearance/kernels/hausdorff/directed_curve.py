"""Compiled directed Hausdorff distance of two curves: map, lower bound, trimming, exact rest.

The steps are those of Kim, Oh, Kim (2010); each lives in a file of its own. Not for: polylines
(`hausdorff.polyline`), the systems without trimming (`hausdorff.systems`).
"""

import numpy as np

from clearance.compile.declared import Floats
from clearance.compile.decorators import inline, kernel
from clearance.kernels.arithmetic.rows import with_capacity
from clearance.kernels.curve.arc import S0, S1, X0, X1, Y0, Y1
from clearance.kernels.curve.bezier import hypotenuse
from clearance.kernels.curve.distance_map import draw, lower_bound_of_map
from clearance.kernels.curve.pair import CurveArrays, CurvePair, Curves
from clearance.kernels.curve.scratch import (
    LARGEST_DEGREE,
    SearchScratch,
    new_scratch,
    widest,
)
from clearance.kernels.hausdorff.cutting import CAPACITY
from clearance.kernels.hausdorff.interval_search import MANY, close, examine
from clearance.kernels.hausdorff.queue import WIDTH, OpenInterval
from clearance.kernels.hausdorff.state import SearchGoal, SearchStates
from clearance.kernels.hausdorff.trim import trim
from clearance.kernels.hausdorff.witness import write_witness

PIXELS_AT_LEAST, PIXELS_AT_MOST = 32.0, 4096.0
SAMPLES = 1000
THE_DEEPEST, SOME_OF_MANY = range(2)


@inline
def _length_of_arcs(arcs):
    """The length of all chords, enough to choose a pixel by."""
    total = 0.0
    for k in range(arcs.shape[0]):
        total += hypotenuse(arcs[k, X1] - arcs[k, X0], arcs[k, Y1] - arcs[k, Y0])
    return total


@inline
def _search_candidates(pair, leaves, aim, drawn, sparing, candidates, state, work, heap):
    """Solves the candidate arcs exactly and takes them off the list; where `sparing`, only some of many.

    `leaves` are those of the curve searched. Returns the queue, which may have grown.

    Many arguments: what belongs together is in tuples already.
    """
    n_candidates, n_met, hint, n_open = 0, 0, -1, 0
    for k in range(leaves.arcs.shape[0]):
        n_candidates += candidates[k]
    step = 1 + n_candidates // SAMPLES if sparing and n_candidates > MANY else 1
    for k in range(leaves.arcs.shape[0]):
        n_met += candidates[k]
        if not candidates[k] or n_met % step > 0:
            hint = -1
            continue
        if state.lower > aim.limit:
            break
        candidates[k] = False
        state.n_kept += 1
        hint = drawn.arc[drawn.first[k]] if hint < 0 else hint
        heap = with_capacity(heap, n_open, CAPACITY)
        row = leaves.arcs[k]
        interval = OpenInterval(leaves.piece[k], row[S0], row[S1], hint, 0.0)
        hint, n_open = examine(pair, aim, interval, state, work, heap, n_open)
    return close(pair, aim, state, work, heap, n_open)


@kernel
def directed_curve(
    one: CurveArrays,
    two: CurveArrays,
    shift_x: float,
    shift_y: float,
    aim: SearchGoal,
    states: SearchStates,
    witness: Floats,
):
    """Fills the first of `states` with the directed distance from A to B; stops once it passes `aim.limit`.

    Args:
        one, two: A and B; shift: from A's frame into B's; states: SEARCH_STATE, zeros; witness: (5,) as of
            `write_witness`.
    """
    most = max(widest(one.pieces), widest(two.pieces))
    composed = np.empty((most + 2, 3, LARGEST_DEGREE + 1))
    work, heap = SearchScratch(new_scratch(most, 0), composed), np.empty((4 * CAPACITY, WIDTH))
    state, la, lb, n_arcs = states[0], one.leaves, two.leaves, one.leaves.arcs.shape[0]
    pixels = min(PIXELS_AT_MOST, max(PIXELS_AT_LEAST, 2.0 * n_arcs))
    pixel = _length_of_arcs(la.arcs) / pixels
    drawn = draw(one.pieces, la, lb, shift_x, shift_y, pixel, work.planes[0])
    state.piece_a, state.n_arcs, state.n_pixels = -1, n_arcs, drawn.depth.shape[0]
    state.map_bound = lower_bound_of_map(drawn, la, lb, pixel)
    pair = CurvePair(Curves(one.pieces, two.pieces, shift_x, shift_y), lb)
    candidates = np.zeros(n_arcs, np.bool_)
    candidates[drawn.deepest_leaf] = True
    for stage in range(3):  # the deepest arc; what trimming leaves, some of much first; the rest
        heap = _search_candidates(
            pair, la, aim, drawn, stage == SOME_OF_MANY, candidates, state, work, heap
        )
        bound = max(max(state.lower, state.map_bound), aim.enough)
        if stage == THE_DEEPEST:
            candidates[:] = True
            candidates[drawn.deepest_leaf] = False
        trim(la, lb, drawn, shift_x, shift_y, bound, candidates)
    if state.lower <= aim.limit:
        state.upper = max(state.upper, max(state.lower, aim.enough))
        write_witness(pair.curves, one.joints, two.joints, state, witness)
