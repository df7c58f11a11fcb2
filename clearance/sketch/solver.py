"""A sketch's solver: the current problem, cached while the structure stays, and its solves and drags.

Not for: how a problem is solved (`execution`).
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from clearance.sketch.branches import run_with_sides
from clearance.sketch.degenerate import check_degenerate
from clearance.sketch.effort import OutOfTime, TimeLimit
from clearance.sketch.execution import ExecutionResult, stopped
from clearance.sketch.movement import least_movement
from clearance.sketch.problem import Problem, problem_of, tables_of
from clearance.sketch.start import sides_hold
from clearance.sketch.steps import residual_of

if TYPE_CHECKING:
    from clearance.sketch.constraints import Constraint

DRAGGED = 1e6
"""[-] Weight of a dragged point against 1 for all others."""


class Solver:
    """A sketch's current problem; it lives as long as the sketch's structure."""

    def __init__(self, sketch) -> None:
        self.sketch = sketch
        self.tables = tables_of(sketch)
        self.sides = sketch.sides()
        self.problem = problem_of(self.tables, np.array(sketch._lists.numbers))
        self.stale = False

    def changed(self, constraint: Constraint) -> None:
        """Adopts a changed dimension; earlier results have the old one."""
        if not self.stale:
            self.tables = replace(self.tables, numbers=self.tables.numbers.copy())
        self.tables.numbers[constraint.index] = constraint.number
        self.stale = True

    def current(self) -> Problem:
        """The problem with the dimensions as they are now."""
        if self.stale:
            self.problem = problem_of(
                self.tables, np.array(self.sketch._lists.numbers), self.problem
            )
            self.stale = False
        return self.problem

    def solve(self, limit: TimeLimit) -> tuple[Problem, np.ndarray, ExecutionResult]:
        """See `Sketch.solve`."""
        problem = self.current()
        problem.limit = limit
        before = np.array(self.sketch._lists.numbers)
        return self._finish(problem, before, self._run(problem, before))

    def _run(self, problem: Problem, before: np.ndarray) -> ExecutionResult:
        """The outcome from the numbers before; these again where the time was not enough."""
        try:
            with problem.limit:
                return run_with_sides(problem, before, self.sides)
        except OutOfTime as stop:
            return stopped(problem, before, stop.x)

    def drag(
        self, point, position: tuple[float, float], limit: TimeLimit
    ) -> tuple[Problem, np.ndarray, ExecutionResult]:
        """See `Sketch.drag`."""
        problem = self.current()
        problem.limit = limit
        before = np.array(self.sketch._lists.numbers)
        outcome = self._run(problem, before)
        if outcome.broken == -1:
            try:
                with problem.limit:
                    self._pull(problem, outcome, problem.alias[point.variable], position)
            except OutOfTime:
                outcome = stopped(problem, before, outcome.x)
        return self._finish(problem, before, outcome)

    def _pull(self, problem: Problem, outcome: ExecutionResult, i: int, position) -> None:
        """Moves a solution so that the point at variable i comes nearest to a position, in place."""
        target, weight = outcome.x.copy(), problem.weight.copy()
        target[i : i + 2] = np.array(position) - self.sketch.origin
        weight[i : i + 2] = DRAGGED
        part = problem.part[problem.system.vertex_of[i]]
        moved = least_movement(problem, part, outcome.x, target, weight)
        if moved is not None and sides_hold(moved, self.sides, problem.size):
            outcome.x = moved[problem.alias]
            outcome.residual, _ = residual_of(problem, moved)

    def _finish(
        self, problem: Problem, before: np.ndarray, outcome: ExecutionResult
    ) -> tuple[Problem, np.ndarray, ExecutionResult]:
        if outcome.broken == -1:
            check_degenerate(self.sketch, problem, outcome.x)
            self.sketch._lists.numbers[:] = outcome.x.tolist()
        return problem, before, outcome
