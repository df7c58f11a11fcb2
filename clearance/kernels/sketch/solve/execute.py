"""Runs a construction plan: closed steps by ruler and compass, numeric clusters by search.

A step whose equations already hold is left alone, which makes a second solve after one change cheap.
A cluster of many bodies is solved with all its points free: rigid bodies bar the ways on which a
descent gets past a wrong fold.
"""

import math
from typing import NamedTuple

import numpy as np

from clearance.compile.jit import inline, kernel
from clearance.kernels.sketch.equations import evaluate
from clearance.kernels.sketch.graph.graph import POINT
from clearance.kernels.sketch.graph.plan_steps import block_of
from clearance.kernels.sketch.solve.motion import (
    ClusterPlace,
    NumericCluster,
    StoppingRule,
    Unknowns,
    freedoms,
    move,
    pivots_of,
)
from clearance.kernels.sketch.solve.place import assign, place
from clearance.kernels.sketch.solve.search import BANDED, solve_block

DONE, FAILED, TOO_LARGE, KEPT = 0, 1, 2, 3
"""Fates of a step: placed; no such place found; a cluster left untried; its equations held already."""


class StepTolerances(NamedTuple):
    """When a step is left alone, and when it has found its place.

    Attributes:
        settled: [m] a step whose equations hold to this is left alone.
        largest_block: equations up to which a numeric step is tried.
        rule: for numeric steps.
    """

    settled: float
    largest_block: int
    rule: StoppingRule


class PlanRun(NamedTuple):
    """How the steps of a plan are run.

    Attributes:
        turned: (s,) 1 where a closed step takes the sketch's branch, -1 the other.
        active: (v,) 0 for the vertices of parts that need no work.
        fate: (s,) of every step; filled as they are run.
    """

    turned: np.ndarray
    active: np.ndarray
    fate: np.ndarray


FREED = 4
"""How many times more unknowns a cluster may have with its bodies' points free than with bodies."""


@inline
def _holds(s, edges, x, gradient, tolerance):
    """Whether every edge (-1 pads) already holds."""
    for row in edges:
        if row >= 0:
            f = evaluate(s.code, s.var, s.coef, s.value, x, row, gradient)
            if not abs(f) <= tolerance:
                return False
    return True


@inline
def _base_of(s, plan, rows, inside):
    """The initial cluster, if that is all that these rows hang on; else -1. `inside` marks the cluster."""
    base = -1
    for row in rows:
        for k in range(5):
            u = s.ends[row, k]
            if u <= 0 or inside[u] >= 0:
                continue
            b = plan.body_of[u]
            if b < 0 or not plan.held[b] or (base >= 0 and base != b):
                return -1
            base = b
    return base


@inline
def _freed(s, plan, cluster, base, inside):
    """A cluster with the points of its bodies, and of the base, each by itself; inner rows and all.

    `inside` (v,) marks the cluster's vertices on entry; -1 on return.
    """
    n, vertices, rows = plan.body_of.shape[0], cluster.vertices, cluster.rows
    free = np.empty(n, np.int64)
    n_free = vertices.shape[0]
    free[:n_free] = vertices
    for v in range(n):
        if base >= 0 and plan.body_of[v] == base:
            free[n_free] = v
            n_free += 1
            inside[v] = 1
    idle = np.zeros(s.ends.shape[0], np.uint8)
    for row in plan.dependent:
        idle[row] = 1
    for row in rows:
        idle[row] = 1
    out = np.empty(s.ends.shape[0], np.int64)
    count = rows.shape[0]
    out[:count] = rows
    for row in range(s.ends.shape[0]):
        v = s.ends[row, 0]
        if idle[row] or v <= 0 or inside[v] < 0 or plan.body_of[v] < 0:
            continue
        within = True
        for k in range(1, 5):
            u = s.ends[row, k]
            within = within and (u < 0 or plan.body_of[u] == plan.body_of[v])
        if within:
            out[count] = row
            count += 1
    for v in free[:n_free]:
        inside[v] = -1
    return NumericCluster(free[:n_free], out[:count], np.full(n, -1, np.int64))


