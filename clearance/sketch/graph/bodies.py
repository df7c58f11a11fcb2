"""Rigid bodies: grown along rigid chains, or made of what is assumed to be rigid.

A body starts from two entities with three degrees of freedom and adds every vertex that hangs
on it by as many edges as it has freedom (Fig. 8 a and b of the paper).
Source: Kwon, Lee, Lee 2001, section 3.5.
"""

from __future__ import annotations

from clearance.sketch.graph.graph import IN_BODY, POINT, SLIDE, TURN, ConstraintGraph, PlanStep
from clearance.sketch.graph.rules import MergeOrder


class Bodies:
    """Rigid bodies, each entity in at most one.

    Attributes:
        body_of: by vertex: its body, -1 outside bodies.
        steps: by body: the steps that build it; those of its initial cluster have fewer edges than freedoms.
    """

    def __init__(self, graph: ConstraintGraph, live: bytearray, free: bytearray) -> None:
        """The bodies of at least three entities among the `free` vertices, grown along the live edges."""
        self.graph, self.live, self.free = graph, live, free
        self.body_of = [-1] * len(graph.kind)
        self.steps: list[list[PlanStep]] = []
        for row, ends in enumerate(graph.ends):
            seeds = self._seeds(ends) if live[row] and len(ends) > 1 else None
            if seeds:
                self._begin(row, seeds)

    def _seeds(self, ends: tuple[int, ...]) -> tuple[int, ...] | None:
        """The ends of an edge that can begin a body: a point and a point, or a point, an offset and its
        direction; None where they cannot."""
        kinds = sorted(self.graph.kind[v] for v in ends)
        if kinds not in ([POINT, POINT], [POINT, TURN, SLIDE]):
            return None
        if not all(v > 0 and self.free[v] and self.body_of[v] < 0 for v in ends):
            return None
        if len(ends) == 2:
            return ends[1], ends[0]
        by_kind = {self.graph.kind[v]: v for v in ends}
        return by_kind[POINT], by_kind[SLIDE], by_kind[TURN]

    def _begin(self, row: int, seeds: tuple[int, ...]) -> None:
        """Begins a body with the ends of an edge; drops it again if nothing hangs on it."""
        body = len(self.steps)
        for v in seeds:
            self.body_of[v] = body
        firsts = (seeds[1],) if len(seeds) == 2 else (seeds[2], seeds[1])
        first = [PlanStep(firsts, (), IN_BODY), PlanStep((seeds[0],), (row,), IN_BODY)]
        grown = self._grown(seeds, body)
        if grown:
            self.steps.append(first + grown)
        else:
            for v in seeds:
                self.body_of[v] = -1

    def _grown(self, seeds: tuple[int, ...], body: int) -> list[PlanStep]:
        """The steps that add the vertices that hang on the seeds, and on added ones."""
        graph, steps, waiting = self.graph, [], list(seeds)
        for u in waiting:
            for row in graph.rows[u]:
                for v in graph.ends[row] if self.live[row] else ():
                    open_to = v > 0 and self.free[v] and self.body_of[v] < 0
                    if open_to and graph.kind[v] != TURN:
                        step = self._adding(v, body)
                        if step is not None:
                            steps.append(step)
                            waiting += reversed(step.vertices)
        return steps

    def _adding(self, v: int, body: int) -> PlanStep | None:
        """The step that adds v to the body, if it hangs on it by as many edges as it has freedom; an offset
        may bring its direction."""
        line = -1
        if self.graph.kind[v] == SLIDE and self.body_of[self.graph.theta_of[v]] != body:
            line = self.graph.theta_of[v]
            if line == 0 or self.body_of[line] >= 0 or not self.free[line]:
                return None
        need = 2 if self.graph.kind[v] == POINT or line >= 0 else 1
        hooks = [
            row for row in self.graph.rows[v] if self.live[row] and self.hangs(row, (v, line), body)
        ]
        if len(hooks) < need:
            return None
        self.body_of[v] = body
        if line >= 0:
            self.body_of[line] = body
        return PlanStep((v,) if line < 0 else (line, v), tuple(hooks[:need]), IN_BODY)

    def hangs(self, row: int, without: tuple[int, ...], body: int) -> bool:
        """Whether all ends of the edge but some belong to the body."""
        return all(u in without or self.body_of[u] == body for u in self.graph.ends[row])

    def assume(self, order: MergeOrder) -> None:
        """Makes bodies of homes of at least three points, each hung on those before it by at most two edges.

        Missing conditions are assumed inside (Fig. 13 a and b): `order.lacking` becomes 0 there.
        """
        homes: dict[int, list[int]] = {}
        for v in sorted(range(1, len(order.turn)), key=order.turn.__getitem__):
            if order.home[v] >= 0:
                homes.setdefault(order.home[v], []).append(v)
        for h in sorted(homes):
            body = len(self.steps)
            steps: list[PlanStep] = []
            for v in homes[h]:
                hung = [r for r in self.graph.rows[v] if self.live[r] and self.hangs(r, (v,), body)]
                self.body_of[v] = body
                enough = len(steps) > 1 or len(hung) == len(steps)
                if self.graph.kind[v] == POINT and len(hung) <= 2 and enough:
                    steps.append(PlanStep((v,), tuple(hung), IN_BODY))
            if len(steps) == len(homes[h]) >= 3:
                self.steps.append(steps)
                for v in homes[h]:
                    order.lacking[v] = 0
            else:
                for v in homes[h]:
                    self.body_of[v] = -1
