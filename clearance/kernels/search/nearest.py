"""The exact nearest faces of two bodies without motion, or a proof that they are far.

Two faces are measured in doubles. Candidates for the nearest wait, and are refined at the end. A pair of nodes or
faces is skipped only if its lower bound exceeds the best distance by more than its own error. So every face pair
that attains the minimum is refined, and the answer does not depend on the order. The first contact ends the
search. Not for: which faces are visited (`descent`).
"""

import math
from typing import NamedTuple

from clearance.compile.decorators import inline
from clearance.kernels.features.bounds import (
    lower_bound_boxes,
    lower_bound_faces_along_direction,
    margin_of,
)
from clearance.kernels.features.every_feature import FeatureCutoff
from clearance.kernels.features.face_pair import (
    FacePairState,
    Hit,
    limit_of,
    may_own_nearest,
    nearest_of_faces,
)
from clearance.kernels.features.meeting import NO_MEETING, Meeting, meeting
from clearance.kernels.features.refine import (
    N_WAITING,
    NOTHING_REFINED,
    RefineBounds,
    RefinedDistance,
    put,
    settle,
    shed,
)
from clearance.kernels.features.rounding_guard import is_beyond_rounding, sure_gap
from clearance.kernels.mesh.surface import box_of
from clearance.kernels.search.descent import (
    NodeQueue,
    cut_of,
    descend,
    from_front,
    is_over,
    put_roots,
    with_faces,
)
from clearance.kernels.search.displacement import Still
from clearance.kernels.search.front import LENGTH, forget_front, update_front
from clearance.kernels.search.node_pairs import Views, views_of
from clearance.kernels.search.scratch import swap
from clearance.kernels.search.warm_start import warm_start


class SearchLimits(NamedTuple):
    """How far a search goes.

    Attributes:
        limit: [m] node pairs with a greater bound than this, or than the best, are not opened.
        wanted: [m] face pairs with a greater distance are not refined.
        slack: [m] of `rounding_slack`.
        effort: node pairs after which it stops with its best so far, and proves nothing.
        first: two faces that are measured already.
    """

    limit: float
    wanted: float
    slack: float
    effort: int
    first: FacePairState


class Tally(NamedTuple):
    """Work done: node pairs bounded, face pairs measured, decisions that took exact arithmetic."""

    nodes: int
    faces: int
    exact_decisions: int


class NearestFaces(NamedTuple):
    """The outcome of a search.

    Attributes:
        meeting: whether and where the bodies have a common point, in the faces of `hit`.
        hit: the best pair of points in doubles, within the limit or not, no worse than the given one.
        lower_bound: [m] on the distance of the face pairs that were not refined.
        refined: the answer in double-double, if one lies within the limit.
    """

    meeting: Meeting
    hit: Hit
    lower_bound: float
    refined: RefinedDistance
    tally: Tally


class Best(NamedTuple):
    """The best pair of points so far.

    Attributes:
        gap: [m] their distance, or the limit if that is less. cut: [m] the cut-off distance.
    """

    hit: Hit
    gap: float
    cut: float


class RefineProgress(NamedTuple):
    """The face pairs that could be the minimum.

    Attributes:
        n_waiting: number of those that wait. refined: the best of those refined so far.
        hides: True if rounding may hide nearer points of a waiting pair.
    """

    n_waiting: int
    refined: RefinedDistance
    hides: bool


class NearestSearch(NamedTuple):
    """The state of a search.

    Attributes:
        views: of the bodies along the line through the best points.
        lower_bound: [m] of the face pairs skipped. n_measured: face pairs measured.
    """

    best: Best
    views: Views
    progress: RefineProgress
    meeting: Meeting
    lower_bound: float
    n_measured: int


@cut_of.register
def _(search: NearestSearch, goal, n_opened):
    return search.best.cut


@is_over.register
def _(search: NearestSearch, goal, n_nodes):
    return search.meeting.found or (n_nodes > goal.effort and search.best.gap < math.inf)


