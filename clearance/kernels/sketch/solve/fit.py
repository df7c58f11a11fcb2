"""Rigid parts set down where the sketch has them: the turn and shift of least movement, in closed
form.

Source: the planar case of Procrustes' problem (Schönemann 1966): the best turn's tangent is the
ratio of the summed cross and dot products about the weighted centroids.
"""

import math

import numpy as np

from clearance.compile.jit import kernel
from clearance.kernels.sketch.graph.graph import POINT, SLIDE, TURN
from clearance.kernels.sketch.solve.place import assign


@kernel
def set_down(s, part, freedom, x, sketch, weight):
    """Moves every part with `freedom` 3 (turn and shift) or 2 (shift) rigidly to lie nearest the
    sketch.

    `part` (v,) with -1 outside, `freedom` (parts,) other than 2 and 3 leaves a part alone, `weight`
    (v,) of the points. Works in place on x. Offsets of lines follow; a part without points stays.
    """
    n = freedom.shape[0]
    total, sums = np.zeros(n), np.zeros((n, 4))
    for v in range(1, s.kind.shape[0]):
        p = part[v]
        if p >= 0 and freedom[p] >= 2 and s.kind[v] == POINT:
            i, w = s.root[v], weight[v]
            total[p] += w
            sums[p, 0] += w * x[i]
            sums[p, 1] += w * x[i + 1]
            sums[p, 2] += w * sketch[i]
            sums[p, 3] += w * sketch[i + 1]
    for p in range(n):
        if total[p] > 0.0:
            sums[p] /= total[p]
    turn = np.zeros((n, 2))
    for v in range(1, s.kind.shape[0]):
        p = part[v]
        if p >= 0 and freedom[p] == 3 and s.kind[v] == POINT:
            i, w = s.root[v], weight[v]
            ax, ay = x[i] - sums[p, 0], x[i + 1] - sums[p, 1]
            bx, by = sketch[i] - sums[p, 2], sketch[i + 1] - sums[p, 3]
            turn[p, 0] += w * (ax * bx + ay * by)
            turn[p, 1] += w * (ax * by - ay * bx)
    angle = np.arctan2(turn[:, 1], turn[:, 0])
    for which in range(2):  # offsets before the directions they need
        for v in range(1, s.kind.shape[0]):
            p = part[v]
            if p < 0 or freedom[p] < 2 or total[p] == 0.0 or (s.kind[v] == SLIDE) != (which == 0):
                continue
            i = s.root[v]
            if s.kind[v] == SLIDE:
                t = x[i - 1]
                d = x[i] + math.sin(t) * sums[p, 0] - math.cos(t) * sums[p, 1]
                t += angle[p]
                assign(s, v, d + math.cos(t) * sums[p, 3] - math.sin(t) * sums[p, 2], x)
            elif s.kind[v] == TURN:
                assign(s, v, x[i] + angle[p], x)
            elif s.kind[v] == POINT:
                c, si = math.cos(angle[p]), math.sin(angle[p])
                ax, ay = x[i] - sums[p, 0], x[i + 1] - sums[p, 1]
                x[i] = sums[p, 2] + c * ax - si * ay
                x[i + 1] = sums[p, 3] + si * ax + c * ay
