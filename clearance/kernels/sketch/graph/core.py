"""The core's parts and nodes: what is held first, what is joined, which equations place what.

A part is what equations connect; a node is a rigid body or a single vertex. Not for: finding the bodies
(`sketch.graph.bodies`), nor the order of the rules (`sketch.graph.rules`).
"""

from typing import NamedTuple

import numpy as np

from clearance.compile.jit import inline, kernel
from clearance.kernels.arithmetic.union_find import find_root, join, labels_of
from clearance.kernels.sketch.graph.graph import POINT, SLIDE, TURN
from clearance.kernels.sketch.graph.matching import match, ordered_parts
from clearance.kernels.sketch.graph.rules import RULED, MergeOrder, merge_order


class Components(NamedTuple):
    """The connected parts of a graph, and how each hangs on the ground.

    Attributes:
        part: (v,) the part of every vertex; the ground's is -1.
        count: how many parts there are.
        hold: (parts,) 0 not at all, 1 by directions only, 2 by position.
    """

    part: np.ndarray
    count: int
    hold: np.ndarray


@inline
def _joined(kind, ends, theta_of):
    """The union-find forest (v,) of what edges, and offsets with their directions, connect."""
    n = kind.shape[0]
    group = np.arange(n)
    for row in range(ends.shape[0]):
        first = -1
        for k in range(5):
            v = ends[row, k]
            if v > 0:
                first = find_root(group, v) if first < 0 else join(group, v, first)
    for v in range(1, n):
        if kind[v] == SLIDE and theta_of[v] > 0:
            join(group, v, theta_of[v])
    return group


@kernel
def components(kind, ends, theta_of, absolute):
    """The connected parts of a graph; see `Components`."""
    n = kind.shape[0]
    group = _joined(kind, ends, theta_of)
    part, count = labels_of(group, 1)
    hold = np.zeros(count, np.int64)
    for row in range(ends.shape[0]):
        grounded = False
        for k in range(5):
            grounded = grounded or ends[row, k] == 0
        if grounded:
            for k in range(5):
                if ends[row, k] > 0:
                    p = part[ends[row, k]]
                    hold[p] = max(hold[p], 2 if absolute[row] == 1 else 1)
    for v in range(1, n):
        if kind[v] == SLIDE and theta_of[v] == 0:
            hold[part[v]] = max(hold[part[v]], 1)
    return Components(part, count, hold)


class CoreNodes(NamedTuple):
    """The nodes of a core as the rules see them: bodies first, then single vertices, then the ground.

    Attributes:
        node: (v,) the node of every vertex, -1 outside the core.
        dof: (nodes + 1,) freedoms of the nodes, the ground's last.
        spare: freedoms of all nodes less those that place the parts as a whole.
    """

    node: np.ndarray
    dof: np.ndarray
    spare: int


@inline
def _nodes_for_rules(graph, free, components, bodies):
    """The nodes of a core; see `CoreNodes`."""
    n, n_bodies = graph.kind.shape[0], bodies.start.shape[0] - 1
    node = np.full(n, -1, np.int64)
    dof = np.full(n_bodies + n + 1, 3, np.int64)
    present, seen = n_bodies, np.zeros(components.count, np.uint8)
    spare = 0
    for v in range(1, n):
        if not free[v]:
            continue
        part = components.part[v]
        if not seen[part]:
            seen[part] = 1
            spare -= 0 if components.hold[part] == 2 else 3 - components.hold[part]
        if bodies.body_of[v] >= 0:
            node[v] = bodies.body_of[v]
            continue
        node[v] = present
        dof[present] = 2 if graph.kind[v] == POINT else 1
        present += 1
    for k in range(present):
        spare += dof[k]
    return CoreNodes(node, dof[: present + 1], spare)


@inline
def _rows_for_rules(graph, live, nodes):
    """The nodes (m, 5) of every live edge between several nodes, -1 pads."""
    m, ground = graph.ends.shape[0], nodes.dof.shape[0] - 1
    rows, count = np.full((m, 5), -1, np.int64), 0
    for row in range(m):
        if not live[row]:
            continue
        several = False
        for k in range(5):
            v = graph.ends[row, k]
            if v > 0 or (v == 0 and graph.absolute[row] == 1):
                rows[count, k] = nodes.node[v] if v > 0 else ground
                several = several or rows[count, k] != rows[count, 0]
        if several:
            count += 1
        else:
            rows[count, :] = -1
    return rows[:count]


