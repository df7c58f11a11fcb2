"""Runs a problem's plan and sets the result down with least movement; falls back on numbers.

Order: numbers that are merged agree; parts that already hold stay bit for bit; the plan places
the rest; what it could not place is tried numerically; rigid parts are set down where the sketch has
them; parts with freedom move least as a whole.
"""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from clearance.sketch.beam import nearest_branch
from clearance.sketch.contacts import Contacts
from clearance.sketch.effort import OutOfTime
from clearance.sketch.equations import Lengths, Ratio, are
from clearance.sketch.folds import solve_from
from clearance.sketch.graph.graph import CONTRADICTED, DIRECTION, IN_GRAPH, POINT
from clearance.sketch.movement import closed, least_movement
from clearance.sketch.problem import DEPENDENT, RESIDUAL, SETTLED, Problem
from clearance.sketch.roots import nearest_roots
from clearance.sketch.solve.columns import Columns
from clearance.sketch.solve.execute import FAILED, LARGEST_BLOCK, SKIPPED, Run, execute, set_down
from clearance.sketch.solve.search import BANDED, RESTARTS, solve_cluster
from clearance.sketch.solve.system import System
from clearance.sketch.start import Sides, sides_hold, started

NEARLY = 1e-5
"""[-] Error of an implied equation, relative to the size, up to which all equations are solved
together once more: where the rest is singular (two loci that touch) a rounding of 1e-16 shows as its
root, 1e-8."""

WRONG_SIDE = -2
"""In place of the broken equation's row: all equations hold, a `same_side` does not."""

REVERSED = -3
"""The same: the points of a line with an angle are in the opposite order along it."""


class ExecutionResult:
    """The outcome of a run of a problem: numbers, the steps' fates, the worst row that does not hold (-1: all do).

    `stopped` says whether its limit has stopped it. `best` are then the numbers of least error, else its numbers.
    """

    def __init__(
        self,
        problem: Problem,
        x: np.ndarray,
        fates: np.ndarray,
        broken: int,
        residual: float,
        stopped: bool = False,
    ) -> None:
        self.problem = problem
        self.x = x
        self.best = x
        self.fates = fates
        self.broken = broken
        self.residual = residual
        self.stopped = stopped


def stopped(problem: Problem, before: np.ndarray, found: np.ndarray | None) -> ExecutionResult:
    """The outcome of a run that its limit stopped: the numbers `before` (n,), nothing solved.

    Its best numbers are those found by then, where their error is less.
    """
    places = [x[problem.alias] for x in (before, found) if x is not None]
    residual, row, best = min((*problem.residual(x), k) for k, x in enumerate(places))
    fates = np.full(len(problem.plan.steps), SKIPPED)
    out = ExecutionResult(problem, before.copy(), fates, max(row, 0), residual, stopped=True)
    out.best = places[best]
    return out


def run(
    problem: Problem,
    before: np.ndarray,
    sides: Sides = (),
    effort: int = 2,
    turned: frozenset[int] = frozenset(),
) -> ExecutionResult:
    """Solves a problem from the numbers `before` (n,).

    Lengths are divided by a power of two near the size first: a sketch that is drawn twice as large has
    the same solution twice as large, bit for bit.

    Args:
        effort: 2 solves it nearest to the sketch, 1 anywhere, 0 gives up where the plan's steps fail.
        turned: the closed steps on the branch opposite to the sketch.

    Raises:
        OutOfTime: the problem's limit has passed.
    """
    unit, lengths = _units(problem)
    try:
        outcome = _run_at_unit(_in_units(problem, unit), before / lengths, sides, effort, turned)
    except OutOfTime as stop:
        stop.x = None if stop.x is None else stop.x * lengths
        raise
    outcome.problem = problem
    outcome.x *= lengths
    outcome.residual *= unit
    return outcome


def at_unit(problem: Problem, x: np.ndarray) -> tuple[Problem, np.ndarray]:
    """The same problem and numbers (n,) with lengths divided by a power of two near the size."""
    unit, lengths = _units(problem)
    return _in_units(problem, unit), x / lengths


def _units(problem: Problem) -> tuple[float, np.ndarray]:
    """A power of two near the size, and what every number is divided by to be in it."""
    unit = 2.0 ** min(math.frexp(problem.size)[1], 1023)
    return unit, np.where(problem.tables.role == DIRECTION, 1.0, unit)


def _in_units(problem: Problem, unit: float) -> Problem:
    """The same problem with lengths divided by `unit`."""
    s, tables = problem.system, problem.tables
    angular = (problem.length_scale != 1.0) | are(s.code, Lengths, Ratio)
    turning = np.append(tables.role == DIRECTION, False)
    system = s.replaced(
        value=np.where(angular, s.value, s.value / unit),
        shift=np.where(turning, s.shift, s.shift / unit),
    )
    scale = np.where(problem.length_scale != 1.0, problem.length_scale / unit, 1.0)
    return replace(problem, system=system, size=problem.size / unit, length_scale=scale)


