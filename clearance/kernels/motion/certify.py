"""A proven lower bound on the clearance of the continuous motion between two steps.

In the middle of an interval the trees are descended as for a distance, but each bound is lowered by how far
the bodies can move in the interval: along the direction of the nearest points where two faces or boxes are
seen apart, so that sliding past costs nothing in the first order. Nodes that are turned away in all of the
interval are passed over (`normal_cones`): at its first instant the distance is above 0, or nothing is asked.
What does not stay above the target is halved, the earlier half first; after `most_parts` of them the target of a
pair is lowered until it can be proven, so that all ends. A bound on a pair holds for later intervals less what
its bodies move in them: pairs that it keeps above the target are not asked.

Not for: one pair over one interval (`twist`), the steps themselves (`sweep`).
"""

import math
from typing import NamedTuple

import numpy as np

from clearance.compile.declared import Floats, Integers
from clearance.compile.decorators import inline, kernel
from clearance.compile.lending import lend
from clearance.kernels.arithmetic.double_double import frames_of
from clearance.kernels.arithmetic.vec3 import rigid
from clearance.kernels.features.posed_pair import PosedPair
from clearance.kernels.mesh.surface import Surface, box_of
from clearance.kernels.motion.interval_middle import (
    IntervalMiddle,
    begin_arcs,
    go_to_middle,
    motion_bound_at,
    motion_bound_in,
    new_middle,
    note_motion_bound,
)
from clearance.kernels.motion.joint_motion_bound import (
    PairMotion,
    loosened,
    motion_bound_of_box,
    orientation_rounding,
)
from clearance.kernels.motion.joint_path import JointPath
from clearance.kernels.motion.kinematics import BALL
from clearance.kernels.motion.placed import GROWTH
from clearance.kernels.motion.twist import CertificateGoal, prove_while_moving
from clearance.kernels.motion.world import World
from clearance.kernels.search.front import KEPT_DOWN, Fronts, PairFront, no_fronts
from clearance.kernels.search.proof import allowed_gap
from clearance.kernels.search.scratch import Scratch, new_scratch

DEPTH = 64
"""Parts of an interval that can wait, one a halving; after 52 the ends are one number."""

WIDER = 4.0
"""Times as wide is the gap of a pair in an interval that has come to its most parts."""

ROUNDED_DOWN = 1.0 - 2.0**-50
"""Covers the rounding of the steps' clearances, which are right to the last place."""


class CertifiedMotion(NamedTuple):
    """What moves and how.

    Attributes:
        world: the bodies and their pairs. Ball joints are among the links as joints that turn, whose fixed parts
            and axes are written for each interval: the arrays belong to this motion.
        path: how the joint above each link moves from step to step.
    """

    world: World
    path: JointPath


class CertifiedSteps(NamedTuple):
    """The steps between which the motion is certified, and what is known of them.

    Attributes:
        first, last: the intervals are those between these two.
        order: (n,) the pair to look at first in each interval.
        clearance: (n,) [m] of the steps over these pairs, proven to within rounding; or any distance, where it is
            enough to know whether the motion stays that far, less the gap.
    """

    first: int
    last: int
    order: Integers
    clearance: Floats


class IntervalBounds(NamedTuple):
    """What is found of each interval.

    Attributes:
        lower, upper: (n,) [m] proven, and the least distance asked about or seen.
        share: (n,) where in the interval `upper` was seen, 0 to 1; -1 where nothing less than was asked about was.
        pair: (n,) which pair was seen there, or -1.
    """

    lower: Floats
    upper: Floats
    share: Floats
    pair: Integers


class PairInterval(NamedTuple):
    """What is known of a pair over an interval: bound and least distance [m], and where that was seen, or -1."""

    lower_bound: float
    least: float
    share: float


