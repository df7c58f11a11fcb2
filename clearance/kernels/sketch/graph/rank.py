"""Closed steps whose equations do not determine their place: two loci that are one, or run side by side.

The count of freedoms does not see them (a distance from a circle and one from its centre, say); the
derivative at the solution does. Not for: whole parts (`clearance.sketch.freedom`).
"""

import numpy as np

from clearance.compile.jit import inline, kernel
from clearance.kernels.sketch.equations import evaluate
from clearance.kernels.sketch.graph.graph import POINT, TURN

ALIKE = 1e-12
"""Determinant of the unit derivatives' products at which they count as one: sine squared, 1e-6 each. What only
touches is marked as well."""


@inline
def _row(s, row, x, v, partner, size, gradient, out):
    """The derivative of an equation by the freedoms of v and its partner, as a unit vector in `out`."""
    evaluate(s.code, s.var, s.coef, s.value, x, row, gradient)
    out[:] = 0.0
    width = 2 if s.kind[v] == POINT else 1
    for k in range(8):
        i = s.var[row, k]
        u = s.vertex_of[i] if i >= 0 else -1
        if u >= 0 and u == v:
            if s.kind[v] == POINT:
                out[i - s.root[v]] += gradient[k]
            else:
                out[0] += gradient[k] * s.scale[i] / (size if s.kind[v] == TURN else 1.0)
        elif u >= 0 and u == partner:
            out[width] += gradient[k] * s.scale[i]
    length = np.sqrt(out[0] * out[0] + out[1] * out[1] + out[2] * out[2])
    if length > 0.0:
        out /= length


@kernel
def singular_steps(s, steps, x, size):
    """Marks (s,) of the closed steps with two or three equations that are not independent at x."""
    out = np.zeros(steps.vertex.shape[0], np.uint8)
    gradient, unit = np.empty(8), np.zeros((3, 3))
    for k in range(out.shape[0]):
        if steps.block[k] >= 0 or steps.edges[k, 1] < 0:
            continue
        count = 3 if steps.edges[k, 2] >= 0 else 2
        unit[:, :] = 0.0
        for a in range(count):
            row = steps.edges[k, a]
            _row(s, row, x, steps.vertex[k], steps.partner[k], size, gradient, unit[a])
        g01 = unit[0] @ unit[1]
        g00, g11 = unit[0] @ unit[0], unit[1] @ unit[1]
        volume = g00 * g11 - g01 * g01
        if count == 3:
            g02, g12, g22 = unit[0] @ unit[2], unit[1] @ unit[2], unit[2] @ unit[2]
            volume = g22 * volume - g00 * g12 * g12 - g11 * g02 * g02 + 2.0 * g01 * g02 * g12
        out[k] = volume <= ALIKE
    return out
