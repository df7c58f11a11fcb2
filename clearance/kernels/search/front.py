"""BVTT fronts: the node pairs at which the last search of each body pair ended, with lower bounds.

A search from its front instead of the roots tests only node pairs that the motion since could have brought near.
Source: front tracking, Ehmann & Lin 2001, Li & Chen 1998; the carried bounds are ours. All fronts lie in one pool
of fixed size. When it is full they are dropped and built again.

An entry is a group of nodes of one body against a node of the other, `(group, other, marks)`. Bit k of the marks
means node k of the group; `OF_B` means that the group is of b.
"""

import math
from typing import Annotated, NamedTuple

import numpy as np

from clearance.compile.declared import Floats, Integers, Integers2, LentTo, Shorts2
from clearance.compile.decorators import inline
from clearance.kernels.arithmetic.lanes import WIDTH

POOL = 1 << 17
"""Capacity in entries (20 bytes each), for all pairs and steps together."""

LONGEST = 4096
"""Most entries of the front of one body pair; a longer one is dropped."""

OF_B = 1 << WIDTH
"""The mark of a group of b."""

GROWN, ANYHOW = 1.2, 16
"""A front is built again from the roots once it exceeds 1.2 times its first length plus 16 entries."""

LONG = 32
"""A front of this many entries costs as much as seeking two planes (`separating_planes`)."""

HULLS_TOUCH, HULLS_NEARER = 15, 1
"""Searches without seeking planes, after none were found or after the hulls were nearer than the bodies."""

LONGEST_PAUSE = 255
"""Most searches in a row without seeking planes."""


@inline(force=True)
def carried_down(bound, moved):
    """[m] a bound of any sign, plus the total motion so far, rounded down."""
    carried = bound + moved
    return carried - 2.0**-50 * (abs(bound) + moved) if abs(carried) < math.inf else carried


START, LENGTH, CAPACITY, FIRST_LENGTH, PAUSE, LAST_PAUSE = range(6)
"""Columns of `Fronts.spans`."""


class Fronts(NamedTuple):
    """The fronts of all pairs.

    Attributes:
        entries: (POOL, 3) as above.
        lower_bounds: (POOL,) [m] a lower bound on the distance of all node pairs of the entry, plus both bodies'
            total motion by then.
        spans: (p, 6) of each pair, by columns: `START` in the pool, `LENGTH`, `CAPACITY`, `FIRST_LENGTH` when it
            was last built from the roots, `PAUSE`: searches until planes are sought again, `LAST_PAUSE`.
        used: (1,) places of the pool that are taken.
    """

    entries: Shorts2
    lower_bounds: Floats
    spans: Integers2
    used: Integers


class PairFront(NamedTuple):
    """The front of one pair.

    Attributes:
        pair: its number in `fronts`. moved: [m] the total motion of both bodies.
    """

    fronts: Annotated[Fronts, LentTo]
    pair: int
    moved: float


@inline
def no_fronts(n_pairs, pool):
    """Fronts of length 0, with a pool of some capacity."""
    return Fronts(
        np.empty((pool, 3), dtype=np.int32),
        np.empty(pool),
        np.zeros((n_pairs, 6), dtype=np.int64),
        np.zeros(1, dtype=np.int64),
    )


@inline
def is_worth_separating(fronts, pair):
    """True if seeking planes that separate the bodies may cost less than visiting the front of the pair.

    Counts down the pause after a search that found none.
    """
    if fronts.spans[pair, LENGTH] < LONG:
        return False
    fronts.spans[pair, PAUSE] -= 1
    return fronts.spans[pair, PAUSE] < 0


@inline
def note_separating_planes(fronts, pair, found, pause):
    """Notes whether planes separate the bodies. If not, the next pause is longer than the last one.

    Args:
        pause: searches to add to twice the last pause.
    """
    spans = fronts.spans
    if found:
        spans[pair, PAUSE], spans[pair, LAST_PAUSE] = 0, 0
    elif spans[pair, PAUSE] < 0:
        spans[pair, LAST_PAUSE] = min(2 * spans[pair, LAST_PAUSE] + pause, LONGEST_PAUSE)
        spans[pair, PAUSE] = spans[pair, LAST_PAUSE]


@inline
def forget_front(fronts, pair):
    """Makes the next search of a pair begin at the roots, as if it were the first."""
    fronts.spans[pair, LENGTH] = 0
    fronts.spans[pair, PAUSE], fronts.spans[pair, LAST_PAUSE] = 0, 0


@inline(force=True)
def _copy(entries, lower_bounds, i, fronts, k):
    for column in range(3):
        fronts.entries[k, column] = entries[i, column]
    fronts.lower_bounds[k] = lower_bounds[i]


@inline
def _reserve(fronts, pair, n_retained, length):
    """Reserves `length` places for a pair and moves the `n_retained` first entries there; False if it cannot."""
    spans = fronts.spans
    if length <= spans[pair, CAPACITY]:
        return True
    capacity = 2 * length + 16
    pool = len(fronts.lower_bounds)
    if capacity > pool:
        return False
    before = spans[pair, START]
    if fronts.used[0] + capacity > pool:
        spans[:, LENGTH] = 0
        spans[:, CAPACITY] = 0
        fronts.used[0] = 0
    first = fronts.used[0]
    for i in range(n_retained):  # upward: the new place may begin below the old one
        _copy(fronts.entries, fronts.lower_bounds, before + i, fronts, first + i)
    fronts.used[0] = first + capacity
    spans[pair, START], spans[pair, CAPACITY] = first, capacity
    return True


@inline(force=True)
def add_entry(scratch, n_fresh, nodes, marks, bound):
    """Writes a new entry for a front: a group's marked nodes against the other node. The number of entries.

    Args:
        bound: [m] on them, plus both bodies' total motion.
    """
    entries = scratch.entries
    entries[n_fresh, 0], entries[n_fresh, 1] = nodes.group, nodes.other
    entries[n_fresh, 2] = marks + OF_B if nodes.is_of_b else marks
    scratch.lower_bounds[n_fresh] = bound
    return n_fresh + (n_fresh <= LONGEST)  # one too many: not all were written


@inline(force=True)
def update_front(fronts, pair, n_retained, entries, lower_bounds, n_fresh):
    """Makes the front of a pair from the `n_retained` first of the old one and `n_fresh` new entries."""
    length = n_retained + n_fresh
    if length > LONGEST or not _reserve(fronts, pair, n_retained, length):
        forget_front(fronts, pair)
        return
    spans = fronts.spans
    at = spans[pair, START] + n_retained
    for i in range(n_fresh):
        _copy(entries, lower_bounds, i, fronts, at + i)
    if n_retained == 0:
        spans[pair, FIRST_LENGTH] = length
    is_grown = length > GROWN * spans[pair, FIRST_LENGTH] + ANYHOW
    spans[pair, LENGTH] = 0 if is_grown else length
