"""Peeling: a vertex with no more edges than degrees of freedom is placed last, given all the
others.

Removing such vertices one after another until none remains orders every ruler-and-compass sketch
in linear time, without a search for clusters; the reverse order is a plan. What remains (the core)
has only vertices with more edges than freedom. A vertex removed with fewer edges leaves freedom:
an assumption.
Source: Owen 1991 and the inverse of the first Henneberg step; joint vertices (a line's direction
and offset, a circle's centre and radius) are ours.
"""

from __future__ import annotations

from collections import deque

from clearance.sketch.graph.graph import (
    FREEDOMS,
    PEELED,
    POINT,
    SIZE,
    SLIDE,
    TURN,
    ConstraintGraph,
    PlanStep,
)


def peel(graph: ConstraintGraph, live: bytearray, removed: bytearray) -> list[PlanStep]:
    """Removes the vertices that can be, in order; clears `live` and sets `removed` in place."""
    peeling, steps = _Peeling(graph, live, removed), []
    while peeling.queue:
        v = peeling.queue.popleft()
        peeling.waiting[v] = 0
        found = peeling.found(v)
        if found is not None:
            peeling.remove(*found)
            steps.append(PlanStep(*found, PEELED))
    return steps


class _Peeling:
    """The rest of a graph while it is peeled, and the vertices that wait for a visit."""

    def __init__(self, graph: ConstraintGraph, live: bytearray, removed: bytearray) -> None:
        self.graph, self.live, self.removed = graph, live, removed
        n = len(graph.kind)
        self.degree = [sum(map(live.__getitem__, rows)) for rows in graph.rows]
        self.n_slides = [0] * n
        for v in range(n):
            if graph.kind[v] == SLIDE and not removed[v]:
                self.n_slides[graph.theta_of[v]] += 1
        self.queue = deque(v for v in range(1, n) if not removed[v])
        self.waiting = bytearray(not r for r in removed)

    def rows_of(self, v: int) -> list[int]:
        """The remaining edges of a vertex."""
        return [row for row in self.graph.rows[v] if self.live[row]]

    def found(self, v: int) -> tuple[tuple[int, ...], tuple[int, ...]] | None:
        """The vertices to remove, v and a partner, and the edges that place them; None where v must stay."""
        kind, degree = self.graph.kind[v], self.degree[v]
        if self.removed[v] or degree > 3:
            return None
        allowed, partner = FREEDOMS[kind], -1
        if degree > allowed or kind == TURN:
            partner = self._partner(v)
            allowed += partner >= 0
        if degree > allowed:
            return None
        chosen = (v,) if partner < 0 else (v, partner)
        rows = tuple(dict.fromkeys(row for u in chosen for row in self.rows_of(u)))
        if len(rows) > allowed or not self._independent(chosen, rows):
            return None
        return chosen, rows

    def remove(self, chosen: tuple[int, ...], rows: tuple[int, ...]) -> None:
        """Removes vertices and edges; what they were tied to waits again."""
        graph = self.graph
        for u in chosen:
            self.removed[u] = 1
        if graph.kind[chosen[0]] == SLIDE:
            self.n_slides[graph.theta_of[chosen[0]]] -= 1
        for row in rows:
            self.live[row] = 0
            for u in graph.ends[row]:
                self.degree[u] -= 1
        for u in (*(u for row in rows for u in graph.ends[row]), graph.theta_of[chosen[0]]):
            if u > 0 and not self.removed[u] and not self.waiting[u]:
                self.waiting[u] = 1
                self.queue.append(u)

    def _independent(self, chosen: tuple[int, ...], rows: tuple[int, ...]) -> bool:
        """Whether the count of freedoms allows these edges (3 must remain for the part as a whole)."""
        graph, seen = self.graph, set(chosen)
        total = sum(FREEDOMS[graph.kind[u]] for u in chosen)
        for row in rows:
            for u in graph.ends[row]:
                if u not in seen:
                    seen.add(u)
                    direction_only = u == 0 and graph.absolute[row] != 1
                    total += 1 if direction_only else FREEDOMS[graph.kind[u]]
        return total - len(rows) >= 3

    def _partner(self, v: int) -> int:
        """The vertex that v may only be placed with: a direction's one offset, a centre's own radius;
        or -1."""
        graph = self.graph
        if graph.kind[v] == TURN and self.n_slides[v] == 1:
            for row in self.rows_of(v):
                for u in graph.ends[row]:
                    if graph.kind[u] == SLIDE and graph.theta_of[u] == v and not self.removed[u]:
                        return u
        if graph.kind[v] == POINT and self.degree[v] == 3:
            for row in self.rows_of(v):
                for u in graph.ends[row]:
                    if graph.kind[u] == SIZE and self.degree[u] <= 3:
                        if all(v in graph.ends[own] for own in self.rows_of(u)):
                            return u
        return -1
