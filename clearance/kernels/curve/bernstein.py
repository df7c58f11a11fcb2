"""Compiled Bernstein form of the squared distance between two Bézier parts run through side by side.

For any map s(t) the distance |A(t) - B(s(t))| bounds that of A(t) to B from above; with both parts cut out
as control polygons and s affine, its square is a polynomial (or a ratio) whose Bernstein coefficients bound
it in turn. The bound is exact where the parts coincide, run parallel or are concentric, which is what ends
the search on overlapping curves. Not for: choosing the parts.
"""

from clearance.compile.decorators import inline
from clearance.kernels.curve.bezier import CHOOSE
from clearance.kernels.curve.scratch import GAP, PART_A, PART_B, SQUARES


@inline
def raise_degree(points, n, m):
    """Rewrites the n + 1 rows of `points` as control points of degree `m` >= n."""
    for r in range(n, m):
        for c in range(3):
            points[r + 1, c] = points[r, c]
        for k in range(r, 0, -1):
            share = k / (r + 1.0)
            for c in range(3):
                points[k, c] = share * points[k - 1, c] + (1.0 - share) * points[k, c]


@inline
def match_weights(p, q, n):
    """Rescales the weights of `q` as lambda^i so that its end weights stand as those of `p` do.

    The curve stays the same; arcs over the same angles then run at the same speed.
    """
    ratio = (p[n, 2] / p[0, 2]) / (q[n, 2] / q[0, 2])
    if ratio == 1.0:
        return
    step = ratio ** (1.0 / n)
    grow = 1.0
    for k in range(1, n + 1):
        grow *= step
        for c in range(3):
            q[k, c] *= grow


@inline
def gap_coefficients(n, m, rational, shift_x, shift_y, work):
    """Bernstein coefficients of |p(u) + shift - q(u)|^2 in work[SQUARES, :, 0]; returns their degree.

    Where the pieces are rational they are coefficient ratios: the square still lies between their least and
    greatest. p and q (homogeneous, degrees `n`, `m`) stand in work[PART_A] and work[PART_B] and are overwritten.
    """
    p, q, gap, out = work[PART_A], work[PART_B], work[GAP], work[SQUARES]
    if n < m:
        raise_degree(p, n, m)
        n = m
    elif m < n:
        raise_degree(q, m, n)
    if not rational:
        for k in range(n + 1):
            gap[k, 0] = (p[k, 0] + shift_x) - q[k, 0]
            gap[k, 1] = (p[k, 1] + shift_y) - q[k, 1]
        if n == 3:
            return cubic_square(gap, out)
        for k in range(n + 1):
            gap[k, 0] *= CHOOSE[n, k]
            gap[k, 1] *= CHOOSE[n, k]
        for k in range(2 * n + 1):
            value = 0.0
            for i in range(max(0, k - n), min(n, k) + 1):
                value += gap[i, 0] * gap[k - i, 0] + gap[i, 1] * gap[k - i, 1]
            out[k, 0] = value / CHOOSE[2 * n, k]
        return 2 * n
    match_weights(p, q, n)
    for k in range(n + 1):
        p[k, 0] += shift_x * p[k, 2]
        p[k, 1] += shift_y * p[k, 2]
    for k in range(2 * n + 1):
        x, y, w = 0.0, 0.0, 0.0
        for i in range(max(0, k - n), min(n, k) + 1):
            j = k - i
            c = CHOOSE[n, i] * CHOOSE[n, j]
            x += c * (p[i, 0] * q[j, 2] - q[j, 0] * p[i, 2])
            y += c * (p[i, 1] * q[j, 2] - q[j, 1] * p[i, 2])
            w += c * p[i, 2] * q[j, 2]
        gap[k, 0], gap[k, 1], gap[k, 2] = x, y, w
    for k in range(4 * n + 1):
        square, weight = 0.0, 0.0
        for i in range(max(0, k - 2 * n), min(2 * n, k) + 1):
            j = k - i
            square += gap[i, 0] * gap[j, 0] + gap[i, 1] * gap[j, 1]
            weight += gap[i, 2] * gap[j, 2]
        out[k, 0] = square / weight
    return 4 * n


@inline
def cubic_square(gap, out):
    """The seven coefficients for cubics, written out: half the time of the loop."""
    ax, ay, bx, by = gap[0, 0], gap[0, 1], gap[1, 0], gap[1, 1]
    cx, cy, dx, dy = gap[2, 0], gap[2, 1], gap[3, 0], gap[3, 1]
    out[0, 0] = ax * ax + ay * ay
    out[1, 0] = ax * bx + ay * by
    out[2, 0] = 0.4 * (ax * cx + ay * cy) + 0.6 * (bx * bx + by * by)
    out[3, 0] = 0.1 * (ax * dx + ay * dy) + 0.9 * (bx * cx + by * cy)
    out[4, 0] = 0.4 * (bx * dx + by * dy) + 0.6 * (cx * cx + cy * cy)
    out[5, 0] = cx * dx + cy * dy
    out[6, 0] = dx * dx + dy * dy
    return 6


@inline
def greatest(out, degree):
    """The greatest of the coefficients, and its index, the end points first among equals."""
    best, which = out[0, 0], 0
    if out[degree, 0] > best:
        best, which = out[degree, 0], degree
    for k in range(1, degree):
        if out[k, 0] > best:
            best, which = out[k, 0], k
    return best, which


@inline
def reverse_rows(points, n):
    """Runs a control polygon the other way."""
    for k in range((n + 1) // 2):
        for c in range(3):
            swap = points[k, c]
            points[k, c] = points[n - k, c]
            points[n - k, c] = swap
