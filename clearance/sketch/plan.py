"""The construction plan in words, step by step as the paper's figures name them.

Clusters: (a) three entities, an initial cluster; (b) an entity on a cluster by two edges; (c) two
bodies by three edges; (d) three bodies; extended, four or more; and the same with edges missing
(Fig. 13), whose assumptions are counted. Not for: making the plan
(`clearance.kernels.sketch_plan`).
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from clearance.kernels.sketch_graph import GROUND, POINT, SIZE, SLIDE, TURN


@dataclass(frozen=True)
class Step:
    """One step of a plan.

    Attributes:
        kind: "preprocess", "initial", "a", "b", "c", "d" or "extended".
        places: the entities that it merges or places.
        uses: the constraints that it satisfies.
        cluster: number of the body or cluster that it works in; 0 is the one that takes in all in
        the end.
        method: "assumed", "algebraic" or "numeric".
        assumptions: how many conditions are missing and taken from the sketch (initial placement
        apart).
        outcome: "done", "kept" (it held already) or "failed".
    """

    kind: str
    places: tuple[str, ...]
    uses: tuple[str, ...]
    cluster: int
    method: str
    assumptions: int = 0
    outcome: str = field(default="done", compare=False)

    def __str__(self) -> str:
        under = f", {self.assumptions} assumed" if self.assumptions else ""
        by = f" by {', '.join(self.uses)}" if self.uses else ""
        return (
            f"({self.kind}) {self.method}{under}: {', '.join(self.places)}{by} -> R{self.cluster}"
        )


class _Names:
    """Names of vertices: the entities whose numbers a vertex holds."""

    def __init__(self, sketch, problem) -> None:
        self.of: dict[int, list[str]] = {}
        self.ordered = sketch._ordered
        self.owner = problem.tables.owner
        s = problem.system
        for entity in sketch.entities.values():
            v = s.vertex_of[problem.alias[entity.variable]]
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
    plan, kind = problem.plan, problem.system.kind
    out = _preprocessing(names, problem)
    base = {int(b) for b in np.flatnonzero(plan.held)}
    spare = {p: [3, 2, 0][problem.hold[p]] for p in range(problem.n_parts)}
    begun: set[int] = set()
    size: dict[int, int] = {}
    for k in range(plan.vertex.size):
        b = plan.block[k]
        outcome = ("done", "failed", "failed", "kept")[fates[k]]
        if b >= 0:
            out.append(_block_step(names, problem, int(b), outcome))
            continue
        vertices = [v for v in (plan.vertex[k], plan.partner[k]) if v >= 0]
        rows = [r for r in plan.edges[k] if r >= 0]
        missing = sum(2 if kind[v] == POINT else 1 for v in vertices) - len(rows)
        inside = plan.origin[k] == 1
        body = int(plan.body_of[vertices[0]])
        cluster = body + 1 if inside and body not in base else 0
        places = names.vertices(vertices) or tuple(f"direction {int(v)}" for v in vertices)
        part = int(problem.part[vertices[0]])
        if inside:
            initial, assumed = missing > 0, 0
        else:
            assumed = max(missing - spare[part], 0)
            initial = missing > 0 and assumed < missing
            spare[part] -= missing - assumed
        key = body if inside else -1 - part
        size[key] = size.get(key, 0) + 1
        word = "initial" if initial and key not in begun else "b"
        if initial or word == "b":
            word = (
                "initial"
                if initial
                else ("a" if size[key] == 3 and problem.hold[part] < 2 else "b")
            )
        method = "assumed" if not rows else "algebraic"
        out.append(Step(word, places, names.rows(rows), cluster, method, assumed, outcome))
        begun.add(key)
    return out


def _preprocessing(names: _Names, problem) -> list[Step]:
    """Pseudo entities: coincident points, lines that share a direction and an offset."""
    out, s = [], problem.system
    for v in range(1, s.kind.size):
        places = names.vertices([v])
        if len(places) > 1 and s.kind[v] in (POINT, SLIDE):
            out.append(Step("preprocess", places, (), 0, "algebraic"))
    return out


def _block_step(names: _Names, problem, b: int, outcome: str) -> Step:
    plan, s = problem.plan, problem.system
    vertices = plan.block_vertex[plan.block_vertex_start[b] : plan.block_vertex_start[b + 1]]
    rows = plan.block_row[plan.block_row_start[b] : plan.block_row_start[b + 1]]
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
        kind, names.vertices(vertices), names.rows(rows), 0, "numeric", freedom - rows.size, outcome
    )


__all__ = ["GROUND", "SIZE", "TURN", "Step", "readable"]
