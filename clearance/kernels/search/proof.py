"""A proven lower bound on the distance of two bodies that move, or that have errors: under a displacement.

A node pair is done once its bound exceeds the target: the least distance that occurs, less an allowed gap. Two
faces are bounded along the direction of their nearest points. Where the bound is far below the distance that
occurs, they are cut into pieces. Not for: choosing bodies and moments, and halving intervals.
"""

import math
from typing import NamedTuple

from clearance.compile.decorators import inline
from clearance.kernels.arithmetic.vec3 import Vec3, move_back
from clearance.kernels.features.bounds import (
    direction_between,
    direction_outward,
    lower_bound_faces_along_direction,
    margin_of,
)
from clearance.kernels.features.face_pair import may_meet, nearest_of_faces, nothing_yet
from clearance.kernels.features.meeting import meeting
from clearance.kernels.search.descent import (
    NodeQueue,
    cut_of,
    descend,
    from_front,
    is_over,
    put_roots,
    with_faces,
)
from clearance.kernels.search.displacement import (
    direction_of_search,
    errors_of_point_along,
    is_nearly_still,
    movement_of_point_along,
    prepare_along,
)
from clearance.kernels.search.front import LENGTH, forget_front, update_front
from clearance.kernels.search.moving_faces import bound_along, bound_in_search, movement_of_both
from clearance.kernels.search.node_pairs import Views, views_along
from clearance.kernels.search.pieces import bound_of_pieces

FINEST_GAP = 1e-3
"""Least share of the allowed gap: a limit nearer than that to the least distance stays undecided."""

STILL = 0.25
"""If the motion is less than this share of the gap and the target is missed, errors or rounding are the cause.
Halving cannot help then, and the bound stays as it is."""

CHAIN_SLACK = 8.0
"""Rounding slacks of a body pair that cover poses computed along a chain of links as well."""

FINEST = 1e-9
"""[m] No face pair is cut for less."""

AS_NEAR = 0.9
"""Faces with a greater bound than this share of the nearest distance so far are not the nearest ones."""

FIRST_FACES = 3
"""A search measures this many face pairs without trying another direction first."""

FACES = 8
"""Two faces cost as much as this many groups of nodes."""

GOING_ON, GIVEN_UP, IN_CONTACT = range(3)


class ProofGoal(NamedTuple):
    """The bound to prove for a pair.

    Attributes:
        target: [m] a node pair with a greater bound is done. least: [m] the least distance known to occur.
        gap: [m] allowed between the bound over an interval and the distance that occurs; 0 at a step.
        fail: [m] the limit.
        skin: [m] radii of balls and surface errors of both bodies; the search ignores them, the result does not.
        is_step: True for a moment without motion: then the search is never given up.
        ends_in_contact: True if the proof ends where bodies meet.
        exact_visits: at a step, after this many visits a bound is enough that is low by `refined`.
        refined: that share of the loss by errors at the nearest points.
    """

    target: float
    least: float
    gap: float
    fail: float
    skin: float
    is_step: bool
    ends_in_contact: bool
    exact_visits: int
    refined: float


class ProofStart(NamedTuple):
    """Where a search begins (frame of a): known nearest points, or any two points along a direction.

    Attributes:
        gap: [m] an upper bound on their distance if they are nearest points of two faces, else infinite.
    """

    p: Vec3
    q: Vec3
    gap: float
    face_a: int
    face_b: int


class ProofSearch(NamedTuple):
    """The state of a search, without the skin of the bodies.

    Attributes:
        views: along `direction_of_search`. u: the direction of the nearest points seen (frame of a).
        nearest: [m] the distance of these points. face_a, face_b: their faces, or -1.
        lower_bound: [m] of the faces visited. target, least: [m] as in `ProofGoal`. enough: [m] at a step, the
            bound that is enough after many visits.
        n_faces: face pairs measured. n_cut: those cut into pieces. state: `GOING_ON`, `GIVEN_UP`, `IN_CONTACT`.
    """

    views: Views
    u: Vec3
    nearest: float
    face_a: int
    face_b: int
    lower_bound: float
    target: float
    least: float
    enough: float
    n_faces: int
    n_cut: int
    state: int


class Proof(NamedTuple):
    """The result of a proof.

    Attributes:
        lower_bound: [m] proven, if the search was completed. least: [m] the least distance seen, or the given one.
        enough: [m] at a step, a bound as good as that.
        is_complete: False if only a shorter interval can prove the target. in_contact: True if bodies meet, which
            ends the proof.
        u: the direction of the nearest points seen (frame of a). face_a, face_b: their faces, or -1.
        n_nodes, n_faces, n_cut: node pairs bounded, face pairs measured and cut.
    """

    lower_bound: float
    least: float
    enough: float
    is_complete: bool
    in_contact: bool
    u: Vec3
    face_a: int
    face_b: int
    n_nodes: int
    n_faces: int
    n_cut: int


