"""The pebble game: which equations of the core depend on others by Definitions 1 to 3, and on
which.

Every vertex has as many pebbles as degrees of freedom; an equation is independent when four
pebbles can be gathered on its vertices, and then one of them pays for it. A dependent equation
closes a circuit: itself and the equations of the least tight set around it (three pebbles in all),
found by following payments.
Source: Jacobs and Hendrickson 1997; Lee and Streinu 2008 for hypergraphs and other counts.
"""

from __future__ import annotations

from clearance.sketch.graph.graph import FREEDOMS, ConstraintGraph

ENOUGH = 4
"""Pebbles that an independent edge can gather: one pays for it, three remain for the part as a whole."""


def play(graph: ConstraintGraph, live: bytearray) -> tuple[list[int], list[list[int]]]:
    """(the live edges that depend on others, the circuit of each with itself last).

    Edges at the ground come first: a dimension is the better suspect.
    """
    game = _PebbleGame(graph)
    dependent, circuits = [], []
    rows = [row for row in range(len(graph.ends)) if live[row]]
    for row in sorted(rows, key=lambda row: graph.absolute[row] != 1):
        game.put_in_play(row)
        if game.gathers(row):
            game.pay(row)
        else:
            dependent.append(row)
            circuits.append(game.circuit(row))
    return dependent, circuits


class _PebbleGame:
    """The remaining pebbles on every vertex, and the edges that every vertex pays for, the newest last.

    The last vertex is the known direction of the ground; the last edge ties it to the ground.
    """

    def __init__(self, graph: ConstraintGraph) -> None:
        n, m = len(graph.kind), len(graph.ends)
        self.graph, self.direction, self.tie = graph, n, m
        self.pebbles = [*(FREEDOMS[k] for k in graph.kind), 0]
        self.ends: dict[int, tuple[int, ...]] = {m: (0, n)}
        self.paid: list[dict[int, None]] = [{} for _ in range(n + 1)]
        self.paid[n][m] = None

    def put_in_play(self, row: int) -> None:
        """Adds the vertices of an edge; a vertex that only refers to directions hangs on the known direction."""
        ground = 0 if self.graph.absolute[row] == 1 else self.direction
        self.ends[row] = tuple(v or ground for v in self.graph.ends[row])

    def gathers(self, row: int) -> bool:
        """Whether enough pebbles can be gathered on the vertices of an edge; gathers them."""
        mine = self.ends[row]
        total = sum(self.pebbles[v] for v in mine)
        while total < ENOUGH and any(self._free(v, set(mine)) for v in mine):
            total += 1
        return total >= ENOUGH

    def pay(self, row: int) -> None:
        """Pays for an edge with a pebble of its first vertex that has one."""
        v = next(v for v in self.ends[row] if self.pebbles[v])
        self.pebbles[v] -= 1
        self.paid[v][row] = None

    def circuit(self, row: int) -> list[int]:
        """The edges of the least tight set around a dependent edge, itself last."""
        reached, out = dict.fromkeys(self.ends[row]), []
        waiting = list(reached)
        for u in waiting:
            for at in self.paid[u]:
                out.append(at)
                fresh = [w for w in self.ends[at] if w not in reached]
                reached.update(dict.fromkeys(fresh))
                waiting += fresh
        return [*(at for at in out if at != self.tie), row]

    def _free(self, v: int, seen: set[int]) -> bool:
        """Frees one pebble onto v by passing payments along, entering no vertex seen; whether one was found."""
        came: dict[int, tuple[int, int]] = {}
        waiting = [v]
        for u in waiting:
            for row in reversed(self.paid[u]):
                for w in self.ends[row]:
                    if w in seen:
                        continue
                    seen.add(w)
                    came[w] = (u, row)
                    if self.pebbles[w]:
                        self._pass(v, w, came)
                        return True
                    waiting.append(w)
        return False

    def _pass(self, v: int, w: int, came: dict[int, tuple[int, int]]) -> None:
        """Lets w pay for the edge it was reached by, that edge's payer for the one before, and so on to
        v."""
        self.pebbles[w] -= 1
        while w != v:
            u, row = came[w]
            del self.paid[u][row]
            self.paid[w][row] = None
            w = u
        self.pebbles[v] += 1