@inline(force=True)
def best_of(hit, limits):
    """A pair of points as `Best`."""
    gap = min(limits.limit, math.sqrt(hit.gap_sq))
    return Best(hit, gap, gap + margin_of(limits.slack))


@inline(force=True)
def _nearest_last(scratch, n_waiting):
    """Moves the nearest waiting node pair to the end."""
    bounds = scratch.bounds
    nearest = n_waiting - 1
    for k in range(n_waiting - 1):
        if max(0.0, bounds[k]) < max(0.0, bounds[nearest]):
            nearest = k
    swap(scratch, nearest, n_waiting - 1)


@inline(force=True)
def _settle_waiting(bodies, search, limits, least, scratch):
    """The best after refining all waiting face pairs; none is nearer than `least` [m], rounding aside."""
    best, progress = search.best, search.progress
    refine_bounds = RefineBounds(search.views.a.direction, limits.slack, least)
    cutoff = FeatureCutoff(min(best.gap, limits.wanted), margin_of(limits.slack))
    return settle(
        bodies, scratch.waiting, progress.n_waiting, cutoff, refine_bounds, progress.refined
    )


@inline(force=True)
def _let_wait(a, b, faces, seen, least_sq, search, limits, scratch):
    """Queues a face pair for refinement. Where too many wait, those that can still win are refined now.

    Many arguments: it is inlined into the inner loop, whose locals they are.
    """
    progress = search.progress
    n_waiting, refined = progress.n_waiting, progress.refined
    if n_waiting == N_WAITING:
        margin = margin_of(limits.slack)
        n_waiting = shed(a, b, search.best.gap, margin, scratch.waiting, n_waiting)
        if n_waiting > N_WAITING // 2:
            few = RefineProgress(n_waiting, refined, progress.hides)
            search = NearestSearch(
                search.best,
                search.views,
                few,
                search.meeting,
                search.lower_bound,
                search.n_measured,
            )
            refined = _settle_waiting(faces, search, limits, 0.0, scratch)
            n_waiting = 0
    put(scratch.waiting, n_waiting, faces.a, faces.b, seen, least_sq)
    return RefineProgress(n_waiting + 1, refined, progress.hides)


@with_faces.register
def _(search: NearestSearch, faces, bound, cut, still, limits, n_waiting, scratch):
    a, b = faces.surface_a, faces.surface_b
    before, slack, margin = search.best, limits.slack, margin_of(limits.slack)
    face_a, face_b, m = faces.a, faces.b, faces.frames.m
    best, views, lower_bound, met = before, search.views, search.lower_bound, search.meeting
    progress, n_measured = search.progress, search.n_measured
    direction = views.a.direction
    separation = lower_bound_faces_along_direction(a, face_a, b, face_b, direction) - slack
    if separation > before.cut:
        lower_bound = min(lower_bound, separation)
    elif before.hit.gap_sq > limits.limit * limits.limit or may_own_nearest(
        a, face_a, b, face_b, direction, separation, before.gap, margin
    ):
        n_measured += 1
        if face_a == limits.first.best.face_a and face_b == limits.first.best.face_b:
            measured = FacePairState(before.hit, limits.first.seen)
        else:
            measured = nearest_of_faces(a, face_a, b, face_b, m, margin, before.hit)
        best = Best(measured.best, before.gap, before.cut)
        if measured.best.gap_sq < before.hit.gap_sq:
            best, views = best_of(measured.best, limits), views_of(measured.best, m)
            direction = views.a.direction
            separation = lower_bound_faces_along_direction(a, face_a, b, face_b, direction) - slack
        gap = sure_gap(a, face_a, b, face_b, m, margin, separation)
        if bound <= 0.0 and gap <= 0.0:
            met = meeting(faces, scratch.exact)
        if met.found:
            best = Best(Hit(0.0, face_a, face_b, m.t, m.t), best.gap, best.cut)
        else:
            if n_waiting > 1 and best.gap < before.gap:
                _nearest_last(scratch, n_waiting)
            least_sq = measured.seen.near_sq
            is_certain = is_beyond_rounding(a, face_a, b, face_b, gap, margin)
            if not is_certain:  # rounding may hide nearer ones
                least_sq = min(least_sq, max(0.0, gap) * max(0.0, gap))
            reach = limit_of(a, face_a, b, face_b, before.gap, margin)
            may_win = least_sq < math.inf and least_sq <= reach * reach
            if may_win:
                known = NearestSearch(best, views, progress, met, lower_bound, n_measured)
                progress = _let_wait(a, b, faces, measured.seen, least_sq, known, limits, scratch)
            if may_win and not is_certain:
                progress = RefineProgress(progress.n_waiting, progress.refined, True)
            elif least_sq < math.inf:
                seen = math.sqrt(least_sq)
                lower_bound = min(
                    lower_bound, 2.0 * seen - limit_of(a, face_a, b, face_b, seen, margin)
                )
            else:
                lower_bound = min(lower_bound, math.sqrt(best.hit.gap_sq) + margin)
    return NearestSearch(best, views, progress, met, lower_bound, n_measured)


