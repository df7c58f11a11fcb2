"""Degrees of freedom of a solved sketch: the whole, every entity, and equations that follow from
others.

The graph's count is generic; where it may err, the motions that a part really has are worked out at the
solution (`mobility`), so that dependencies which no count can see (theorems of geometry) are found.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from clearance.sketch.effort import OutOfTime
from clearance.sketch.entities import Circle
from clearance.sketch.execution import at_unit
from clearance.sketch.graph.graph import POINT, SLIDE, TURN
from clearance.sketch.mobility import (
    SINGULAR,
    Equations,
    Motions,
    are_independent,
    dependent,
    implied,
    motions_of,
    rank_of,
)
from clearance.sketch.problem import Problem, entities_of
from clearance.sketch.solve.columns import Columns

FACTORED = 1500
"""Freedoms of a part up to which its matrix is factored; beyond that the plan's own steps are the
evidence."""

WALKED = 400
"""Freedoms of a part up to which contacts beyond the first order are examined: half a second."""

ALIKE = 1e-12
"""Determinant of the unit derivatives' products at which they count as one: sine squared, 1e-6 each. What only
touches is marked as well."""

CLEAR = 1e-6
"""[-] Share of a motion below which it does not move an entity: a walk comes back to 1e-8."""


def equations_of(problem: Problem, part: int, x: np.ndarray, *, regular: bool = True) -> Equations:
    """The equations of a part that are edges of the graph; those implied by the count come last.

    The regular ones are for freedoms. Implied equations are found among the equations as they were given: a
    regular equation says what it says only together with the incidences of its point.
    """
    system = problem.regular if regular else problem.system
    last = problem.plan.dependent[problem.row_part[problem.plan.dependent] == part]
    rows = np.concatenate([problem.independent_rows(part), last])
    return Equations(problem, part, rows, x, system)


def rigid_motions(problem: Problem, x: np.ndarray, columns: Columns) -> np.ndarray:
    """(n, 3) two shifts and a turn about the origin as motions of the columns."""
    s, first, out = problem.system, columns.first, np.zeros((columns.n, 3))
    kind = s.kind[columns.single]
    points, turns, slides = (columns.single[kind == k] for k in (POINT, TURN, SLIDE))
    c, i = first[points], s.root[points]
    out[c, 0] = out[c + 1, 1] = 1.0
    out[c, 2], out[c + 1, 2] = -x[i + 1] / problem.size, x[i] / problem.size
    out[first[turns], 2] = 1.0
    theta = x[s.root[slides] - 1]
    out[first[slides], 0], out[first[slides], 1] = -np.sin(theta), np.cos(theta)
    return out


def freedom_of(problem: Problem, x: np.ndarray) -> int:
    """Remaining degrees of freedom beyond placing the whole."""
    problem, x = _begun(problem, x)
    suspicious = suspicious_parts(problem, x)
    total = sum(_part_freedom(problem, x, p, suspicious[p]) for p in range(problem.n_parts))
    return max(total - whole_placement(problem, x), 0)


def _begun(problem: Problem, x: np.ndarray) -> tuple[Problem, np.ndarray]:
    """The problem and numbers at a size near 1; a question may take as long as the solve."""
    return at_unit(replace(problem, limit=problem.limit.again()), x)


def suspicious_parts(problem: Problem, x: np.ndarray) -> np.ndarray:
    """(parts,) whether the count alone may err: numeric clusters, implied equations, singular steps."""
    plan, out = problem.plan, np.zeros(problem.n_parts, bool)
    numeric = [step.vertex for step in plan.steps if step.numeric]
    out[problem.part[numeric + _singular_steps(problem, x)]] = True
    out[problem.row_part[plan.dependent]] = True
    return out


def _singular_steps(problem: Problem, x: np.ndarray) -> list[int]:
    """The first vertices of the closed steps with two or three equations that are not independent at x: two loci
    that are one, or run side by side. The count of freedoms does not see them."""
    s = problem.system
    closed = [step for step in problem.plan.steps if not step.numeric and len(step.rows) > 1]
    columns = Columns(s, np.arange(1, s.kind.size), np.arange(s.code.size))
    step_of_row, place_of_row = np.full((2, s.code.size), -1)
    step_of, place_of = np.full((2, columns.n), -1)
    for k, step in enumerate(closed):
        rows = np.array(step.rows)
        step_of_row[rows], place_of_row[rows] = k, np.arange(rows.size)
        first = columns.first[list(step.vertices)]
        mine = np.append(first, first[0] + 1)[:3] if s.kind[step.vertex] == POINT else first
        step_of[mine], place_of[mine] = k, np.arange(mine.size)
    row, column = columns.pattern
    unit = np.ones(columns.n)
    unit[columns.first[columns.single[s.kind[columns.single] == TURN]]] = 1.0 / problem.size
    own = (step_of[column] >= 0) & (step_of[column] == step_of_row[row])
    slopes = np.zeros((len(closed), 3, 3))
    at = step_of[column], place_of_row[row], place_of[column]
    np.add.at(slopes, tuple(i[own] for i in at), (columns.entries(x) * unit[column])[own])
    length = np.linalg.norm(slopes, axis=2, keepdims=True)
    slopes /= np.where(length > 0.0, length, 1.0)
    gram = slopes @ slopes.transpose(0, 2, 1)
    gram[:, 2, 2] += [len(step.rows) == 2 for step in closed]
    singular = np.flatnonzero(np.linalg.det(gram) <= ALIKE)
    return [closed[k].vertex for k in singular]


def _part_freedom(problem: Problem, x: np.ndarray, part: int, suspicious: bool) -> int:
    """Freedoms of one part including its placement; the motions decide where the count may err."""
    if not suspicious:
        return int(problem.free[part])
    equations = equations_of(problem, part, x)
    if equations.n > FACTORED:
        return int(problem.free[part])
    return _motions(equations).basis.shape[1]


def _motions(equations: Equations) -> Motions:
    """The motions of a part; those of the first order where it is large, or the time is not enough for more."""
    try:
        return motions_of(equations, walk=equations.n <= WALKED)
    except OutOfTime:
        return motions_of(equations, walk=False)


def whole_placement(problem: Problem, x: np.ndarray) -> int:
    """How many of the three rigid motions of the whole move anything and respect the ground."""
    s = problem.system
    grounded = np.zeros((0, 3))
    vertices = np.arange(1, s.kind.size)
    if not vertices.size:
        return 0
    touching = np.flatnonzero((problem.fate == 0) & (problem.absolute > 0))
    columns = Columns(s, vertices, touching)
    motions = rigid_motions(problem, x, columns)
    if touching.size:
        grounded = columns.sparse(x) @ motions
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

    If constraints follow from one another, those are named that have one equation only and are no part
    of how an entity is drawn, as far as there are such; then the last.
    """
    problem, x = _begun(problem, x)
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
    """The equations of a part that follow from its others; those of the count where more would need too long.

    None where the regular ones are independent: they say the same, so that each removes a freedom.
    """
    counted = [int(r) for r in problem.plan.dependent if problem.row_part[r] == part]
    equations = equations_of(problem, part, x, regular=False)
    if equations.rows.size > FACTORED or not equations.n:
        return counted
    if not counted and are_independent(equations_of(problem, part, x)):
        return []
    try:
        return implied(equations, walk=equations.n <= WALKED)
    except OutOfTime:
        return counted


