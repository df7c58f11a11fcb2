"""Two faces in a search: measured, refined later if they can be nearest, and what is nearest after them.

Not for: which faces are looked at (`descent`).
"""

import math
from typing import NamedTuple

from clearance.compile.decorators import inline
from clearance.kernels.features.bounds import lower_bound_faces_along_direction, margin_of
from clearance.kernels.features.every_feature import FeatureCutoff
from clearance.kernels.features.face_pair import (
    FacePairState,
    Hit,
    limit_of,
    may_own_nearest,
    nearest_of_faces,
)
from clearance.kernels.features.meeting import Meeting, meeting
from clearance.kernels.features.refine import (
    N_WAITING,
    RefineBounds,
    RefinedDistance,
    put,
    settle,
    shed,
)
from clearance.kernels.features.rounding_guard import sure_gap, told_apart
from clearance.kernels.search.node_pairs import Views, views_of
from clearance.kernels.search.scratch import swap


class SearchLimits(NamedTuple):
    """How far a search goes.

    Attributes:
        limit: [m] node pairs farther than this, or than the best, are not opened.
        wanted: [m] face pairs farther apart are not refined.
        slack: [m] of `rounding_slack`.
        effort: node pairs after which it stops with what is within its limit so far, and proves nothing.
    """

    limit: float
    wanted: float
    slack: float
    effort: int


class NearestSoFar(NamedTuple):
    """The best pair of points so far, and what follows from it.

    Attributes:
        gap: [m] theirs, or the limit if that is less. cut: [m] the cut-off distance: what is farther is left.
        views: the bodies seen in the direction from one point to the other.
    """

    hit: Hit
    gap: float
    cut: float
    views: Views


class RefineProgress(NamedTuple):
    """The face pairs that could be the minimum.

    Attributes:
        n_waiting: so many wait. refined: the best of those that waited before.
        hides: True if rounding may hide nearer points of one that waits than were seen.
    """

    n_waiting: int
    refined: RefinedDistance
    hides: bool


class FaceSearch(NamedTuple):
    """What is known from the face pairs that were looked at.

    Attributes:
        lower_bound: [m] of those that are left.
        n_measured: how many were measured.
    """

    near: NearestSoFar
    progress: RefineProgress
    meeting: Meeting
    lower_bound: float
    n_measured: int


@inline(force=True)
def nearest_so_far(hit, limits, m):
    """What follows from a pair of points."""
    gap = min(limits.limit, math.sqrt(hit.gap_sq))
    return NearestSoFar(hit, gap, gap + margin_of(limits.slack), views_of(hit, m))


@inline(force=True)
def _nearest_last(scratch, n_waiting):
    """Puts the nearest of all node pairs that wait last."""
    bounds = scratch.bounds
    nearest = n_waiting - 1
    for k in range(n_waiting - 1):
        if max(0.0, bounds[k]) < max(0.0, bounds[nearest]):
            nearest = k
    swap(scratch, nearest, n_waiting - 1)


@inline(force=True)
def settle_waiting(bodies, search, limits, least, scratch):
    """The best after all face pairs that wait; no two are nearer than `least` [m] but for rounding."""
    near, progress = search.near, search.progress
    refine_bounds = RefineBounds(near.views.a.direction, limits.slack, least)
    cutoff = FeatureCutoff(min(near.gap, limits.wanted), margin_of(limits.slack))
    return settle(
        bodies, scratch.waiting, progress.n_waiting, cutoff, refine_bounds, progress.refined
    )


@inline(force=True)
def _let_wait(a, b, faces, seen, least_sq, search, limits, scratch):
    """Lets a face pair wait to be refined; where too many wait, those are refined that can still win.

    Many arguments: it is inlined into the inner loop, whose locals they are.
    """
    near, progress = search.near, search.progress
    margin = margin_of(limits.slack)
    n_waiting, refined = progress.n_waiting, progress.refined
    if n_waiting == N_WAITING:
        n_waiting = shed(a, b, near.gap, margin, scratch.waiting, n_waiting)
        if n_waiting > N_WAITING // 2:
            few = RefineProgress(n_waiting, refined, progress.hides)
            left = FaceSearch(near, few, search.meeting, search.lower_bound, search.n_measured)
            refined = settle_waiting(faces, left, limits, 0.0, scratch)
            n_waiting = 0
    put(scratch.waiting, n_waiting, faces.a, faces.b, seen, least_sq)
    return RefineProgress(n_waiting + 1, refined, progress.hides)


@inline
def look_at_faces(faces, bound, first, search, limits, n_waiting, scratch):
    """What is known after a pair of leaves, `bound` [m] apart at least, while so many node pairs wait."""
    a, b = faces.surface_a, faces.surface_b
    before, slack, margin = search.near, limits.slack, margin_of(limits.slack)
    face_a, face_b, m = faces.a, faces.b, faces.frames.m
    near, lower_bound, met = before, search.lower_bound, search.meeting
    progress, n_measured = search.progress, search.n_measured
    direction = before.views.a.direction
    apart = lower_bound_faces_along_direction(a, face_a, b, face_b, direction) - slack
    if apart > before.cut:
        lower_bound = min(lower_bound, apart)
    elif before.hit.gap_sq > limits.limit * limits.limit or may_own_nearest(
        a, face_a, b, face_b, direction, apart, before.gap, margin
    ):
        n_measured += 1
        if face_a == first.best.face_a and face_b == first.best.face_b:
            measured = FacePairState(before.hit, first.seen)
        else:
            measured = nearest_of_faces(a, face_a, b, face_b, m, margin, before.hit)
        near = NearestSoFar(measured.best, before.gap, before.cut, before.views)
        if measured.best.gap_sq < before.hit.gap_sq:
            near = nearest_so_far(measured.best, limits, m)
            direction = near.views.a.direction
            apart = lower_bound_faces_along_direction(a, face_a, b, face_b, direction) - slack
        gap = sure_gap(a, face_a, b, face_b, m, margin, apart)
        if bound <= 0.0 and gap <= 0.0:
            met = meeting(faces, scratch.exact)
        if met.found:
            touching = Hit(0.0, face_a, face_b, m.t, m.t)
            near = NearestSoFar(touching, near.gap, near.cut, near.views)
        else:
            if n_waiting > 1 and near.gap < before.gap:
                _nearest_last(scratch, n_waiting)
            least_sq = measured.seen.near_sq
            is_told = told_apart(a, face_a, b, face_b, gap, margin)
            if not is_told:  # nearer ones may be hidden
                least_sq = min(least_sq, max(0.0, gap) * max(0.0, gap))
            reach = limit_of(a, face_a, b, face_b, before.gap, margin)
            may_win = least_sq < math.inf and least_sq <= reach * reach
            if may_win:
                known = FaceSearch(near, progress, met, lower_bound, n_measured)
                progress = _let_wait(a, b, faces, measured.seen, least_sq, known, limits, scratch)
            if may_win and not is_told:
                progress = RefineProgress(progress.n_waiting, progress.refined, True)
            elif least_sq < math.inf:
                seen = math.sqrt(least_sq)
                left = 2.0 * seen - limit_of(a, face_a, b, face_b, seen, margin)
                lower_bound = min(lower_bound, left)
            else:
                lower_bound = min(lower_bound, math.sqrt(near.hit.gap_sq) + margin)
    return FaceSearch(near, progress, met, lower_bound, n_measured)
