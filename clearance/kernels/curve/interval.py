"""Compiled interval enclosures of a Bézier part and its first three derivatives, by control polygons.

An enclosure is a box (x0, x1, y0, y1) for each order of derivative. Used to prove that a system has no root,
or just one, in a cell. Rounding is not enclosed: a cell is only cut while it is far larger than that.
"""

import numpy as np

from clearance.compile.decorators import inline
from clearance.kernels.curve.bezier import Pieces, cut


@inline
def derived(pieces):
    """The homogeneous derivative of every piece as pieces of one degree less; constants stay constants."""
    n_pieces = pieces.first.shape[0] - 1
    first = np.zeros(n_pieces + 1, np.int64)
    for i in range(n_pieces):
        first[i + 1] = first[i] + max(1, pieces.first[i + 1] - pieces.first[i] - 1)
    control = np.zeros((first[n_pieces], 3))
    for i in range(n_pieces):
        start = pieces.first[i]
        n = pieces.first[i + 1] - start - 1
        for k in range(n):
            for c in range(3):
                step = pieces.control[start + k + 1, c] - pieces.control[start + k, c]
                control[first[i] + k, c] = n * step
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
def _box(points, n, column):
    low = high = points[0, column]
    for k in range(1, n + 1):
        low, high = min(low, points[k, column]), max(high, points[k, column])
    return low, high


@inline
def _put_boxes(out, row, points, n):
    """Writes the range of x and that of y."""
    out[row, 0], out[row, 1] = _box(points, n, 0)
    out[row, 2], out[row, 3] = _box(points, n, 1)


@inline
def enclose(pieces, derivatives, i, t0, t1, points, out):
    """Writes boxes (4, 4) of piece `i` on [t0, t1] and of its first three derivatives into `out`.

    `derivatives` are the pieces `derived` once, twice and three times. A rational derivative
    follows from Leibniz' rule for (point times weight), in interval arithmetic.
    """
    one, two, three = derivatives
    n = cut(pieces, i, t0, t1, points)
    rational = pieces.rational[i]
    w0, w1 = _box(points, n, 2)
    for k in range(n + 1):
        points[k, 0] /= points[k, 2]
        points[k, 1] /= points[k, 2]
    _put_boxes(out, 0, points, n)
    n = cut(one, i, t0, t1, points)
    d0, d1 = _box(points, n, 2)
    _put_boxes(out, 1, points, n)
    n = cut(two, i, t0, t1, points)
    e0, e1 = _box(points, n, 2)
    _put_boxes(out, 2, points, n)
    n = cut(three, i, t0, t1, points)
    f0, f1 = _box(points, n, 2)
    _put_boxes(out, 3, points, n)
    if not rational:
        return
    for c in range(0, 4, 2):
        _less(out, 1, c, 0, d0, d1, 1.0)
        _over(out, 1, c, w0, w1)
        _less(out, 2, c, 1, d0, d1, 2.0)
        _less(out, 2, c, 0, e0, e1, 1.0)
        _over(out, 2, c, w0, w1)
        _less(out, 3, c, 2, d0, d1, 3.0)
        _less(out, 3, c, 1, e0, e1, 3.0)
        _less(out, 3, c, 0, f0, f1, 1.0)
        _over(out, 3, c, w0, w1)


@inline
def _less(out, order, c, other, w0, w1, factor):
    low, high = times(out[other, c], out[other, c + 1], w0, w1)
    out[order, c] -= factor * high
    out[order, c + 1] -= factor * low


@inline
def _over(out, order, c, w0, w1):
    low, high = times(out[order, c], out[order, c + 1], 1.0 / w1, 1.0 / w0)
    out[order, c], out[order, c + 1] = low, high
