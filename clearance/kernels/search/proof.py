"""A proven lower bound on the distance of two bodies that move, or that have errors: under a displacement.

A node pair is done if its bound is above the target: the least distance that occurs, less an allowed gap.
Two faces are bounded along the direction of their nearest points. Where that is far below what occurs, they are
cut into pieces. Not for: which bodies and moments are asked, and halving intervals.
"""

import math
from typing import NamedTuple

from clearance.compile.decorators import inline
from clearance.kernels.arithmetic.lanes import WIDTH
from clearance.kernels.arithmetic.vec3 import Vec3, dot, move_back, row
from clearance.kernels.features.bounds import (
    direction_beside,
    direction_between,
    lower_bound_faces_along_direction,
    margin_of,
)
from clearance.kernels.features.face_pair import may_meet, nearest_of_faces, nothing_yet
from clearance.kernels.features.meeting import meeting
from clearance.kernels.mesh.corners import corners_at, greatest_in, least_in
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
    movement_of_point,
    movement_of_point_along,
    movement_of_point_in_search,
    prepare_along,
)
from clearance.kernels.search.front import forget, keep
from clearance.kernels.search.node_pairs import Views, views_along
from clearance.kernels.search.pieces import bound_of_pieces

FINEST_GAP = 1e-3
"""The share of the asked gap beyond which a limit that is touched is left undecided."""

STILL = 0.25
"""Where motion moves less than this share of the gap and the target is missed, errors or rounding are to blame:
halving cannot help, and the bound stands as it is."""

CHAIN_SLACK = 8.0
"""Rounding slacks of a body pair that cover poses computed along a chain of links as well."""

FINEST = 1e-9
"""[m] No face pair is cut for less."""

AS_NEAR = 0.9
"""Faces that are seen to be farther apart than this share of the nearest so far are not the nearest ones."""

FIRST_FACES = 3
"""Face pairs that a search measures, whatever is seen beside them: what occurs is below."""

FACES = 8
"""As many groups of nodes take as long as two faces."""

GOING_ON, GIVEN_UP, IN_CONTACT = range(3)


class Goal(NamedTuple):
    """What is to be proven of a pair.

    Attributes:
        target: [m] what stays above it is done. least: [m] the least that is known to occur.
        gap: [m] how far the bound over an interval may stay below what occurs, 0 at a step. fail: [m] the limit.
        thin: [m] balls and surfaces about both bodies: the search is of what they are about.
        is_step: True where all stands: then the bound is never given up.
        ends_in_contact: True where bodies that meet leave nothing to prove.
        exact_visits: at a step, as many visits are made before what is `refined` below what occurs is enough.
        refined: that share of what errors take there.
    """

    target: float
    least: float
    gap: float
    fail: float
    thin: float
    is_step: bool
    ends_in_contact: bool
    exact_visits: int
    refined: float


class Start(NamedTuple):
    """Where a search begins (frame of a): nearest points that are known, or two that differ along a direction.

    Attributes:
        gap: [m] no less than their distance where they are known to be the nearest of two faces, else infinite.
    """

    p: Vec3
    q: Vec3
    gap: float
    face_a: int
    face_b: int


class ProofSearch(NamedTuple):
    """What a search has come to, without what is about the bodies.

    Attributes:
        views: along `direction_of_search`. u: the direction of the nearest points seen (frame of a).
        nearest: [m] the distance of those. face_a, face_b: they are on these, or -1.
        lower_bound: [m] of the faces visited. target, least: [m] as in `Goal`. enough: [m] at a step, what is
            a share of what errors take below what occurs.
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
    """What is proven of a pair.

    Attributes:
        lower_bound: [m] proven, if the search was completed. least: [m] the least seen to occur, or as asked.
        enough: [m] at a step, what is as good as that.
        is_complete: False where the target cannot be proven without a shorter interval. in_contact: True where
            bodies meet and nothing is left to prove.
        u: the direction of the nearest points seen (frame of a). face_a, face_b: they are on these, or -1.
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
    """[m] how far below the least distance seen a bound may stay: less where that leaves `fail` undecided."""
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
def _near_by(taken, goal):
    """[m] how far below what occurs a bound at a step may stay, where errors take so much."""
    return max(FINEST, goal.refined * taken)


@inline(force=True)
def _with_value(search, value, taken, goal):
    """A search that has seen what occurs [m], of which errors take so much; that moves the target."""
    target, least, enough, state = search.target, search.least, search.enough, search.state
    if goal.is_step:
        enough = min(enough, value - _near_by(taken, goal))
    elif value < least:
        target = min(target, value - allowed_gap(value - goal.thin, goal.gap, goal.fail))
    least = min(least, value)
    if goal.ends_in_contact and goal.thin > 0.0 and least <= goal.thin:
        state = IN_CONTACT
    return ProofSearch(
        search.views, search.u, search.nearest, search.face_a, search.face_b, search.lower_bound,
        target, least, enough, search.n_faces, search.n_cut, state,
    )  # fmt: skip


