"""The findings of a solve; details are computed on demand."""

from __future__ import annotations

from functools import cached_property

import numpy as np

from clearance.sketch.diagnosis import Diagnosis, diagnose
from clearance.sketch.freedom import entity_freedoms, freedom_of, redundant_constraints
from clearance.sketch.graph.graph import X, Y
from clearance.sketch.plan import Step, readable
from clearance.sketch.problem import RESIDUAL, Problem
from clearance.sketch.repairs import Repair
from clearance.sketch.roots import alternatives_of, by_name


class SketchResult:
    """The outcome of `Sketch.solve` or `Sketch.drag`.

    Attributes:
        residual: [m] the largest equation error of the best placement that was found (directions as
            arcs at the sketch's size).
        movement: [m] root of the summed squares of the points' shifts.
        stopped: the solve's limit of time has passed before it was done; the sketch is as it was.
    """

    def __init__(self, sketch, problem: Problem, before: np.ndarray, outcome) -> None:
        self.sketch = sketch
        self._problem = problem
        self._before = before
        self._outcome = outcome
        self.residual = outcome.residual
        self.stopped: bool = outcome.stopped

    @property
    def solved(self) -> bool:
        """Whether all constraints hold."""
        return self._outcome.broken == -1

    @cached_property
    def status(self) -> str:
        """The verdict: one of "well", "under", "over", "inconsistent" and "unsolved".

        "over": some constraints follow from others. "inconsistent": no solution exists, and `reason`
        says by what proof. "unsolved": a search found none, or was stopped; that is no proof that there is none.
        """
        if not self.solved:
            return "inconsistent" if self._diagnosis.proof else "unsolved"
        if self.redundant:
            return "over"
        return "under" if self.freedom > 0 else "well"

    @cached_property
    def freedom(self) -> int:
        """Remaining degrees of freedom of the shape; where the whole lies and how it is turned is not counted."""
        return freedom_of(self._problem, self._outcome.x)

    @cached_property
    def freedom_of(self) -> dict[str, int]:
        """Degrees of freedom of every entity with the initial cluster fixed."""
        return entity_freedoms(self.sketch, self._problem, self._outcome.x)

    @cached_property
    def redundant(self) -> list[str]:
        """Constraints that follow from the others."""
        chosen = redundant_constraints(self._problem, self._outcome.x, self.solved)
        return [self.sketch._lists.constraints[k].name for k in chosen]

    @cached_property
    def over_constrained(self) -> list[list[str]]:
        """Every over-constrained part: the constraints of a circuit of the graph (Definition 2)."""
        plan, owner = self._problem.plan, self._problem.tables.owner
        out = []
        for rows in plan.circuits:
            names = dict.fromkeys(
                self.sketch._lists.constraints[o].name for o in owner[sorted(rows)]
            )
            out.append(list(names))
        return out

    @cached_property
    def movement(self) -> float:
        """[m] how far the points moved: root of the summed squares."""
        role = self._problem.tables.role
        shift = (self._outcome.x - self._before)[(role == X) | (role == Y)]
        return float(np.linalg.norm(shift))

    @cached_property
    def drift(self) -> float:
        """[m] the largest shift of a point, where no entity is fixed; 0 where one is."""
        if any(one.kind == "fix" for one in self.sketch._lists.constraints):
            return 0.0
        role, shift = self._problem.tables.role, self._outcome.x - self._before
        return float(np.hypot(shift[role == X], shift[role == Y]).max(initial=0.0))

    @cached_property
    def plan(self) -> list[Step]:
        """The construction plan, step by step."""
        return readable(self.sketch, self._problem, self._outcome.fates)

    @cached_property
    def alternatives(self) -> list[dict[str, np.ndarray]]:
        """Other solutions of the small numeric clusters: the numbers of every entity, by name."""
        sides = self.sketch.sides()
        x = self._outcome.x
        return alternatives_of(self.sketch, self._problem, x, sides) if self.solved else []

    @cached_property
    def best(self) -> dict[str, np.ndarray]:
        """The placement of least error that was found: the numbers of every entity, by name.

        A sketch that is not solved stays as it was drawn; this is how far its solve came.
        """
        return by_name(self.sketch, self._problem, self._outcome.best)

    @cached_property
    def errors(self) -> dict[str, float]:
        """[m] how far every constraint is off at the best placement (directions as arcs at the sketch's size)."""

        error, owner = self._problem.errors(self._outcome.best), self._problem.tables.owner
        out = np.zeros(len(self.sketch._lists.constraints))
        np.maximum.at(out, owner, error)
        constraints = self.sketch._lists.constraints
        return {constraints[k].name: float(out[k]) for k in np.unique(owner).tolist()}

    @cached_property
    def unclosed(self) -> list[list[str]]:
        """The clusters of the plan that do not close at the best placement, each by its constraints.

        First those that place entities, in their order, then over-constrained parts.
        """
        problem, constraints = self._problem, self.sketch._lists.constraints
        off = problem.errors(self._outcome.best) > RESIDUAL * problem.size
        clusters = [*(list(step.rows) for step in problem.plan.steps), *problem.plan.circuits]
        owners = [problem.tables.owner[sorted(rows)] for rows in clusters if off[rows].any()]
        named = [list(dict.fromkeys(constraints[k].name for k in mine)) for mine in owners]
        return [] if self.solved else named

    @cached_property
    def _diagnosis(self) -> Diagnosis:
        return diagnose(self.sketch, self._problem, self._before, self._outcome)

    @property
    def conflicts(self) -> list[str]:
        """A minimal set of constraints that cannot hold together; empty when all hold.

        For an "unsolved" sketch it is the least set that the search could not solve, and empty where a
        cluster is too large to decide: then `searched` lists the cluster's constraints.
        """
        return [] if self.solved else self._diagnosis.names

    @property
    def searched(self) -> list[str]:
        """The constraints among which no solution was found; empty when all hold."""
        return [] if self.solved else self._diagnosis.searched

    @cached_property
    def reason(self) -> str:
        """One line that says why there is no solution, or that none was found; empty when all hold."""
        if self.solved:
            return ""
        names = self.conflicts or self.searched
        shown = ", ".join(names[:6]) + (f" and {len(names) - 6} more" if len(names) > 6 else "")
        if self._diagnosis.proof:
            said = (self._diagnosis.proof, self._diagnosis.kept_side)
            return f"{shown} cannot hold together: {'; '.join(filter(None, said))}"
        if self.stopped:
            what = f"{shown} do not hold" if names else "all holds, but not with the least movement"
            seconds = self._problem.limit.seconds
            return f"not solved within {seconds:g} s: {what}; a longer time limit may help"
        return f"no place found where {shown} hold; a failed search is no proof that there is none"

    @property
    def fault(self) -> str:
        """The obstacle to a drawing of the sketch, in one line; empty when all hold."""
        if self.solved or self.status != "inconsistent":
            return self.reason
        return f"the constraints {', '.join(self.conflicts[:6])} contradict each other"

    @property
    def repairs(self) -> list[Repair]:
        """Changes of dimensions that make the conflict solvable, the least first."""
        return [] if self.solved else self._diagnosis.repairs

    def __repr__(self) -> str:
        return (
            f"<SketchResult {self.status}, freedom {self.freedom}, residual {self.residual:.1e} m>"
        )
