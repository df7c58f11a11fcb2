"""Where a solve starts: merged directions, offsets and radii agree, everything else as sketched.

Also the book-keeping over whole parts: which equations of which part do not hold yet.
"""

import math

import numpy as np

from clearance.compile.jit import kernel
from clearance.kernels.sketch.equations import evaluate
from clearance.kernels.sketch.graph.graph import DIRECTION, OFFSET, RADIUS


@kernel
def agree(s, role, x, middle, settled):
    """Makes merged numbers agree, in place on x; lines turn about `middle` (n, 2), given by
    direction index.

    Numbers that agree to `settled` are left as they are. `s` is a System.
    """
    n = role.shape[0]
    for which in (DIRECTION, OFFSET, RADIUS):
        total, count, off = np.zeros(n + 1), np.zeros(n + 1), np.zeros(n + 1)
        for i in range(n):
            if role[i] == which and s.vertex_of[i] > 0 and s.scale[i] != 0.0:
                total[s.parent[i]] += (x[i] - s.shift[i]) / s.scale[i]
                count[s.parent[i]] += 1.0
        for i in range(n):
            if role[i] != which or (s.parent[i] == i and count[i] <= 1.0):
                continue
            r = s.parent[i]
            mean = total[r] / count[r] if r < n else 0.0
            off[r] = max(off[r], abs(s.scale[i] * mean + s.shift[i] - x[i]))
        for i in range(n):
            if role[i] != which or (s.parent[i] == i and count[i] <= 1.0):
                continue
            r = s.parent[i]
            if off[r] <= settled:
                continue
            before = x[i]
            x[i] = s.shift[i] + (s.scale[i] * total[r] / count[r] if r < n else 0.0)
            if which == DIRECTION and x[i] != before:
                x[i + 1] = math.cos(x[i]) * middle[i, 1] - math.sin(x[i]) * middle[i, 0]


@kernel
def unsettled(s, part_of_row, n_parts, x, length_scale, settled):
    """Which parts (n_parts,) have an equation that does not hold to `settled`."""
    out = np.zeros(n_parts, np.uint8)
    gradient = np.empty(8)
    for row in range(part_of_row.shape[0]):
        p = part_of_row[row]
        if p >= 0 and not out[p]:
            f = evaluate(s.code, s.var, s.coef, s.value, x, row, gradient) * length_scale[row]
            if not abs(f) <= settled:
                out[p] = 1
    return out


@kernel
def row_parts(ends, var, part, vertex_of):
    """The connected part of every equation; -1 for those of known numbers only."""
    out = np.full(ends.shape[0], -1, np.int64)
    for row in range(ends.shape[0]):
        for k in range(8):
            i = var[row, k]
            if i >= 0 and vertex_of[i] > 0:
                out[row] = part[vertex_of[i]]
                break
    return out


@kernel
def counts(kind, ends, part, n_parts, dependent, dof):
    """Degrees of freedom left in every part: those of its vertices less its independent
    equations."""
    out = np.zeros(n_parts, np.int64)
    for v in range(1, kind.shape[0]):
        out[part[v]] += dof[kind[v]]
    idle = np.zeros(ends.shape[0], np.uint8)
    for row in dependent:
        idle[row] = 1
    for row in range(ends.shape[0]):
        if idle[row]:
            continue
        for k in range(5):
            if ends[row, k] > 0:
                out[part[ends[row, k]]] -= 1
                break
    return out
