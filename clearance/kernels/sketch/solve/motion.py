"""The freedoms of a numeric cluster: its columns, its squared error, its moves and how to undo them.

Unknowns are the freedoms of the vertices and, for a body, a shift and a turn about its pivot; a body's
members are moved rigidly, so that what is already true inside it stays true.
"""

import math
from typing import NamedTuple

import numpy as np

from clearance.compile.jit import inline
from clearance.kernels.sketch.equations import evaluate
from clearance.kernels.sketch.graph.graph import POINT, SLIDE, TURN
from clearance.kernels.sketch.solve.place import assign


class NumericCluster(NamedTuple):
    """What is moved at once until its equations hold.

    Attributes:
        vertices: a body's members together.
        rows: (m,) the equations.
        body_of: (v,) the body that a vertex is moved with, -1 for none.
    """

    vertices: np.ndarray
    rows: np.ndarray
    body_of: np.ndarray


class ClusterPlace(NamedTuple):
    """Where a cluster is; moves change it in place.

    Attributes:
        x: (n,) [m, rad] all numbers of the sketch.
        pivot: (bodies, 2) [m] the point that every body turns about.
    """

    x: np.ndarray
    pivot: np.ndarray


class StoppingRule(NamedTuple):
    """When a search for a cluster's place ends.

    Attributes:
        floor: [m] the residual that it aims at. tolerance: [m] the residual at which the equations hold.
        attempts: how often it is tried.
    """

    floor: float
    tolerance: float
    attempts: int


class Unknowns(NamedTuple):
    """The freedoms of a cluster as columns.

    Attributes:
        first: (v,) the first column of every vertex (of its body, if it has one), -1 outside the cluster.
        n: how many columns there are.
    """

    cluster: NumericCluster
    first: np.ndarray
    n: int


class KeptPlace(NamedTuple):
    """A cluster's place as it was: the numbers of its vertices one after another, and the pivots."""

    numbers: np.ndarray
    pivot: np.ndarray


@inline
def unknowns_of(s, cluster):
    """The columns of a cluster: single vertices first, then its bodies."""
    vertices, body_of = cluster.vertices, cluster.body_of
    first = np.full(s.kind.shape[0], -1, np.int64)
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
    return Unknowns(cluster, first, count)


@inline
def freedoms(s, vertices, body_of):
    """How many unknowns a cluster has; a body's members are listed together."""
    count, last = 0, -1
    for v in vertices:
        b = body_of[v]
        if b < 0:
            count += 2 if s.kind[v] == POINT else 1
        elif b != last:
            count += 3
        last = b
    return count


@inline
def total_of(s, rows, x, gradient):
    """The sum of squared residuals."""
    total = 0.0
    for row in rows:
        f = evaluate(s.code, s.var, s.coef, s.value, x, row, gradient)
        total += f * f
    return total


@inline
def move(s, unknowns, step, size, place):
    """Adds `size` times `step` (n,) to the unknowns; bodies turn and shift exactly."""
    vertices, body_of = unknowns.cluster.vertices, unknowns.cluster.body_of
    first, x, pivot = unknowns.first, place.x, place.pivot
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


@inline
def new_kept_place(s, vertices, place):
    """Room in which `keep` keeps the place of these vertices."""
    count = 0
    for v in vertices:
        count += 2 if s.kind[v] == POINT else s.member_start[v + 1] - s.member_start[v]
    return KeptPlace(np.empty(count), np.empty(place.pivot.shape))


@inline
def keep(s, vertices, place, kept):
    """Copies the vertices' numbers and the pivots into `kept`."""
    numbers, x, at = kept.numbers, place.x, 0
    for v in vertices:
        if s.kind[v] == POINT:
            numbers[at], numbers[at + 1] = x[s.root[v]], x[s.root[v] + 1]
            at += 2
        else:
            for where in range(s.member_start[v], s.member_start[v + 1]):
                numbers[at] = x[s.member[where]]
                at += 1
    kept.pivot[:] = place.pivot


@inline
def restore(s, vertices, kept, place):
    """Copies the vertices' numbers and the pivots back from `kept`."""
    numbers, x, at = kept.numbers, place.x, 0
    for v in vertices:
        if s.kind[v] == POINT:
            x[s.root[v]], x[s.root[v] + 1] = numbers[at], numbers[at + 1]
            at += 2
        else:
            for where in range(s.member_start[v], s.member_start[v + 1]):
                x[s.member[where]] = numbers[at]
                at += 1
    place.pivot[:] = kept.pivot


@inline
def pivots_of(s, body_of, n_bodies, x):
    """The mean of every body's points (n_bodies, 2)."""
    out = np.zeros((n_bodies, 2))
    count = np.zeros(n_bodies)
    for v in range(body_of.shape[0]):
        b = body_of[v]
        if b >= 0 and s.kind[v] == POINT:
            out[b, 0] += x[s.root[v]]
            out[b, 1] += x[s.root[v] + 1]
            count[b] += 1.0
    for b in range(n_bodies):
        out[b] /= max(count[b], 1.0)
    return out
