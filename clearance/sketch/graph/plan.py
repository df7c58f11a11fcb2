"""The construction plan: which vertices are placed from which equations, in which order.

Peeled vertices come last; before them the core: rigid bodies in their own frame, then the clusters in the order
of placing. A part is what equations connect; a node is a rigid body or a single vertex. A matching of edges to
freedoms and the strongly connected parts of the directed graph give the smallest clusters (Fig. 8 c and d of the
paper, and extended ones).
Source: Kwon, Lee, Lee 2001, section 3.5; Hoffmann, Lomonosov, Sitharam 1997 for minimal dense subgraphs.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from graphlib import TopologicalSorter

import numpy as np
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from clearance.sketch.graph.bodies import Bodies
from clearance.sketch.graph.graph import (
    FREEDOMS,
    IN_BODY,
    IN_CORE,
    POINT,
    SLIDE,
    TURN,
    Components,
    ConstraintGraph,
    ConstructionPlan,
    PlanStep,
    components,
)
from clearance.sketch.graph.pebble import match, play
from clearance.sketch.graph.peel import peel
from clearance.sketch.graph.rules import RULED, MergeOrder, merge_order


def make_plan(graph: ConstraintGraph, last: frozenset[int] = frozenset()) -> ConstructionPlan:
    """The plan of a constraint graph; see `ConstructionPlan`.

    Dependent edges are omitted, those of `last` before others; vertices that hung on them are peeled as well.
    """
    n = len(graph.kind)
    live, removed = bytearray(map(bool, graph.ends)), bytearray(n)
    outer = peel(graph, live, removed)
    before: list[PlanStep] = []
    dependent: list[int] = []
    circuits: list[list[int]] = []
    if any(live):
        dependent, circuits = play(graph, live, last)
        for row in dependent:
            live[row] = 0
        before = peel(graph, live, removed) if dependent else []
    core: list[PlanStep] = []
    body_of, fixed = [-1] * n, np.zeros(0, bool)
    if any(live):
        core, body_of, fixed = _Core(graph, live, removed).planned()
    steps = (*core, *reversed(before), *reversed(outer))
    return ConstructionPlan(
        steps, np.array(body_of), fixed, np.array(dependent, np.int64), circuits
    )


class _Core:
    """A graph after peeling: its live edges, its free vertices, its parts and bodies."""

    def __init__(self, graph: ConstraintGraph, live: bytearray, removed: bytearray) -> None:
        self.graph, self.live = graph, live
        self.free = bytearray(not r for r in removed)
        self.free[0] = 0
        self.rows = [row for row in range(len(graph.ends)) if live[row]]
        self.vertices = [v for v in range(1, len(graph.kind)) if self.free[v]]
        self.bodies = Bodies(graph, live, self.free)
        self.body_of = self.bodies.body_of
        self.parts = self._components()

    def planned(self) -> tuple[list[PlanStep], list[int], np.ndarray]:
        """(steps, body of every vertex, marks of the fixed bodies) of the core."""
        order = self._turns_by_rule()
        self.bodies.assume(order)
        steps = [step for body in self.bodies.steps for step in body]
        fixed, begun = self._initial_clusters(order.turn)
        steps += [PlanStep((self.graph.ends[row][0],), (row,), IN_BODY) for row in begun]
        return steps + self._clusters(fixed, order), self.body_of, np.array(fixed, bool)

    def _components(self) -> Components:
        ends = np.full((len(self.graph.ends), 5), -1)
        for row in self.rows:
            mine = self.graph.ends[row]
            ends[row, : len(mine)] = mine
        kind, theta_of = np.array(self.graph.kind), np.array(self.graph.theta_of)
        return components(kind, ends, theta_of, np.array(self.graph.absolute))

    def _turns_by_rule(self) -> MergeOrder:
        """The order (by vertex) in which rules A and B add the vertices of a core with remaining freedom.

        The conditions that a node lacks are noted at its first vertex. Turns and conditions are 0 and
        homes -1 where no freedom remains or the core is too large for the rules.
        """
        n = len(self.graph.kind)
        out = MergeOrder([0] * n, [0] * n, [-1] * n)
        node, dof = self._nodes()
        rows = [mine for row in self.rows if (mine := self._nodes_of(row, node, len(dof)))]
        parts = {int(self.parts.part[v]) for v in self.vertices}
        spare = sum(dof) - sum((3, 2, 0)[self.parts.fixing[p]] for p in parts)
        if len(dof) <= RULED and spare > len(rows):
            order = merge_order(rows, [*dof, 3])
            for v, at in node.items():
                out.turn[v], out.lacking[v], out.home[v] = (
                    order.turn[at],
                    order.lacking[at],
                    order.home[at],
                )
                order.lacking[at] = 0
        return out

    def _nodes(self) -> tuple[dict[int, int], list[int]]:
        """(the node of every vertex, the freedoms of the nodes): bodies first, then single vertices."""
        node, dof = {}, [3] * len(self.bodies.steps)
        for v in self.vertices:
            node[v] = self.body_of[v]
            if node[v] < 0:
                node[v] = len(dof)
                dof.append(FREEDOMS[self.graph.kind[v]])
        return node, dof

    def _nodes_of(self, row: int, node: dict[int, int], ground: int) -> list[int]:
        """The nodes of an edge between several, a known direction being none; empty for an edge within one."""
        ends = self.graph.ends[row]
        directed = 0 in ends and self.graph.absolute[row] != 1
        mine = [node[v] if v else ground for v in ends if v or not directed]
        return mine if directed or len(set(mine)) > 1 else []

    def _initial_clusters(self, turn: list[int]) -> tuple[list[bool], list[int]]:
        """(marks of the fixed bodies, edges whose two ends become a fixed body).

        A part begins with the ground, a body, or an edge's two ends; a part fixed by directions only fixes its
        first point.
        """
        fixed = [False] * len(self.bodies.steps)
        largest, begun = self._largest_bodies(turn), []
        for b in largest.values():
            fixed[b] = True
        for p, row in sorted(self._seeds(turn, largest).items()):
            v, u = self.graph.ends[row][:2]
            if self.body_of[v] >= 0 or self.body_of[u] >= 0:
                continue
            whole = self.parts.fixing[p] == 0
            for w in self.graph.ends[row] if whole else (v,):
                self.body_of[w] = len(fixed)
            begun += [row] if whole else []
            fixed.append(True)
        return fixed, begun

    def _largest_bodies(self, turn: list[int]) -> dict[int, int]:
        """The body that begins every part that is not fixed: the first by turn, then the largest."""
        early: dict[int, int] = {}
        weight = [0] * len(self.bodies.steps)
        for v in self.vertices:
            p = int(self.parts.part[v])
            early[p] = min(early.get(p, turn[v]), turn[v])
            if self.body_of[v] >= 0:
                weight[self.body_of[v]] += 1
        best: dict[int, int] = {}
        for v in self.vertices:
            b, p = self.body_of[v], int(self.parts.part[v])
            if b >= 0 and self.parts.fixing[p] == 0 and turn[v] == early[p]:
                if p not in best or weight[b] > weight[best[p]]:
                    best[p] = b
        return best

    def _seeds(self, turn: list[int], largest: dict[int, int]) -> dict[int, int]:
        """The edge whose ends begin every part that has no body to begin with: the first by turn."""
        kind, seed = self.graph.kind, dict[int, int]()
        least: dict[int, int] = {}
        for row in self.rows:
            ends = self.graph.ends[row]
            if len(ends) < 2 or 0 in ends[:2] or kind[ends[0]] != POINT:
                continue
            v, u = ends[:2]
            p = int(self.parts.part[v])
            if not self.free[v] or self.parts.fixing[p] == 2 or p in largest:
                continue
            line = len(ends) == 3 and kind[u] == TURN and kind[ends[2]] == SLIDE
            if self.parts.fixing[p] == 1 or [kind[w] for w in ends] == [POINT, POINT] or line:
                late = max(turn[v], turn[u])
                if late < least.get(p, 1 << 30):
                    seed[p], least[p] = row, late
        return seed

    def _clusters(self, fixed: list[bool], order: MergeOrder) -> list[PlanStep]:
        """The clusters of a core: the strongly connected parts of its nodes, in the order of placing."""
        node_of, capacity = self._contracted(fixed)
        between = [row for row in self.rows if not self._within(row, node_of)]
        owner = self._matched(between, node_of, capacity, order)
        members: dict[int, list[int]] = {}
        for v in sorted(node_of, key=lambda v: self.body_of[v]):
            members.setdefault(node_of[v], []).append(v)
        near: dict[int, list[int]] = {}
        rows: dict[int, list[int]] = {}
        for row in between:
            if row in owner:
                mine = owner[row]
                rows.setdefault(mine, []).append(row)
                others = (node_of[v] for v in self.graph.ends[row] if v in node_of)
                near.setdefault(mine, []).extend(w for w in others if w != mine)
        out = []
        for part in strong_parts(sorted(members), near):
            placed = sorted(
                (v for node in part for v in members[node]), key=lambda v: (self.body_of[v], v)
            )
            used = sorted(row for node in part for row in rows.get(node, ()))
            out.append(self._step(tuple(placed), tuple(used)))
        return out

    def _contracted(self, fixed: list[bool]) -> tuple[dict[int, int], list[int]]:
        """(the contracted node of every vertex that is not fixed, the freedoms of every node)."""
        node_of, capacity = {}, [0 if h else 3 for h in fixed]
        for v in self.vertices:
            b = self.body_of[v]
            if b < 0:
                node_of[v] = len(capacity)
                capacity.append(FREEDOMS[self.graph.kind[v]])
            elif not fixed[b]:
                node_of[v] = b
        return node_of, capacity

    def _within(self, row: int, node_of: dict[int, int]) -> bool:
        """Whether an edge lies inside one body or inside the fixed ones."""
        ends = self.graph.ends[row]
        if any(v in node_of and self.body_of[v] < 0 for v in ends):
            return False
        return len({node_of.get(v, -1) for v in ends}) <= 1

    def _matched(
        self, between: list[int], node_of: dict[int, int], capacity: list[int], order: MergeOrder
    ) -> dict[int, int]:
        """The node of every edge: those of rules A and B keep the freedom that they assume, if that works out."""
        turn = order.turn
        later = {row: sorted(self.graph.ends[row], key=lambda v: -turn[v]) for row in between}
        chosen = sorted(between, key=lambda row: turn[later[row][0]])
        nodes_of = {row: [node_of[v] for v in later[row] if v in node_of] for row in chosen}
        if any(order.lacking):
            remaining = list(capacity)
            for v, node in node_of.items():
                remaining[node] = max(remaining[node] - order.lacking[v], 0)
            owner = match(nodes_of, remaining)
            if len(owner) == len(nodes_of):
                return owner
        return match(nodes_of, capacity)

    def _step(self, placed: tuple[int, ...], rows: tuple[int, ...]) -> PlanStep:
        """A closed step for one vertex or one line, a numeric one for all else."""
        kind, v = self.graph.kind, placed[0]
        single = self.body_of[v] < 0
        line = len(placed) == 2 and kind[v] == TURN and kind[placed[1]] == SLIDE
        line = line and self.graph.theta_of[placed[1]] == v
        return PlanStep(placed, rows, IN_CORE, numeric=not (single and (len(placed) == 1 or line)))


def strong_parts(nodes: Sequence[int], near: Mapping[int, list[int]]) -> list[list[int]]:
    """The strongly connected parts of a directed graph, each after those that it leads to."""
    at = {node: k for k, node in enumerate(nodes)}
    pairs = [(at[u], at[w]) for u in nodes for w in near.get(u, ())]
    i, j = np.array(pairs, np.int64).reshape(-1, 2).T
    links = coo_array((np.ones(i.size), (i, j)), (len(nodes), len(nodes)))
    labels = connected_components(links, connection="strong")[1].tolist()
    parts: dict[int, list[int]] = {}
    for node, label in zip(nodes, labels, strict=True):
        parts.setdefault(label, []).append(node)
    order = TopologicalSorter(dict.fromkeys(parts, ()))
    for u, w in pairs:
        if labels[u] != labels[w]:
            order.add(labels[u], labels[w])
    return [parts[label] for label in order.static_order()]
