"""Knowledge of pairs that lasts from one question to the next, while their bodies move a little in between.

The motion of each body is bounded. So a bound on a pair, less the motion of both bodies since, still holds. Not
for: how far bodies move, and which pairs are asked.
"""

import math
from typing import NamedTuple

import numpy as np

from clearance.compile.declared import Floats, Integers2
from clearance.compile.decorators import inline
from clearance.kernels.search.front import Fronts, PairFront, carried_down, no_fronts

NO_FACE = -1


class Carried(NamedTuple):
    """Carried bounds, witness faces and fronts of pairs.

    Attributes:
        moved: (bodies,) [m] the total motion of each body, or more; infinite where unknown.
        lower_bounds: (p,) [m] a bound on each pair, plus the total motion of both bodies by then.
        faces: (p, 2) the witness faces: the nearest ones of the last answer, or NO_FACE.
        fronts: where the last descent of each pair ended.
    """

    moved: Floats
    lower_bounds: Floats
    faces: Integers2
    fronts: Fronts


@inline
def nothing_carried(n_bodies, n_pairs, pool):
    """Nothing is known yet; `pool` is the capacity of the fronts."""
    return Carried(
        np.zeros(n_bodies), np.full(n_pairs, -np.inf), np.full((n_pairs, 2), NO_FACE),
        no_fronts(n_pairs, pool),
    )  # fmt: skip


@inline(force=True)
def moved_of(pairs, pair, carried):
    """[m] the total motion of both bodies of a pair."""
    return carried.moved[pairs[pair, 0]] + carried.moved[pairs[pair, 1]]


@inline(force=True)
def carried_bound(pairs, pair, carried):
    """[m] the bound of a pair that remains after the motion of its bodies."""
    moved = moved_of(pairs, pair, carried)
    return carried.lower_bounds[pair] - moved if moved < math.inf else -math.inf


@inline(force=True)
def carry(pairs, pair, lower_bound, carried):
    """Stores a bound of a pair [m]."""
    moved = moved_of(pairs, pair, carried)
    carried.lower_bounds[pair] = carried_down(lower_bound, moved)


@inline(force=True)
def carry_faces(pair, found, carried):
    """Stores the nearest faces of a search."""
    carried.faces[pair, 0], carried.faces[pair, 1] = found.face_a, found.face_b


@inline(force=True)
def front_of(pairs, pair, carried):
    """The front of a pair, for a descent."""
    return PairFront(carried.fronts, pair, moved_of(pairs, pair, carried))


@inline(force=True)
def no_front(carried):
    """A front that a descent neither reads nor updates."""
    return PairFront(carried.fronts, 0, math.inf)
