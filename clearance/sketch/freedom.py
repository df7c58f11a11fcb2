"""Degrees of freedom of a solved sketch: the whole, every entity, and equations that follow from
others.

The graph's count is generic; where it may err, the motions that a part really has are worked out at the
solution (`mobility`), so that dependencies which no count can see (theorems of geometry) are found.
"""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from clearance.kernels.sketch.graph.graph import POINT, SLIDE, TURN
from clearance.kernels.sketch.graph.plan_steps import block_of
from clearance.kernels.sketch.graph.rank import singular_steps
from clearance.kernels.sketch.solve.columns import spread
from clearance.sketch.execution import at_unit
from clearance.sketch.mobility import SINGULAR, Equations, implied, motions_of, numbered, rank_of
from clearance.sketch.problem import Problem

FACTORED = 1500
"""Freedoms of a part up to which its matrix is factored; beyond that the plan's own steps are the
evidence."""

WALKED = 400
"""Freedoms of a part up to which contacts beyond the first order are examined: half a second."""

CLEAR = 1e-6
"""[-] Share of a motion below which it does not move an entity: a walk comes back to 1e-8."""


def equations_of(problem: Problem, part: int, x: np.ndarray, *, regular: bool = True) -> Equations:
    """The equations of a part that are edges of the graph; those implied by the count come last.

    The regular ones are for freedoms. What follows from what is asked of the equations as they were given: a
    regular equation says what it says only together with the incidences of its point.
    """
    system = problem.regular if regular else problem.system
    chosen = (problem.row_part == part) & (problem.fate == 0)
    last = problem.plan.dependent[chosen[problem.plan.dependent]]
    chosen[last] = False
    return Equations(problem, part, np.concatenate([np.flatnonzero(chosen), last]), x, system)


def rigid_motions(
    problem: Problem, x: np.ndarray, vertices: np.ndarray, first: np.ndarray
) -> np.ndarray:
    """(n, 3) two shifts and a turn about the origin as motions of the columns."""
    s = problem.system
    out = np.zeros((int(np.max(first)) + 2, 3))
    for v in vertices:
        c, i = first[v], s.root[v]
        if s.kind[v] == POINT:
            out[c, 0] = out[c + 1, 1] = 1.0
            out[c, 2], out[c + 1, 2] = -x[i + 1] / problem.size, x[i] / problem.size
        elif s.kind[v] == TURN:
            out[c, 2] = 1.0
        elif s.kind[v] == SLIDE:
            out[c, 0], out[c, 1] = -np.sin(x[i - 1]), np.cos(x[i - 1])
    return out


def freedom_of(problem: Problem, x: np.ndarray) -> int:
    """Degrees of freedom left beyond placing the whole."""
    problem, x = at_unit(problem, x)
    suspicious = suspicious_parts(problem, x)
    total = sum(_part_freedom(problem, x, p, suspicious[p]) for p in range(problem.n_parts))
    return max(total - whole_placement(problem, x), 0)


def suspicious_parts(problem: Problem, x: np.ndarray) -> np.ndarray:
    """(parts,) whether the count alone may err: numeric clusters, implied equations, singular steps."""
    plan, out = problem.plan, np.zeros(problem.n_parts, bool)
    out[problem.part[plan.steps.block_vertex]] = True
    out[problem.row_part[plan.dependent]] = True
    singular = singular_steps(problem.system, plan.steps, x, problem.size) > 0
    out[problem.part[plan.steps.vertex[singular]]] = True
    return out


def _part_freedom(problem: Problem, x: np.ndarray, part: int, suspicious: bool) -> int:
    """Freedoms of one part including its placement; the motions decide where the count may err."""
    if not suspicious:
        return int(problem.free[part])
    equations = equations_of(problem, part, x)
    if equations.n > FACTORED:
        return int(problem.free[part])
    return motions_of(equations, walk=equations.n <= WALKED).basis.shape[1]


def whole_placement(problem: Problem, x: np.ndarray) -> int:
    """How many of the three rigid motions of the whole move anything and respect the ground."""
    s = problem.system
    motions, grounded = np.zeros((0, 3)), np.zeros((0, 3))
    vertices = np.arange(1, s.kind.size)
    if not vertices.size:
        return 0
    first, _ = numbered(problem, vertices)
    motions = rigid_motions(problem, x, vertices, first)
    rows = np.flatnonzero(problem.fate == 0)
    touching = rows[(problem.absolute[rows] > 0)]
    if touching.size:
        _, i, j, value = spread(s, touching, x, first)
        grounded = np.zeros((touching.size, 3))
        np.add.at(grounded, i, value[:, None] * motions[j])
    turned = np.any((s.vertex_of == 0) & (problem.tables.role == 2))
    slid = np.flatnonzero((s.vertex_of == 0) & (problem.tables.role == 3))
    extra = [[0.0, 0.0, 1.0]] if turned else []
    extra += [[-np.sin(x[i - 1]), np.cos(x[i - 1]), 0.0] for i in slid]
    if extra:
        grounded = np.vstack([grounded, extra])
    if not grounded.size:
        return rank_of(motions)
    _, values, vt = np.linalg.svd(grounded)
    rank = int(np.sum(values > SINGULAR * max(values[0], 1.0)))
    return rank_of(motions @ vt[rank:].T) if rank < 3 else 0


