"""The pebble game: which equations of the core depend on others by Definitions 1 to 3, and on which.

Every vertex has as many pebbles as degrees of freedom; an equation is independent when four
pebbles can be gathered on its vertices, and then one of them pays for it. A dependent equation
closes a circuit: itself and the equations of the least tight set around it (three pebbles in all),
found by following payments. The same payments match equations to the freedoms that they take.
Source: Jacobs and Hendrickson 1997; Lee and Streinu 2008 for hypergraphs and other counts.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping

from clearance.sketch.graph.graph import FREEDOMS, ConstraintGraph

ENOUGH = 4
"""Pebbles that an independent edge can gather: one pays for it, three remain for the part as a whole."""


class Payments:
    """The pebbles left on every vertex, and the edges that every vertex pays for, the newest last.

    Args:
        pebbles: by vertex.
        ends: the vertices of every edge in play.
    """

    def __init__(self, pebbles: Iterable[int], ends: Mapping[int, Iterable[int]]) -> None:
        self.pebbles, self.ends = list(pebbles), ends
        self.paid: list[dict[int, None]] = [{} for _ in self.pebbles]

    def pay(self, row: int) -> None:
        """Pays for an edge with a pebble of its first vertex that has one."""
        v = next(v for v in self.ends[row] if self.pebbles[v])
        self.pebbles[v] -= 1
        self.paid[v][row] = None

    def free(self, starts: Iterable[int], seen: set[int]) -> bool:
        """Frees one pebble onto a start by passing payments along, through no vertex seen; False for none."""
        came: dict[int, tuple[int, int]] = {}
        waiting = list(starts)
        for u in waiting:
            for row in reversed(self.paid[u]):
                for w in self.ends[row]:
                    if w in seen:
                        continue
                    seen.add(w)
                    came[w] = (u, row)
                    if self.pebbles[w]:
                        self._pass(w, came)
                        return True
                    waiting.append(w)
        return False

    def _pass(self, w: int, came: dict[int, tuple[int, int]]) -> None:
        """Lets w pay for the edge it was reached by, its payer for the one before, and so on to the start."""
        self.pebbles[w] -= 1
        while w in came:
            u, row = came[w]
            del self.paid[u][row]
            self.paid[w][row] = None
            w = u
        self.pebbles[w] += 1


def match(nodes_of: Mapping[int, list[int]], capacity: Iterable[int]) -> dict[int, int]:
    """The node of every edge, each in turn given the first of its nodes with freedom left; edges that find none
    are missing.

    Args:
        nodes_of: by edge, in the order in which they choose: the nodes that may own it.
        capacity: the freedoms of every node.
    """
    game = Payments(capacity, nodes_of)
    for edge, nodes in nodes_of.items():
        if any(game.pebbles[v] for v in nodes) or game.free(nodes, set(nodes)):
            game.pay(edge)
    return {edge: node for node, mine in enumerate(game.paid) for edge in mine}


def play(
    graph: ConstraintGraph, live: bytearray, last: frozenset[int] = frozenset()
) -> tuple[list[int], list[list[int]]]:
    """(the live edges that depend on others, the circuit of each with itself last).

    Edges that are held by the ground come first: a dimension is the better suspect. Those of `last` come last.
    Edges that only refer to directions hang on the known direction, a vertex of its own that an edge ties to the
    ground.
    """
    n, tie = len(graph.kind), len(graph.ends)
    ends: dict[int, tuple[int, ...]] = {tie: (0, n)}
    game = Payments([*(FREEDOMS[k] for k in graph.kind), 0], ends)
    game.paid[n][tie] = None
    dependent, circuits = [], []
    rows = [row for row in range(tie) if live[row]]
    for row in sorted(rows, key=lambda row: (row in last, graph.absolute[row] != 1)):
        ground = 0 if graph.absolute[row] == 1 else n
        ends[row] = mine = tuple(v or ground for v in graph.ends[row])
        total = sum(game.pebbles[v] for v in mine)
        while total < ENOUGH and any(game.free([v], set(mine)) for v in mine):
            total += 1
        if total >= ENOUGH:
            game.pay(row)
        else:
            dependent.append(row)
            circuits.append([at for at in _circuit(game, row) if at != tie])
    return dependent, circuits


def _circuit(game: Payments, row: int) -> list[int]:
    """The edges of the least tight set around a dependent edge, itself last."""
    reached, out = dict.fromkeys(game.ends[row]), []
    waiting = list(reached)
    for u in waiting:
        for at in game.paid[u]:
            out.append(at)
            fresh = [w for w in game.ends[at] if w not in reached]
            reached.update(dict.fromkeys(fresh))
            waiting += fresh
    return [*out, row]