class CertifyState(NamedTuple):
    """What is carried from interval to interval, and scratch.

    Attributes:
        whole, part: the middle of the interval, and of a part of it.
        motion_bounds: (bodies, 9) numbers of the `MotionBound` of each in the interval, and [m] what of it is the
            rounding of orientations, which holds in all parts of it.
        displacements: (bodies,) [m] how far each can have moved in all.
        lower_bounds: (p,) [m] a bound on each pair's distance over an interval, plus the displacement at its end.
        witness_faces: (p, 2) the faces that were nearest, or -1.
        waiting: (DEPTH, 2) parts of an interval. fronts: none.
    """

    whole: IntervalMiddle
    part: IntervalMiddle
    motion_bounds: np.ndarray
    displacements: np.ndarray
    lower_bounds: np.ndarray
    witness_faces: np.ndarray
    waiting: np.ndarray
    fronts: Fronts
    scratch: Scratch


@inline
def _go_on(surface, world, path, step, state):
    """Goes to the interval after `step`: its middle, each body's motion about it, its displacement at the end."""
    begin_arcs(world.links, path.balls, step)
    go_to_middle(world.links, path, step, 0.0, 1.0, state.whole)
    for body in range(len(world.frames)):
        numbers = state.motion_bounds[body]
        numbers[8] = 0.0
        if len(path.balls.links) > 0 and world.frames[body] >= 0:
            box = box_of(surface, surface.roots[world.solids[body]])
            numbers[8] = orientation_rounding(
                box, world.links, world.frames[body], path.balls, state.whole
            )
        about_middle = motion_bound_in(surface, world, body, state.whole)
        motion_bound = loosened(about_middle, numbers[8])
        note_motion_bound(motion_bound, numbers)
        if world.frames[body] >= 0:
            box = box_of(surface, surface.roots[world.solids[body]])
            state.displacements[body] += 2.0 * GROWTH * motion_bound_of_box(box, motion_bound)


@inline
def _pose_of(world, body, middle):
    """Where a body is in `middle`."""
    frame = world.frames[body]
    return rigid(middle.poses[frame] if frame >= 0 else world.standing[body])


@inline
def _prove_pair(lent, world, pair, middle, motion, least, aim, state, tally):
    """A `Proof` of a pair about the state in `middle`.

    Many arguments: what belongs together is in tuples already.
    """
    body_a, body_b = world.pairs[pair, 0], world.pairs[pair, 1]
    frames = frames_of(_pose_of(world, body_a, middle), _pose_of(world, body_b, middle))
    bodies = PosedPair(lent, world.solids[body_a], lent, world.solids[body_b], frames)
    faces, front = state.witness_faces[pair], PairFront(state.fronts, 0, math.inf)
    proof = prove_while_moving(bodies, faces, motion, least, aim, front, state.scratch)
    tally[1] += 1
    tally[2] += proof.n_nodes
    tally[3] += proof.n_faces
    return proof


@kernel
def certify(
    surface: Surface,
    motion: CertifiedMotion,
    steps: CertifiedSteps,
    aim: CertificateGoal,
    bounds: IntervalBounds,
    tally: Integers,
):
    """Fills `bounds` for the motion between some steps.

    Args:
        surface: every face owns all its features.
        motion: a `CertifiedMotion`. steps: `CertifiedSteps`. aim: a `CertificateGoal`.
        tally: (4,) counts: pairs whose carried bound was enough, searches, nodes and faces looked at.
    """
    world = motion.world
    if (world.links.kinds == BALL).any():
        raise AssertionError("a joint that turns takes its place")
    n_links, n_bodies, n_pairs = len(world.links.parents), len(world.frames), len(world.pairs)
    state = lend(CertifyState(
        new_middle(n_links), new_middle(n_links), np.empty((n_bodies, 9)),
        np.zeros(n_bodies), np.full(n_pairs, -np.inf), np.full((n_pairs, 2), -1), np.empty((DEPTH, 2)),
        no_fronts(1, 0), new_scratch(),
    ))  # fmt: skip
    _certify(lend(surface), motion, steps, aim, bounds, tally, state)