@inline
def allowed_gap(least, gap, fail):
    """[m] the gap allowed between the least distance seen and a bound; less where `fail` would stay undecided."""
    if least < fail:
        return gap
    return max(min(gap, 0.5 * (least - fail)), gap * FINEST_GAP)


@cut_of.register
def _(search: ProofSearch, goal, n_opened):
    if n_opened + FACES * search.n_faces > goal.exact_visits:
        return min(search.target, search.enough)
    return search.target


@is_over.register
def _(search: ProofSearch, goal, n_nodes):
    return search.state != GOING_ON


@inline(force=True)
def _near_by(loss, goal):
    """[m] the gap allowed at a step, for a loss by errors."""
    return max(FINEST, goal.refined * loss)


@inline(force=True)
def _with_value(search, value, loss, goal):
    """A search after it has seen a distance that occurs [m], with its loss by errors; that lowers the target."""
    target, least, enough, state = search.target, search.least, search.enough, search.state
    if goal.is_step:
        enough = min(enough, value - _near_by(loss, goal))
    elif value < least:
        target = min(target, value - allowed_gap(value - goal.skin, goal.gap, goal.fail))
    least = min(least, value)
    if goal.ends_in_contact and goal.skin > 0.0 and least <= goal.skin:
        state = IN_CONTACT
    return ProofSearch(
        search.views, search.u, search.nearest, search.face_a, search.face_b, search.lower_bound,
        target, least, enough, search.n_faces, search.n_cut, state,
    )  # fmt: skip


@inline(force=True)
def _with_bound(search, bound, state, n_faces, n_cut, goal):
    """A search after it has bounded two faces [m]; at a step that lowers the target."""
    target = min(search.target, bound) if goal.is_step else search.target
    return ProofSearch(
        search.views, search.u, search.nearest, search.face_a, search.face_b,
        min(search.lower_bound, bound), target, search.least, search.enough,
        search.n_faces + n_faces, search.n_cut + n_cut, max(state, search.state),
    )  # fmt: skip


@inline(force=True)
def _towards(search, direction, length, faces, displacement):
    """A search after it has found nearer points, along the prepared direction."""
    views = views_along(direction_of_search(displacement, direction), faces.frames.m)
    return ProofSearch(
        views, direction.u, length, faces.a, faces.b, search.lower_bound, search.target,
        search.least, search.enough, search.n_faces, search.n_cut, search.state,
    )  # fmt: skip


class _Effect(NamedTuple):
    """The loss at two points [m]: by errors, and by motion alone."""

    loss: float
    motion: float


@inline
def _effect_at(p, q, direction, m, displacement, goal):
    """The loss at two points (frame of a), along the prepared direction."""
    u, v, q = direction.u, direction.v, move_back(m, q)
    whole = movement_of_point_along(displacement, p, 0, u)
    whole += movement_of_point_along(displacement, q, 1, v)
    if goal.is_step:
        return _Effect(whole, 0.0)
    loss = errors_of_point_along(displacement, p, 0, u)
    loss += errors_of_point_along(displacement, q, 1, v)
    return _Effect(loss, max(0.0, whole - loss))


@inline
def _bound_outward(search, faces, known, displacement):
    """([m] a bound on two faces along the outward direction, True if they may be the nearest).

    Args:
        known: [m] a bound on them.
    """
    a, b = faces.surface_a, faces.surface_b
    direction = direction_outward(a, faces.a, b, faces.b, faces.frames.m, search.views.b.m)
    separation = lower_bound_faces_along_direction(a, faces.a, b, faces.b, direction)
    separation -= displacement.slack
    is_near = separation < AS_NEAR * search.nearest
    if separation <= known:  # a displacement only lowers it
        return known, is_near
    prepare_along(displacement, direction)
    return max(known, bound_along(faces, direction, displacement)), is_near


@with_faces.register
def _(search: ProofSearch, faces, bound, cut, displacement, goal, n_waiting, scratch):
    bound = max(bound, bound_in_search(faces, search.views.a.direction, displacement))
    is_near = False
    if bound <= cut and search.n_faces >= FIRST_FACES:
        bound, is_near = _bound_outward(search, faces, bound, displacement)
    if bound > cut and not is_near:
        return _with_bound(search, bound, GOING_ON, 0, 0, goal)
    return _measured(search, faces, bound, displacement, goal, scratch)


@inline
def _meet(faces, margin, scratch):
    """True if two faces have a point in common, by exact signs."""
    a, b = faces.surface_a, faces.surface_b
    if not may_meet(a, faces.a, b, faces.b, faces.frames.m, margin):
        return False
    return meeting(faces, scratch.exact).found