def _run_at_unit(
    problem: Problem, before: np.ndarray, sides: Sides, effort: int, turned: frozenset[int]
) -> ExecutionResult:
    """`run` for a problem of a size near 1."""
    size, dependent = problem.size, problem.plan.dependent
    x, sketch = started(problem, before, sides)
    active = _unsettled(problem, problem.regular, x, SETTLED * size)
    for k in turned:
        active[problem.part[problem.plan.steps[k].vertex]] = True
    fates = np.full(len(problem.plan.steps), SKIPPED)
    if active.any():
        try:
            fates, x = _solve_parts(problem, x, sketch, active, effort, turned)
        except OutOfTime as stop:
            stop.x = x if stop.x is None else stop.x
            raise
    if problem.tables.together:
        x = x[problem.alias]
    residual, broken = _verdict(problem, x)
    if dependent.size and RESIDUAL * size < residual <= NEARLY * size:
        for p in np.unique(problem.row_part[dependent]).tolist():
            _numeric_part(problem, p, x, x.copy(), effort)
        x = x[problem.alias]
        residual, broken = _verdict(problem, x)
    if problem.contacts is not None and broken == -1 and effort == 2:
        x = _touching(problem, problem.contacts, x, active)[problem.alias]
        residual, broken = _verdict(problem, x)
    outcome = ExecutionResult(problem, x, fates, broken, residual)
    if broken == -1 and sides and not sides_hold(x, sides, size):
        outcome.broken = WRONG_SIDE
    return outcome


def _unsettled(problem: Problem, system: System, x: np.ndarray, tolerance: float) -> np.ndarray:
    """(parts,) marks those with an equation that does not hold, of the equations that no others imply."""
    off = ~(np.abs(system.all_rows.errors(x)) * problem.length_scale <= tolerance)
    off[problem.plan.dependent] = False
    out = np.zeros(problem.n_parts, bool)
    out[problem.row_part[off & (problem.row_part >= 0)]] = True
    return out


def _solve_parts(
    problem: Problem,
    x: np.ndarray,
    sketch: np.ndarray,
    active_part: np.ndarray,
    effort: int,
    turned: frozenset[int],
):
    """(fates of the steps, numbers) after the parts that need work are solved from x."""
    size, s = problem.size, problem.system
    start = x.copy()
    active = np.where(problem.part >= 0, active_part[problem.part], False).tolist()
    rule = problem.rule(RESTARTS if effort else 4)
    fates = execute(s, problem.plan, x, Run(start, rule, turned, active))
    if effort == 0 and (fates == FAILED).any():
        return fates, x
    broken = _unsettled(problem, s, x, RESIDUAL * size)
    for p in np.flatnonzero(broken & active_part).tolist():
        problem.limit.require_time()
        if effort < 2 or not _from_drawing(problem, p, x, start):
            _numeric_part(problem, p, x, start, effort)
    if effort < 2:
        return fates, x
    x = nearest_roots(problem, x, start, fates)
    return fates, _nearest(problem, x, sketch, start, active_part)


def _touching(
    problem: Problem, contacts: Contacts, x: np.ndarray, active: np.ndarray
) -> np.ndarray:
    """x with the points of contact where they touch to the last digits."""
    parts = np.unique(problem.row_part[contacts.rows])
    for p in parts[parts >= 0].tolist():
        moved = closed(problem, p, x) if active[p] else None
        x = x if moved is None else moved
    return x


def _nearest(
    problem: Problem, x: np.ndarray, sketch: np.ndarray, start: np.ndarray, active: np.ndarray
) -> np.ndarray:
    """Sets rigid parts down nearest to the sketch, and moves those with freedom least."""
    s, rigid = problem.system, problem.is_rigid
    settle = np.where(rigid & (active > 0) & (problem.fixing < 2), 3 - problem.fixing, 0)
    if settle.any():
        weight = np.ones(s.kind.shape[0])
        weight[s.kind == POINT] = problem.weight[s.root[s.kind == POINT]]
        x = set_down(s, problem.part, settle, x, sketch, weight)
    for p in np.flatnonzero(~rigid & (active > 0) & (problem.free > 0)).tolist():
        problem.limit.require_time()
        moved = least_movement(problem, p, x, sketch, problem.weight, start)
        if moved is not None:
            x = moved
    return x


def _from_drawing(problem: Problem, part: int, x: np.ndarray, start: np.ndarray) -> bool:
    """Solves one whole part of many freedoms by least squares from the drawing, in place on x; True when
    it holds."""
    if problem.free[part] + np.sum(problem.row_part == part) < BANDED:
        return False
    mine = problem.numbers_of(part)
    branch = nearest_branch(problem, part, start)
    origin = np.where(mine, start if branch is None else branch, x)
    found = solve_from(problem, part, origin, RESIDUAL * problem.size)
    if found is None:
        return False
    x[:] = found
    return True


def _numeric_part(
    problem: Problem, part: int, x: np.ndarray, start: np.ndarray, effort: int
) -> bool:
    """Solves one whole part at once, from the start and from where the plan came; True when it holds."""
    rows = np.flatnonzero((problem.row_part == part) & (problem.fate == IN_GRAPH))
    if rows.size > 4 * LARGEST_BLOCK:
        return False
    columns = Columns(problem.system, problem.vertices_of(part), rows)
    rule = problem.rule(6 if rows.size < 60 and effort == 2 else effort)
    mine = problem.numbers_of(part)
    for origin in (start, x):
        problem.limit.require_time()
        found = solve_cluster(columns, np.where(mine, origin, x), rule)  # other parts stay
        if found is not None:
            x[:] = found
            return True
    return False


def _verdict(problem: Problem, x: np.ndarray) -> tuple[float, int]:
    """(residual, row that does not hold or -1)."""
    residual, row = problem.residual(x)
    contradicted = np.flatnonzero(problem.fate == CONTRADICTED)
    if contradicted.size:
        return residual, int(contradicted[0])
    allowed = DEPENDENT if problem.plan.dependent.size else RESIDUAL
    return residual, -1 if residual <= allowed * problem.size else int(row)