@inline
def _certify(lent, motion, steps, aim, bounds, tally, state):
    """`certify`, with the arrays of its state."""
    surface = lent
    world, order, clearance = motion.world, steps.order, steps.clearance
    n_pairs = len(world.pairs)
    displacements, lower_bounds = state.displacements, state.lower_bounds
    for i in range(len(tally)):
        tally[i] = 0
    for step in range(steps.first, steps.last):
        least = min(clearance[step], clearance[step + 1])
        lower_bound = least  # 0 for a contact: then nothing is left to prove
        share, seen = -1.0, np.int64(-1)
        _go_on(surface, world, motion.path, step, state)
        for turn in range(-1, n_pairs):
            pair = order[step] if turn < 0 else turn
            if turn == order[step] or least <= 0.0:
                continue
            moved = displacements[world.pairs[pair, 0]] + displacements[world.pairs[pair, 1]]
            carried = lower_bounds[pair] - moved
            if carried >= least - allowed_gap(least, aim.gap, aim.fail):
                lower_bound = min(lower_bound, carried)
                tally[0] += 1
                continue
            over = _prove_interval(lent, surface, motion, step, pair, least, aim, state, tally)
            lower_bounds[pair] = (over.lower_bound + moved) * KEPT_DOWN
            if over.share >= 0.0:
                least, share, seen = over.least, over.share, pair
            lower_bound = min(lower_bound, over.lower_bound)
        bounds.lower[step] = max(0.0, min(lower_bound, least) * ROUNDED_DOWN)
        bounds.upper[step] = least
        bounds.share[step] = share
        bounds.pair[step] = seen
    return 0


@inline(force=True)
def _loosened_in(surface, world, body, state):
    """The motion bound of a body about the middle of a part, with the rounding of the whole interval."""
    bound = motion_bound_in(surface, world, body, state.part)
    return loosened(bound, state.motion_bounds[body, 8])


@inline
def _prove_interval(lent, surface, motion, step, pair, least, aim, state, tally):
    """The proof of a pair over the whole interval after `step`, halved until that is done.

    Many arguments: what belongs together is in tuples already.
    """
    world, path = motion.world, motion.path
    body_a, body_b = world.pairs[pair, 0], world.pairs[pair, 1]
    b_moves = world.frames[body_b] >= 0
    moving = PairMotion(
        motion_bound_at(state.motion_bounds, body_a),
        motion_bound_at(state.motion_bounds, body_b),
        b_moves,
    )
    proof = _prove_pair(lent, world, pair, state.whole, moving, least, aim, state, tally)
    share = 0.5 if proof.least < least else -1.0
    if proof.is_complete or proof.least <= 0.0:
        return PairInterval(proof.lower_bound, proof.least, share)
    least = proof.least
    lower_bound = math.inf
    waiting = state.waiting
    waiting[0, 0], waiting[0, 1] = 0.5, 1.0
    waiting[1, 0], waiting[1, 1] = 0.0, 0.5
    n_waiting = 2
    n_parts = 0
    while n_waiting > 0:
        n_waiting -= 1
        n_parts += 1
        low, high = waiting[n_waiting, 0], waiting[n_waiting, 1]
        if n_parts % aim.most_parts == 0 or n_waiting + 2 > DEPTH:
            aim = CertificateGoal(WIDER * aim.gap, aim.fail, aim.most_parts)
        go_to_middle(world.links, path, step, low, high, state.part)
        moving = PairMotion(
            _loosened_in(surface, world, body_a, state),
            _loosened_in(surface, world, body_b, state),
            b_moves,
        )
        proof = _prove_pair(lent, world, pair, state.part, moving, least, aim, state, tally)
        if proof.least < least:
            least, share = proof.least, 0.5 * (low + high)
        if least <= 0.0:
            return PairInterval(0.0, least, share)
        if proof.is_complete:
            lower_bound = min(lower_bound, proof.lower_bound)
        elif n_waiting + 2 > DEPTH:
            lower_bound = 0.0
        else:
            at = 0.5 * (low + high)
            waiting[n_waiting, 0], waiting[n_waiting, 1] = at, high
            waiting[n_waiting + 1, 0], waiting[n_waiting + 1, 1] = low, at
            n_waiting += 2
    return PairInterval(lower_bound, least, share)
