"""The face pairs that could be the minimum, measured again in wide numbers.

Vertices and poses are taken exactly as given. The search (`descent`) names the face pairs; here the feature
pair that doubles found the nearest is measured to some 30 digits, and a lower bound along its direction
mostly proves that it is. Only where it does not are all features within the limit measured. The least
wins, ties go to the least faces, and the lower bound tells how far the answer can be above the truth.
"""

import math
from typing import NamedTuple

from clearance.jit import inlined, kernel, merged
from clearance.kernels.double_double import (
    NOISE,
    Wide,
    Wide3,
    less,
    minus,
    root,
    wide,
)
from clearance.kernels.every_feature import Ask, nearest_of_every
from clearance.kernels.face_floor import SURE, UNSURE, floor_of
from clearance.kernels.face_pair import Hit, limit_of, nearest_of_faces
from clearance.kernels.fan_floor import floor_of_fans
from clearance.kernels.feature import nearest_feature, simplex, simplex_here
from clearance.kernels.meeting import common_points
from clearance.kernels.vec3 import Vec3
from clearance.kernels.wide_features import wide_feature

__all__ = [
    "Refined", "common_points", "error_of", "nothing_refined", "refine_faces", "refine_near", "settle", "shed",
]  # fmt: skip


class Refined(NamedTuple):
    """The best pair of points so far, in the orientation of the world, from the origin of a.

    Attributes:
        floor: [m] a lower bound on the distance of all face pairs refined so far.
    """

    gap_sq: Wide
    face_a: int
    face_b: int
    p: Wide3
    q: Wide3
    floor: Wide


@inlined
def nothing_refined():
    """What any pair of points beats."""
    zero = wide(0.0)
    nowhere = Wide3(zero, zero, zero)
    return Refined(wide(math.inf), 2**62, 2**62, nowhere, nowhere, wide(math.inf))


@inlined
def _wins(found_sq, face_a, face_b, best):
    """True where a new pair is nearer, or as near with lesser faces."""
    if less(best.gap_sq, found_sq):
        return False
    if less(found_sq, best.gap_sq):
        return True
    return face_a < best.face_a or (face_a == best.face_a and face_b < best.face_b)


@inlined
def _enough(gap_sq, margin):
    """[m] the floor that proves a distance."""
    length = root(gap_sq)
    return minus(length, wide(SURE * length.hi + UNSURE * margin))


@inlined
def _better(best, pair, face_a, face_b, floor):
    """`best` after a face pair."""
    if less(best.floor, floor):
        floor = best.floor
    if _wins(pair.gap_sq, face_a, face_b, best):
        return Refined(pair.gap_sq, face_a, face_b, pair.p, pair.q, floor)
    return Refined(best.gap_sq, best.face_a, best.face_b, best.p, best.q, floor)


@kernel
def _refine_every(a, face_a, b, face_b, frames, ask, best):
    """`best`, or better: all features of two faces within the limit."""
    chosen = nearest_of_every(a, face_a, b, face_b, frames, ask)
    if chosen.gap_sq.hi == math.inf:
        return best
    feature = chosen.feature
    one = simplex(a, face_a, feature.n_a, feature.i)
    two = simplex(b, face_b, feature.n_b, feature.j)
    pair = wide_feature(frames, one, two)
    floor = floor_of(a, face_a, b, face_b, frames, feature, pair, ask.margin)
    enough = _enough(pair.gap_sq, ask.margin)
    if less(floor, enough) and (a.bent[face_a] or b.bent[face_b]):
        floor = floor_of_fans(a, face_a, b, face_b, frames, pair, enough, floor)
    return _better(best, pair, face_a, face_b, floor)


@merged
def refine_near(a, face_a, b, face_b, frames, near, ask, best):
    """`best`, or better: two faces of which the search in doubles found the nearest features."""
    if near.near_sq < math.inf:
        feature = nearest_feature(a, face_a, b, face_b, frames.m, near)
        one = simplex_here(a, face_a, feature.n_a, feature.i)
        two = simplex_here(b, face_b, feature.n_b, feature.j)
        pair = wide_feature(frames, one, two)
        if pair.gap_sq.hi < math.inf:
            floor = floor_of(a, face_a, b, face_b, frames, feature, pair, ask.margin)
            if not less(floor, _enough(pair.gap_sq, ask.margin)):
                return _better(best, pair, face_a, face_b, floor)
    return _refine_every(a, face_a, b, face_b, frames, ask, best)


@kernel
def refine_faces(a, face_a, b, face_b, frames, ask, best):
    """`best`, or better: two faces that come within the limit."""
    nowhere = Vec3(0.0, 0.0, 0.0)
    start = Hit(ask.limit * ask.limit, 2**62, 2**62, nowhere, nowhere)
    near = nearest_of_faces(a, face_a, b, face_b, frames.m, ask.margin, start)
    return refine_near(a, face_a, b, face_b, frames, near, ask, best)


@merged
def settle(a, b, frames, best_gap, margin, pairs, near_sq, n_pairs, best):
    """`best` after all waiting face pairs that can still win."""
    for i in range(n_pairs):
        limit = limit_of(a, pairs[i, 0], b, pairs[i, 1], best_gap, margin)
        if near_sq[i] <= limit * limit:
            ask = Ask(limit, margin)
            best = refine_faces(a, pairs[i, 0], b, pairs[i, 1], frames, ask, best)
    return best


@merged
def shed(a, b, best_gap, margin, pairs, near_sq, n_pairs):
    """Drops the waiting face pairs that cannot win any more; how many are left."""
    kept = 0
    for i in range(n_pairs):
        limit = limit_of(a, pairs[i, 0], b, pairs[i, 1], best_gap, margin)
        if near_sq[i] <= limit * limit:
            pairs[kept, 0], pairs[kept, 1] = pairs[i, 0], pairs[i, 1]
            near_sq[kept] = near_sq[i]
            kept += 1
    return kept


@inlined
def error_of(refined, distance):
    """[m] a bound on |distance - true distance|, `distance` being the refined one rounded."""
    length = root(refined.gap_sq)
    short = minus(length, refined.floor)
    below = abs(distance - length.hi) + abs(length.lo)
    return (below + max(0.0, short.hi)) * (1.0 + 2.0**-50) + NOISE * distance