def entity_freedoms(sketch, problem: Problem, x: np.ndarray) -> dict[str, int]:
    """Degrees of freedom of every entity while the initial cluster of its part is fixed."""
    out = {}
    problem, x = _begun(problem, x)
    moving = ~problem.is_rigid | suspicious_parts(problem, x)
    motions = {p: _loose_motions(problem, x, p) for p in np.flatnonzero(moving).tolist()}
    for name, entity in entities_of(sketch, problem).items():
        count = {"point": 2, "line": 2, "segment": 2}.get(entity.what, 1)
        variables = [problem.alias[entity.variable + k] for k in range(count)]
        if isinstance(entity, Circle):  # an arc, too
            variables += [problem.alias[entity.center.variable + k] for k in (0, 1)]
        out[name] = _freedom_at(problem, motions, variables)
    return out


def _freedom_at(problem: Problem, motions: dict, variables: list[int]) -> int:
    s = problem.system
    for v in variables:
        part = int(problem.part[s.vertex_of[v]]) if s.vertex_of[v] > 0 else -1
        if part in motions:
            basis, first = motions[part]
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
    """(basis of the remaining motions (n, k), first columns) with the part's initial cluster fixed."""
    equations = equations_of(problem, part, x)
    motions = _motions(equations)
    fixed = motions.basis[_gauge(problem, part, equations, motions.place)]
    _, values, vt = np.linalg.svd(fixed)
    rank = int(np.sum(values > CLEAR)) if values.size else 0
    return motions.basis @ vt[rank:].T, equations.first


def _gauge(problem: Problem, part: int, equations: Equations, x: np.ndarray) -> list[int]:
    """The columns of vertices placed first that fix a part: as many as its remaining rigid motions."""
    vertices, first = equations.vertices.tolist(), equations.first
    motions = rigid_motions(problem, x, equations.columns)[:, : (3, 2, 0)[problem.fixing[part]]]
    inside, kind = set(vertices), problem.system.kind
    placed = [v for step in problem.plan.steps for v in step.vertices if v in inside]
    in_order = dict.fromkeys([*placed, *vertices])
    columns = [int(first[v]) + k for v in in_order for k in range(2 if kind[v] == POINT else 1)]
    spanned = set(dependent(motions[columns]))
    return [c for k, c in enumerate(columns) if k not in spanned]
