"""Compiled Hausdorff distance of two curves, both directions: map, lower bound, trimming, exact rest.

The steps are those of Kim, Oh, Kim (2010); each lives in a file of its own. Not for: the systems without
trimming (`hausdorff.systems`), curves whose distance has no end (there are none).
"""

import math

import numpy as np

from clearance.compile.jit import inline, kernel
from clearance.kernels.curve.arc import S0, S1, X0, X1, Y0, Y1
from clearance.kernels.curve.bezier import hypotenuse, jet
from clearance.kernels.curve.distance_map import draw, lower_bound_of_map
from clearance.kernels.curve.follow import LARGEST_DEGREE
from clearance.kernels.hausdorff.search import ROOM, Pair, close, examine, grown
from clearance.kernels.hausdorff.state import (
    ARCS,
    AT_A,
    AT_B,
    KEPT,
    LOWER,
    MAP_BOUND,
    PIECE_A,
    PIECE_B,
    PIXELS,
    STATE,
    UPPER,
)
from clearance.kernels.hausdorff.trim import trim, trim_nodes

PIXELS_AT_LEAST, PIXELS_AT_MOST = 32.0, 4096.0
MANY = 512  # arcs from which on whole runs are tried first
SAMPLES = 1000


@inline
def widest(pieces):
    """The largest number of control points of a piece."""
    most = 0
    for i in range(pieces.first.shape[0] - 1):
        most = max(most, pieces.first[i + 1] - pieces.first[i])
    return most


@inline
def length_of_arcs(arcs):
    """The length of all chords, enough to choose a pixel by."""
    total = 0.0
    for k in range(arcs.shape[0]):
        total += hypotenuse(arcs[k, X1] - arcs[k, X0], arcs[k, Y1] - arcs[k, Y0])
    return total


@inline
def _search_kept(pair, la, aim, drawn, sparing, kept, state, work, composed, heap):
    """Solves the arcs kept exactly and takes them off the list; where `sparing`, only some of many.

    Returns the queue's room, which may have grown.
    """
    n_kept, seen, hint, n_open = 0, 0, -1, 0
    for k in range(la.arcs.shape[0]):
        n_kept += kept[k]
    step = 1 + n_kept // SAMPLES if sparing and n_kept > MANY else 1
    for k in range(la.arcs.shape[0]):
        seen += kept[k]
        if not kept[k] or seen % step > 0:
            hint = -1
            continue
        if state[LOWER] > aim.limit:
            break
        kept[k] = False
        state[KEPT] += 1.0
        hint = drawn.arc[drawn.first[k]] if hint < 0 else hint
        if n_open + ROOM > heap.shape[0]:
            heap = grown(heap)
        hint, n_open = examine(
            pair, aim, la.piece[k], la.arcs[k, S0], la.arcs[k, S1], hint, 0.0, state, work, composed,
            heap, n_open,
        )  # fmt: skip
    return close(pair, aim, state, work, composed, heap, n_open)


@inline
def _is_end(ends, piece, local):
    return (local <= 1e-12 and ends[piece, 0]) or (local >= 1.0 - 1e-12 and ends[piece, 1])


@inline
def witness(pa, ends_a, pb, ends_b, shift_x, shift_y, state, out):
    """Fills `out` with the two points that `state` names and the kind of solution that they are.

    At a smooth point of A the distance is either stationary (common normal, or a corner or end of B) or it
    rises on one side and falls on the other: the self-bisector.
    """
    i, j = int(state[PIECE_A]), int(state[PIECE_B])
    a, b = jet(pa, i, state[AT_A]), jet(pb, j, state[AT_B])
    out[0], out[1], out[2], out[3] = a.x, a.y, b.x, b.y
    ex, ey = a.x + shift_x - b.x, a.y + shift_y - b.y
    apart = hypotenuse(ex, ey) > 1e-14 * (hypotenuse(a.x, a.y) + hypotenuse(b.x, b.y))
    steep = apart and abs(ex * a.dx + ey * a.dy) > 1e-6 * hypotenuse(ex, ey) * hypotenuse(
        a.dx, a.dy
    )
    if _is_end(ends_a, i, state[AT_A]):
        out[4] = 0.0
    elif steep:
        out[4] = 2.0
    else:
        out[4] = 0.0 if _is_end(ends_b, j, state[AT_B]) else 1.0


@kernel
def both_directions(pa, la, ends_a, pb, lb, ends_b, shift_x, shift_y, aim):
    """The directed distances from A to B and from B to A: (2, STATE) numbers, and witnesses (2, 5).

    A witness is the point of the curve searched, the point of the other, each in its own frame, and the kind:
    0 end, 1 common normal, 2 self-bisector. `ends_*` (n, 2) flag the pieces' ends that are not smooth. Stops
    once a lower bound passes the limit. One function, not two: a second level would be compiled all over again.
    """
    out, points = np.zeros((2, STATE)), np.empty((2, 5))
    out[:, PIECE_A] = -1.0
    points[:] = math.nan
    most = max(widest(pa), widest(pb))
    work = np.empty((11, max(2 * LARGEST_DEGREE + 2, 4 * most + 4), 4))
    composed, heap = np.empty((most + 2, 3, LARGEST_DEGREE + 1)), np.empty((4 * ROOM, 6))
    for turn in range(2):
        state, n_arcs = out[turn], la.arcs.shape[0]
        pixel = length_of_arcs(la.arcs) / min(PIXELS_AT_MOST, max(PIXELS_AT_LEAST, 2.0 * n_arcs))
        drawn = draw(pa, la, lb, shift_x, shift_y, pixel, work[0])
        state[ARCS], state[PIXELS] = n_arcs, drawn.depth.shape[0]
        state[MAP_BOUND] = lower_bound_of_map(drawn, la, lb, pixel)
        pair = Pair(pa, pb, lb, shift_x, shift_y)
        kept = np.zeros(n_arcs, np.bool_)
        kept[drawn.deepest_leaf] = True
        # the deepest arc; then what trimming leaves, some of it first where it is much; then the rest
        for stage in range(3):
            heap = _search_kept(pair, la, aim, drawn, stage == 1, kept, state, work, composed, heap)
            bound = max(max(state[LOWER], state[MAP_BOUND]), aim.enough)
            if stage == 0:
                kept[:] = True
                kept[drawn.deepest_leaf] = False
                if n_arcs >= MANY:
                    trim_nodes(la, lb, drawn, shift_x, shift_y, bound, kept, work[0])
            trim(la, lb, drawn, shift_x, shift_y, bound, kept)
        if state[LOWER] > aim.limit:
            out[1 - turn, LOWER] = state[LOWER]
            break
        state[UPPER] = max(state[UPPER], max(state[LOWER], aim.enough))
        witness(pa, ends_a, pb, ends_b, shift_x, shift_y, state, points[turn])
        pa, la, ends_a, pb, lb, ends_b = pb, lb, ends_b, pa, la, ends_a
        shift_x, shift_y = -shift_x, -shift_y
    return out, points
