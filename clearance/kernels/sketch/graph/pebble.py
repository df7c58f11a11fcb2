"""The pebble game: which equations of the core depend on others by Definitions 1 to 3, and on
which.

Every vertex holds as many pebbles as degrees of freedom; an equation is independent when four
pebbles can be gathered on its vertices, and then one of them pays for it. A dependent equation
closes a circuit: itself and the equations of the least tight set around it (three pebbles in all),
found by following payments.
Source: Jacobs and Hendrickson 1997; Lee and Streinu 2008 for hypergraphs and other counts.
"""

from typing import NamedTuple

import numpy as np

from clearance.compile.jit import inline
from clearance.kernels.sketch.graph.graph import POINT

ENOUGH = 4
"""Pebbles that an independent edge can gather: one pays for it, three remain for the part as a whole."""


class PebbleGame(NamedTuple):
    """The state of a game: pebbles left on every vertex, and the edges that every vertex pays for.

    The last vertex is the known direction of the ground; the last edge ties it to the ground.

    Attributes:
        ends: (m + 1, 5) the vertices of every edge in play, -1 pads.
        pebbles: (n + 1,) pebbles left.
        first_paid: (n + 1,) the first edge that a vertex pays for, -1 for none.
        next_paid: (m + 1,) the edge after it that the same vertex pays for, -1 for none.
        seen: (n + 1,) the last walk that came by.
        came, via: (n + 1,) the vertex and the edge by which the walk came.
        queue: (n + 2,) the vertices of a walk.
        n_walks: (1,) how many walks there were.
    """

    ends: np.ndarray
    pebbles: np.ndarray
    first_paid: np.ndarray
    next_paid: np.ndarray
    seen: np.ndarray
    came: np.ndarray
    via: np.ndarray
    queue: np.ndarray
    n_walks: np.ndarray


class Circuits(NamedTuple):
    """The dependent edges (k,) and their circuits: `rows` from `start[i]` to `start[i + 1]`, start (k + 1,)."""

    dependent: np.ndarray
    start: np.ndarray
    rows: np.ndarray


@inline
def no_circuits():
    """The circuits of a graph without dependent edges."""
    return Circuits(np.empty(0, np.int64), np.zeros(1, np.int64), np.empty(0, np.int64))


@inline
def _new_game(kind, n_edges):
    """A game before its first edge: every vertex holds as many pebbles as freedoms."""
    n, m = kind.shape[0], n_edges
    pebbles = np.ones(n + 1, np.int64)
    for v in range(n):
        if kind[v] == POINT:
            pebbles[v] = 2
    pebbles[0], pebbles[n] = 3, 0
    ends = np.full((m + 1, 5), -1, np.int64)
    ends[m, 0], ends[m, 1] = 0, n
    first_paid = np.full(n + 1, -1, np.int64)
    first_paid[n] = m
    return PebbleGame(
        ends,
        pebbles,
        first_paid,
        np.full(m + 1, -1, np.int64),
        np.full(n + 1, -1, np.int64),
        np.empty(n + 1, np.int64),
        np.empty(n + 1, np.int64),
        np.empty(n + 2, np.int64),
        np.zeros(1, np.int64),
    )


@inline(force=True)
def _mark(game, row):
    """Begins a walk: marks the vertices of an edge as seen and puts them into the queue; how many."""
    game.n_walks[0] += 1
    count = 0
    for k in range(5):
        v = game.ends[row, k]
        if v >= 0:
            game.seen[v] = game.n_walks[0]
            game.queue[count] = v
            count += 1
    return count


@inline(force=True)
def _free_pebble(game, v):
    """Frees one pebble onto v by passing payments along; True when one was found.

    Vertices that the walk has marked already are not entered.
    """
    ends, pebbles, queue, seen = game.ends, game.pebbles, game.queue, game.seen
    walk = game.n_walks[0]
    head, tail = 0, 1
    queue[0] = v
    while head < tail:
        u = queue[head]
        head += 1
        row = game.first_paid[u]
        while row >= 0:
            for k in range(5):
                w = ends[row, k]
                if w < 0 or seen[w] == walk:
                    continue
                seen[w] = walk
                game.came[w], game.via[w] = u, row
                if pebbles[w] > 0:
                    _pass(game, v, w)
                    return True
                queue[tail] = w
                tail += 1
            row = game.next_paid[row]
    return False


