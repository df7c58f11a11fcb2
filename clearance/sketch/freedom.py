"""Degrees of freedom of a solved sketch: the whole, every entity, and equations that follow from
others.

The graph's count is generic; where a part is not too large its derivative matrix at the solution is
factored as well, so that dependencies which no count can see (theorems of geometry) are found.
"""

from __future__ import annotations

import numpy as np

from clearance.kernels.sketch_columns import spread
from clearance.kernels.sketch_graph import POINT, SLIDE, TURN
from clearance.kernels.sketch_rank import singular_steps
from clearance.sketch.problem import Problem

FACTORED = 1500
"""Freedoms of a part up to which its matrix is factored; beyond that the plan's own steps are the
evidence."""

SINGULAR = 1e-9
"""[-] Ratio to the largest below which a singular value is taken for 0: dimensions are scaled to
one size."""


def derivative(problem: Problem, x: np.ndarray, part: int, rows: np.ndarray):
    """(matrix (m, n) scaled to lengths, vertices, first column of each) of one part's equations."""
    s = problem.system
    vertices = np.flatnonzero(problem.part == part)
    widths = np.where(s.kind[vertices] == POINT, 2, 1)
    first = np.full(s.kind.size, -1)
    first[vertices] = np.concatenate([[0], np.cumsum(widths)[:-1]])
    _, i, j, value = spread(s, rows, x, first)
    matrix = np.zeros((rows.size, int(widths.sum())))
    np.add.at(matrix, (i, j), value)
    turns = first[vertices[s.kind[vertices] == TURN]]
    matrix[:, turns] /= problem.size
    return matrix, vertices, first


def rows_of(problem: Problem, part: int, *, independent: bool) -> np.ndarray:
    """The equations of a part that are edges of the graph."""
    chosen = (problem.row_part == part) & (problem.fate == 0)
    if independent:
        chosen[problem.plan.dependent] = False
    return np.flatnonzero(chosen)


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


def rank_of(matrix: np.ndarray) -> int:
    """The numerical rank."""
    if not matrix.size:
        return 0
    values = np.linalg.svd(matrix, compute_uv=False)
    return int(np.sum(values > SINGULAR * max(values[0], 1.0)))


def freedom_of(problem: Problem, x: np.ndarray) -> int:
    """Degrees of freedom left beyond placing the whole."""
    suspicious = suspicious_parts(problem, x)
    total = sum(_part_freedom(problem, x, p, suspicious[p]) for p in range(problem.n_parts))
    return max(total - whole_placement(problem, x), 0)


def suspicious_parts(problem: Problem, x: np.ndarray) -> np.ndarray:
    """(parts,) whether the count alone may err: numeric clusters, implied equations, singular steps."""
    plan, out = problem.plan, np.zeros(problem.n_parts, bool)
    out[problem.part[plan.block_vertex]] = True
    out[problem.row_part[plan.dependent]] = True
    singular = singular_steps(problem.system, plan, x, problem.size) > 0
    out[problem.part[plan.vertex[singular]]] = True
    return out


def _part_freedom(problem: Problem, x: np.ndarray, part: int, suspicious: bool) -> int:
    """Freedoms of one part including its placement; the matrix decides where the count may err."""
    vertices = np.flatnonzero(problem.part == part) if suspicious else np.zeros(0)
    if not suspicious or vertices.size > FACTORED // 2:
        return int(problem.free[part])
    matrix, _, _ = derivative(problem, x, part, rows_of(problem, part, independent=False))
    return matrix.shape[1] - rank_of(matrix)


def whole_placement(problem: Problem, x: np.ndarray) -> int:
    """How many of the three rigid motions of the whole move anything and respect the ground."""
    s = problem.system
    motions, grounded = np.zeros((0, 3)), np.zeros((0, 3))
    vertices = np.arange(1, s.kind.size)
    if not vertices.size:
        return 0
    widths = np.where(s.kind[vertices] == POINT, 2, 1)
    first = np.full(s.kind.size, -1)
    first[vertices] = np.concatenate([[0], np.cumsum(widths)[:-1]])
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


def redundant_rows(problem: Problem, x: np.ndarray, solved: bool) -> list[int]:
    """Equations that follow from the others: by merges, by the graph's count, or at the
    solution."""
    rows = [*problem.repeated, *np.flatnonzero(problem.fate >= 2), *problem.plan.dependent]
    suspicious = suspicious_parts(problem, x) if solved else np.zeros(problem.n_parts, bool)
    for part in np.flatnonzero(suspicious):
        mine = rows_of(problem, part, independent=True)
        if mine.size == 0 or mine.size > FACTORED:
            continue
        matrix, _, _ = derivative(problem, x, part, mine)
        rows += [mine[k] for k in _dependent_rows(matrix)]
    return sorted(int(r) for r in rows)


def _dependent_rows(matrix: np.ndarray) -> list[int]:
    """Rows that the rows before them span."""
    if rank_of(matrix) == matrix.shape[0]:
        return []
    basis, out = np.zeros((0, matrix.shape[1])), []
    for k, row in enumerate(matrix):
        rest = row - basis.T @ (basis @ row)
        rest -= basis.T @ (basis @ rest)
        norm = np.linalg.norm(rest)
        if norm <= SINGULAR * max(np.linalg.norm(row), 1.0):
            out.append(k)
        else:
            basis = np.vstack([basis, rest / norm])
    return out


def entity_freedoms(sketch, problem: Problem, x: np.ndarray) -> dict[str, int]:
    """Degrees of freedom of every entity while the initial cluster of its part is held."""
    out = {}
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
    return rank_of(np.array(rows)) if rows else 0


def _loose_motions(problem: Problem, x: np.ndarray, part: int):
    """(basis of the motions left (n, k), first columns) with the part's initial cluster held."""
    matrix, vertices, first = derivative(
        problem, x, part, rows_of(problem, part, independent=False)
    )
    hold = problem.hold[part]
    if hold < 2:
        matrix = np.vstack([matrix, _gauge(problem, vertices, first, matrix.shape[1], x, hold)])
    _, values, vt = np.linalg.svd(matrix)
    rank = int(np.sum(values > SINGULAR * max(values[0], 1.0))) if values.size else 0
    return vt[rank:].T, first


def _gauge(problem: Problem, vertices, first, n: int, x, hold: int) -> np.ndarray:
    """Rows that hold the vertices placed first: as many as rigid motions are left to the part."""
    motions = rigid_motions(problem, x, vertices, first)[:n, : 2 if hold else 3]
    rows = []
    inside = set(int(v) for v in vertices)
    ordered = [
        int(v)
        for k in range(problem.plan.vertex.size)
        for v in _placed(problem, k)
        if int(v) in inside
    ]
    for v in dict.fromkeys([*ordered, *map(int, vertices)]):
        for c in range(first[v], first[v] + (2 if problem.system.kind[v] == POINT else 1)):
            trial = [*rows, c]
            if rank_of(motions[trial]) == len(trial):
                rows = trial
    out = np.zeros((len(rows), n))
    out[np.arange(len(rows)), rows] = 1.0
    return out


def _placed(problem: Problem, step: int) -> list[int]:
    plan = problem.plan
    b = plan.block[step]
    if b >= 0:
        return list(plan.block_vertex[plan.block_vertex_start[b] : plan.block_vertex_start[b + 1]])
    return [v for v in (plan.vertex[step], plan.partner[step]) if v >= 0]
