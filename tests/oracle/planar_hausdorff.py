"""The Hausdorff distance of planar curves by interval subdivision in extended precision: the slow truth.

Curves are halved into ever smaller control polygons, kept as 80-bit floats. Of each part only two things are
used: its chord, and how far its control points stand off the chord (the part lies in their hull, so that the
distance to the chord, a convex function, is largest at one of them). A point's distance to a part is then
within that much of its distance to the chord, and a part of A is within max(ends) + both errors of a part
of B. No derivative, no Newton step, no arc, and nothing from the package.
"""

from __future__ import annotations

import numpy as np

REAL = np.longdouble
PRECISE = np.finfo(REAL).nmant >= 63


def spline_parts(control, degree, knots=None, weights=None):
    """Homogeneous Bézier control points (n, degree + 1, 3) of a B-spline, by inserting knots (Boehm 1980)."""
    n = len(control)
    if knots is None:
        inner = np.linspace(0.0, 1.0, n - degree + 1)
        knots = np.concatenate([np.zeros(degree), inner, np.ones(degree)])
    weights = np.ones(n) if weights is None else weights
    knots = [REAL(u) for u in knots]
    points = [
        np.array([x * w, y * w, w], REAL)
        for (x, y), w in zip(np.array(control, REAL), np.array(weights, REAL), strict=True)
    ]
    low, high = knots[degree], knots[n]
    for u in sorted(set(k for k in knots if low <= k <= high)):
        while sum(k == u for k in knots) < degree:
            points, knots = _inserted(points, knots, degree, u)
    starts = [
        i for i in range(len(knots) - 1) if knots[i] < knots[i + 1] and low <= knots[i] < high
    ]
    return np.array([points[i - degree : i + 1] for i in starts])


def _inserted(points, knots, degree, u):
    k = max(
        i
        for i in range(len(knots) - 1)
        if knots[i] <= u and (knots[i] < knots[i + 1] or knots[i] < u)
    )
    if knots[k + 1] <= u and knots[k] < u:
        k = max(i for i in range(len(knots)) if knots[i] <= u)
    out = []
    for i in range(len(points) + 1):
        if i <= k - degree:
            out.append(points[i])
        elif i > k:
            out.append(points[i - 1])
        else:
            share = (u - knots[i]) / (knots[i + degree] - knots[i])
            # at the right end of an unclamped domain the share is 0 and there is no next point
            out.append((1 - share) * points[i - 1] + share * points[min(i, len(points) - 1)])
    return out, knots[: k + 1] + [u] + knots[k + 1 :]


def line_parts(points):
    """The segments of a polyline as parts (n, 2, 3)."""
    points = np.array(points, REAL)
    out = np.ones((len(points) - 1, 2, 3), REAL)
    out[:, 0, :2], out[:, 1, :2] = points[:-1], points[1:]
    return out


def arc_parts(center, radius, start, end, n=4):
    """An arc as `n` rational quadratics (n, 3, 3)."""
    step = (REAL(end) - REAL(start)) / n
    out = np.ones((n, 3, 3), REAL)
    for i in range(n):
        for j in range(3):
            angle = REAL(start) + step * (i + REAL(j) / 2)
            reach = radius / np.cos(step / 2) if j == 1 else REAL(radius)
            out[i, j, 0], out[i, j, 1] = (
                center[0] + reach * np.cos(angle),
                center[1] + reach * np.sin(angle),
            )
        out[i, 1, 2] = np.cos(step / 2)
        out[i, 1, :2] *= out[i, 1, 2]
    return out


def _halved(parts):
    """Both halves of every part: de Casteljau at 1/2."""
    n = parts.shape[1]
    left, right = np.empty_like(parts), np.empty_like(parts)
    row = parts.copy()
    for r in range(n):
        left[:, r], right[:, n - 1 - r] = row[:, 0], row[:, n - 1 - r]
        row = (row[:, :-1] + row[:, 1:]) / 2
    return left, right


def _to_chord(x, start, end):
    along, seen = end - start, x - start
    length_sq = _dot(along, along)
    t = _dot(seen, along) / np.where(length_sq > 0, length_sq, 1)
    off = seen - np.clip(t, 0, 1)[..., None] * along
    return np.sqrt(_dot(off, off))


def _dot(a, b):
    """By hand: to sum along an axis of two takes numpy several times as long."""
    return a[..., 0] * b[..., 0] + a[..., 1] * b[..., 1]


def _chords(parts):
    flat = parts[:, :, :2] / parts[:, :, 2:]
    start, end = flat[:, 0], flat[:, -1]
    off = _to_chord(flat, start[:, None], end[:, None]).max(axis=1)
    return start, end, off


def directed(a, b, width, levels=64, most=60_000):
    """Proven (lower, upper) of the distance from parts `a` to parts `b`, at most `width` apart if it can."""
    one, two = np.divmod(np.arange(len(a) * len(b)), len(b))
    low, out = REAL(0), REAL(np.inf)
    for _ in range(levels):
        a_start, a_end, a_off = _chords(a)
        b_start, b_end, b_off = _chords(b)
        at_start = _to_chord(a_start[one], b_start[two], b_end[two])
        at_end = _to_chord(a_end[one], b_start[two], b_end[two])
        upper = np.full(len(a), REAL(np.inf))
        np.minimum.at(upper, one, np.maximum(at_start, at_end) + a_off[one] + b_off[two])
        for near in (at_start - b_off[two], at_end - b_off[two]):
            lower = np.full(len(a), REAL(np.inf))
            np.minimum.at(lower, one, near)
            low = max(low, lower.max())
        out = min(out, max(low, upper.max()))
        if out - low <= width:
            break
        middle = (a_start + a_end) / 2
        half = np.sqrt(_dot(a_end - a_start, a_end - a_start)) / 2
        nearest = (
            _to_chord(middle[one], b_start[two], b_end[two]) - half[one] - a_off[one] - b_off[two]
        )
        keep = (upper[one] > low) & (nearest <= upper[one])
        one, two = one[keep], two[keep]
        if len(one) == 0 or len(one) > most:
            break
        a, one = _split_used(a, one)
        b, two = _split_used(b, two)
        one, two = (one[:, None] + [0, 0, 1, 1]).ravel(), (two[:, None] + [0, 1, 0, 1]).ravel()
    return low, out


def _split_used(parts, index):
    """Halves of the parts that `index` names, and the index of each named part's first half."""
    used, inverse = np.unique(index, return_inverse=True)
    left, right = _halved(parts[used])
    out = np.empty((2 * len(used), *parts.shape[1:]), REAL)
    out[0::2], out[1::2] = left, right
    return out, 2 * inverse


def hausdorff(a, b, relative=1e-13):
    """Proven (lower, upper) of the Hausdorff distance of two lists of parts, each (n, degree + 1, 3)."""
    flat = np.concatenate([(p[:, :, :2] / p[:, :, 2:]).reshape(-1, 2) for p in (a, b)])
    width = relative * np.sqrt(((flat.max(axis=0) - flat.min(axis=0)) ** 2).sum())
    forth, back = directed(a, b, width), directed(b, a, width)
    return max(forth[0], back[0]), max(forth[1], back[1])