@inline
def turns_by_rule(graph, live, free, components, bodies):
    """The order (by vertex) in which rules A and B take in the vertices of a core with freedom left.

    What a node lacks is noted at its first vertex. Turns and conditions are 0 and homes -1 where no freedom
    is left or the core is too large for the rules.
    """
    n = graph.kind.shape[0]
    turn, lacking, home = np.zeros(n, np.int64), np.zeros(n, np.int64), np.full(n, -1, np.int64)
    nodes = _nodes_for_rules(graph, free, components, bodies)
    rows = _rows_for_rules(graph, live, nodes)
    if nodes.dof.shape[0] - 1 <= RULED and nodes.spare > rows.shape[0]:
        order = merge_order(rows, nodes.dof)
        for v in range(1, n):
            at = nodes.node[v]
            if at >= 0:
                turn[v] = order.turn[at]
                lacking[v] = order.lacking[at]
                order.lacking[at] = 0
                home[v] = order.home[at]
    return MergeOrder(turn, lacking, home)


@inline
def _by_turn(ends, turn):
    """The order of the edges by their last vertex' turn, and the edges with their last vertex first."""
    m = ends.shape[0]
    late, later = np.zeros(m, np.int64), ends.copy()
    for row in range(m):
        for k in range(1, 5):
            at = k
            while (
                at > 0 and later[row, at] >= 0 and turn[later[row, at]] > turn[later[row, at - 1]]
            ):
                v = later[row, at]
                later[row, at] = later[row, at - 1]
                later[row, at - 1] = v
                at -= 1
        late[row] = turn[later[row, 0]] if later[row, 0] >= 0 else 0
    return np.argsort(late, kind="mergesort"), later


@inline
def matched_by_turn(ends, between, hold, capacity, turn, lack):
    """The node of every edge: those of rules A and B keep the freedom that they assume, if that works out."""
    order, later = _by_turn(ends, turn)
    if lack.any():
        left = capacity.copy()
        for v in range(hold.shape[0]):
            if hold[v] >= 0:
                left[hold[v]] = max(left[hold[v]] - lack[v], 0)
        owner = match(order, later, between, hold, left)
        if not (between.astype(np.bool_) & (owner < 0)).any():
            return owner
    return match(order, later, between, hold, capacity)


class InitialClusters(NamedTuple):
    """What is held first of every part, and the bodies that are made for it.

    Attributes:
        held: (bodies,) marks the bodies that are held, those made here last.
        seed: (bodies,) the edge whose ends a body made here begins with, -1 for the others.
    """

    held: np.ndarray
    seed: np.ndarray


@inline
def _largest_bodies(graph, free, components, bodies, turn):
    """The body (parts,) that begins every part: the first by turn, then the largest; -1 for none."""
    n, n_parts, n_bodies = graph.kind.shape[0], components.count, bodies.start.shape[0] - 1
    weight = np.zeros(n_bodies + 1, np.int64)
    early = np.full(n_parts, 1 << 30, np.int64)
    for v in range(1, n):
        if free[v]:
            p = components.part[v]
            early[p] = min(early[p], turn[v])
            if bodies.body_of[v] >= 0:
                weight[bodies.body_of[v]] += 1
    best = np.full(n_parts, -1, np.int64)
    for v in range(1, n):
        b, p = bodies.body_of[v], components.part[v]
        if b >= 0 and components.hold[p] == 0 and turn[v] == early[p]:
            if best[p] < 0 or weight[b] > weight[best[p]]:
                best[p] = b
    return best


@inline
def _seeds(graph, live, free, components, best, turn):
    """The edge (parts,) whose ends begin every part that has no body to begin with: the first by turn."""
    kind, ends, hold = graph.kind, graph.ends, components.hold
    n_parts = best.shape[0]
    seed, least = np.full(n_parts, -1, np.int64), np.full(n_parts, 1 << 30, np.int64)
    for row in range(ends.shape[0]):
        v, u = ends[row, 0], ends[row, 1]
        if not live[row] or v <= 0 or u <= 0 or kind[v] != POINT or not free[v]:
            continue
        p = components.part[v]
        if hold[p] == 2 or best[p] >= 0:
            continue
        line = kind[u] == TURN and ends[row, 3] < 0 and kind[ends[row, 2]] == SLIDE
        if hold[p] == 1 or (kind[u] == POINT and ends[row, 2] < 0) or line:
            late = max(turn[v], turn[u])
            if late < least[p]:
                seed[p], least[p] = row, late
    return seed