@inline(force=True)
def _with_bound(search, bound, state, n_faces, n_cut, goal):
    """A search that has bounded two faces [m]; at a step that moves the target."""
    target = min(search.target, bound) if goal.is_step else search.target
    return ProofSearch(
        search.views, search.u, search.nearest, search.face_a, search.face_b,
        min(search.lower_bound, bound), target, search.least, search.enough,
        search.n_faces + n_faces, search.n_cut + n_cut, max(state, search.state),
    )  # fmt: skip


@inline(force=True)
def _towards(search, direction, length, faces, displacement):
    """A search that sees along the prepared direction of nearer points than before."""
    views = views_along(direction_of_search(displacement, direction), faces.frames.m)
    return ProofSearch(
        views, direction.u, length, faces.a, faces.b, search.lower_bound, search.target,
        search.least, search.enough, search.n_faces, search.n_cut, search.state,
    )  # fmt: skip


class _Faces(NamedTuple):
    """Two faces whole: [m] a bound under the displacement, and one on their distance, along one direction."""

    bound: float
    apart: float


@inline(force=True)
def _along(faces, direction, displacement):
    """Two faces along the prepared direction."""
    a, b, slack = faces.surface_a, faces.surface_b, displacement.slack
    u, v = direction.u, direction.v
    far = beyond = -math.inf
    end = a.face_starts[faces.a + 1]
    for c in range(a.face_starts[faces.a], end, WIDTH):
        x = corners_at(a, c, end)
        height = dot(u, x)
        far = max(far, greatest_in(height + movement_of_point_along(displacement, x, 0, u)))
        beyond = max(beyond, greatest_in(height))
    first = before = math.inf
    end = b.face_starts[faces.b + 1]
    for c in range(b.face_starts[faces.b], end, WIDTH):
        x = corners_at(b, c, end)
        height = dot(v, x)
        first = min(first, least_in(height - movement_of_point_along(displacement, x, 1, v)))
        before = min(before, least_in(height))
    return _Faces(
        first + direction.offset - far - slack, before + direction.offset - beyond - slack
    )


@inline(force=True)
def _in_search(faces, direction, displacement):
    """[m] a bound on two faces along the direction of the search."""
    a, b = faces.surface_a, faces.surface_b
    u, v = direction.u, direction.v
    far, near = -math.inf, math.inf
    end = a.face_starts[faces.a + 1]
    for c in range(a.face_starts[faces.a], end, WIDTH):
        x = corners_at(a, c, end)
        far = max(far, greatest_in(dot(u, x) + movement_of_point_in_search(displacement, x, 0, u)))
    end = b.face_starts[faces.b + 1]
    for c in range(b.face_starts[faces.b], end, WIDTH):
        x = corners_at(b, c, end)
        near = min(near, least_in(dot(v, x) - movement_of_point_in_search(displacement, x, 1, v)))
    return near + direction.offset - far - displacement.slack


@inline
def _movement_of_face(surface, face, side, displacement):
    moved = 0.0
    for c in range(surface.face_starts[face], surface.face_starts[face + 1]):
        x = row(surface.vertices, surface.face_vertices[c])
        moved = max(moved, movement_of_point(displacement, x, side))
    return moved


@inline
def _movement_of_both(faces, displacement):
    """[m] how far two faces come together at most."""
    moved = _movement_of_face(faces.surface_a, faces.a, 0, displacement)
    return moved + _movement_of_face(faces.surface_b, faces.b, 1, displacement)


class _Effect(NamedTuple):
    """Two points: [m] what errors take of their distance, and what motion takes beside them."""

    taken: float
    motion: float


@inline
def _effect_at(p, q, direction, m, displacement, goal):
    """What is taken at two points (frame of a), along the prepared direction."""
    u, v, q = direction.u, direction.v, move_back(m, q)
    whole = movement_of_point_along(displacement, p, 0, u)
    whole += movement_of_point_along(displacement, q, 1, v)
    if goal.is_step:
        return _Effect(whole, 0.0)
    taken = errors_of_point_along(displacement, p, 0, u)
    taken += errors_of_point_along(displacement, q, 1, v)
    return _Effect(taken, max(0.0, whole - taken))


@inline
def _beside(search, faces, known, displacement):
    """([m] a bound on two faces along a direction in which they are probably apart, True if they may be nearest).

    Args:
        known: [m] a bound on them.
    """
    a, b = faces.surface_a, faces.surface_b
    direction = direction_beside(a, faces.a, b, faces.b, faces.frames.m, search.views.b.m)
    apart = lower_bound_faces_along_direction(a, faces.a, b, faces.b, direction)
    apart -= displacement.slack
    is_near = apart < AS_NEAR * search.nearest
    if apart <= known:  # a displacement only takes of it
        return known, is_near
    prepare_along(displacement, direction)
    return max(known, _along(faces, direction, displacement).bound), is_near


