"""The face pairs that could be the minimum, measured again in double-double.

Vertices and poses are used exactly as given. The search (`descent`) names the face pairs. Here the feature pair
that doubles found the nearest is measured to some 30 digits, and a lower bound along its direction mostly proves
it. Only where it does not, all features within the limit are measured. The least wins, and ties go to the least
faces. The lower bound limits how far the answer can exceed the true distance.
"""

import math
from typing import NamedTuple

import numpy as np

from clearance.compile.declared import Floats, Integers2
from clearance.compile.decorators import inline, kernel
from clearance.kernels.arithmetic.double_double import (
    FAR,
    NOISE,
    ZERO3,
    Wide,
    Wide3,
    less,
    lesser,
    minus,
    root,
    wide,
)
from clearance.kernels.features.bounds import SeparatingDirection, lower_bound_faces_along_direction
from clearance.kernels.features.every_feature import FeatureCutoff, nearest_of_every
from clearance.kernels.features.face_lower_bounds import SURE, UNSURE, lower_bound_of
from clearance.kernels.features.face_pair import UNSEEN, FeatureCandidate, limit_of
from clearance.kernels.features.fan_lower_bounds import lower_bound_of_fans
from clearance.kernels.features.feature import nearest_feature, simplex
from clearance.kernels.features.posed_pair import PosedPair, parts
from clearance.kernels.features.rounding_guard import may_hide
from clearance.kernels.features.wide_features import size_features, too_far, wide_feature

N_WAITING = 64
"""Face pairs that wait to be refined; where more are equally near, the waiting ones are refined first."""


class RefinedDistance(NamedTuple):
    """The best pair of points so far, in the orientation of the world, from the origin of a.

    Attributes:
        length: [m] their distance, the root of `gap_sq`.
        lower_bound: [m] a lower bound on the distance of its two faces.
        sure: [m] a lower bound on the distances of all feature pairs that were measured, whichever won.
    """

    gap_sq: Wide
    length: Wide
    face_a: int
    face_b: int
    p: Wide3
    q: Wide3
    lower_bound: Wide
    sure: Wide


NOTHING_REFINED = RefinedDistance(FAR, FAR, 2**62, 2**62, ZERO3, ZERO3, FAR, FAR)
"""Infinitely far: any pair of points is nearer."""


@inline
def _wins(found_sq, face_a, face_b, best):
    """True where a new pair is nearer, or as near with lesser faces."""
    if less(best.gap_sq, found_sq):
        return False
    if less(found_sq, best.gap_sq):
        return True
    return face_a < best.face_a or (face_a == best.face_a and face_b < best.face_b)


@inline
def _enough(length, margin):
    """[m] the lower bound that proves a distance."""
    return minus(length, wide(SURE * length.hi + UNSURE * margin))


@inline
def _better(best, pair, length, face_a, face_b, lower_bound, sure):
    """`best` after a face pair. The lower bound of one that does not win may be low: others are nearest."""
    sure = lesser(best.sure, sure)
    if _wins(pair.gap_sq, face_a, face_b, best):
        return RefinedDistance(
            pair.gap_sq, length, face_a, face_b, pair.p, pair.q, lower_bound, sure
        )
    return RefinedDistance(
        best.gap_sq, best.length, best.face_a, best.face_b, best.p, best.q, best.lower_bound, sure
    )


@kernel
def refine_every(faces: PosedPair, cutoff: FeatureCutoff, best: RefinedDistance) -> RefinedDistance:
    """`best`, or better: all features of two faces within the limit."""
    a, b = faces.surface_a, faces.surface_b
    face_a, face_b, frames = faces.a, faces.b, faces.frames
    chosen = nearest_of_every(a, face_a, b, face_b, frames, cutoff)
    if chosen.gap_sq.hi == math.inf:
        return best
    feature = chosen.feature
    one = simplex(a, face_a, feature.n_a, feature.i)
    two = simplex(b, face_b, feature.n_b, feature.j)
    sized = size_features(frames, one, two)
    pair, length = sized.pair, sized.length
    lower_bound = lower_bound_of(a, face_a, b, face_b, frames, feature, pair, cutoff.margin)
    enough = _enough(length, cutoff.margin)
    if less(lower_bound, enough) and (a.bent[face_a] or b.bent[face_b]):
        lower_bound = lower_bound_of_fans(faces, pair, enough, lower_bound)
    return _better(best, pair, length, face_a, face_b, minus(lower_bound, sized.off), chosen.sure)


