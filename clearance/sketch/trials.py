"""Trials: can some of the constraints hold together, and which least set of them cannot.

A quick trial starts from the numbers of the failed solve, where most equations hold already; only
when it finds nothing are the chosen constraints planned and solved from the sketch. What a trial finds
solvable is so; what it does not find solvable need not be impossible.
"""

from __future__ import annotations

import numpy as np

from clearance.sketch.branches import run_with_sides
from clearance.sketch.graph.graph import IN_GRAPH, RADIUS, REPEATED
from clearance.sketch.problem import Problem, Tables, problem_of
from clearance.sketch.solve.columns import Columns
from clearance.sketch.solve.search import solve_cluster
from clearance.sketch.start import sides_hold

AT_ONCE = 64
"""Constraints up to which each is dropped in turn before halving: circuits mostly are minimal already."""


class Trials:
    """Solves of parts of a sketch's constraints (by index), from the sketch as it was or from `found`."""

    def __init__(self, sketch, problem: Problem, before: np.ndarray, found: np.ndarray) -> None:
        self.effort = 1
        self.sketch = sketch
        self.tables: Tables = problem.tables
        self.problem = problem
        self.before = before
        self.starts = [found]
        self.limit = problem.limit

    def marks(self, chosen: list[int]) -> np.ndarray:
        """(constraints,) True for the chosen."""
        out = np.zeros(len(self.sketch._lists.constraints), bool)
        out[chosen] = True
        return out

    def part(self, chosen: list[int]) -> Problem:
        """The problem of these constraints alone."""
        self.limit.require_time()
        part = problem_of(self.tables.only(self.marks(chosen)), self.before)
        part.limit = self.limit
        return part

    def run(self, chosen: list[int], effort: int | None = None):
        """The outcome of these constraints alone, solved from the sketch."""
        sides = self.sketch.sides(set(chosen))
        effort = self.effort if effort is None else effort
        return run_with_sides(self.part(chosen), self.before, sides, effort)

    def run_from(self, x: np.ndarray, chosen: list[int]):
        """The outcome of these constraints alone, nearest to the numbers x (n,)."""
        return run_with_sides(self.part(chosen), x, self.sketch.sides(set(chosen)))

    def solvable(self, chosen: list[int]) -> bool:
        """Whether a trial finds a place where these constraints hold together."""
        self.limit.require_time()
        if not chosen or self._near(chosen) or self.run(chosen, 0).broken == -1:
            return True
        return self.effort > 0 and self.run(chosen).broken == -1

    def _near(self, chosen: list[int]) -> bool:
        """Whether they hold after a descent from numbers found before; what is merged stays merged."""
        s = self.problem.system
        mine = self.marks(chosen)[self.tables.owner]
        if (self.problem.fate[mine] > REPEATED).any():
            return False
        rows = np.flatnonzero(mine & (self.problem.fate == IN_GRAPH))
        vertices = np.unique(s.ends[rows])
        vertices = vertices[vertices > 0]
        sides = self.sketch.sides(set(chosen))
        columns = Columns(s, vertices, rows)
        for k, start in enumerate(self.starts):
            x = self._descended(columns, start)
            if x is not None and sides_hold(x, sides, self.problem.size):
                self.starts[1:] = [x] if k == 0 else [x, *self.starts[1:k]]
                return True
        return False

    def _descended(self, columns: Columns, x: np.ndarray) -> np.ndarray | None:
        """Where a descent from x makes some equations hold, with every radius above 0; None for nowhere."""
        rule = self.problem.rule(1)._replace(limit=self.limit)
        found = solve_cluster(columns, x, rule) if columns.rows.size else x
        good = found is not None and (found[self.tables.role == RADIUS] > 0.0).all()
        return found if good else None

    def everything(self, broken: int) -> list[int]:
        """All constraints of the broken part of the sketch (of the whole when it cannot be found)."""
        owner = self.tables.owner
        part = self.problem.row_part[broken] if broken >= 0 else -1
        if part < 0 or not (self.problem.fate == IN_GRAPH).any():
            sides = [c.index for c in self.sketch._lists.constraints if c.kind == "same_side"]
            return sorted({int(o) for o in owner} | set(sides))
        inside = (self.problem.row_part == part) | (self.problem.row_part < 0)
        return sorted({int(o) for o in owner[inside]})

    def is_minimal(self, conflict: list[int]) -> bool:
        """Whether no trial solves the set, and one does without any one of its members."""
        return not self.solvable(conflict) and self.each_needed([], conflict)

    def each_needed(self, fixed: list[int], rest: list[int]) -> bool:
        """Whether leaving out any one of `rest` makes it solvable."""
        return all(self.solvable(fixed + [i for i in rest if i != drop]) for drop in rest)

    def thinned(self, circuit: list[int]) -> list[int]:
        """The rest of a circuit after dropping, one after another, all constraints that it conflicts without."""
        remaining = list(circuit)
        for drop in circuit:
            rest = [i for i in remaining if i != drop]
            if not self.solvable(rest):
                remaining = rest
        return remaining

    def minimal(self, suspects: list[int]) -> list[int]:
        """A subset that is not solved while every smaller one is; incidences of drawing are tried last."""
        ordered = self.sketch._lists.constraints
        background = [i for i in suspects if ordered[i].built_in]
        changeable = [i for i in suspects if not ordered[i].built_in]
        if not self.solvable(background):
            return self._explain([], background, False)
        core = self._explain(background, changeable, False)
        return sorted(core + self._explain(core, background, False))

    def _explain(self, fixed: list[int], rest: list[int], grew: bool) -> list[int]:
        """Junker's QuickXplain: the part of `rest` that conflicts together with `fixed`, minimal."""
        if grew and not self.solvable(fixed):
            return []
        if not rest or not self.solvable(fixed):
            return []
        if len(rest) == 1:
            return rest
        if len(rest) <= AT_ONCE and self.each_needed(fixed, rest):
            return rest
        half = len(rest) // 2
        first, second = rest[:half], rest[half:]
        right = self._explain(fixed + first, second, True)
        remaining = self._explain(fixed + right, first, bool(right))
        return remaining + right