@inline
def _measured(search, faces, bound, displacement, goal, scratch):
    """The search after it has measured two faces."""
    a, b, m = faces.surface_a, faces.surface_b, faces.frames.m
    margin = margin_of(displacement.slack)
    near = nearest_of_faces(a, faces.a, b, faces.b, m, margin, nothing_yet(math.inf)).best
    direction = direction_between(near.p, near.q, m)
    prepare_along(displacement, direction)
    separation = lower_bound_faces_along_direction(a, faces.a, b, faces.b, direction)
    separation -= displacement.slack
    length = math.sqrt(near.gap_sq)
    if separation <= 0.0 and goal.ends_in_contact and _meet(faces, margin, scratch):
        search = _towards(search, direction, length, faces, displacement)
        return _with_bound(search, 0.0, IN_CONTACT, 1, 0, goal)
    if separation <= 0.0 and not goal.ends_in_contact:  # they may touch
        moved = movement_of_both(faces, displacement)
        search = _with_value(search, -moved, moved, goal)
        return _with_bound(search, max(bound, -moved), GOING_ON, 1, 0, goal)
    bound = max(bound, bound_along(faces, direction, displacement))
    point = _effect_at(near.p, near.q, direction, m, displacement, goal)
    value = length + margin - point.loss
    if length < search.nearest:
        search = _towards(search, direction, length, faces, displacement)
    search = _with_value(search, value, point.loss, goal)
    if bound < search.target:
        bound = max(bound, separation - movement_of_both(faces, displacement))
    wanted, allowed = search.target, _near_by(point.loss, goal)
    if goal.is_step:
        wanted = min(wanted, search.enough)
    else:
        allowed = allowed_gap(search.least - goal.skin, goal.gap, goal.fail)
    state, n_cut = GOING_ON, 0
    if bound < wanted:
        still = goal.is_step or is_nearly_still(displacement, point.motion, STILL * allowed)
        if still or value - point.motion >= wanted:
            n_cut = 1
            cut = bound_of_pieces(faces, displacement, bound, wanted, allowed, scratch.pieces)
            bound = max(bound, cut.lower_bound)
            search = _with_value(search, cut.least + margin, point.loss, goal)
        if bound < search.target and not still:
            state = GIVEN_UP
    return _with_bound(search, bound, state, 1, n_cut, goal)


@inline
def _begin(start, m, displacement, goal):
    """A search at its start."""
    direction = direction_between(start.p, start.q, m)
    prepare_along(displacement, direction)
    views = views_along(direction_of_search(displacement, direction), m)
    search = ProofSearch(
        views, direction.u, start.gap, start.face_a, start.face_b, math.inf, goal.target + goal.skin,
        goal.least + goal.skin, math.inf, 0, 0, GOING_ON,
    )  # fmt: skip
    if start.gap == math.inf:
        return search
    loss = _effect_at(start.p, start.q, direction, m, displacement, goal).loss
    return _with_value(search, start.gap - loss, loss, goal)


@inline(force=True)
def _without_skin(length, skin):
    """[m] a bound less the skin of the bodies, rounded down."""
    return length - skin - 2.0**-50 * (abs(length) + skin) if skin > 0.0 else length


@inline
def prove(roots, displacement, start, goal, front, scratch):
    """A lower bound on the distance of two bodies under a displacement, as close as the goal asks.

    The proof is given up where only a shorter interval can complete it.

    Args:
        roots: of the bodies' trees, of surfaces in which every face owns all its features, so that a face pair is
            measured completely. start: a `ProofStart`. goal: a `ProofGoal`.
        front: a `PairFront`; it is neither read nor updated where `moved` is infinite.
    """
    search = _begin(start, roots.frames.m, displacement, goal)
    fronts, pair, moved = front.fronts, front.pair, front.moved
    put_roots(roots, -math.inf, scratch)
    queue = NodeQueue(0, 1, 0, math.inf)
    if moved < math.inf and fronts.spans[pair, LENGTH] > 0:
        cut = cut_of(search, goal, 0)
        queue = from_front(roots, search.views, displacement, cut, front, scratch)
    found = descend(roots, displacement, search, goal, queue, moved, scratch)
    search = found.search
    lower_bound = _without_skin(min(found.lower_bound, search.lower_bound), goal.skin)
    least = search.least - goal.skin if search.least < goal.least + goal.skin else goal.least
    if search.state == IN_CONTACT:
        lower_bound, least = 0.0, 0.0
    if search.state == GIVEN_UP:
        lower_bound = -math.inf
    if moved < math.inf and search.state != GOING_ON:
        forget_front(fronts, pair)
    elif moved < math.inf:
        entries, bounds = scratch.entries, scratch.lower_bounds
        update_front(fronts, pair, queue.n_retained, entries, bounds, found.n_fresh)
    return Proof(
        lower_bound, least, search.enough - goal.skin, search.state != GIVEN_UP,
        search.state == IN_CONTACT, search.u, search.face_a, search.face_b, found.n_nodes,
        search.n_faces, search.n_cut,
    )  # fmt: skip
