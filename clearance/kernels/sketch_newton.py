"""Numeric clusters: several vertices and rigid bodies moved at once until their equations hold.

Unknowns are the freedoms of the vertices and, for a body, a small turn about its pivot and a shift;
a body's members are moved rigidly, so that what is already true inside it stays true. Newton with a
step control (the residual must fall), and Levenberg and Marquardt's damping where Newton fails.
"""

import math

import numpy as np

from clearance.jit import inlined, kernel
from clearance.kernels.sketch_equations import evaluate
from clearance.kernels.sketch_graph import POINT, SLIDE, TURN
from clearance.kernels.sketch_place import assign

RESTARTS = 60
"""How often a numeric cluster is tried: measured on irreducible clusters of 100 points off by 20 %,
where one start solves 3 of 4 and each further one about half of the rest."""


@inlined
def columns(s, vertices, body_of, first):
    """Fills `first` (v,) with the first column of every vertex (of its body, if it has one); their
    number.

    `first` must be -1 for all others.
    """
    count = 0
    for v in vertices:
        if body_of[v] >= 0:
            continue
        first[v] = count
        count += 2 if s.kind[v] == POINT else 1
    for v in vertices:
        b = body_of[v]
        if b < 0 or first[v] >= 0:
            continue
        for u in vertices:
            if body_of[u] == b:
                first[u] = count
        count += 3
    return count


@inlined
def _spread(s, i, g, x, pivot, body, at, jacobian, row):
    """Adds g times the derivative of variable i by the columns from `at` on."""
    v = s.vertex_of[i]
    kind = s.kind[v]
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


@inlined
def assemble(s, rows, x, first, body_of, pivot, residual, jacobian, gradient):
    """Fills residual (m,) and jacobian (m, n) of the equations; the sum of squares."""
    total = 0.0
    jacobian[:, :] = 0.0
    for a in range(rows.shape[0]):
        row = rows[a]
        f = evaluate(s.code, s.var, s.coef, s.value, x, row, gradient)
        residual[a] = f
        total += f * f
        for k in range(8):
            i = s.var[row, k]
            if i >= 0 and s.vertex_of[i] >= 0 and first[s.vertex_of[i]] >= 0 and gradient[k] != 0.0:
                v = s.vertex_of[i]
                _spread(s, i, gradient[k], x, pivot, body_of[v], first[v], jacobian, a)
    return total


@inlined
def total_of(s, rows, x, gradient):
    """The sum of squared residuals."""
    total = 0.0
    for row in rows:
        f = evaluate(s.code, s.var, s.coef, s.value, x, row, gradient)
        total += f * f
    return total


@inlined
def move(s, vertices, step, size, x, first, body_of, pivot):
    """Adds `size` times `step` to the vertices; bodies turn and shift exactly."""
    for v in vertices:  # offsets first: they need the directions before the turn
        i, at, b = s.root[v], first[v], body_of[v]
        if b >= 0 and s.kind[v] == SLIDE:
            before = x[i - 1]
            after = before + size * step[at + 2]
            d = x[i] + math.sin(before) * pivot[b, 0] - math.cos(before) * pivot[b, 1]
            px, py = pivot[b, 0] + size * step[at], pivot[b, 1] + size * step[at + 1]
            assign(s, v, d + math.cos(after) * py - math.sin(after) * px, x)
    for v in vertices:
        i, at, b = s.root[v], first[v], body_of[v]
        if b < 0:
            if s.kind[v] == POINT:
                x[i] += size * step[at]
                x[i + 1] += size * step[at + 1]
            else:
                assign(s, v, x[i] + size * step[at], x)
        elif s.kind[v] == TURN:
            assign(s, v, x[i] + size * step[at + 2], x)
        elif s.kind[v] == POINT:
            angle = size * step[at + 2]
            c, si = math.cos(angle), math.sin(angle)
            dx, dy = x[i] - pivot[b, 0], x[i + 1] - pivot[b, 1]
            x[i] = pivot[b, 0] + size * step[at] + c * dx - si * dy
            x[i + 1] = pivot[b, 1] + size * step[at + 1] + si * dx + c * dy
    last = -1
    for v in vertices:
        b = body_of[v]
        if b >= 0 and b != last:
            last = b
            pivot[b, 0] += size * step[first[v]]
            pivot[b, 1] += size * step[first[v] + 1]


