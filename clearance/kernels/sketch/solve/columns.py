"""Equations of a part as a sparse matrix by freedoms: first and second derivatives, and steps."""

import numpy as np

from clearance.compile.jit import inline, kernel
from clearance.kernels.sketch.equations import evaluate
from clearance.kernels.sketch.graph.graph import POINT
from clearance.kernels.sketch.solve.place import assign


@inline
def _column(s, i, first):
    """The column of variable i and its factor; -1 where it has none."""
    if i < 0 or s.vertex_of[i] < 0 or first[s.vertex_of[i]] < 0:
        return -1, 0.0
    v = s.vertex_of[i]
    if s.kind[v] == POINT:
        return first[v] + i - s.root[v], 1.0
    return first[v], s.scale[i]


@kernel
def spread(s, rows, x, first):
    """(residuals (m,), and the derivative's entries as rows, columns, values; repeated entries add
    up)."""
    m = rows.shape[0]
    residual = np.empty(m)
    at_row, at_column, value = np.empty(8 * m, np.int64), np.empty(8 * m, np.int64), np.empty(8 * m)
    gradient = np.empty(8)
    count = 0
    for a in range(m):
        residual[a] = evaluate(s.code, s.var, s.coef, s.value, x, rows[a], gradient)
        for k in range(8):
            c, factor = _column(s, s.var[rows[a], k], first)
            if c >= 0:
                at_row[count], at_column[count], value[count] = a, c, gradient[k] * factor
                count += 1
    return residual, at_row[:count], at_column[:count], value[:count]


@kernel
def bend(s, rows, x, first, multipliers):
    """The second derivative of the equations, weighted by their multipliers, as (rows, columns,
    values).

    Central differences of the analytic first derivatives, symmetrised.
    """
    m = rows.shape[0]
    size = 64 * m
    at_row, at_column, value = np.empty(size, np.int64), np.empty(size, np.int64), np.empty(size)
    ahead, behind = np.empty(8), np.empty(8)
    count = 0
    for a in range(m):
        row = rows[a]
        for k in range(8):
            i = s.var[row, k]
            c, factor = _column(s, i, first)
            named = False  # in an earlier slot: two lengths may share a point
            for j in range(k):
                named = named or s.var[row, j] == i
            if c < 0 or named:
                continue
            kept = x[i]
            h = 1e-6 * (1.0 + abs(kept))
            x[i] = kept + h
            evaluate(s.code, s.var, s.coef, s.value, x, row, ahead)
            x[i] = kept - h
            evaluate(s.code, s.var, s.coef, s.value, x, row, behind)
            x[i] = kept
            for j in range(8):
                d, other = _column(s, s.var[row, j], first)
                if d >= 0:
                    at_row[count], at_column[count] = c, d
                    second = 0.5 * (ahead[j] - behind[j]) / h
                    value[count] = multipliers[a] * factor * other * second
                    count += 1
    return at_row[:count], at_column[:count], value[:count]


@kernel
def step_by(s, vertices, step, size, x, first):
    """Adds `size` times `step` to the vertices, in place on x."""
    for v in vertices:
        i, at = s.root[v], first[v]
        if s.kind[v] == POINT:
            x[i] += size * step[at]
            x[i + 1] += size * step[at + 1]
        else:
            assign(s, v, x[i] + size * step[at], x)
