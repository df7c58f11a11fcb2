"""The construction plan in words, step by step as the paper's figures name them.

Clusters: (a) three entities, an initial cluster; (b) an entity on a cluster by two edges; (c) two
bodies by three edges; (d) three bodies; extended, four or more; and the same with edges missing,
whose assumptions are counted: Fig. 13 (a) and (b) lack one edge, (c) is two bodies that lack two,
(d) two bodies that lack one.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from clearance.sketch.graph.graph import IN_BODY, POINT, SLIDE, PlanStep
from clearance.sketch.problem import entities_of


@dataclass(frozen=True)
class Step:
    """One step of a plan.

    Attributes:
        kind: "preprocess", "initial", "a", "b", "c", "d" or "extended".
        places: the entities that it merges or places.
        uses: the constraints that it satisfies.
        cluster: number of the body or cluster that it works in; 0 is the one that adds all in
        the end.
        method: "assumed", "algebraic" or "numeric".
        assumptions: how many conditions are missing and come from the sketch (initial placement
        excluded).
        outcome: "done", "kept" (it held already) or "failed".
    """

    kind: str
    places: tuple[str, ...]
    uses: tuple[str, ...]
    cluster: int
    method: str
    assumptions: int = 0
    outcome: str = field(default="done", compare=False)

    @property
    def figure(self) -> str:
        """The figure of Kwon, Lee and Lee 2001 that shows this kind of cluster; empty for none."""
        if self.kind == "preprocess":
            return "Fig. 9 (0)"
        if self.kind == "extended":
            return "Fig. 11"
        if self.kind == "initial":
            return ""
        if not self.assumptions:
            return f"Fig. 8 ({self.kind})"
        letter = {("c", 1): "d", ("c", 2): "c", ("b", 1): "b", ("a", 1): "a"}
        found = letter.get((self.kind, self.assumptions))
        return f"Fig. 13 ({found})" if found else ""

    def __str__(self) -> str:
        under = f", {self.assumptions} assumed" if self.assumptions else ""
        by = f" by {', '.join(self.uses)}" if self.uses else ""
        return (
            f"({self.kind}) {self.method}{under}: {', '.join(self.places)}{by} -> R{self.cluster}"
        )


OUTCOMES = ("done", "failed", "failed", "kept")
"""By the fates of `clearance.sketch.solve.execute`."""


class _Names:
    """Names of vertices: the entities whose numbers a vertex has."""

    def __init__(self, sketch, problem) -> None:
        self.of: dict[int, list[str]] = {}
        self.ordered = sketch._lists.constraints
        self.owner = problem.tables.owner
        s = problem.system
        for entity in entities_of(sketch, problem).values():
            slot = entity.variable + (1 if entity.what in ("line", "segment") else 0)
            v = s.vertex_of[problem.alias[slot]]
            self.of.setdefault(int(v), []).append(entity.name)

    def vertices(self, vertices) -> tuple[str, ...]:
        return tuple(n for v in vertices for n in self.of.get(int(v), []))

    def rows(self, rows) -> tuple[str, ...]:
        return tuple(dict.fromkeys(self.ordered[self.owner[r]].name for r in rows if r >= 0))


def readable(sketch, problem, fates: np.ndarray) -> list[Step]:
    """The steps of a problem's plan."""
    names = _Names(sketch, problem)
    reading = _ClosedStepReading(names, problem)
    out = _preprocessing(names, problem)
    for step, fate in zip(problem.plan.steps, fates.tolist(), strict=True):
        if step.numeric:
            out.append(_block_step(names, problem, step, OUTCOMES[fate]))
        else:
            out.append(reading.step(step, OUTCOMES[fate]))
    return out


class _ClosedStepReading:
    """Closed steps in order: which begin a cluster, and what they assume beyond its placement."""

    def __init__(self, names: _Names, problem) -> None:
        self.names = names
        self.problem = problem
        self.plan = problem.plan
        self.base = {int(b) for b in np.flatnonzero(self.plan.fixed)}
        inside = np.isin(self.plan.body_of, list(self.base))
        self.based = set(problem.part[inside].tolist())
        self.placed = {v for step in problem.plan.steps for v in step.vertices}
        self.spare = {p: [3, 2, 0][problem.fixing[p]] for p in range(problem.n_parts)}
        self.spare.update(dict.fromkeys(self.based, 0))  # its base places the part
        self.spare_of_body: dict[int, int] = {}
        self.size: dict[int, int] = {}

    def step(self, step: PlanStep, outcome: str) -> Step:
        vertices, rows = list(step.vertices), step.rows
        inside, body = step.origin == IN_BODY, int(self.plan.body_of[step.vertex])
        kind, assumed = self._kind(vertices, rows, inside, body)
        if inside and len(rows) == 1:  # an edge whose other end is fixed without a step of its own
            ends = [int(v) for v in self.problem.system.ends[rows[0]] if v > 0]
            vertices = [*(v for v in ends if v not in self.placed), *vertices]
        places = self.names.vertices(vertices) or tuple(f"direction {v}" for v in vertices)
        cluster = body + 1 if inside and body not in self.base else 0
        method = "algebraic" if rows else "assumed"
        return Step(kind, places, self.names.rows(rows), cluster, method, assumed, outcome)

    def _kind(self, vertices, rows, inside: bool, body: int) -> tuple[str, int]:
        """("initial", "a" or "b", conditions assumed) of a step; placement is no assumption."""
        part = int(self.problem.part[vertices[0]])
        freedom = sum(2 if self.problem.system.kind[v] == POINT else 1 for v in vertices)
        missing = freedom - len(rows)
        key = body if inside else -1 - part
        spare = self.spare_of_body.setdefault(body, 3) if inside else self.spare[part]
        granted = min(missing, spare)
        if inside:
            self.spare_of_body[body] -= granted
        else:
            self.spare[part] -= granted
        fresh = inside or (self.problem.fixing[part] < 2 and part not in self.based)
        self.size[key] = self.size.get(key, 0) + 1
        if granted:
            return "initial", missing - granted
        return ("a" if fresh and self.size[key] == 3 else "b"), missing


def _preprocessing(names: _Names, problem) -> list[Step]:
    """Pseudo entities: coincident points, lines that share a direction and an offset."""
    out, s = [], problem.system
    for v in range(1, s.kind.size):
        places = names.vertices([v])
        if len(places) > 1 and s.kind[v] in (POINT, SLIDE):
            out.append(Step("preprocess", places, (), 0, "algebraic"))
    return out


def _block_step(names: _Names, problem, step: PlanStep, outcome: str) -> Step:
    plan, s, vertices, rows = problem.plan, problem.system, step.vertices, step.rows
    nodes = {
        ("body", int(plan.body_of[v])) if plan.body_of[v] >= 0 else ("vertex", int(v))
        for v in vertices
    }
    freedom = sum(3 if n[0] == "body" else (2 if s.kind[n[1]] == POINT else 1) for n in nodes)
    bodies = sum(n[0] == "body" for n in nodes)
    kind = "extended"
    if bodies == len(nodes) == 1:
        kind = "c"
    elif bodies == len(nodes) == 2:
        kind = "d"
    return Step(
        kind, names.vertices(vertices), names.rows(rows), 0, "numeric", freedom - len(rows), outcome
    )
