"""The distance of two bodies: descent of their trees, then containment, then the radii of clouds."""

from typing import NamedTuple

import numpy as np

from clearance.compile.decorators import inline, kernel
from clearance.kernels.arithmetic.double_double import (
    Wide3,
    plus3,
    rounded,
    wide,
)
from clearance.kernels.arithmetic.vec3 import Vec3, move, row
from clearance.kernels.features.bounds import margin_of, rounding_slack
from clearance.kernels.features.common_point import common_point
from clearance.kernels.features.face_pair import (
    NOTHING_SEEN,
    FacePairState,
    Hit,
    nearest_of_faces,
    nothing_yet,
)
from clearance.kernels.features.posed_pair import PosedPair, parts
from clearance.kernels.features.refine import error_of
from clearance.kernels.features.rounding_guard import PASSED_OVER
from clearance.kernels.mesh.surface import box_of
from clearance.kernels.search.balls import less_balls, radii_of
from clearance.kernels.search.carried import NO_FACE
from clearance.kernels.search.containment import contained
from clearance.kernels.search.front import (
    HULLS_NEARER,
    HULLS_TOUCH,
    PairFront,
    forget_front,
    is_worth_separating,
    note_separating_planes,
)
from clearance.kernels.search.nearest import SearchLimits, Tally, nearest_faces
from clearance.kernels.search.overlap import Overlap, overlap
from clearance.kernels.search.scratch import Scratch
from clearance.kernels.search.separating_planes import NOT_SEPARATED, separate

TO_THE_END = 2**62
"""The effort of a search that is not cut short."""


class PairQuestion(NamedTuple):
    """A question about a body pair.

    Attributes:
        limit: [m] the search stops once its lower bound exceeds this.
        wanted: [m] points with a greater distance are not returned; at most `limit`.
        face_a, face_b: faces that were nearest before, or NO_FACE; they change the work, not the answer.
        not_nested: True if neither body is known to be inside the other.
        touches: True if the bodies were in contact just before; it changes the work, not the answer.
        effort: the search ends after this many node pairs. Its distance then occurs, but may not be the least,
            and nothing is proven. `TO_THE_END` to search everything.
    """

    limit: float
    wanted: float
    face_a: int
    face_b: int
    not_nested: bool
    effort: int
    touches: bool


class PairDistance(NamedTuple):
    """The answer about a body pair.

    Attributes:
        hit: the nearest points in the world; faces of 2**62 if they are farther than the distance wanted.
        lower_bound: [m] proven.
        error: [m] a bound on the error of the distance of `hit`.
        face_a, face_b: the nearest faces met, within the limit or not: the next search begins there.
    """

    hit: Hit
    lower_bound: float
    error: float
    face_a: int
    face_b: int
    tally: Tally


@inline
def _in_world(frames, x):
    """A point in the world, given from the origin of a."""
    t = frames.a.t
    return rounded(plus3(x, Wide3(wide(t.x), wide(t.y), wide(t.z))))


@inline
def _face_contact(bodies, found, tally):
    face_a, face_b = found.face_a, found.face_b
    common = common_point(parts(bodies, face_a, face_b), found.meeting)
    p, q = _in_world(bodies.frames, common.p), _in_world(bodies.frames, common.q)
    return PairDistance(Hit(0.0, face_a, face_b, p, q), 0.0, 0.0, face_a, face_b, tally)


@inline
def _ball_contact(frames, found, radii, tally):
    """The contact of a ball with the first face found within its radius, or of two balls."""
    hit = found.hit
    _, _, x, _ = less_balls(wide(np.sqrt(hit.gap_sq)), 0.0, hit.p, hit.q, radii)
    x = move(frames.a, x)
    touching = Hit(0.0, found.face_a, found.face_b, x, x)
    return PairDistance(touching, 0.0, 0.0, found.face_a, found.face_b, tally)


@inline
def _question_of_centres(question, radii):
    """The same question about the points of clouds instead of their balls."""
    wider = radii.both
    return PairQuestion(
        question.limit + wider, question.wanted + wider, question.face_a, question.face_b,
        question.not_nested, question.effort, question.touches,
    )  # fmt: skip


NOWHERE = Vec3(0.0, 0.0, 0.0)

NOTHING_MEASURED = PairDistance(
    Hit(np.inf, NO_FACE, NO_FACE, NOWHERE, NOWHERE), 0.0, 0.0, NO_FACE, NO_FACE, Tally(0, 0, 0)
)


@inline(force=True)
def _from_centres(a, root_a, b, root_b, m):
    """The start of a search that knows nothing: the bodies' centres."""
    p, q = box_of(a, root_a).centre, move(m, box_of(b, root_b).centre)
    return FacePairState(Hit(np.inf, 2**62, 2**62, p, q), NOTHING_SEEN)


@inline(force=True)
def _first_faces(a, root_a, b, root_b, m, margin, question):
    """The start of a search: the faces that were nearest, measured, or the bodies' centres."""
    if question.face_a >= 0:
        near = nearest_of_faces(
            a, question.face_a, b, question.face_b, m, margin, nothing_yet(np.inf)
        )
        if near.best.face_a != 2**62:
            return near
        p = row(a.vertices, a.face_vertices[a.face_starts[question.face_a]])
        q = row(b.vertices, b.face_vertices[b.face_starts[question.face_b]])
        return FacePairState(Hit(np.inf, 2**62, 2**62, p, move(m, q)), NOTHING_SEEN)
    return _from_centres(a, root_a, b, root_b, m)


