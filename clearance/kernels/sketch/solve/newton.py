"""Numeric clusters: several vertices and rigid bodies moved at once until their equations hold.

Unknowns are the freedoms of the vertices and, for a body, a small turn about its pivot and a shift;
a body's members are moved rigidly, so that what is already true inside it stays true. Newton with a
step control (the residual must fall), and Levenberg and Marquardt's damping where Newton fails.
"""

import math
from typing import NamedTuple

import numpy as np

from clearance.compile.jit import inline
from clearance.kernels.sketch.equations import evaluate
from clearance.kernels.sketch.graph.graph import POINT, SLIDE, TURN
from clearance.kernels.sketch.solve.motion import keep, move, new_kept_place, restore, total_of
from clearance.kernels.sketch.solve.place import assign


class LinearEquations(NamedTuple):
    """The equations of a cluster, linear about a place.

    Attributes:
        residual: (m,) [m]. jacobian: (m, n). gradient: (8,) room for one equation's derivatives by slot.
    """

    residual: np.ndarray
    jacobian: np.ndarray
    gradient: np.ndarray


@inline(force=True)
def _spread(s, i, g, unknowns, place, jacobian, row):
    """Adds g times the derivative of variable i to a row of the jacobian."""
    v = s.vertex_of[i]
    body, at, kind = unknowns.cluster.body_of[v], unknowns.first[v], s.kind[v]
    x, pivot = place.x, place.pivot
    if body < 0:
        if kind == POINT:
            jacobian[row, at + (i - s.root[v])] += g
        else:
            jacobian[row, at] += g * s.scale[i]
    elif kind == POINT:
        if i == s.root[v]:
            jacobian[row, at] += g
            jacobian[row, at + 2] -= g * (x[i + 1] - pivot[body, 1])
        else:
            jacobian[row, at + 1] += g
            jacobian[row, at + 2] += g * (x[i - 1] - pivot[body, 0])
    elif kind == TURN:
        jacobian[row, at + 2] += g
    elif kind == SLIDE:
        si, c = math.sin(x[i - 1]), math.cos(x[i - 1])
        jacobian[row, at] -= g * si
        jacobian[row, at + 1] += g * c
        jacobian[row, at + 2] -= g * (c * pivot[body, 0] + si * pivot[body, 1])


@inline
def assemble(s, unknowns, place, linear):
    """Fills residuals and jacobian of the equations; the sum of squares."""
    rows, first, gradient = unknowns.cluster.rows, unknowns.first, linear.gradient
    total = 0.0
    linear.jacobian[:, :] = 0.0
    for a in range(rows.shape[0]):
        row = rows[a]
        f = evaluate(s.code, s.var, s.coef, s.value, place.x, row, gradient)
        linear.residual[a] = f
        total += f * f
        for k in range(8):
            i = s.var[row, k]
            if i >= 0 and s.vertex_of[i] >= 0 and first[s.vertex_of[i]] >= 0 and gradient[k] != 0.0:
                _spread(s, i, gradient[k], unknowns, place, linear.jacobian, a)
    return total


@inline
def _eliminate(matrix, right):
    """Solves in place, by elimination with row pivots; an unknown whose pivot is lost in rounding is left at 0,
    so that a singular matrix gives neither an error nor a step to where rounding hides all errors."""
    n = right.shape[0]
    largest = 1e-300
    for k in range(n):
        for c in range(n):
            largest = max(largest, abs(matrix[k, c]))
    for k in range(n):
        best = k
        for i in range(k + 1, n):
            if abs(matrix[i, k]) > abs(matrix[best, k]):
                best = i
        if best != k:
            for c in range(k, n):
                matrix[k, c], matrix[best, c] = matrix[best, c], matrix[k, c]
            right[k], right[best] = right[best], right[k]
        if not abs(matrix[k, k]) > 1e-15 * largest:
            matrix[k, k] = 1e300
        for i in range(k + 1, n):
            factor = matrix[i, k] / matrix[k, k]
            if factor != 0.0:
                for c in range(k + 1, n):
                    matrix[i, c] -= factor * matrix[k, c]
                right[i] -= factor * right[k]
    for k in range(n - 1, -1, -1):
        for c in range(k + 1, n):
            right[k] -= matrix[k, c] * right[c]
        right[k] /= matrix[k, k]


