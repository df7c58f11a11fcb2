"""Conflicts: a minimal set of constraints that cannot hold together, and the least changes that
repair it.

The first suspects are the circuit that the graph (or the merging of directions) closes around the
broken equation; otherwise the broken part as a whole. The set is then thinned by trying: a
constraint stays only if the rest can be solved without it (QuickXplain's halving, Junker 2004), so
minimality is checked by machine.
"""

from __future__ import annotations

import heapq
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from clearance.kernels.sketch_equations import POINT_POINT
from clearance.sketch.constraints import measured
from clearance.sketch.problem import Problem, Tables, problem_of


@dataclass(frozen=True)
class Repair:
    """Dimensions to change so that the conflict can be solved.

    Attributes:
        changes: new value by constraint name, in the constraint's own unit ([m], [rad] or [-]).
        size: root of the summed squares of the changes, angles as arcs at the sketch's size.
    """

    changes: dict[str, float]
    size: float


class Diagnosis:
    """A minimal conflict; its repairs, the least first, are worked out when asked for."""

    def __init__(self, trial: _Trials, conflict: list[int]) -> None:
        self._trial = trial
        self._conflict = conflict
        self.names = [trial.sketch._ordered[i].name for i in conflict]

    @cached_property
    def repairs(self) -> list[Repair]:
        """See `Repair`."""
        return _repairs(self._trial, self._conflict)


def diagnose(sketch, problem: Problem, before: np.ndarray, outcome) -> Diagnosis:
    """Why a problem has no solution; the sketch is not changed."""
    suspects = _suspects(problem, outcome.broken)
    chain = _too_short(problem, suspects or [], outcome.broken)
    if chain:
        trial = _Trials(sketch, problem, before, 1)
        if trial.is_minimal(chain):
            return Diagnosis(trial, chain)
    for effort in (0, 1):  # quick trials first; their answer counts only when full ones confirm it
        trial = _Trials(sketch, problem, before, effort)
        chosen = suspects
        if chosen is None or trial.solvable(chosen):
            chosen = trial.everything(outcome.broken)
        if trial.solvable(chosen):
            continue
        conflict = trial.minimal(chosen)
        trial.effort = 1
        if trial.is_minimal(conflict):
            break
    else:
        return Diagnosis(trial, conflict if not trial.solvable(chosen) else [])
    return Diagnosis(trial, conflict)


def _suspects(problem: Problem, broken: int) -> list[int] | None:
    """The constraints (by index) of the circuit around a broken equation, if there is one."""
    owner, plan = problem.tables.owner, problem.plan
    for k in range(plan.dependent.size):
        rows = plan.circuit[plan.circuit_start[k] : plan.circuit_start[k + 1]]
        if plan.dependent[k] == broken:
            merged = np.flatnonzero(problem.fate == 1)
            touched = set(problem.system.var[rows][problem.system.var[rows] >= 0])
            near = [r for r in merged if touched & set(problem.system.var[r])]
            together = [i for i, _ in problem.tables.together]
            return sorted(
                {int(o) for o in owner[rows]} | {int(owner[r]) for r in near} | set(together)
            )
    return None


def _too_short(problem: Problem, suspects: list[int], broken: int) -> list[int]:
    """A distance and a chain of other distances that cannot span it, if there is one (else empty).

    The shortest chain between the broken distance's ends, by Dijkstra's method.
    """
    tables, var = problem.tables, problem.system.var
    if broken < 0 or tables.code[broken] != POINT_POINT:
        return []
    value, near = tables.value, {}
    for row in np.flatnonzero((tables.code == POINT_POINT) & np.isin(tables.owner, suspects)):
        if row != broken:
            a, b = int(var[row, 0]), int(var[row, 2])
            near.setdefault(a, []).append((b, float(value[row]), int(row)))
            near.setdefault(b, []).append((a, float(value[row]), int(row)))
    start, goal = int(var[broken, 0]), int(var[broken, 2])
    came, waiting, done = {}, [(0.0, start, -1, -1)], set()
    while waiting:
        length, at, before, row = heapq.heappop(waiting)
        if at in done:
            continue
        done.add(at)
        came[at] = (before, row)
        if at == goal:
            break
        for other, step, by in near.get(at, []):
            heapq.heappush(waiting, (length + step, other, at, by))
    if goal not in came or length >= value[broken]:
        return []
    chain = [broken]
    while goal != start:
        goal, row = came[goal]
        chain.append(row)
    return sorted(int(o) for o in tables.owner[chain])