@inline
def _seek_planes(roots, best, limit, slack, front, scratch):
    """Planes that separate the bodies, if seeking them may cost less than visiting the front."""
    fronts, pair = front.fronts, front.pair
    if not is_worth_separating(fronts, pair):
        return NOT_SEPARATED
    planes = separate(roots, best, limit, slack, scratch)
    if planes.n_waiting == 0:
        note_separating_planes(fronts, pair, planes.lower_bound > limit, HULLS_TOUCH)
    return planes


@inline
def _balls_overlap(found, radii):
    """True if the nearest centres are closer than the radii of their balls."""
    refined = found.refined
    return radii.both > 0.0 and refined.face_a != 2**62 and refined.length.hi <= radii.both


@inline
def _distance_by_planes(planes, question, slack, radii, tally):
    """The answer where planes separate the bodies by more than the limit."""
    nothing = nothing_yet(question.wanted * question.wanted)
    lower_bound = max(0.0, planes.lower_bound - slack - 2.0 * margin_of(slack) - radii.both)
    return PairDistance(nothing, lower_bound, 0.0, planes.face_a, planes.face_b, tally)


@inline
def _distance_by_descent(found, question, frames, slack, radii, tally):
    """The answer of a descent without contact."""
    lower_bound = max(0.0, found.lower_bound - slack - 2.0 * margin_of(slack) - radii.both)
    face_a, face_b = found.hit.face_a, found.hit.face_b
    if face_a == 2**62:
        face_a, face_b = question.face_a, question.face_b
    refined = found.refined
    if refined.face_a == 2**62:
        nothing = nothing_yet(question.wanted * question.wanted)
        return PairDistance(nothing, lower_bound, 0.0, face_a, face_b, tally)
    distance = refined.length.hi
    error = error_of(refined, distance) + PASSED_OVER * distance
    p, q = _in_world(frames, refined.p), _in_world(frames, refined.q)
    if radii.both > 0.0:
        distance, error, p, q = less_balls(refined.length, error, p, q, radii)
    hit = Hit(distance * distance, refined.face_a, refined.face_b, p, q)
    lower_bound = min(lower_bound, max(0.0, distance - error))
    return PairDistance(hit, lower_bound, error, refined.face_a, refined.face_b, tally)


@kernel
def search(
    bodies: PosedPair, question: PairQuestion, front: PairFront, scratch: Scratch
) -> PairDistance:
    """The nearest points of two bodies, or a proof that they are farther apart than the limit.

    Args:
        bodies: a `PosedPair` of bodies.
        front: a `PairFront`. Its bounds are of the points of clouds, before radii are subtracted.
    """
    a, b = bodies.surface_a, bodies.surface_b
    radii = radii_of(a, bodies.a, b, bodies.b)
    question = _question_of_centres(question, radii)
    frames, fronts, pair = bodies.frames, front.fronts, front.pair
    roots = parts(bodies, a.roots[bodies.a], b.roots[bodies.b])
    slack = rounding_slack(a, roots.a, b, roots.b, frames)
    margin = margin_of(slack)
    n_nodes, n_faces, n_exact = 0, 0, 0
    if question.touches:
        over = overlap(roots, slack, radii.both, scratch)
        n_nodes, n_faces = over.n_nodes, over.n_faces
        if over.face_a != NO_FACE:
            forget_front(fronts, pair)
            tally = Tally(n_nodes, n_faces, 0)
            if radii.both > 0.0:
                return _ball_contact(frames, over, radii, tally)
            return _face_contact(bodies, over, tally)
    first = _first_faces(a, roots.a, b, roots.b, frames.m, margin, question)
    limit = question.limit + margin
    planes = _seek_planes(roots, first.best, limit, slack, front, scratch)
    n_nodes += planes.n_nodes
    if planes.lower_bound > limit:
        return _distance_by_planes(planes, question, slack, radii, Tally(n_nodes, 0, 0))
    limits = SearchLimits(limit, question.wanted, slack, question.effort, first)
    best = first.best
    for _ in range(2):
        found = nearest_faces(roots, best, limits, planes, front, scratch)
        n_nodes, n_faces = n_nodes + found.tally.nodes, n_faces + found.tally.faces
        n_exact += found.tally.exact_decisions
        if planes.n_waiting == 0:
            break
        is_proven = planes.beyond > min(limit, np.sqrt(found.hit.gap_sq)) + margin
        note_separating_planes(fronts, pair, is_proven, HULLS_NEARER)
        if is_proven:
            break
        best, planes = found.hit, NOT_SEPARATED  # the hulls are nearer than the bodies
    if found.meeting.found or _balls_overlap(found, radii):
        # the contact returned must not depend on where the search began
        over = overlap(roots, slack, radii.both, scratch)
        n_nodes, n_faces = n_nodes + over.n_nodes, n_faces + over.n_faces
        tally = Tally(n_nodes, n_faces, n_exact)
        if radii.both > 0.0 and over.face_a != NO_FACE:
            forget_front(fronts, pair)
            return _ball_contact(frames, over, radii, tally)
        if found.meeting.found:
            if not over.meeting.found:
                best = found.hit
                over = Overlap(found.meeting, best, best.face_a, best.face_b, 0, 0)
            return _face_contact(bodies, over, tally)
    tally = Tally(n_nodes, n_faces, n_exact)
    if not (question.not_nested or planes.n_waiting > 0):
        inside, x = contained(a, bodies.a, b, bodies.b, frames, scratch)
        if inside:
            forget_front(fronts, pair)  # a contact must not depend on where the search begins
            x = move(frames.a, x)
            return PairDistance(Hit(0.0, NO_FACE, NO_FACE, x, x), 0.0, 0.0, NO_FACE, NO_FACE, tally)
    return _distance_by_descent(found, question, frames, slack, radii, tally)