@kernel
def refine(
    faces: PosedPair, seen: FeatureCandidate, cutoff: FeatureCutoff, best: RefinedDistance
) -> RefinedDistance:
    """`best`, or better: two faces of which the search in doubles has seen the nearest features."""
    a, b = faces.surface_a, faces.surface_b
    face_a, face_b, frames = faces.a, faces.b, faces.frames
    if seen.kind != UNSEEN:
        feature = nearest_feature(a, face_a, b, face_b, frames.m, seen)
        one = simplex(a, face_a, feature.n_a, feature.i)
        two = simplex(b, face_b, feature.n_b, feature.j)
        pair = wide_feature(frames, one, two)
        if pair.gap_sq.hi < math.inf:
            lower_bound = lower_bound_of(a, face_a, b, face_b, frames, feature, pair, cutoff.margin)
            length = root(pair.gap_sq)
            if not less(lower_bound, _enough(length, cutoff.margin)):
                off = too_far(frames, one, two, pair, length)
                return _better(
                    best, pair, length, face_a, face_b, minus(lower_bound, off), minus(length, off)
                )
    return refine_every(faces, cutoff, best)


class RefineQueue(NamedTuple):
    """Face pairs that wait to be refined, as a `FeatureCandidate` each.

    Attributes:
        faces: (n, 2) int64. near_sq: (n,) [m^2]. features: (n, 3) int64 kind, i, j.
        least_sq: (n,) [m^2] of the nearest features that the face pair may have: near_sq, or less.
    """

    faces: Integers2
    near_sq: Floats
    features: Integers2
    least_sq: Floats


@inline
def new_refine_queue():
    """Arrays for `N_WAITING` face pairs."""
    return RefineQueue(
        np.empty((N_WAITING, 2), dtype=np.int64),
        np.empty(N_WAITING),
        np.empty((N_WAITING, 3), dtype=np.int64),
        np.empty(N_WAITING),
    )


@inline(force=True)
def put(waiting, at, face_a, face_b, seen, least_sq):
    """Queues a face pair at a place."""
    waiting.faces[at, 0], waiting.faces[at, 1] = face_a, face_b
    waiting.near_sq[at], waiting.least_sq[at] = seen.near_sq, least_sq
    features = waiting.features
    features[at, 0], features[at, 1], features[at, 2] = seen.kind, seen.i, seen.j


class RefineBounds(NamedTuple):
    """Bounds on the distances of all faces while some are refined.

    Attributes:
        direction: the best separating direction so far. slack: [m] its rounding.
        least: [m] a lower bound on the distance of any two faces, except features that rounding hides.
    """

    direction: SeparatingDirection
    slack: float
    least: float


@inline(force=True)
def settle(bodies, waiting, n_waiting, cutoff, bounds, best):
    """`best` after all waiting face pairs that can still win, by features seen or hidden by rounding.

    Args:
        bodies: any parts of the surfaces that the faces are of.
        cutoff: of `FeatureCutoff`, for the faces nearest so far.
        bounds: of `RefineBounds`.
    """
    a, b = bodies.surface_a, bodies.surface_b
    margin = cutoff.margin
    for i in range(n_waiting):
        face_a, face_b = waiting.faces[i, 0], waiting.faces[i, 1]
        limit = limit_of(a, face_a, b, face_b, cutoff.limit, margin)
        near_sq = waiting.near_sq[i]
        if waiting.least_sq[i] > limit * limit:
            continue
        if near_sq > limit * limit:
            along_direction = (
                lower_bound_faces_along_direction(a, face_a, b, face_b, bounds.direction)
                - bounds.slack
            )
            if along_direction > limit or not may_hide(
                a, face_a, b, face_b, bodies.frames.m, margin, limit, bounds.least
            ):
                continue
        features = waiting.features
        seen = FeatureCandidate(near_sq, features[i, 0], features[i, 1], features[i, 2])
        faces = parts(bodies, face_a, face_b)
        best = refine(faces, seen, FeatureCutoff(limit, margin), best)
    return best


@inline(force=True)
def shed(a, b, best_gap, margin, waiting, n_waiting):
    """Drops the waiting face pairs that cannot win any more; how many remain."""
    n_remaining = 0
    for i in range(n_waiting):
        limit = limit_of(a, waiting.faces[i, 0], b, waiting.faces[i, 1], best_gap, margin)
        if waiting.least_sq[i] <= limit * limit:
            waiting.near_sq[n_remaining], waiting.least_sq[n_remaining] = (
                waiting.near_sq[i],
                waiting.least_sq[i],
            )
            for k in range(2):
                waiting.faces[n_remaining, k] = waiting.faces[i, k]
            for k in range(3):
                waiting.features[n_remaining, k] = waiting.features[i, k]
            n_remaining += 1
    return n_remaining


@inline
def error_of(refined, distance):
    """[m] a bound on |distance - true distance|, `distance` being the refined one rounded."""
    short = minus(refined.length, lesser(refined.sure, refined.lower_bound))
    below = abs(distance - refined.length.hi) + abs(refined.length.lo)
    return (below + max(0.0, short.hi)) * (1.0 + 2.0**-50) + NOISE * distance