@inline(force=True)
def _pass(game, v, w):
    """Lets w pay for the edge it was reached by, that edge's payer for the one before, and so on to
    v."""
    first_paid, next_paid = game.first_paid, game.next_paid
    game.pebbles[w] -= 1
    while True:
        u, row = game.came[w], game.via[w]
        before = -1
        at = first_paid[u]
        while at != row:
            before = at
            at = next_paid[at]
        if before < 0:
            first_paid[u] = next_paid[row]
        else:
            next_paid[before] = next_paid[row]
        next_paid[row] = first_paid[w]
        first_paid[w] = row
        if u == v:
            game.pebbles[v] += 1
            return
        w = u


@inline(force=True)
def _put_in_play(game, row, ends, absolute):
    """Takes in the vertices of an edge; what only refers to directions hangs on the known direction."""
    direction = game.pebbles.shape[0] - 1
    for k in range(5):
        game.ends[row, k] = ends[row, k]
        if ends[row, k] == 0 and absolute[row] != 1:
            game.ends[row, k] = direction


@inline(force=True)
def _gather(game, row):
    """Gathers pebbles on the vertices of an edge until there are enough; whether there are."""
    total = 0
    for k in range(5):
        total += game.pebbles[game.ends[row, k]] if game.ends[row, k] >= 0 else 0
    grew = True
    while total < ENOUGH and grew:
        grew = False
        for k in range(5):
            v = game.ends[row, k]
            if v < 0:
                continue
            _mark(game, row)
            if _free_pebble(game, v):
                total += 1
                grew = True
                break
    return total >= ENOUGH


@inline(force=True)
def _pay(game, row):
    """Pays for an edge with a pebble of its first vertex that has one."""
    for k in range(5):
        v = game.ends[row, k]
        if v >= 0 and game.pebbles[v] > 0:
            game.pebbles[v] -= 1
            game.next_paid[row] = game.first_paid[v]
            game.first_paid[v] = row
            return


@inline
def _append_circuit(game, row, rows, filled):
    """Appends the edges of the least tight set around a dependent edge, itself last, from `filled` on.

    Returns (rows, with more room where there was too little; its new end).
    """
    ground = game.ends.shape[0] - 1
    tail = _mark(game, row)
    walk = game.n_walks[0]
    head = 0
    while head < tail:
        at = game.first_paid[game.queue[head]]
        head += 1
        while at >= 0:
            if at < ground:
                if filled + 1 >= rows.shape[0]:
                    larger = np.empty(2 * rows.shape[0], np.int64)
                    larger[:filled] = rows[:filled]
                    rows = larger
                rows[filled] = at
                filled += 1
            for k in range(5):
                w = game.ends[at, k]
                if w >= 0 and game.seen[w] != walk:
                    game.seen[w] = walk
                    game.queue[tail] = w
                    tail += 1
            at = game.next_paid[at]
    rows[filled] = row
    return rows, filled + 1


@inline(reference_counts=True)
def play(kind, ends, absolute, live):
    """The live edges that depend on others, with their circuits; see `Circuits`.

    Edges that are held by the ground come first: a dimension is the better suspect.
    """
    m = ends.shape[0]
    game = _new_game(kind, m)
    dependent, start = np.empty(m, np.int64), np.zeros(m + 1, np.int64)
    rows = np.empty(max(m, 1) * 4 + 16, np.int64)
    count, filled = 0, 0
    for turn in range(2 * m):
        row = turn % m
        if not live[row] or (absolute[row] == 1) != (turn < m):
            continue
        _put_in_play(game, row, ends, absolute)
        if _gather(game, row):
            _pay(game, row)
            continue
        rows, filled = _append_circuit(game, row, rows, filled)
        dependent[count] = row
        count += 1
        start[count] = filled
        game.ends[row, :] = -1
    return Circuits(dependent[:count], start[: count + 1], rows[:filled])