@inline
def _put_back(s, plan, base, cluster, x, before, inside):
    """Moves the cluster rigidly so that the base lies where it was; how far it is off then [m].

    A base of a single point hangs on known directions: it is only shifted.
    """
    vertices = cluster.vertices
    pivot, goal, turn, count = np.zeros((1, 2)), np.zeros(2), np.zeros(2), 0
    for v in vertices:
        inside[v] = 0
        if plan.body_of[v] == base and s.kind[v] == POINT:
            for k in range(2):
                pivot[0, k] += x[s.root[v] + k]
                goal[k] += before[s.root[v] + k]
            count += 1
    pivot /= count
    goal /= count
    for v in vertices:
        if plan.body_of[v] == base and s.kind[v] == POINT:
            i = s.root[v]
            ax, ay = x[i] - pivot[0, 0], x[i + 1] - pivot[0, 1]
            bx, by = before[i] - goal[0], before[i + 1] - goal[1]
            turn[0] += ax * bx + ay * by
            turn[1] += ax * by - ay * bx
    step = np.empty(3)
    step[:2] = goal - pivot[0]
    step[2] = math.atan2(turn[1], turn[0])
    as_one = NumericCluster(vertices, cluster.rows, np.zeros(inside.shape[0], np.int64))
    move(s, Unknowns(as_one, inside, 3), step, 1.0, ClusterPlace(x, pivot))
    off = 0.0
    for v in vertices:
        inside[v] = -1
        if plan.body_of[v] == base and s.kind[v] == POINT:
            for k in range(2):
                off = max(off, abs(x[s.root[v] + k] - before[s.root[v] + k]))
    return off


@inline
def _find_freed(s, plan, cluster, x, sketch, rule, alone_in_part):
    """Solves a large cluster from the sketch with all its points free; it is set down by its base.

    A base that came out mirrored will do only where no other cluster hangs on it already.
    """
    inside = np.full(s.kind.shape[0], -1, np.int64)
    for v in cluster.vertices:
        inside[v] = 1
    base = _base_of(s, plan, cluster.rows, inside)
    freed = _freed(s, plan, cluster, base, inside)
    before = x.copy()
    for v in freed.vertices:
        if s.kind[v] == POINT:
            x[s.root[v]], x[s.root[v] + 1] = sketch[s.root[v]], sketch[s.root[v] + 1]
        else:
            assign(s, v, sketch[s.root[v]], x)
    if not solve_block(s, freed, ClusterPlace(x, np.zeros((0, 2))), rule):
        x[:] = before
        return False
    off = _put_back(s, plan, base, freed, x, before, inside) if base >= 0 else 0.0
    if off > rule.tolerance and not alone_in_part:
        x[:] = before
        return False
    return True


@kernel
def place_closed(s, steps, x, sketch, run, settled, begin):
    """Runs the closed steps from `begin` on, in place on x and `run.fate`, up to a numeric step that has
    work to do; its index, or the number of steps.

    A step whose equations hold to `settled` [m] is left alone.
    """
    gradient = np.empty(8)
    for k in range(begin, steps.vertex.shape[0]):
        b, v = steps.block[k], steps.vertex[k]
        run.fate[k] = KEPT
        if b >= 0:
            vertices, rows = block_of(steps, b)
            if not run.active[vertices[0]]:
                continue
            if not _holds(s, rows, x, gradient, settled):
                return k
        elif run.active[v]:
            turned, edges, partner = run.turned[k], steps.edges[k], steps.partner[k]
            if turned > 0.0 and _holds(s, edges, x, gradient, settled):
                continue
            if s.kind[v] == POINT and partner >= 0:
                return k
            done = place(s, v, partner, edges, x, sketch, gradient, turned)
            run.fate[k] = DONE if done else FAILED
    return steps.vertex.shape[0]


@kernel
def solve_numeric(s, plan, x, sketch, k, limits):
    """The fate of one numeric step, in place on x: a cluster, or a circle from three conditions."""
    alone = np.full(s.kind.shape[0], -1, np.int64)
    steps, b = plan.steps, plan.steps.block[k]
    if b < 0:
        vertices, rows = np.empty(2, np.int64), steps.edges[k][steps.edges[k] >= 0]
        vertices[0], vertices[1] = steps.vertex[k], steps.partner[k]
    else:
        vertices, rows = block_of(steps, b)
    if rows.shape[0] > limits.largest_block:
        return TOO_LARGE
    cluster = NumericCluster(vertices, rows, plan.body_of if b >= 0 else alone)
    pivot = pivots_of(s, plan.body_of, plan.held.shape[0], x)
    unknowns = freedoms(s, vertices, plan.body_of)
    if BANDED <= unknowns and freedoms(s, vertices, alone) <= FREED * unknowns:
        if _find_freed(s, plan, cluster, x, sketch, limits.rule, b == 0):
            return DONE
    done = solve_block(s, cluster, ClusterPlace(x, pivot), limits.rule)
    return DONE if done else FAILED
