"""Compiled Hausdorff distance of two curves, both directions: map, lower bound, trimming, exact rest.

The steps are those of Kim, Oh, Kim (2010); each lives in a file of its own. Not for: the systems without
trimming (`hausdorff_systems`), curves whose distance has no end (there are none).
"""

import math

import numpy as np

from clearance.jit import inlined, kernel
from clearance.kernels.arc import S0, S1, X0, X1, Y0, Y1
from clearance.kernels.curve_bezier import hypotenuse, jet
from clearance.kernels.distance_map import draw, lower_bound_of_map
from clearance.kernels.hausdorff_exact import consider, search_leaf
from clearance.kernels.hausdorff_state import (
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
from clearance.kernels.hausdorff_trim import trim, trim_nodes

PIXELS_AT_LEAST, PIXELS_AT_MOST = 32.0, 4096.0
MANY = 512  # arcs from which on whole runs are tried first
SAMPLES = 1000


@inlined
def widest(pieces):
    """The largest number of control points of a piece."""
    most = 0
    for i in range(pieces.first.shape[0] - 1):
        most = max(most, pieces.first[i + 1] - pieces.first[i])
    return most


@inlined
def length_of_arcs(arcs):
    """The length of all chords, enough to choose a pixel by."""
    total = 0.0
    for k in range(arcs.shape[0]):
        total += hypotenuse(arcs[k, X1] - arcs[k, X0], arcs[k, Y1] - arcs[k, Y0])
    return total


@inlined
def _sample_kept(pa, la, pb, lb, kept, drawn, shift_x, shift_y, state, work):
    """Raises the lower bound by the true distances at the middles of some arcs that trimming left."""
    step = max(1, int(state[KEPT]) // SAMPLES)
    seen, hint = 0, 0
    for k in range(la.arcs.shape[0]):
        if not kept[k]:
            continue
        seen += 1
        if seen % step == 0:
            middle = 0.5 * (la.arcs[k, S0] + la.arcs[k, S1])
            hint = drawn.arc[drawn.first[k]]
            consider(pa, pb, lb, la.piece[k], middle, shift_x, shift_y, hint, state, work)


@kernel
def directed(pa, la, pb, lb, shift_x, shift_y, trimming, gap, limit, budget, state, work):
    """Fills `state` with the directed distance from A to B; stops once it passes `limit`."""
    n_arcs = la.arcs.shape[0]
    state[:] = 0.0
    state[PIECE_A] = -1.0
    state[ARCS] = n_arcs
    n_pixels = min(PIXELS_AT_MOST, max(PIXELS_AT_LEAST, 2.0 * n_arcs))
    pixel = length_of_arcs(la.arcs) / n_pixels
    drawn = draw(pa, la, lb, shift_x, shift_y, pixel, work[0])
    state[PIXELS] = drawn.depth.shape[0]
    state[MAP_BOUND] = lower_bound_of_map(drawn, la, lb, pixel)
    best = drawn.deepest_leaf
    search_leaf(
        pa,
        la,
        pb,
        lb,
        best,
        drawn.arc[drawn.deepest],
        shift_x,
        shift_y,
        gap,
        limit,
        budget,
        state,
        work,
    )
    kept = np.ones(n_arcs, np.bool_)
    state[KEPT] = n_arcs
    if trimming:
        bound = max(state[LOWER], state[MAP_BOUND])
        if n_arcs >= MANY:
            trim_nodes(la, lb, drawn, shift_x, shift_y, bound, kept, work[0])
        state[KEPT] = trim(la, lb, drawn, shift_x, shift_y, bound, kept)
        if (
            state[KEPT] > MANY
        ):  # the map was too coarse for these curves: a better bound, and once more
            _sample_kept(pa, la, pb, lb, kept, drawn, shift_x, shift_y, state, work)
            state[KEPT] = trim(la, lb, drawn, shift_x, shift_y, state[LOWER], kept)
    hint = -1
    for k in range(n_arcs):
        if kept[k] and k != best and state[LOWER] <= limit:
            hint = drawn.arc[drawn.first[k]] if hint < 0 else hint
            hint = search_leaf(
                pa, la, pb, lb, k, hint, shift_x, shift_y, gap, limit, budget, state, work
            )
        else:
            hint = -1
    state[UPPER] = max(state[UPPER], state[LOWER])


@inlined
def _is_end(ends, piece, local):
    return (local <= 1e-12 and ends[piece, 0]) or (local >= 1.0 - 1e-12 and ends[piece, 1])


@inlined
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
def both_directions(pa, la, ends_a, pb, lb, ends_b, shift_x, shift_y, trimming, gap, limit, budget):
    """The directed distances from A to B and from B to A: (2, STATE) numbers, and witnesses (2, 5).

    A witness is the point of the curve searched, the point of the other, each in its own frame, and the kind:
    0 end, 1 common normal, 2 self-bisector. `ends_*` (n, 2) flag the pieces' ends that are not smooth.
    """
    out = np.empty((2, STATE))
    points = np.empty((2, 5))
    rows = max(96, 4 * max(widest(pa), widest(pb)) + 4)
    work = np.empty((11, rows, 4))
    directed(pa, la, pb, lb, shift_x, shift_y, trimming, gap, limit, budget, out[0], work)
    if out[0, LOWER] > limit:
        out[1, :] = math.nan
        return out, points
    directed(pb, lb, pa, la, -shift_x, -shift_y, trimming, gap, limit, budget, out[1], work)
    witness(pa, ends_a, pb, ends_b, shift_x, shift_y, out[0], points[0])
    witness(pb, ends_b, pa, ends_a, -shift_x, -shift_y, out[1], points[1])
    return out, points
