"""Open intervals of a search, the one of the greatest bound first: a binary heap of rows.

Not for: what becomes of them (`hausdorff.interval_search`).
"""

from typing import NamedTuple

from clearance.compile.decorators import inline

BOUND, T0, T1, HINT, WAS_CUT, PIECE = range(6)
WIDTH = 6


class OpenInterval(NamedTuple):
    """An interval of a piece of A: its limits, a leaf of B nearby, and whether a root made it (1) or not (0)."""

    piece: int
    t0: float
    t1: float
    hint: int
    was_cut: float


@inline
def interval_at(heap, k):
    """Entry `k` of the queue."""
    row = heap[k]
    return OpenInterval(int(row[PIECE]), row[T0], row[T1], int(row[HINT]), row[WAS_CUT])


@inline
def _before(heap, i, j):
    """Whether entry `i` comes before `j`: the greater bound, of equals the earlier part of the curve."""
    if heap[i, BOUND] != heap[j, BOUND]:
        return heap[i, BOUND] > heap[j, BOUND]
    if heap[i, PIECE] != heap[j, PIECE]:
        return heap[i, PIECE] < heap[j, PIECE]
    return heap[i, T0] < heap[j, T0]


@inline
def _swap(heap, i, j):
    for c in range(heap.shape[1]):
        heap[i, c], heap[j, c] = heap[j, c], heap[i, c]


@inline
def push(heap, n, bound, interval):
    """Puts an interval into the queue of `n` entries; returns the new number."""
    row = heap[n]
    row[BOUND], row[T0], row[T1], row[HINT] = bound, interval.t0, interval.t1, interval.hint
    row[WAS_CUT], row[PIECE] = interval.was_cut, interval.piece
    k = n
    while k > 0 and _before(heap, k, (k - 1) // 2):
        _swap(heap, k, (k - 1) // 2)
        k = (k - 1) // 2
    return n + 1


@inline
def pop(heap, n):
    """Moves the first entry behind the others; returns the new number."""
    n -= 1
    _swap(heap, 0, n)
    k = 0
    while True:
        first = k
        for child in (2 * k + 1, 2 * k + 2):
            if child < n and _before(heap, child, first):
                first = child
        if first == k:
            return n
        _swap(heap, k, first)
        k = first
