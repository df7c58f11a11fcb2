"""Rules A and B: in which order the nodes of an under-constrained core are merged.

A node is a rigid body or a single vertex. Basic clusters (Fig. 8 b to d) are merged first; when there is
none, freedom remains and an under-constrained cluster (Fig. 13) is merged, as many conditions being
assumed as it lacks. Rule B takes it from the cycle of least freedom and, among those, of most vertices,
and starts a body there if the cycle has none; rule A takes any where there is no cycle. The wrong choice
would leave a rest that fits no basic cluster (Fig. 14).
Source: Kwon, Lee, Lee 2001, section 4.1; candidates for the least cycle: Horton 1987.
"""

from __future__ import annotations

from collections.abc import Sequence, Set
from typing import NamedTuple

RULED = 100
"""Nodes of a core up to which the rules are applied: the search for cycles grows with the cube."""


class MergeOrder(NamedTuple):
    """The order in which nodes (or the vertices in them) are added.

    Attributes:
        turn: by node, counted from 0; ties are those merged at once.
        lacking: by node: how many conditions are missing then.
        home: by node: a cluster that began without a body and took in single nodes until it met another
            cluster; -1 outside such.
    """

    turn: list[int]
    lacking: list[int]
    home: list[int]


def merge_order(rows: Sequence[Sequence[int]], dof: Sequence[int]) -> MergeOrder:
    """The order in which the nodes are added; see `MergeOrder`.

    Args:
        rows: the distinct nodes of every equation between nodes.
        dof: freedoms of the nodes: 3 of a body, 2 or 1 of a vertex.
    """
    return _Merging(rows, dof).order()


