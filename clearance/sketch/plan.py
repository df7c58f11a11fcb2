"""The construction plan in words, step by step."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from clearance.sketch.graph.graph import FREEDOMS
from clearance.sketch.graph.steps import PlanStep
from clearance.sketch.problem import Problem, entities_of


@dataclass(frozen=True)
class Step:
    """One step of a plan.

    Attributes:
        places: the entities that it places: one, or a cluster at once.
        uses: the constraints that it satisfies.
        method: "assumed", "algebraic" or "numeric".
        assumptions: how many conditions are missing and come from the sketch; the first steps also assume where a
            part lies.
        outcome: "done", "kept" (it held already) or "failed".
    """

    places: tuple[str, ...]
    uses: tuple[str, ...]
    method: str
    assumptions: int = 0
    outcome: str = field(default="done", compare=False)

    def __str__(self) -> str:
        under = f", {self.assumptions} assumed" if self.assumptions else ""
        by = f" by {', '.join(self.uses)}" if self.uses else ""
        return f"{self.method}{under}: {', '.join(self.places)}{by}"


OUTCOMES = ("done", "failed", "failed", "kept")
"""By the fates of `clearance.sketch.solve.execute`."""


def readable(sketch, problem: Problem, fates: np.ndarray) -> list[Step]:
    """The steps of a problem's plan."""
    names, placed, out = _names_of_vertices(sketch, problem), set[int](), []
    constraints, owner = sketch._lists.constraints, problem.tables.owner
    for step, fate in zip(problem.plan.steps, fates.tolist(), strict=True):
        ends = dict.fromkeys(problem.system.ends[list(step.rows)].ravel().tolist())
        drawn = [v for v in ends if v > 0 and v not in placed and v not in step.vertices]
        placed.update(drawn, step.vertices)
        here = (*drawn, *step.vertices)
        places = tuple(name for v in here for name in names.get(v, ()))
        out.append(
            Step(
                places or tuple(f"direction {v}" for v in here),
                tuple(dict.fromkeys(constraints[owner[row]].name for row in step.rows)),
                "numeric" if step.numeric else "algebraic" if step.rows else "assumed",
                _freedom(problem, step) - len(step.rows),
                OUTCOMES[fate],
            )
        )
    return out


def _names_of_vertices(sketch, problem: Problem) -> dict[int, list[str]]:
    """By vertex, the entities whose numbers it has; a line is its offset."""
    out: dict[int, list[str]] = {}
    for entity in entities_of(sketch, problem).values():
        number = entity.variable + (1 if entity.what in ("line", "segment") else 0)
        v = int(problem.system.vertex_of[problem.alias[number]])
        out.setdefault(v, []).append(entity.name)
    return out


def _freedom(problem: Problem, step: PlanStep) -> int:
    """The freedoms of what a step places; a cluster moves bodies as a whole."""
    kind, body_of = problem.system.kind, problem.plan.body_of
    bodies = {int(body_of[v]) for v in step.vertices if step.numeric and body_of[v] >= 0}
    single = [v for v in step.vertices if not step.numeric or body_of[v] < 0]
    return 3 * len(bodies) + sum(FREEDOMS[kind[v]] for v in single)