@inline
def initial_clusters(graph, live, free, components, bodies, turn):
    """Chooses the initial cluster of every part of the core: ground, body, or an edge's two ends.

    An edge's ends become a new body in `bodies.body_of`; a part held by directions only holds its first
    point.
    """
    n_parts, n_bodies, body_of = components.count, bodies.start.shape[0] - 1, bodies.body_of
    held = np.zeros(n_bodies + n_parts + 1, np.uint8)
    made = np.full(n_bodies + n_parts + 1, -1, np.int64)
    best = _largest_bodies(graph, free, components, bodies, turn)
    for p in range(n_parts):
        if best[p] >= 0:
            held[best[p]] = 1
    seed = _seeds(graph, live, free, components, best, turn)
    for p in range(n_parts):
        row = seed[p]
        if row < 0 or body_of[graph.ends[row, 0]] >= 0 or body_of[graph.ends[row, 1]] >= 0:
            continue
        v, u = graph.ends[row, 0], graph.ends[row, 1]
        body_of[v] = n_bodies
        if components.hold[p] == 0:
            body_of[u] = n_bodies
            if graph.kind[u] == TURN:
                body_of[graph.ends[row, 2]] = n_bodies
            made[n_bodies] = row
        held[n_bodies] = 1
        n_bodies += 1
    return InitialClusters(held[:n_bodies], made[:n_bodies])


@inline
def nodes_of_core(kind, free, body_of, held):
    """Contracted nodes: (hold (v,), capacity (nodes,)); bodies first, then single vertices."""
    n_bodies = held.shape[0]
    n = kind.shape[0]
    hold = np.full(n, -1, np.int64)
    capacity = np.zeros(n_bodies + n, np.int64)
    for b in range(n_bodies):
        capacity[b] = 0 if held[b] else 3
    count = n_bodies
    for v in range(1, n):
        if not free[v]:
            continue
        b = body_of[v]
        if b >= 0:
            hold[v] = -1 if held[b] else b
        else:
            hold[v] = count
            capacity[count] = 2 if kind[v] == POINT else 1
            count += 1
    return hold, capacity[:count]


@inline
def edges_between(ends, live, hold, body_of):
    """The live edges that are not inside one body or inside what is held."""
    out = np.zeros(ends.shape[0], np.uint8)
    for row in range(ends.shape[0]):
        if not live[row]:
            continue
        common, first = True, -2
        for k in range(5):
            v = ends[row, k]
            if v < 0:
                continue
            h = hold[v]
            if h >= 0 and body_of[v] < 0:
                common = False
            if first == -2:
                first = h
            elif h != first:
                common = False
        out[row] = not common
    return out


class Clusters(NamedTuple):
    """The clusters of a core in the order of placing.

    Attributes:
        count: how many there are.
        vertex_start, vertex: the vertices of every cluster, bodies' members together.
        row_start, row: the edges that place every cluster.
    """

    count: int
    vertex_start: np.ndarray
    vertex: np.ndarray
    row_start: np.ndarray
    row: np.ndarray


@inline
def clusters_of(graph, live, free, body_of, held, order):
    """The clusters of a core: the strongly connected parts of its nodes; see `Clusters`."""
    hold, capacity = nodes_of_core(graph.kind, free, body_of, held)
    between = edges_between(graph.ends, live, hold, body_of)
    owner = matched_by_turn(graph.ends, between, hold, capacity, order.turn, order.lacking)
    present = np.zeros(capacity.shape[0], np.uint8)
    for v in range(hold.shape[0]):
        if hold[v] >= 0:
            present[hold[v]] = 1
    node_part, count = ordered_parts(graph.ends, between, hold, owner, capacity.shape[0], present)
    vertex_start, vertex = _vertices_by_part(hold, node_part, body_of, count)
    row_start, row = _rows_by_part(owner, between, node_part, count)
    return Clusters(count, vertex_start, vertex, row_start, row)


@inline
def _vertices_by_part(hold, node_part, body_of, n_clusters):
    """The vertices of every cluster, bodies' members together, as (starts, vertices)."""
    start = np.zeros(n_clusters + 1, np.int64)
    for v in range(hold.shape[0]):
        if hold[v] >= 0:
            start[node_part[hold[v]] + 1] += 1
    start = np.cumsum(start)
    out = np.empty(start[-1], np.int64)
    fill = start[:-1].copy()
    order = np.argsort(body_of, kind="mergesort")
    for v in order:
        if hold[v] >= 0:
            c = node_part[hold[v]]
            out[fill[c]] = v
            fill[c] += 1
    return start, out


@inline
def _rows_by_part(owner, between, node_part, n_clusters):
    """The rows that place every cluster as (starts, rows)."""
    start = np.zeros(n_clusters + 1, np.int64)
    for row in range(owner.shape[0]):
        if between[row] and owner[row] >= 0:
            start[node_part[owner[row]] + 1] += 1
    start = np.cumsum(start)
    out = np.empty(start[-1], np.int64)
    fill = start[:-1].copy()
    for row in range(owner.shape[0]):
        if between[row] and owner[row] >= 0:
            c = node_part[owner[row]]
            out[fill[c]] = row
            fill[c] += 1
    return start, out
