"""The equations of a sketch: residuals and derivatives of every kind of constraint.

A sketch is one flat vector `x`: two numbers a point (x, y), two a line (direction theta and signed
offset d of n . p = d with the normal n = (-sin theta, cos theta)), one a circle (its radius; its
centre is a point). An equation is a row: a code, up to eight indices into `x` (-1 pads), up to four
coefficients and a value. Lengths [m], angles [rad]; every residual is a length except those of
angles, which are scaled by the caller.
"""

import math

import numpy as np

from clearance.compile.jit import inline, kernel

POINT_POINT = 1
"""|p - q| = value"""
POINT_LINE = 2
"""n . p - d = value"""
POINT_CIRCLE = 3
"""|p - c| - r = value"""
LINE_CIRCLE = 4
"""n . c - d - coef0 r = value"""
CIRCLE_CIRCLE = 5
"""|c1 - c2| - coef0 r1 - coef1 r2 = value"""
LINEAR = 6
"""sum of coef_k x_k = value"""
LENGTHS = 7
"""|p - q| = value |u - w|"""
MIDDLE_ON = 8
"""n . (p + q) / 2 = d"""
ACROSS = 9
"""t . (q - p) = 0 with t the line's direction"""
RATIO = 10
"""x0 = value x1"""
IN_LINE = 11
"""A point lies on the line through two centres: its distance from that line is 0."""


@inline
def _distance(x, var, row, i, gradient, g):
    """|a - b| of the points in slots i..i+3; adds g times its derivative to `gradient`."""
    dx = x[var[row, i]] - x[var[row, i + 2]]
    dy = x[var[row, i + 1]] - x[var[row, i + 3]]
    length = math.sqrt(dx * dx + dy * dy)
    ux, uy = 1.0, 0.0
    if length > 0.0:
        ux, uy = dx / length, dy / length
    gradient[i] += g * ux
    gradient[i + 1] += g * uy
    gradient[i + 2] -= g * ux
    gradient[i + 3] -= g * uy
    return length


@inline
def _beside(x, var, row, gradient):
    """The distance of the point in slots 0, 1 from the line through those in 2, 3 and 4, 5; fills `gradient`."""
    wx, wy = x[var[row, 4]] - x[var[row, 2]], x[var[row, 5]] - x[var[row, 3]]
    qx, qy = x[var[row, 0]] - x[var[row, 2]], x[var[row, 1]] - x[var[row, 3]]
    length = math.sqrt(wx * wx + wy * wy)
    if length == 0.0:
        return math.sqrt(qx * qx + qy * qy)
    ux, uy = wx / length, wy / length
    f = ux * qy - uy * qx
    gradient[0], gradient[1] = -uy, ux
    gradient[4], gradient[5] = (qy - f * ux) / length, (-qx - f * uy) / length
    gradient[2], gradient[3] = -gradient[0] - gradient[4], -gradient[1] - gradient[5]
    return f


@inline
def evaluate(code, var, coef, value, x, row, gradient):
    """The residual of equation `row`; fills `gradient` (8,) with its derivatives by slot."""
    for k in range(8):
        gradient[k] = 0.0
    kind = code[row]
    v = value[row]
    if kind == POINT_POINT:
        return _distance(x, var, row, 0, gradient, 1.0) - v
    if kind == POINT_LINE or kind == LINE_CIRCLE:
        theta = x[var[row, 2]]
        s, c = math.sin(theta), math.cos(theta)
        px, py = x[var[row, 0]], x[var[row, 1]]
        gradient[0], gradient[1] = -s, c
        gradient[2] = -c * px - s * py
        gradient[3] = -1.0
        f = c * py - s * px - x[var[row, 3]] - v
        if kind == LINE_CIRCLE:
            gradient[4] = -coef[row, 0]
            f -= coef[row, 0] * x[var[row, 4]]
        return f
    if kind == POINT_CIRCLE:
        gradient[4] = -1.0
        return _distance(x, var, row, 0, gradient, 1.0) - x[var[row, 4]] - v
    if kind == CIRCLE_CIRCLE:
        gradient[4] = -coef[row, 0]
        gradient[5] = -coef[row, 1]
        f = _distance(x, var, row, 0, gradient, 1.0) - v
        return f - coef[row, 0] * x[var[row, 4]] - coef[row, 1] * x[var[row, 5]]
    if kind == LINEAR:
        f = -v
        for k in range(4):
            if var[row, k] >= 0:
                gradient[k] = coef[row, k]
                f += coef[row, k] * x[var[row, k]]
        return f
    if kind == LENGTHS:
        first = _distance(x, var, row, 0, gradient, 1.0)
        return first - v * _distance(x, var, row, 4, gradient, -v)
    if kind == IN_LINE:
        return _beside(x, var, row, gradient)
    if kind == RATIO:
        gradient[0] = 1.0
        gradient[1] = -v
        return x[var[row, 0]] - v * x[var[row, 1]]
    theta = x[var[row, 4]]
    s, c = math.sin(theta), math.cos(theta)
    px, py, qx, qy = x[var[row, 0]], x[var[row, 1]], x[var[row, 2]], x[var[row, 3]]
    if kind == MIDDLE_ON:
        gradient[0], gradient[1], gradient[2], gradient[3] = -0.5 * s, 0.5 * c, -0.5 * s, 0.5 * c
        gradient[4] = -0.5 * (c * (px + qx) + s * (py + qy))
        gradient[5] = -1.0
        return 0.5 * (c * (py + qy) - s * (px + qx)) - x[var[row, 5]]
    gradient[0], gradient[1], gradient[2], gradient[3] = -c, -s, c, s
    gradient[4] = -s * (qx - px) + c * (qy - py)
    return c * (qx - px) + s * (qy - py)


@kernel
def residuals(code, var, coef, value, x):
    """The residual (m,) of every equation at `x`."""
    gradient = np.empty(8)
    out = np.empty(code.shape[0])
    for row in range(code.shape[0]):
        out[row] = evaluate(code, var, coef, value, x, row, gradient)
    return out


@kernel
def worst(code, var, coef, value, x, length_scale):
    """The largest |residual|, those of direction equations times `length_scale`, and its row (-1:
    none).

    A NaN counts as infinite. `length_scale` (m,) holds 1 for equations in lengths.
    """
    gradient = np.empty(8)
    largest, at = 0.0, -1
    for row in range(code.shape[0]):
        f = abs(evaluate(code, var, coef, value, x, row, gradient)) * length_scale[row]
        if not f <= 1.7e308:
            return np.inf, row
        if f > largest:
            largest, at = f, row
    return largest, at