@inline
def _begin(roots, still, search, planes, front, scratch):
    """The first node pairs to visit: those of the separating planes or the front, or the roots."""
    if planes.n_waiting > 0:
        return NodeQueue(0, planes.n_waiting, 0, planes.beyond)
    if front.fronts.spans[front.pair, LENGTH] > 0:
        return from_front(roots, search.views, still, search.best.cut, front, scratch)
    a, b = roots.surface_a, roots.surface_b
    m = roots.frames.m
    put_roots(
        roots, lower_bound_boxes(box_of(a, roots.a), box_of(b, roots.b), m, still.slack), scratch
    )
    n_waiting, n_nodes = 1, 1
    if search.best.gap == math.inf:
        n_waiting, n_nodes = warm_start(a, b, roots, search.views, scratch)
    return NodeQueue(0, n_waiting, n_nodes, math.inf)


@inline
def nearest_faces(roots, hit, limits, planes, front, scratch):
    """All face pairs of two bodies that can be nearest within a limit.

    Args:
        roots: of the bodies' trees.
        hit: the start, or none. Its points give the direction along which boxes are bounded, even beyond the
            limit.
        limits: a `SearchLimits`.
        planes: of `SeparatingPlanes`. If leaves wait already, only these are visited; `beyond` bounds all others.
        front: of `PairFront`, the front of the pair.
    """
    still, n_exact = Still(limits.slack), scratch.exact.count[0]
    nothing_waits = RefineProgress(0, NOTHING_REFINED, False)
    views = views_of(hit, roots.frames.m)
    search = NearestSearch(best_of(hit, limits), views, nothing_waits, NO_MEETING, math.inf, 0)
    queue = _begin(roots, still, search, planes, front, scratch)
    found = descend(roots, still, search, limits, queue, front.moved, scratch)
    search = found.search
    met, refined = search.meeting, search.progress.refined
    lower_bound = min(found.lower_bound, search.lower_bound)
    if not met.found:
        refined = _settle_waiting(roots, search, limits, search.best.gap, scratch)
    if met.found or not found.is_complete:
        lower_bound = -math.inf
        forget_front(front.fronts, front.pair)
    elif planes.n_waiting == 0:
        entries, bounds = scratch.entries, scratch.lower_bounds
        update_front(front.fronts, front.pair, queue.n_retained, entries, bounds, found.n_fresh)
    if search.progress.hides:  # hidden points are beyond the distance wanted, or refined
        lower_bound = min(lower_bound, min(search.best.gap, limits.wanted))
    tally = Tally(found.n_nodes, search.n_measured, scratch.exact.count[0] - n_exact)
    return NearestFaces(met, search.best.hit, lower_bound, refined, tally)
