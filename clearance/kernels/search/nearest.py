"""The exact nearest faces of two bodies that stand, or a proof that they are far.

Two faces are measured in doubles. Those that can be the nearest wait, and are refined at the end. A pair of nodes
or faces is passed over only if a lower bound exceeds the best distance by more than its own error. So every face
pair that attains the minimum is refined, and the answer does not depend on the order. The first contact ends it.
Not for: which faces are visited (`descent`).
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
from clearance.kernels.features.rounding_guard import sure_gap, told_apart
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
from clearance.kernels.search.front import forget, keep
from clearance.kernels.search.node_pairs import Views, views_of
from clearance.kernels.search.scratch import swap
from clearance.kernels.search.warm_start import warm_start


class SearchLimits(NamedTuple):
    """How far a search goes.

    Attributes:
        limit: [m] node pairs farther than this, or than the best, are not opened.
        wanted: [m] face pairs farther apart are not refined.
        slack: [m] of `rounding_slack`.
        effort: node pairs after which it stops with what is within its limit so far, and proves nothing.
        first: the hit of two faces that are measured already, and what was seen of them.
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
        hit: the best pair of points in doubles, within the limit or not, no worse than what was given.
        lower_bound: [m] a lower bound on the distance of the face pairs that were not refined.
        refined: the answer in double-double, if there is one within the limit.
    """

    meeting: Meeting
    hit: Hit
    lower_bound: float
    refined: RefinedDistance
    tally: Tally


class Best(NamedTuple):
    """The best pair of points so far, and what follows from it.

    Attributes:
        gap: [m] theirs, or the limit if that is less. cut: [m] the cut-off distance.
    """

    hit: Hit
    gap: float
    cut: float


class RefineProgress(NamedTuple):
    """The face pairs that could be the minimum.

    Attributes:
        n_waiting: so many wait. refined: the best of those that waited before.
        hides: True if rounding may hide nearer points of one that waits than were seen.
    """

    n_waiting: int
    refined: RefinedDistance
    hides: bool


class NearestSearch(NamedTuple):
    """What is known from the face pairs that were visited.

    Attributes:
        views: the bodies seen in the direction from one of the best points to the other.
        lower_bound: [m] of those that were passed over. n_measured: how many were measured.
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
    """What follows from a pair of points."""
    gap = min(limits.limit, math.sqrt(hit.gap_sq))
    return Best(hit, gap, gap + margin_of(limits.slack))


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
def _settle_waiting(bodies, search, limits, least, scratch):
    """The best after all face pairs that wait; no two are nearer than `least` [m] but for rounding."""
    best, progress = search.best, search.progress
    refine_bounds = RefineBounds(search.views.a.direction, limits.slack, least)
    cutoff = FeatureCutoff(min(best.gap, limits.wanted), margin_of(limits.slack))
    return settle(
        bodies, scratch.waiting, progress.n_waiting, cutoff, refine_bounds, progress.refined
    )


@inline(force=True)
def _let_wait(a, b, faces, seen, least_sq, search, limits, scratch):
    """Lets a face pair wait to be refined; where too many wait, those are refined that can still win.

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
    apart = lower_bound_faces_along_direction(a, face_a, b, face_b, direction) - slack
    if apart > before.cut:
        lower_bound = min(lower_bound, apart)
    elif before.hit.gap_sq > limits.limit * limits.limit or may_own_nearest(
        a, face_a, b, face_b, direction, apart, before.gap, margin
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
            apart = lower_bound_faces_along_direction(a, face_a, b, face_b, direction) - slack
        gap = sure_gap(a, face_a, b, face_b, m, margin, apart)
        if bound <= 0.0 and gap <= 0.0:
            met = meeting(faces, scratch.exact)
        if met.found:
            best = Best(Hit(0.0, face_a, face_b, m.t, m.t), best.gap, best.cut)
        else:
            if n_waiting > 1 and best.gap < before.gap:
                _nearest_last(scratch, n_waiting)
            least_sq = measured.seen.near_sq
            is_told = told_apart(a, face_a, b, face_b, gap, margin)
            if not is_told:  # nearer ones may be hidden
                least_sq = min(least_sq, max(0.0, gap) * max(0.0, gap))
            reach = limit_of(a, face_a, b, face_b, before.gap, margin)
            may_win = least_sq < math.inf and least_sq <= reach * reach
            if may_win:
                known = NearestSearch(best, views, progress, met, lower_bound, n_measured)
                progress = _let_wait(a, b, faces, measured.seen, least_sq, known, limits, scratch)
            if may_win and not is_told:
                progress = RefineProgress(progress.n_waiting, progress.refined, True)
            elif least_sq < math.inf:
                seen = math.sqrt(least_sq)
                left = 2.0 * seen - limit_of(a, face_a, b, face_b, seen, margin)
                lower_bound = min(lower_bound, left)
            else:
                lower_bound = min(lower_bound, math.sqrt(best.hit.gap_sq) + margin)
    return NearestSearch(best, views, progress, met, lower_bound, n_measured)


@inline
def _begin(roots, still, search, planes, front, scratch):
    """What waits first: what the separating planes or the front have left, or the roots."""
    if planes.n_waiting > 0:
        return NodeQueue(0, planes.n_waiting, 0, planes.beyond)
    if front.fronts.spans[front.pair, 1] > 0:
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
        hit: where to start, or none; its points say in which direction the bodies are seen apart, also where they
            are farther apart than the limit.
        limits: a `SearchLimits`.
        planes: of `SeparatingPlanes`; if leaves wait already, only these are visited, and nothing else is nearer
            than it says.
        front: of `PairFront`, where the front of the pair is kept.
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
        forget(front.fronts, front.pair)
    elif planes.n_waiting == 0:
        left, bounds = scratch.left, scratch.lower_bounds
        keep(front.fronts, front.pair, queue.n_kept, left, bounds, found.n_left)
    if search.progress.hides:  # they are no nearer than what is wanted, or refined
        lower_bound = min(lower_bound, min(search.best.gap, limits.wanted))
    tally = Tally(found.n_nodes, search.n_measured, scratch.exact.count[0] - n_exact)
    return NearestFaces(met, search.best.hit, lower_bound, refined, tally)