@with_faces.register
def _(search: ProofSearch, faces, bound, cut, displacement, goal, n_waiting, scratch):
    bound = max(bound, _in_search(faces, search.views.a.direction, displacement))
    is_near = False
    if bound <= cut and search.n_faces >= FIRST_FACES:
        bound, is_near = _beside(search, faces, bound, displacement)
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
    """The search after two faces that are measured."""
    a, b, m = faces.surface_a, faces.surface_b, faces.frames.m
    margin = margin_of(displacement.slack)
    near = nearest_of_faces(a, faces.a, b, faces.b, m, margin, nothing_yet(math.inf)).best
    direction = direction_between(near.p, near.q, m)
    prepare_along(displacement, direction)
    whole = _along(faces, direction, displacement)
    length = math.sqrt(near.gap_sq)
    if whole.apart <= 0.0 and goal.ends_in_contact and _meet(faces, margin, scratch):
        search = _towards(search, direction, length, faces, displacement)
        return _with_bound(search, 0.0, IN_CONTACT, 1, 0, goal)
    if whole.apart <= 0.0 and not goal.ends_in_contact:  # they may touch
        moved = _movement_of_both(faces, displacement)
        search = _with_value(search, -moved, moved, goal)
        return _with_bound(search, max(bound, -moved), GOING_ON, 1, 0, goal)
    bound = max(bound, whole.bound)
    point = _effect_at(near.p, near.q, direction, m, displacement, goal)
    value = length + margin - point.taken
    if length < search.nearest:
        search = _towards(search, direction, length, faces, displacement)
    search = _with_value(search, value, point.taken, goal)
    if bound < search.target:
        bound = max(bound, whole.apart - _movement_of_both(faces, displacement))
    wanted, allowed = search.target, _near_by(point.taken, goal)
    if goal.is_step:
        wanted = min(wanted, search.enough)
    else:
        allowed = allowed_gap(search.least - goal.thin, goal.gap, goal.fail)
    state, n_cut = GOING_ON, 0
    if bound < wanted:
        still = goal.is_step or is_nearly_still(displacement, point.motion, STILL * allowed)
        if still or value - point.motion >= wanted:
            n_cut = 1
            cut = bound_of_pieces(faces, displacement, bound, wanted, allowed, scratch.pieces)
            bound = max(bound, cut.lower_bound)
            search = _with_value(search, cut.least + margin, point.taken, goal)
        if bound < search.target and not still:
            state = GIVEN_UP
    return _with_bound(search, bound, state, 1, n_cut, goal)


@inline
def _begin(start, m, displacement, goal):
    """A search that has seen nothing but its start."""
    direction = direction_between(start.p, start.q, m)
    prepare_along(displacement, direction)
    views = views_along(direction_of_search(displacement, direction), m)
    search = ProofSearch(
        views, direction.u, start.gap, start.face_a, start.face_b, math.inf, goal.target + goal.thin,
        goal.least + goal.thin, math.inf, 0, 0, GOING_ON,
    )  # fmt: skip
    if start.gap == math.inf:
        return search
    taken = _effect_at(start.p, start.q, direction, m, displacement, goal).taken
    return _with_value(search, start.gap - taken, taken, goal)


@inline(force=True)
def _without(length, thin):
    """[m] a bound without what is about the bodies, and without the rounding of that."""
    return length - thin - 2.0**-50 * (abs(length) + thin) if thin > 0.0 else length


@inline
def prove(roots, displacement, start, goal, front, scratch):
    """A lower bound on the distance of two bodies under a displacement, within what the goal allows.

    It is given up where that cannot be proven and a shorter interval would help.

    Args:
        roots: of the bodies' trees, of surfaces in which every face owns all its features, so that a face pair is
            seen whole. start: a `Start`. goal: a `Goal`.
        front: a `PairFront`; it is not gone on from, and not kept, where `moved` is infinite.
    """
    search = _begin(start, roots.frames.m, displacement, goal)
    fronts, pair, moved = front.fronts, front.pair, front.moved
    put_roots(roots, -math.inf, scratch)
    queue = NodeQueue(0, 1, 0, math.inf)
    if moved < math.inf and fronts.spans[pair, 1] > 0:
        cut = cut_of(search, goal, 0)
        queue = from_front(roots, search.views, displacement, cut, front, scratch)
    found = descend(roots, displacement, search, goal, queue, moved, scratch)
    search = found.search
    lower_bound = _without(min(found.lower_bound, search.lower_bound), goal.thin)
    least = search.least - goal.thin if search.least < goal.least + goal.thin else goal.least
    if search.state == IN_CONTACT:
        lower_bound, least = 0.0, 0.0
    if search.state == GIVEN_UP:
        lower_bound = -math.inf
    if moved < math.inf and search.state != GOING_ON:
        forget(fronts, pair)
    elif moved < math.inf:
        left, bounds = scratch.left, scratch.lower_bounds
        keep(fronts, pair, queue.n_kept, left, bounds, found.n_left)
    return Proof(
        lower_bound, least, search.enough - goal.thin, search.state != GIVEN_UP,
        search.state == IN_CONTACT, search.u, search.face_a, search.face_b, found.n_nodes,
        search.n_faces, search.n_cut,
    )  # fmt: skip
