"""The least sets of nodes that are solvable at once, in the order of placing.

A node is a rigid body of three freedoms or a vertex, and one of them is fixed. A matching of edges to freedoms and
the strongly connected parts of the directed graph give the smallest clusters (Fig. 8 c and d of the paper, and
extended ones). Not for: finding the bodies (`sketch.graph.bodies`).
Source: Kwon, Lee, Lee 2001, section 3.5; Hoffmann, Lomonosov, Sitharam 1997 for minimal dense subgraphs.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping


def match(nodes_of: Mapping[int, list[int]], capacity: Iterable[int]) -> dict[int, int]:
    """The node of every edge, each in turn given the first of its nodes with freedom; edges that find none
    are missing.

    Args:
        nodes_of: by edge, in the order in which they choose: the nodes that may own it.
        capacity: the freedoms of every node.
    """
    remaining = list(capacity)
    owner: dict[int, int] = {}
    paid: list[dict[int, None]] = [
        {} for _ in remaining
    ]  # the edges of every node, the newest last
    for edge in nodes_of:
        came, seen, waiting = {edge: -1}, set[int](), [edge]
        free = _free_node(nodes_of, remaining, paid, came, seen, waiting)
        if free is None:
            continue
        at, node = free
        remaining[node] -= 1
        while at >= 0:  # the node that it leaves goes to the edge before it, and so on to the first
            before = owner.get(at, -1)
            if before >= 0:
                del paid[before][at]
            owner[at], paid[node][at] = node, None
            at, node = came[at], before
    return owner


def _free_node(nodes_of, remaining, paid, came, seen, waiting) -> tuple[int, int] | None:
    """(an edge, a node with freedom for it) that the first edge reaches by moving others; fills `came`."""
    for edge in waiting:
        for node in nodes_of[edge]:
            if node in seen:
                continue
            seen.add(node)
            if remaining[node] > 0:
                return edge, node
            for other in reversed(paid[node]):
                came[other] = edge
                waiting.append(other)
    return None


def strong_parts(nodes: Iterable[int], near: Mapping[int, list[int]]) -> list[list[int]]:
    """The strongly connected parts of a directed graph, each after those that it leads to.

    Source: Tarjan 1972, without recursion.
    """
    index: dict[int, int] = {}
    low: dict[int, int] = {}
    stack, done, parts = [], set[int](), []
    for first in nodes:
        calls = [] if first in index else [first]
        where: list[Iterable[int]] = []
        while calls:
            u = calls[-1]
            if len(where) < len(calls):
                index[u] = low[u] = len(index)
                stack.append(u)
                where.append(iter(near.get(u, ())))
            fresh = _next_fresh(u, where[-1], index, low, done)
            if fresh is not None:
                calls.append(fresh)
                continue
            calls.pop(), where.pop()
            if calls:
                low[calls[-1]] = min(low[calls[-1]], low[u])
            if low[u] == index[u]:
                at = next(k for k in reversed(range(len(stack))) if stack[k] == u)
                parts.append(stack[at:])
                done.update(stack[at:])
                del stack[at:]
    return parts


def _next_fresh(u, following, index, low, done) -> int | None:
    """The next node after u that was not seen; notes the least index of those on the stack."""
    for w in following:
        if w not in index:
            return w
        if w not in done:
            low[u] = min(low[u], index[w])
    return None