def redundant_constraints(problem: Problem, x: np.ndarray, solved: bool) -> list[int]:
    """The constraints (by index) that follow from the others: all their equations do, by merges, by the
    graph's count or at the solution.

    Of constraints that follow from one another those are named that have one equation only and are no part
    of how an entity is drawn, as far as there are such; then the last.
    """
    problem, x = at_unit(problem, x)
    owner = problem.tables.owner
    rows: list[int] = np.flatnonzero(problem.fate >= 2).tolist()
    if solved:
        suspicious = suspicious_parts(problem, x)
        rows += [
            r for p in np.flatnonzero(suspicious).tolist() for r in _implied_rows(problem, p, x)
        ]
    else:
        rows += problem.plan.dependent.tolist()
    count = np.bincount(owner[rows], minlength=owner.max(initial=-1) + 1)
    whole = (count > 0) & (count == np.bincount(owner))
    whole[owner[problem.repeated]] = True
    return [int(k) for k in np.flatnonzero(whole)]


def _implied_rows(problem: Problem, part: int, x: np.ndarray) -> list[int]:
    """The equations of a part that follow from its others."""
    equations = equations_of(problem, part, x, regular=False)
    if equations.rows.size > FACTORED or not equations.n:
        return [int(r) for r in problem.plan.dependent if problem.row_part[r] == part]
    return implied(equations, walk=equations.n <= WALKED)


def entity_freedoms(sketch, problem: Problem, x: np.ndarray) -> dict[str, int]:
    """Degrees of freedom of every entity while the initial cluster of its part is held."""
    out = {}
    problem, x = at_unit(problem, x)
    motions = {p: _loose_motions(problem, x, p) for p in range(problem.n_parts)}
    for name, entity in sketch.entities.items():
        count = {"point": 2, "line": 2, "segment": 2}.get(entity.what, 1)
        variables = [problem.alias[entity.variable + k] for k in range(count)]
        if entity.what in ("circle", "arc"):
            variables += [problem.alias[entity.center.variable + k] for k in (0, 1)]
        out[name] = _freedom_at(problem, motions, variables)
    return out


def _freedom_at(problem: Problem, motions: dict, variables: list[int]) -> int:
    s = problem.system
    for v in variables:
        if s.vertex_of[v] > 0:
            basis, first = motions[int(problem.part[s.vertex_of[v]])]
            break
    else:
        return 0
    rows = []
    for i in variables:
        v = s.vertex_of[i]
        if v > 0:
            shift = i - s.root[v] if s.kind[v] == POINT else 0
            rows.append(basis[first[v] + shift])
    return rank_of(np.array(rows), CLEAR) if rows else 0


def _loose_motions(problem: Problem, x: np.ndarray, part: int):
    """(basis of the motions left (n, k), first columns) with the part's initial cluster held."""
    equations = equations_of(problem, part, x)
    motions = motions_of(equations, walk=equations.n <= WALKED)
    held = motions.basis[_gauge(problem, part, equations, motions.place)]
    _, values, vt = np.linalg.svd(held)
    rank = int(np.sum(values > CLEAR)) if values.size else 0
    return motions.basis @ vt[rank:].T, equations.first


def _gauge(problem: Problem, part: int, equations: Equations, x: np.ndarray) -> list[int]:
    """The columns of vertices placed first that hold a part: as many as rigid motions are left to it."""
    vertices, first = equations.vertices, equations.first
    motions = rigid_motions(problem, x, vertices, first)[:, : (3, 2, 0)[problem.hold[part]]]
    inside = set(map(int, vertices))
    columns: list[int] = []
    steps = range(problem.plan.steps.vertex.size)
    placed = [v for k in steps for v in _placed(problem, k) if v in inside]
    for v in dict.fromkeys([*placed, *map(int, vertices)]):
        for c in range(first[v], first[v] + (2 if problem.system.kind[v] == POINT else 1)):
            if len(columns) == motions.shape[1]:
                return columns
            if rank_of(motions[[*columns, c]]) == len(columns) + 1:
                columns.append(c)
    return columns


def _placed(problem: Problem, step: int) -> Iterable[int]:
    steps = problem.plan.steps
    b = steps.block[step]
    if b >= 0:
        return map(int, block_of(steps, b)[0])
    return [int(v) for v in (steps.vertex[step], steps.partner[step]) if v >= 0]
