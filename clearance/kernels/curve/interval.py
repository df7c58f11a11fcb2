"""Compiled interval enclosures of a Bézier part and its first three derivatives, by control polygons.

An enclosure is a box (x0, x1, y0, y1) for each order of derivative. Used to prove that a system has no root,
or just one, in a cell. Rounding is not enclosed: a cell is only cut while it is far larger than that.
"""

import numpy as np

from clearance.compile.decorators import inline
from clearance.kernels.curve.bezier import CHOOSE, Pieces, cut

ORDERS = 3  # of derivatives


@inline
def with_derivatives(pieces):
    """The pieces, then the homogeneous derivatives of all, then the second and the third ones.

    A derivative has one degree less; constants stay constants.
    """
    n_pieces = pieces.first.shape[0] - 1
    first = np.zeros((ORDERS + 1) * n_pieces + 1, np.int64)
    for i in range(first.shape[0] - 1):
        order, own = i // n_pieces, i % n_pieces
        size = pieces.first[own + 1] - pieces.first[own]
        first[i + 1] = first[i] + max(1, size - order)
    control = np.zeros((first[first.shape[0] - 1], 3))
    control[: pieces.control.shape[0]] = pieces.control
    for i in range(n_pieces, first.shape[0] - 1):
        before, n = first[i - n_pieces], first[i - n_pieces + 1] - first[i - n_pieces] - 1
        for k in range(n):
            for c in range(3):
                control[first[i] + k, c] = n * (control[before + k + 1, c] - control[before + k, c])
    return Pieces(control, first, pieces.rational)


@inline
def times(a0, a1, b0, b1):
    """The product of two intervals."""
    p, q, r, s = a0 * b0, a0 * b1, a1 * b0, a1 * b1
    return min(min(p, q), min(r, s)), max(max(p, q), max(r, s))


@inline
def dot(a, b):
    """The inner product of two boxes, an interval."""
    x0, x1 = times(a[0], a[1], b[0], b[1])
    y0, y1 = times(a[2], a[3], b[2], b[3])
    return x0 + y0, x1 + y1


@inline
def enclose(pieces, i, t0, t1, points, out):
    """Writes boxes (4, 4) of piece `i` on [t0, t1] and of its first three derivatives into `out`.

    `pieces` are `with_derivatives`. A rational derivative follows from Leibniz' rule for (point times weight),
    in interval arithmetic; columns 4 and 5 of `out` are those of the weights.
    """
    n_pieces = pieces.rational.shape[0]
    for order in range(ORDERS + 1):
        n = cut(pieces, order * n_pieces + i, t0, t1, points)
        for column in range(3):
            weighs = order == 0 and column < 2
            low = high = points[0, column] / (points[0, 2] if weighs else 1.0)
            for k in range(1, n + 1):
                value = points[k, column] / (points[k, 2] if weighs else 1.0)
                low, high = min(low, value), max(high, value)
            out[order, 2 * column], out[order, 2 * column + 1] = low, high
    if not pieces.rational[i]:
        return
    w0, w1 = out[0, 4], out[0, 5]
    for order in range(1, ORDERS + 1):
        for c in range(0, 4, 2):
            low, high = out[order, c], out[order, c + 1]
            for k in range(1, order + 1):
                less = times(out[order - k, c], out[order - k, c + 1], out[k, 4], out[k, 5])
                low -= CHOOSE[order, k] * less[1]
                high -= CHOOSE[order, k] * less[0]
            out[order, c], out[order, c + 1] = times(low, high, 1.0 / w1, 1.0 / w0)
