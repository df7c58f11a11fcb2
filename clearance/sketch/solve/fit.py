"""Rigid parts set down where the sketch has them: the turn and shift of least movement, in closed
form.

Source: the planar case of Procrustes' problem (Schönemann 1966): the best turn's tangent is the
ratio of the summed cross and dot products about the weighted centroids.
"""

from __future__ import annotations

import numpy as np

from clearance.sketch.graph.graph import POINT, SLIDE, TURN
from clearance.sketch.solve.system import System


def set_down(s: System, part, freedom, x: np.ndarray, sketch: np.ndarray, weight) -> np.ndarray:
    """The numbers (n,) with every part of `freedom` 3 (turn and shift) or 2 (shift) moved rigidly to lie nearest
    the sketch.

    `part` (v,) with -1 outside, `freedom` (parts,) other than 2 and 3 leaves a part alone, `weight`
    (v,) of the points. Offsets of lines follow; a part without points stays.
    """
    mine = np.flatnonzero((part >= 0) & (freedom[part] >= 2))
    points = mine[s.kind[mine] == POINT]
    p, i, w = part[points], s.root[points], weight[points]
    total = np.bincount(p, w, freedom.size)
    mine = mine[total[part[mine]] > 0.0]
    total = np.where(total > 0.0, total, 1.0)
    middle, goal = (
        np.column_stack([np.bincount(p, w * y[i + k], freedom.size) / total for k in (0, 1)])
        for y in (x, sketch)
    )
    a, b = (y[i[:, None] + (0, 1)] - at[p] for y, at in ((x, middle), (sketch, goal)))
    dot = np.bincount(p, w * np.sum(a * b, axis=1), freedom.size)
    cross = np.bincount(p, w * (a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]), freedom.size)
    angle = np.where(freedom == 3, np.arctan2(cross, dot), 0.0)
    out, number = x.copy(), x[s.root]
    c, si = np.cos(angle)[p], np.sin(angle)[p]
    out[i] = goal[p, 0] + c * a[:, 0] - si * a[:, 1]
    out[i + 1] = goal[p, 1] + si * a[:, 0] + c * a[:, 1]
    turns, slides = mine[s.kind[mine] == TURN], mine[s.kind[mine] == SLIDE]
    number[turns] += angle[part[turns]]
    p, theta = part[slides], x[s.root[slides] - 1]
    number[slides] += np.sin(theta) * middle[p, 0] - np.cos(theta) * middle[p, 1]
    theta = theta + angle[p]
    number[slides] += np.cos(theta) * goal[p, 1] - np.sin(theta) * goal[p, 0]
    follows = np.zeros(s.kind.size, bool)
    follows[turns] = follows[slides] = True
    m = s.member[follows[s.vertex_of[s.member]]]
    out[m] = s.scale[m] * number[s.vertex_of[m]] + s.shift[m]
    return out