@inlined
def keep(s, vertices, x, kept, back):
    """Copies the vertices' numbers into `kept`, or back from it; returns how many there are."""
    at = 0
    for v in vertices:
        if s.kind[v] == POINT:
            for i in range(s.root[v], s.root[v] + 2):
                if back:
                    x[i] = kept[at]
                else:
                    kept[at] = x[i]
                at += 1
        else:
            for where in range(s.member_start[v], s.member_start[v + 1]):
                i = s.member[where]
                if back:
                    x[i] = kept[at]
                else:
                    kept[at] = x[i]
                at += 1
    return at


@inlined
def _room(s, vertices):
    """How many numbers `keep` needs."""
    count = 0
    for v in vertices:
        count += 2 if s.kind[v] == POINT else s.member_start[v + 1] - s.member_start[v]
    return count


@inlined
def _descend(s, vertices, rows, x, body_of, pivot, first, floor, tolerance, longest):
    """Moves the vertices until |residual| <= floor or nothing is gained; True when <= tolerance.

    `first` (v,) is scratch: -1 on entry and on return. `vertices` lists a body's members together.
    """
    n = columns(s, vertices, body_of, first)
    m = rows.shape[0]
    residual, jacobian = np.empty(m), np.empty((m, n))
    gradient = np.empty(8)
    kept = np.empty(_room(s, vertices))
    pivots = pivot.copy()
    damping = 0.0
    total = assemble(s, rows, x, first, body_of, pivot, residual, jacobian, gradient)
    for _ in range(longest):
        if not total > floor * floor:
            break
        if damping == 0.0 and m == n:
            for k in range(n):
                jacobian[k, k] += (
                    1e-15  # an exactly singular matrix must not stop the factorisation
                )
            step = np.linalg.solve(jacobian, -residual)
        else:
            normal = jacobian.T @ jacobian
            mean = np.trace(normal) / n
            for k in range(n):
                normal[k, k] += damping * (normal[k, k] + 1e-3 * mean) + 1e-14 * mean + 1e-300
            step = np.linalg.solve(normal, -(jacobian.T @ residual))
        keep(s, vertices, x, kept, False)
        pivots[:] = pivot
        size, fell = 1.0, False
        for _ in range(7 if damping == 0.0 else 1):
            move(s, vertices, step, size, x, first, body_of, pivot)
            after = total_of(s, rows, x, gradient)
            if after < (1.0 - 1e-3 * size) * total:
                fell = True
                break
            keep(s, vertices, x, kept, True)
            pivot[:] = pivots
            size *= 0.5
        if fell:
            damping = damping * 0.1 if damping > 1e-7 else 0.0
        elif damping > 1e8 or total <= tolerance * tolerance:
            break
        else:
            damping = max(1e-3, 8.0 * damping)
        if fell or damping > 0.0:
            total = assemble(s, rows, x, first, body_of, pivot, residual, jacobian, gradient)
    for v in vertices:
        first[v] = -1
    return total <= tolerance * tolerance


@inlined
def _shake(s, vertices, x, body_of, pivot, spread, state):
    """Moves every vertex (bodies as a whole) by up to `spread`, by a fixed sequence; its next
    state."""
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


@inlined
def newton(s, vertices, rows, x, body_of, pivot, first, floor, tolerance, attempts):
    """Moves the vertices until their equations hold; True when they do to `tolerance`.

    Where the descent ends in a local minimum it starts again from the sketch, shaken by a fixed
    sequence of shifts that grows from a fifth of the first residual to twice it. On failure x is as
    it was. `first` (v,) is scratch: -1 on entry and on return. `vertices` lists a body's members
    together.
    """
    kept = np.empty(_room(s, vertices))
    keep(s, vertices, x, kept, False)
    pivots = pivot.copy()
    spread = math.sqrt(total_of(s, rows, x, np.empty(8)) / rows.shape[0])
    state = 12345
    for attempt in range(attempts):
        if attempt > 0:
            keep(s, vertices, x, kept, True)
            pivot[:] = pivots
            strength = 0.2 + 1.8 * attempt / attempts
            state = _shake(s, vertices, x, body_of, pivot, strength * spread, state)
        longest = 40 if attempt == 0 else 20
        if _descend(s, vertices, rows, x, body_of, pivot, first, floor, tolerance, longest):
            return True
    keep(s, vertices, x, kept, True)
    pivot[:] = pivots
    return False


@kernel
def solve_block(s, vertices, rows, x, body_of, pivot, floor, tolerance, attempts):
    """`newton` for one call from outside."""
    first = np.full(s.kind.shape[0], -1, np.int64)
    return newton(s, vertices, rows, x, body_of, pivot, first, floor, tolerance, attempts)
