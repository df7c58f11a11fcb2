"""What is carried of pairs from one question to the next, while their bodies move a little in between.

No point of a body moves farther than is noted of it, so a bound on a pair, less what both bodies have moved since,
still holds. Not for: how far bodies move, and which pairs are asked.
"""

import math
from typing import NamedTuple

import numpy as np

from clearance.compile.declared import Floats, Integers2
from clearance.compile.decorators import inline
from clearance.kernels.search.front import Fronts, PairFront, carried_down, no_fronts

NO_FACE = -1


class Carried(NamedTuple):
    """What is known of pairs.

    Attributes:
        moved: (bodies,) [m] no less than what each body has moved in all; infinite where that is not known.
        lower_bounds: (p,) [m] a bound on each pair, plus what both bodies had moved by then.
        faces: (p, 2) the witness faces: those that were nearest, or NO_FACE.
        fronts: where the last descent of each pair has ended.
    """

    moved: Floats
    lower_bounds: Floats
    faces: Integers2
    fronts: Fronts


@inline
def nothing_carried(n_bodies, n_pairs, pool):
    """Nothing is known yet; fronts have room for so many entries."""
    return Carried(
        np.zeros(n_bodies), np.full(n_pairs, -np.inf), np.full((n_pairs, 2), NO_FACE),
        no_fronts(n_pairs, pool),
    )  # fmt: skip


@inline(force=True)
def moved_of(pairs, pair, carried):
    """[m] what both bodies of a pair have moved in all."""
    return carried.moved[pairs[pair, 0]] + carried.moved[pairs[pair, 1]]


@inline(force=True)
def carried_bound(pairs, pair, carried):
    """[m] what remains of the bound of a pair after what its bodies have moved."""
    moved = moved_of(pairs, pair, carried)
    return carried.lower_bounds[pair] - moved if moved < math.inf else -math.inf


@inline(force=True)
def carry(pairs, pair, lower_bound, carried):
    """Carries a bound of a pair [m] on."""
    moved = moved_of(pairs, pair, carried)
    carried.lower_bounds[pair] = carried_down(lower_bound, moved)


@inline(force=True)
def carry_faces(pair, found, carried):
    """Carries the faces on that a search has found nearest."""
    carried.faces[pair, 0], carried.faces[pair, 1] = found.face_a, found.face_b


@inline(force=True)
def front_of(pairs, pair, carried):
    """The front of a pair, as a descent takes it."""
    return PairFront(carried.fronts, pair, moved_of(pairs, pair, carried))


@inline(force=True)
def no_front(carried):
    """A front that no descent goes on from, or keeps."""
    return PairFront(carried.fronts, 0, math.inf)
