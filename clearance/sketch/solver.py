"""A sketch's solver: the current problem, cached while the structure stays, and its solves and drags."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from clearance.sketch.branches import run_with_sides
from clearance.sketch.constraints import measured
from clearance.sketch.effort import OutOfTime, TimeLimit
from clearance.sketch.execution import REVERSED, ExecutionResult, stopped
from clearance.sketch.faults import DegenerateSketch
from clearance.sketch.graph.graph import RADIUS
from clearance.sketch.movement import least_movement
from clearance.sketch.problem import RESIDUAL, Problem, problem_of, tables_of
from clearance.sketch.start import sides_hold

SMALL_TURN = 1.0
"""[rad] Below a right angle: a line that turns by so much keeps the order of its points."""

DRAGGED = 1e6
"""[-] Weight of a dragged point against 1 for all others."""

KEPT = 1e4
"""[-] The same of radii, where the least movement would take a circle to a point."""


class Solver:
    """A sketch's current problem; it lives as long as the sketch's structure."""

    def __init__(self, sketch) -> None:
        self.sketch = sketch
        self._lists = sketch._lists
        self.tables = tables_of(sketch)
        self.sides = sketch.sides()
        self.problem = problem_of(self.tables, np.array(sketch._lists.numbers))

    def knows_all(self) -> bool:
        """Whether no entity or constraint has come in since."""
        lists, tables = self._lists, self.tables
        return (len(lists.numbers), len(lists.constraints)) == (
            tables.role.size,
            tables.numbers.size,
        )

    def current(self) -> Problem:
        """The problem with the dimensions as they are now; what was found before keeps the old ones."""
        lists = self._lists
        dimensions = lists.dimensions()
        if not np.array_equal(dimensions, self.tables.numbers):
            self.tables = replace(self.tables, numbers=dimensions)
            self.problem = problem_of(self.tables, np.array(lists.numbers), self.problem)
        return self.problem

    def solve(self, limit: TimeLimit) -> tuple[Problem, np.ndarray, ExecutionResult]:
        """See `Sketch.solve`."""
        problem = self.current()
        problem.limit = limit
        before = np.array(self._lists.numbers)
        outcome = self._run(problem, before)
        if outcome.broken == -1 and _vanished(problem, outcome.x).size:
            outcome = self._run(replace(outcome.problem, weight_of_radii=KEPT), before)
        return self._finish(before, outcome)

    def _run(self, problem: Problem, before: np.ndarray) -> ExecutionResult:
        """The outcome from the numbers before; these again where the time was not enough."""
        try:
            with problem.limit:
                outcome = run_with_sides(problem, before, self.sides)
                if outcome.broken != -1 or not self._lists.reversed_angles(before, outcome.x):
                    return outcome
                return self._by_small_turns(problem, before)
        except OutOfTime as stop:
            return stopped(problem, before, stop.x)

    def _by_small_turns(self, problem: Problem, before: np.ndarray) -> ExecutionResult:
        """The outcome with every angle turned a little at a time: by a far turn, a point may pass the other end of
        its line."""
        lists, goal = self._lists, self.tables.numbers
        drawn = goal.copy()
        for constraint in lists.angles():
            drawn[constraint.index] = measured(constraint, before.tolist())
        n_turns = math.ceil(np.abs(goal - drawn).max() / SMALL_TURN)
        x = before
        for k in range(1, n_turns):
            numbers = drawn + (goal - drawn) * (k / n_turns)
            turn = problem_of(replace(self.tables, numbers=numbers), x, problem)
            turn.limit = problem.limit
            outcome = run_with_sides(turn, x, self.sides)
            if outcome.broken != -1:
                break
            x = outcome.x
        outcome = run_with_sides(problem, x, self.sides)
        if outcome.broken == -1 and lists.reversed_angles(before, outcome.x):
            outcome.broken = REVERSED
        return outcome

    def drag(
        self, point, position: tuple[float, float], limit: TimeLimit
    ) -> tuple[Problem, np.ndarray, ExecutionResult]:
        """See `Sketch.drag`."""
        problem = self.current()
        problem.limit = limit
        before = np.array(self._lists.numbers)
        outcome = self._run(problem, before)
        if outcome.broken == -1:
            try:
                with problem.limit:
                    self._pull(outcome, problem.alias[point.variable], position)
            except OutOfTime:
                outcome = stopped(outcome.problem, before, outcome.x)
        return self._finish(before, outcome)

    def _pull(self, outcome: ExecutionResult, i: int, position) -> None:
        """Moves a solution so that the point at variable i comes nearest to a position, in place."""
        problem = outcome.problem
        target, weight = outcome.x.copy(), problem.weight.copy()
        target[i : i + 2] = np.array(position) - self.sketch.origin
        weight[i : i + 2] = DRAGGED
        part = problem.part[problem.system.vertex_of[i]]
        moved = least_movement(problem, part, outcome.x, target, weight, target)
        if moved is not None and sides_hold(moved, self.sides, problem.size):
            outcome.x = moved[problem.alias]
            outcome.residual, _ = problem.residual(moved)

    def _finish(
        self, before: np.ndarray, outcome: ExecutionResult
    ) -> tuple[Problem, np.ndarray, ExecutionResult]:
        problem = self.problem = replace(outcome.problem, weight_of_radii=1.0)
        if outcome.broken == -1:
            _check_degenerate(self.sketch, problem, outcome.x)
            self._lists.numbers[:] = outcome.x.tolist()
        return problem, before, outcome


def _check_degenerate(sketch, problem: Problem, x: np.ndarray) -> None:
    """Passes a solution (n,) in which every line and circle has extent.

    Raises:
        DegenerateSketch: one has none; the message names it.
    """
    small = _vanished(problem, x)
    if small.size:
        name = _name_at(sketch, int(small[0]))
        raise DegenerateSketch(f"{name} would have the radius 0", valid="a radius above 0")
    short = _closed_lines(problem, x)
    if short.size:
        raise DegenerateSketch(
            f"the two points of {_name_at(sketch, int(short[0]))} would coincide",
            valid="a line of some length",
        )


def _vanished(problem: Problem, x: np.ndarray) -> np.ndarray:
    """The variables of radii that are not above 0 at a solution (n,)."""
    return np.flatnonzero((problem.tables.role == RADIUS) & ~(x > RESIDUAL * problem.size))


def _closed_lines(problem: Problem, x: np.ndarray) -> np.ndarray:
    """The variables of lines whose two points are one at a solution (n,)."""
    line, a, b = problem.tables.line_ends.T
    length = np.hypot(x[a] - x[b], x[a + 1] - x[b + 1])
    return line[(a >= 0) & (length <= RESIDUAL * problem.size)]


def is_degenerate(problem: Problem, x: np.ndarray) -> bool:
    """Whether a line or circle has no extent at a solution (n,)."""
    return bool(_vanished(problem, x).size or _closed_lines(problem, x).size)


def _name_at(sketch, variable: int) -> str:
    """The line, circle or arc whose numbers start at a variable."""
    return next(
        e.name for e in sketch.entities.values() if e.variable == variable and e.what != "point"
    )