class _Merging:
    """Clusters of nodes while they are merged: the cluster of every node, and the freedoms of every cluster."""

    def __init__(self, rows: Sequence[Sequence[int]], dof: Sequence[int]) -> None:
        n = len(dof)
        self.rows, self.own, self.dof = rows, list(dof), list(dof)
        self.group = list(range(n))
        self.turn, self.lacking, self.home = [-1] * n, [0] * n, [-1] * n
        self.now, self.closed = 0, set[int]()

    def order(self) -> MergeOrder:
        """Merges until nothing is joined; the order in which that took the nodes in."""
        while True:
            self._read()
            chosen, missing = self._next()
            if not chosen:
                break
            self._merge(chosen, missing)
        self.turn = [self.now if t < 0 else t for t in self.turn]
        return MergeOrder(self.turn, self.lacking, self.home)

    def _read(self) -> None:
        """The clusters of every equation, the equations of every cluster, and how many join every two clusters."""
        self.labels = [tuple(dict.fromkeys(self.group[v] for v in row)) for row in self.rows]
        self.labels = [mine for mine in self.labels if len(mine) > 1]
        self.joined: dict[int, dict[int, int]] = {}
        self.at: dict[int, set[int]] = {}
        for k, mine in enumerate(self.labels):
            for g in mine:
                self.at.setdefault(g, set()).add(k)
            if len(mine) == 2:
                for a, b in (mine, mine[::-1]):
                    near = self.joined.setdefault(a, {})
                    near[b] = near.get(b, 0) + 1

    def _pairs(self):
        """Every two clusters that equations join, the first the lesser."""
        for a in sorted(self.joined):
            for b in sorted(self.joined[a]):
                if a < b:
                    yield a, b, self.joined[a][b]

    def _next(self) -> tuple[tuple[int, ...], int]:
        """The clusters to merge next (none where nothing is joined), and the conditions that they lack."""
        basic = self._basic()
        if basic:
            return basic, 0
        inside = self._cycle() or set(
            range(len(self.dof))
        )  # rule A: without cycles assumptions agree
        body = any(self.dof[g] == 3 for g in inside)
        pairs = [
            (self.dof[a] + self.dof[b] - n - 3, a, b)
            for a, b, n in self._pairs()
            if a in inside and b in inside and not (body and max(self.dof[a], self.dof[b]) < 3)
        ]
        if not pairs:
            return (), 0
        missing, a, b = min(pairs)
        return (a, b), max(missing, 0)

    def _basic(self) -> tuple[int, ...]:
        """Two or three clusters that the equations among them make rigid (Fig. 8 b, c, d), or none."""
        dof, pairs = self.dof, list(self._pairs())
        for a, b, n in pairs:
            if max(dof[a], dof[b]) == 3 and dof[a] + dof[b] - n <= 3:
                return a, b
        for a, b, n in pairs:
            for c in sorted(self.joined[a].keys() & self.joined[b].keys()):
                among = n + self.joined[a][c] + self.joined[b][c]
                bodies = (dof[a], dof[b], dof[c]).count(3)
                if c > b and bodies >= 2 and dof[a] + dof[b] + dof[c] - among <= 3:
                    return a, b, c
        return ()

    def _cycle(self) -> Set[int]:
        """Rule B: the cycle of least freedom and most vertices; none where there is no cycle.

        Two clusters joined by two equations are a cycle, too.
        """
        best, least, most = set[int](), 1 << 30, 0
        for root in range(len(self.dof)):
            came, depth = self._tree(root)
            for u, v, n in self._pairs():
                double = came.get(v) == u or came.get(u) == v
                if u not in depth or (double and (n < 2 or root not in (u, v))):
                    continue
                inside = set(_up(came, u)) | set(_up(came, v))
                if not double and len(inside) != depth[u] + depth[v] + 1:
                    continue
                freedom = self._freedom(inside)
                if freedom < least or (freedom == least and len(inside) > most):
                    best, least, most = inside, freedom, len(inside)
        return best

    def _tree(self, root: int) -> tuple[dict[int, int], dict[int, int]]:
        """Breadth first from a cluster: where each one was reached from, and in how many steps."""
        came, depth, waiting = {root: -1}, {root: 0}, [root]
        for u in waiting:
            for v in sorted(self.joined.get(u, ())):
                if v not in depth:
                    came[v], depth[v] = u, depth[u] + 1
                    waiting.append(v)
        return came, depth

    def _freedom(self, inside: Set[int]) -> int:
        """The remaining freedom of a set of clusters: their own less the equations among them."""
        near = set[int]().union(*(self.at.get(g, ()) for g in inside))
        within = sum(inside >= set(self.labels[k]) for k in near)
        return sum(self.dof[g] for g in inside) - within

    def _merge(self, chosen: tuple[int, ...], missing: int) -> None:
        """Makes clusters one: the first; notes their nodes' turns, what is missing and their home."""
        a, b = chosen[:2]
        nodes = [v for v, g in enumerate(self.group) if g in chosen]
        self._give_turns(nodes, missing)
        bodies = sum(self.dof[g] == 3 for g in chosen)
        if bodies > 1 or self.closed & {a, b} or 3 in (self.own[a], self.own[b]):
            self.closed.add(a)
        else:
            for v in nodes:
                self.home[v] = a
        for v in nodes:
            self.group[v] = a
        for g in chosen:
            self.dof[g] = 3 if g == a else 0

    def _give_turns(self, nodes: list[int], missing: int) -> None:
        """Gives nodes their turns, where a body starts it goes first; what is missing is noted at the first of
        those that come in."""
        if all(self.turn[v] < 0 for v in nodes):
            leader = next((v for v in nodes if self.own[v] == 3), nodes[0])
            self.turn[leader] = self.now
            self.now += 1
        for v in nodes:
            if self.turn[v] < 0:
                self.turn[v], self.lacking[v], missing = self.now, missing, 0
        self.now += 1


def _up(came: dict[int, int], v: int) -> list[int]:
    """A cluster and those on the path to the root."""
    out = []
    while v >= 0:
        out.append(v)
        v = came[v]
    return out
