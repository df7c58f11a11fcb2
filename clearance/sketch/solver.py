"""Runs a sketch's plan and sets the result down with least movement; falls back on numbers where it
fails.

Order: numbers that are merged agree; parts that already hold are left bit for bit; the plan places
the rest; rigid parts are set down where the sketch has them; parts with freedom move least as a
whole; what the plan could not place is tried numerically; what is left is inconsistent.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from clearance.kernels.sketch_equations import worst
from clearance.kernels.sketch_execute import execute
from clearance.kernels.sketch_fit import set_down
from clearance.kernels.sketch_graph import POINT
from clearance.kernels.sketch_search import RESTARTS, solve_block
from clearance.kernels.sketch_start import agree, unsettled
from clearance.sketch.movement import least_movement
from clearance.sketch.problem import DEPENDENT, RESIDUAL, SETTLED, Problem, problem_of, tables_of

if TYPE_CHECKING:
    from clearance.sketch.constraints import Constraint

LARGEST_BLOCK = 6000
"""Equations of a numeric cluster up to which it is tried; large ones are solved on a band."""

FLOOR = 2e-16
"""[-] What a numeric cluster aims at, relative to the size: about one rounding of a coordinate."""

NEARLY = 1e-5
"""[-] Error of an implied equation, relative to the size, up to which all equations are solved
together once
more: where the rest is singular (two loci that touch) a rounding of 1e-16 shows as its root,
1e-8."""

DRAGGED = 1e6
"""[-] Weight of a dragged point against 1 for all others."""


class Outcome:
    """What a run gave: numbers, steps' fates and the worst equation that does not hold (-1: all
    do)."""

    def __init__(self, x: np.ndarray, fates: np.ndarray, broken: int, residual: float) -> None:
        self.x = x
        self.fates = fates
        self.broken = broken
        self.residual = residual


class Solver:
    """A sketch's current problem; it lives as long as the sketch's structure."""

    def __init__(self, sketch) -> None:
        self.sketch = sketch
        self.tables = tables_of(sketch)
        self.index = {id(c): i for i, c in enumerate(sketch._ordered)}
        self.problem = problem_of(self.tables, np.array(sketch._numbers))
        self.stale = False

    def changed(self, constraint: Constraint) -> None:
        """Takes over a changed dimension."""
        self.tables.numbers[self.index[id(constraint)]] = constraint.number
        self.stale = True

    def current(self) -> Problem:
        """The problem with the dimensions as they are now."""
        if self.stale:
            self.problem = problem_of(self.tables, np.array(self.sketch._numbers), self.problem)
            self.stale = False
        return self.problem

    def solve(self) -> tuple[Problem, np.ndarray, Outcome]:
        """See `Sketch.solve`."""
        problem = self.current()
        before = np.array(self.sketch._numbers)
        outcome = run(problem, before, sides=self.sketch_sides())
        return self._finish(problem, before, outcome)

    def drag(self, point, position: tuple[float, float]) -> tuple[Problem, np.ndarray, Outcome]:
        """See `Sketch.drag`."""
        problem = self.current()
        before = np.array(self.sketch._numbers)
        outcome = run(problem, before, sides=self.sketch_sides())
        if outcome.broken < 0:
            target = outcome.x.copy()
            i = problem.alias[point.variable]
            target[i : i + 2] = position
            weight = problem.weight.copy()
            weight[i : i + 2] = DRAGGED
            part = problem.part[problem.system.vertex_of[i]]
            moved = least_movement(problem, part, outcome.x, target, weight)
            if moved is not None:
                outcome.x = moved
                outcome.residual, _ = residual_of(problem, moved)
        return self._finish(problem, before, outcome)

    def sketch_sides(self) -> list[tuple[int, int, int]]:
        """The variables of every `same_side`: two points and a line."""
        return [
            tuple(e.variable for e in c.entities)
            for c in self.sketch._ordered
            if c.kind == "same_side" and not c.driven
        ]

    def _finish(
        self, problem: Problem, before: np.ndarray, outcome: Outcome
    ) -> tuple[Problem, np.ndarray, Outcome]:
        if outcome.broken < 0:
            check_degenerate(self.sketch, outcome.x, problem.size)
            self.sketch._numbers[:] = outcome.x.tolist()
        return problem, before, outcome


def residual_of(problem: Problem, x: np.ndarray) -> tuple[float, int]:
    """The largest residual [m] of all equations that are not implied by others, and its row."""
    s = problem.system
    return worst(s.code, s.var, s.coef, s.value, x, problem.length_scale)


def run(problem: Problem, before: np.ndarray, sides=(), effort: int = 2) -> Outcome:
    """Solves a problem from the numbers `before` (n,).

    Args:
        effort: 2 solves it nearest to the sketch, 1 anywhere, 0 gives up where the plan's steps
        fail.
    """
    size, s = problem.size, problem.system
    dependent = problem.plan.dependent
    contradicted = np.flatnonzero(problem.fate == 3)
    x = before.copy()
    if problem.tables.together:
        _join(problem, x)
    reflect(problem, x, sides)
    sketch_raw = x.copy()
    agree(s, problem.tables.role, x, middles(problem, sketch_raw), SETTLED * size)
    loose = _loosened(problem, dependent)
    active_part = unsettled(s, loose, problem.n_parts, x, problem.length_scale, SETTLED * size)
    fates = np.full(problem.plan.vertex.shape[0], 3)
    if active_part.any():
        fates, x = _solve_parts(problem, x, sketch_raw, active_part, effort)
    if problem.tables.together:
        x = x[problem.alias]
    residual, broken = _verdict(problem, x, dependent, contradicted)
    if dependent.size and RESIDUAL * size < residual <= NEARLY * size and not contradicted.size:
        for p in np.unique(problem.row_part[dependent]):
            _numeric_part(problem, p, x, x.copy(), effort)
        x = x[problem.alias]
        residual, broken = _verdict(problem, x, dependent, contradicted)
    if broken < 0 and sides and not _sides_hold(x, sides, size):
        broken = -2
    return Outcome(x, fates, broken, residual)


def run_after(problem: Problem, block: int, x: np.ndarray) -> np.ndarray:
    """The numbers after the steps that follow a numeric cluster are run again from x."""
    size = problem.size
    later = int(np.flatnonzero(problem.plan.block == block)[0]) + 1
    plan = problem.plan._replace(
        vertex=problem.plan.vertex[later:], partner=problem.plan.partner[later:],
        edges=problem.plan.edges[later:], block=problem.plan.block[later:],
        origin=problem.plan.origin[later:],
    )  # fmt: skip
    out = x.copy()
    active = np.ones(problem.system.kind.size, np.uint8)
    execute(
        problem.system, plan, out, x.copy(), active, SETTLED * size, FLOOR * size, RESIDUAL * size,
        LARGEST_BLOCK, RESTARTS,
    )  # fmt: skip
    return out


def _loosened(problem: Problem, dependent: np.ndarray) -> np.ndarray:
    """The part of every row, without the rows that others imply."""
    if not dependent.size:
        return problem.row_part
    out = problem.row_part.copy()
    out[dependent] = -1
    return out


def _solve_parts(
    problem: Problem, x: np.ndarray, sketch: np.ndarray, active_part: np.ndarray, effort: int
):
    size, s = problem.size, problem.system
    start = x.copy()
    active = np.where(problem.part >= 0, active_part[problem.part], 0).astype(np.uint8)
    fates = execute(
        s, problem.plan, x, start, active, SETTLED * size, FLOOR * size, RESIDUAL * size,
        LARGEST_BLOCK, RESTARTS if effort else 4,
    )  # fmt: skip
    if effort == 0 and (fates == 1).any():
        return fates, x
    rigid = problem.is_rigid
    loose = _loosened(problem, problem.plan.dependent)
    broken = unsettled(s, loose, problem.n_parts, x, problem.length_scale, RESIDUAL * size)
    for p in np.flatnonzero(broken & active_part):
        _numeric_part(problem, p, x, start, effort)
    if effort < 2:
        return fates, x
    settle = np.where(rigid & (active_part > 0) & (problem.hold < 2), 3 - problem.hold, 0)
    if settle.any():
        weight = np.ones(s.kind.shape[0])
        weight[s.kind == POINT] = problem.weight[s.root[s.kind == POINT]]
        set_down(s, problem.part, settle, x, sketch, weight)
    for p in np.flatnonzero(~rigid & (active_part > 0) & (problem.free > 0)):
        moved = least_movement(problem, p, x, sketch, problem.weight, start)
        if moved is not None:
            x = moved
    return fates, x


def _numeric_part(
    problem: Problem, part: int, x: np.ndarray, start: np.ndarray, effort: int
) -> bool:
    """Solves one whole part at once, from the sketch and then from where the plan came; True when
    it holds."""
    size, s = problem.size, problem.system
    vertices = np.flatnonzero(problem.part == part)
    rows = np.flatnonzero((problem.row_part == part) & (problem.fate == 0))
    if rows.size > 4 * LARGEST_BLOCK:
        return False
    alone = np.full(s.kind.shape[0], -1)
    pivot = np.zeros((0, 2))
    for origin in (start, x):
        tried = origin.copy()
        if solve_block(
            s,
            vertices,
            rows,
            tried,
            alone,
            pivot,
            FLOOR * size,
            RESIDUAL * size,
            6 if rows.size < 60 and effort == 2 else effort,
        ):
            x[:] = tried
            return True
    return False


def _join(problem: Problem, x: np.ndarray) -> None:
    """Gives coincident points their mean, unless they already agree."""
    mean = np.bincount(problem.alias, weights=x, minlength=x.size) / np.maximum(problem.weight, 1.0)
    mean = mean[problem.alias]
    apart = np.abs(mean - x) > SETTLED * problem.size
    moved = np.isin(problem.alias, problem.alias[apart])
    x[moved] = mean[moved]
    x[:] = x[problem.alias]


def middles(problem: Problem, x: np.ndarray) -> np.ndarray:
    """(n, 2) by direction index: the point about which a line turns: its points' middle, or its
    foot."""
    out = np.zeros((x.size, 2))
    ends = problem.tables.line_ends
    if ends.size:
        theta, a, b = ends.T
        foot = np.column_stack([-np.sin(x[theta]) * x[theta + 1], np.cos(x[theta]) * x[theta + 1]])
        out[theta] = foot
        drawn = a >= 0
        a, b = problem.alias[a[drawn]], problem.alias[b[drawn]]
        out[theta[drawn], 0] = 0.5 * (x[a] + x[b])
        out[theta[drawn], 1] = 0.5 * (x[a + 1] + x[b + 1])
    return out


def _verdict(problem: Problem, x: np.ndarray, dependent: np.ndarray, contradicted: np.ndarray):
    """(residual, row that does not hold or -1)."""
    size, s = problem.size, problem.system
    residual, row = worst(s.code, s.var, s.coef, s.value, x, problem.length_scale)
    if contradicted.size:
        return residual, int(contradicted[0])
    if residual <= RESIDUAL * size:
        return residual, -1
    if dependent.size and residual <= DEPENDENT * size:
        return residual, -1
    return residual, int(row)


def reflect(problem: Problem, x: np.ndarray, sides) -> None:
    """Mirrors the second point of a `same_side` that is drawn on the wrong side."""
    for p, q, line in sides:
        p, q = problem.alias[p], problem.alias[q]
        n = np.array([-np.sin(x[line]), np.cos(x[line])])
        first, second = n @ x[p : p + 2] - x[line + 1], n @ x[q : q + 2] - x[line + 1]
        if first * second < 0.0:
            x[q : q + 2] -= 2.0 * second * n


def _sides_hold(x: np.ndarray, sides, size: float) -> bool:
    for p, q, line in sides:
        n = np.array([-np.sin(x[line]), np.cos(x[line])])
        first, second = n @ x[p : p + 2] - x[line + 1], n @ x[q : q + 2] - x[line + 1]
        if min(first * second, 0.0) < -RESIDUAL * size * size:
            return False
    return True


def check_degenerate(sketch, x: np.ndarray, size: float) -> None:
    """Refuses a solution with a circle of radius 0 or a line whose points coincide."""
    from clearance.kernels.sketch_graph import RADIUS
    from clearance.sketch.faults import DegenerateSketch

    role = np.array(sketch._roles)
    small = np.flatnonzero((role == RADIUS) & (x <= RESIDUAL * size))
    for entity in sketch.entities.values() if small.size else ():
        if entity.variable in small:
            raise DegenerateSketch(
                f"{entity.name} would have the radius 0", valid="a radius above 0"
            )
    ends = np.array(sketch._line_ends).reshape(-1, 3)
    drawn = ends[ends[:, 1] >= 0]
    if not drawn.size:
        return
    _, a, b = drawn.T
    short = np.hypot(x[a] - x[b], x[a + 1] - x[b + 1]) <= RESIDUAL * size
    for line in drawn[short, 0]:
        name = next(
            e.name
            for e in sketch.entities.values()
            if e.what in ("line", "segment") and e.variable == line
        )
        raise DegenerateSketch(
            f"the two points of {name} would coincide", valid="a line of some length"
        )


__all__ = ["DEPENDENT", "Outcome", "Solver", "run"]