class _Trials:
    """Solves of parts of the constraints from the sketch as it was."""

    def __init__(self, sketch, problem: Problem, before: np.ndarray, effort: int) -> None:
        self.effort = effort
        self.sketch = sketch
        self.tables: Tables = problem.tables
        self.problem = problem
        self.before = before
        self.count = 0

    def run(self, chosen: list[int], effort: int | None = None):
        from clearance.sketch.solver import run

        self.count += 1
        marks = np.zeros(len(self.sketch._ordered), bool)
        marks[chosen] = True
        part = problem_of(self.tables.only(marks), self.before)
        sides = [
            tuple(e.variable for e in c.entities)
            for i, c in enumerate(self.sketch._ordered)
            if marks[i] and c.kind == "same_side" and not c.driven
        ]
        return run(part, self.before, sides, effort=self.effort if effort is None else effort)

    def solvable(self, chosen: list[int]) -> bool:
        """Whether these constraints (by index) can hold together."""
        if not chosen or self.run(chosen, 0).broken == -1:
            return True
        return self.effort > 0 and self.run(chosen).broken == -1

    def everything(self, broken: int) -> list[int]:
        """All constraints of the broken part of the sketch (of the whole when it cannot be
        told)."""
        owner = self.tables.owner
        part = self.problem.row_part[broken] if broken >= 0 else -1
        if part < 0 or not (self.problem.fate == 0).any():
            extra = [
                i
                for i, c in enumerate(self.sketch._ordered)
                if c.kind == "same_side" and not c.driven
            ]
            return sorted({int(o) for o in owner} | set(extra))
        return sorted({int(o) for o in owner[self.problem.row_part == part]} | {int(o) for o in
        owner[
            (self.problem.row_part < 0)]})  # fmt: skip

    def is_minimal(self, conflict: list[int]) -> bool:
        """Whether the set cannot be solved, and can without any one of its members."""
        return not self.solvable(conflict) and all(
            self.solvable([i for i in conflict if i != drop]) for drop in conflict
        )

    def minimal(self, suspects: list[int]) -> list[int]:
        """A subset that cannot be solved while every smaller one can. Built-in incidences are tried
        last."""
        ordered = self.sketch._ordered
        background = [i for i in suspects if ordered[i].built_in]
        changeable = [i for i in suspects if not ordered[i].built_in]
        if not self.solvable(background):
            return self._explain([], background, False)
        core = self._explain(background, changeable, False)
        return sorted(core + self._explain(core, background, False))

    def _explain(self, fixed: list[int], rest: list[int], grew: bool) -> list[int]:
        """Junker's QuickXplain: the part of `rest` that conflicts together with `fixed`,
        minimal."""
        if grew and not self.solvable(fixed):
            return []
        if not self.solvable(fixed) or not rest:
            return []
        if len(rest) == 1:
            return rest
        if len(rest) <= 64 and self._each_needed(fixed, rest):
            return rest
        half = len(rest) // 2
        first, second = rest[:half], rest[half:]
        right = self._explain(fixed + first, second, True)
        left = self._explain(fixed + right, first, bool(right))
        return left + right

    def _each_needed(self, fixed: list[int], rest: list[int]) -> bool:
        """Whether leaving out any one makes it solvable: circuits mostly are minimal already."""
        return all(self.solvable(fixed + [i for i in rest if i != drop]) for drop in rest)


def _repairs(trial: _Trials, conflict: list[int]) -> list[Repair]:
    """One dimension changed at a time, and all together by least squares; the least change
    first."""
    ordered, size = trial.sketch._ordered, trial.problem.size
    dimensions = [i for i in conflict if ordered[i].given is not None]
    found = []
    whole = [int(k) for k in np.unique(trial.tables.owner)]
    for i in dimensions:
        outcome = trial.run(
            [k for k in whole if k != i]
        )  # so that the repair suits all other constraints
        if outcome.broken != -1:  # there are more conflicts than this one
            outcome = trial.run([k for k in conflict if k != i])
        if outcome.broken == -1:
            number = measured(ordered[i], outcome.x.tolist())
            found.append(_repair(ordered, size, {i: number}))
    shared = _shared(trial, conflict, dimensions)
    if shared is not None:
        found.append(_repair(ordered, size, shared))
    return sorted(found, key=lambda r: (r.size, len(r.changes)))


def _repair(ordered, size: float, numbers: dict[int, float]) -> Repair:
    scale = {i: size if ordered[i].kind == "angle" else 1.0 for i in numbers}
    total = sum((scale[i] * (v - ordered[i].number)) ** 2 for i, v in numbers.items())
    return Repair({ordered[i].name: float(v) for i, v in numbers.items()}, float(np.sqrt(total)))


def _shared(trial: _Trials, conflict: list[int], dimensions: list[int]) -> dict[int, float] | None:
    """The least-squares change of all dimensions at once, the other constraints kept; None if not
    found."""
    from scipy.optimize import least_squares

    from clearance.kernels.sketch_equations import residuals

    tables = trial.tables
    if tables.code.size > 300:
        marks = np.zeros(len(trial.sketch._ordered), bool)
        marks[conflict] = True
        tables = trial.tables.only(marks)
    if tables.code.size == 0 or tables.code.size > 300:
        return None
    soft = np.isin(tables.owner, dimensions) & (tables.scale != 0.0)
    free = np.unique(tables.var[tables.var >= 0])
    weight = np.where(soft, 1.0, 1e3)
    from clearance.sketch.problem import joined

    alias, _, _ = joined(tables)
    var = np.where(tables.var >= 0, alias[tables.var], -1)

    def violation(numbers: np.ndarray) -> np.ndarray:
        x = trial.before.copy()
        x[free] = numbers
        return weight * residuals(tables.code, var, tables.coef, tables.value, x[alias])

    fitted = least_squares(
        violation, trial.before[free], xtol=1e-12, ftol=1e-12, gtol=1e-12, max_nfev=300
    )
    x = trial.before.copy()
    x[free] = fitted.x
    x = x[alias]
    if np.abs(violation(x[free])[~soft]).max(initial=0.0) > 1e-3 * trial.problem.size:
        return None
    return {i: measured(trial.sketch._ordered[i], x.tolist()) for i in dimensions}
