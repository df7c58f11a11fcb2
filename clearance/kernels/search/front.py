"""BVTT fronts: where the last search of each body pair ended, node pairs left with how far apart they are.

A search that goes on from its front instead of the roots retests only what the motion since then could have
brought near (front tracking: Ehmann & Lin 2001, Li & Chen 1998; the bounds carried with it are ours). All
fronts lie in one pool of fixed size; where it is full they are dropped and built anew.

An entry is a group of nodes of one body against a node of the other, `(group, other, marks)`: bit k of the marks
says that node k of the group is meant, `OF_B` that the group is of b.
"""

import math
from typing import Annotated, NamedTuple

import numpy as np

from clearance.compile.declared import Floats, Integers, Integers2, LentTo, Shorts2
from clearance.compile.decorators import inline
from clearance.kernels.arithmetic.lanes import WIDTH

POOL = 1 << 17
"""Entries that are kept in all (20 bytes each), whatever the number of pairs and steps."""

LONGEST = 4096
"""Entries that the front of one body pair may have; a longer one is not kept."""

OF_B = 1 << WIDTH
"""The mark of a group of b."""

GROWN, ANYHOW = 1.2, 16
"""A front that has grown to so many times its first length, and so many entries, is built anew from the roots."""

LONG = 32
"""Entries of a front that take as long as it takes to seek two planes (`separating_planes`)."""

HULLS_TOUCH, HULLS_NEARER = 15, 1
"""Searches in which planes are not sought, after none were found or after the bodies were farther apart."""

MOST_LEFT_OUT = 255
"""Searches at most in which planes are not sought after they were not found."""


@inline(force=True)
def carried_down(bound, moved):
    """[m] a bound of any sign, plus the way so far, less the rounding of either."""
    carried = bound + moved
    return carried - 2.0**-50 * (abs(bound) + moved) if abs(carried) < math.inf else carried


class Fronts(NamedTuple):
    """The fronts of all pairs.

    Attributes:
        entries: (POOL, 3) as above.
        lower_bounds: (POOL,) [m] a lower bound on the distance of all node pairs of the entry, plus both bodies'
            displacements by then.
        spans: (p, 6) of each pair: its first place in the pool, its length, its room, its first length; searches
            until planes are sought again, and how many those were at the last time.
        used: (1,) places of the pool that are given away.
    """

    entries: Shorts2
    lower_bounds: Floats
    spans: Integers2
    used: Integers


class PairFront(NamedTuple):
    """The front of one pair.

    Attributes:
        pair: its number in `fronts`. moved: [m] what both bodies have moved in all.
    """

    fronts: Annotated[Fronts, LentTo]
    pair: int
    moved: float


@inline
def no_fronts(n_pairs, pool):
    """Fronts of length 0; those of single queries have no pool."""
    return Fronts(
        np.empty((pool, 3), dtype=np.int32),
        np.empty(pool),
        np.zeros((n_pairs, 6), dtype=np.int64),
        np.zeros(1, dtype=np.int64),
    )


@inline
def is_worth_separating(fronts, pair):
    """True if it may take less to seek planes that separate the bodies of a pair than to go on from its front.

    Not if they were not found lately, which counts down.
    """
    if fronts.spans[pair, 1] < LONG:
        return False
    fronts.spans[pair, 4] -= 1
    return fronts.spans[pair, 4] < 0


@inline
def note_separating_planes(fronts, pair, found, pause):
    """Notes whether planes separate the bodies; if not, they are not sought for a while, each time a longer one.

    Args:
        pause: searches that it is longer by than twice the last one.
    """
    spans = fronts.spans
    if found:
        spans[pair, 4], spans[pair, 5] = 0, 0
    elif spans[pair, 4] < 0:
        spans[pair, 5] = min(2 * spans[pair, 5] + pause, MOST_LEFT_OUT)
        spans[pair, 4] = spans[pair, 5]


@inline
def forget(fronts, pair):
    """Lets the next search of a pair begin at the roots, as if it were the first."""
    fronts.spans[pair, 1] = 0
    fronts.spans[pair, 4], fronts.spans[pair, 5] = 0, 0


@inline(force=True)
def _copy(entries, lower_bounds, i, fronts, k):
    for column in range(3):
        fronts.entries[k, column] = entries[i, column]
    fronts.lower_bounds[k] = lower_bounds[i]


@inline
def _has_room(fronts, pair, n_kept, length):
    """Finds `length` places for a pair, moving the `n_kept` first of its front there; False if there are none."""
    spans = fronts.spans
    if length <= spans[pair, 2]:
        return True
    room = 2 * length + 16
    pool = len(fronts.lower_bounds)
    if room > pool:
        return False
    before = spans[pair, 0]
    if fronts.used[0] + room > pool:
        spans[:, 1] = 0
        spans[:, 2] = 0
        fronts.used[0] = 0
    first = fronts.used[0]
    for i in range(n_kept):  # upward: the new place may begin below the old one
        _copy(fronts.entries, fronts.lower_bounds, before + i, fronts, first + i)
    fronts.used[0] = first + room
    spans[pair, 0], spans[pair, 2] = first, room
    return True


@inline(force=True)
def leave(scratch, n_left, nodes, marks, kept):
    """Notes an entry for a front: a group's marked nodes against the node across. How many there are now.

    Args:
        kept: [m] a bound on them, plus both bodies' displacements in all.
    """
    left = scratch.left
    left[n_left, 0], left[n_left, 1] = nodes.group, nodes.other
    left[n_left, 2] = marks + OF_B if nodes.is_of_b else marks
    scratch.lower_bounds[n_left] = kept
    return n_left + (n_left <= LONGEST)  # one too many says that not all are there


@inline(force=True)
def keep(fronts, pair, n_kept, entries, lower_bounds, n_fresh):
    """Makes the front of a pair from the `n_kept` first of the old one and `n_fresh` new entries."""
    length = n_kept + n_fresh
    if length > LONGEST or not _has_room(fronts, pair, n_kept, length):
        forget(fronts, pair)
        return
    spans = fronts.spans
    at = spans[pair, 0] + n_kept
    for i in range(n_fresh):
        _copy(entries, lower_bounds, i, fronts, at + i)
    if n_kept == 0:
        spans[pair, 3] = length
    spans[pair, 1] = 0 if length > GROWN * spans[pair, 3] + ANYHOW else length