@inline(one_caller=True)
def _step_of(linear, damping):
    """The step (n,) to where the linear equations hold, or nearly; a square jacobian is spent by it.

    `damping` is in units of the normal matrix's diagonal.
    """
    residual, jacobian = linear.residual, linear.jacobian
    m, n = jacobian.shape
    if damping == 0.0 and m == n:
        step = -residual
        _eliminate(jacobian, step)
        return step
    normal = jacobian.T @ jacobian
    mean = np.trace(normal) / n
    for k in range(n):
        normal[k, k] += damping * (normal[k, k] + 1e-3 * mean) + 1e-14 * mean + 1e-300
    step = -(jacobian.T @ residual)
    _eliminate(normal, step)
    return step


@inline
def descend_cluster(s, unknowns, place, rule, longest):
    """Moves the cluster by up to `longest` steps until |residual| is at most `rule.floor` or nothing is gained.

    True when it is at most `rule.tolerance`.
    """
    vertices, rows = unknowns.cluster.vertices, unknowns.cluster.rows
    m, n = rows.shape[0], unknowns.n
    linear = LinearEquations(np.empty(m), np.empty((m, n)), np.empty(8))
    kept = new_kept_place(s, vertices, place)
    damping = 0.0
    total = assemble(s, unknowns, place, linear)
    for _ in range(longest):
        if not total > rule.floor * rule.floor:
            break
        step = _step_of(linear, damping)
        keep(s, vertices, place, kept)
        size, fell = 1.0, False
        for _ in range(7 if damping == 0.0 else 1):
            move(s, unknowns, step, size, place)
            after = total_of(s, rows, place.x, linear.gradient)
            if after < (1.0 - 1e-3 * size) * total:
                fell = True
                break
            restore(s, vertices, kept, place)
            size *= 0.5
        if fell:
            damping = damping * 0.1 if damping > 1e-7 else 0.0
        elif damping > 1e8 or total <= rule.tolerance * rule.tolerance:
            break
        else:
            damping = max(1e-3, 8.0 * damping)
        if fell or damping > 0.0:
            total = assemble(s, unknowns, place, linear)
    return total <= rule.tolerance * rule.tolerance


@inline
def _shake(s, cluster, place, spread, state):
    """Moves every vertex (bodies as a whole) by up to `spread`, by a fixed sequence; its next
    state."""
    vertices, body_of, x, pivot = cluster.vertices, cluster.body_of, place.x, place.pivot
    last = -1
    shift = np.zeros(3)
    for v in vertices:
        b = body_of[v]
        if b < 0 or b != last:
            for k in range(3):
                state = (state * 1103515245 + 12345) % 2147483648
                shift[k] = spread * (2.0 * state / 2147483648.0 - 1.0)
            if b >= 0:
                pivot[b, 0] += shift[0]
                pivot[b, 1] += shift[1]
        last = b
        i = s.root[v]
        if s.kind[v] == POINT:
            x[i] += shift[0]
            x[i + 1] += shift[1]
        elif b < 0 and s.kind[v] != TURN:
            assign(s, v, x[i] + shift[0], x)
        elif b >= 0 and s.kind[v] == SLIDE:
            assign(s, v, x[i] - math.sin(x[i - 1]) * shift[0] + math.cos(x[i - 1]) * shift[1], x)
    return state


@inline
def newton(s, unknowns, place, rule):
    """Moves the cluster until its equations hold; True when they do to `rule.tolerance`.

    Where the descent ends in a local minimum it starts again from the sketch, shaken by a fixed
    sequence of growing shifts in units of the first residual. On failure the place is as it was.
    """
    cluster, attempts = unknowns.cluster, rule.attempts
    vertices, rows = cluster.vertices, cluster.rows
    kept = new_kept_place(s, vertices, place)
    keep(s, vertices, place, kept)
    spread = math.sqrt(total_of(s, rows, place.x, np.empty(8)) / rows.shape[0])
    state = 12345
    for attempt in range(attempts):
        if attempt > 0:
            restore(s, vertices, kept, place)
            strength = 0.2 + 1.8 * attempt / attempts
            state = _shake(s, cluster, place, strength * spread, state)
        longest = 40 if attempt == 0 else 20
        if descend_cluster(s, unknowns, place, rule, longest):
            return True
    restore(s, vertices, kept, place)
    return False
