"""A proven lower bound on the clearance of the continuous motion between two steps.

In the middle of an interval the trees are descended as for a distance. Each bound is lowered by the motion of the
bodies in the interval, along the direction of the nearest points. So sliding past costs nothing to first order.
Nodes that are turned away in all of the interval are skipped (`normal_cones`); the distance at its first instant
is above 0, or the proof ends. If the bound misses the target, the interval is halved, the earlier half first.
After `most_parts` parts the target of a pair is lowered until it can be proven, so the loop ends. A bound on a
pair, less the motion of its bodies, holds for later intervals: while it exceeds the target, the pair is skipped.

Not for: one pair over one interval (`twist`), the steps themselves (`sweep`).
"""

from typing import NamedTuple

import numpy as np

from clearance.compile.declared import Floats, Integers
from clearance.compile.decorators import inline, kernel
from clearance.compile.lending import lend
from clearance.kernels.arithmetic.double_double import frames_of
from clearance.kernels.features.posed_pair import PosedPair
from clearance.kernels.mesh.surface import Surface, box_of
from clearance.kernels.motion.halving import DEPTH, prove_interval, prove_part
from clearance.kernels.motion.interval_middle import (
    IntervalMiddle,
    begin_arcs,
    go_to_middle,
    motion_bound_at,
    motion_bound_in,
    new_middle,
    note_motion_bound,
)
from clearance.kernels.motion.joint_motion_bound import PairMotion, motion_bound_of_box
from clearance.kernels.motion.joint_path import JointPath
from clearance.kernels.motion.kinematics import BALL
from clearance.kernels.motion.placed import GROWTH
from clearance.kernels.motion.twist import CertificateGoal, prove_while_moving
from clearance.kernels.motion.world import World, pose_of
from clearance.kernels.search.carried import (
    Carried,
    carried_bound,
    carry,
    no_front,
    nothing_carried,
)
from clearance.kernels.search.proof import allowed_gap
from clearance.kernels.search.scratch import Scratch, new_scratch

ROUNDED_DOWN = 1.0 - 2.0**-50
"""Covers the rounding of the steps' clearances, which are exact to the last place."""


class CertifiedMotion(NamedTuple):
    """The bodies and their motion.

    Attributes:
        world: the bodies and their pairs. Ball joints are joints that turn, with fixed parts and axes written
            anew for each interval; so the arrays belong to this motion.
        path: how the joint above each link moves from step to step.
    """

    world: World
    path: JointPath


class CertifiedSteps(NamedTuple):
    """The steps between which the motion is certified.

    Attributes:
        first, last: the intervals lie between these two.
        order: (n,) the pair to ask first in each interval.
        clearance: (n,) [m] of the steps over these pairs, proven to within rounding. Or any distance, to learn
            whether the motion stays farther than that, less the gap.
    """

    first: int
    last: int
    order: Integers
    clearance: Floats


class IntervalBounds(NamedTuple):
    """The bounds on each interval.

    Attributes:
        lower, upper: (n,) [m] proven, and the least distance given or seen.
        share: (n,) where in the interval `upper` was seen, 0 to 1; -1 where no less than the given one was seen.
        pair: (n,) the pair seen there, or -1.
    """

    lower: Floats
    upper: Floats
    share: Floats
    pair: Integers


class CertifyState(NamedTuple):
    """State that lasts from interval to interval, and scratch.

    Attributes:
        whole, part: the middle of the interval, and of a part of it.
        motion_bounds: (bodies, 8) numbers of the `MotionBound` of each in the interval.
        carried: of all pairs, without fronts; a bound is over an interval.
        waiting: (DEPTH, 2) parts of an interval.
    """

    whole: IntervalMiddle
    part: IntervalMiddle
    motion_bounds: np.ndarray
    carried: Carried
    waiting: np.ndarray
    scratch: Scratch


@inline
def _go_on(surface, world, path, step, state):
    """Goes to the interval after `step`: its middle, each body's motion bound, and its displacement at the end."""
    begin_arcs(world.links, path.balls, step)
    go_to_middle(world.links, path, step, 0.0, 1.0, state.whole)
    for body in range(len(world.frames)):
        bound = motion_bound_in(surface, world, path.balls, body, state.whole)
        note_motion_bound(bound, state.motion_bounds[body])
        box = box_of(surface, surface.roots[world.solids[body]])
        state.carried.moved[body] += 2.0 * GROWTH * motion_bound_of_box(box, bound)


class MovingPair(NamedTuple):
    """A pair in the interval after a step.

    Attributes:
        surface, state: lent. motion, aim, tally: as of `certify`.
    """

    surface: Surface
    state: CertifyState
    motion: CertifiedMotion
    step: int
    pair: int
    aim: CertificateGoal
    tally: Integers


@inline
def _motion_of(asked, body, is_whole):
    """The motion bound of a body about the middle of the interval or a part."""
    motion, state = asked.motion, asked.state
    if is_whole:
        return motion_bound_at(state.motion_bounds, body)
    return motion_bound_in(asked.surface, motion.world, motion.path.balls, body, state.part)


@prove_part.register
def _(asked: MovingPair, low, high, n_parts, least, gap):
    world, state, surface, tally = asked.motion.world, asked.state, asked.surface, asked.tally
    is_whole = n_parts == 1
    if not is_whole:
        go_to_middle(world.links, asked.motion.path, asked.step, low, high, state.part)
    body_a, body_b = world.pairs[asked.pair, 0], world.pairs[asked.pair, 1]
    motion = PairMotion(
        _motion_of(asked, body_a, is_whole),
        _motion_of(asked, body_b, is_whole),
        world.frames[body_b] >= 0,
    )
    poses = (state.whole if is_whole else state.part).poses
    frames = frames_of(pose_of(world, body_a, poses), pose_of(world, body_b, poses))
    bodies = PosedPair(surface, world.solids[body_a], surface, world.solids[body_b], frames)
    faces, front = state.carried.faces[asked.pair], no_front(state.carried)
    aim = CertificateGoal(gap, asked.aim.fail, asked.aim.most_parts)
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
        tally: (4,) counts: pairs whose carried bound was enough, searches, nodes and faces visited.
    """
    world = motion.world
    if (world.links.kinds == BALL).any():
        raise AssertionError("a joint that turns takes its place")
    n_links, n_bodies, n_pairs = len(world.links.parents), len(world.frames), len(world.pairs)
    state = lend(CertifyState(
        new_middle(n_links), new_middle(n_links), np.empty((n_bodies, 8)),
        nothing_carried(n_bodies, n_pairs, 0), np.empty((DEPTH, 2)), new_scratch(),
    ))  # fmt: skip
    _certify(lend(surface), motion, steps, aim, bounds, tally, state)


@inline
def _certify(surface, motion, steps, aim, bounds, tally, state):
    """`certify`, with the arrays of its state."""
    world, order, clearance = motion.world, steps.order, steps.clearance
    pairs, carried = world.pairs, state.carried
    for i in range(len(tally)):
        tally[i] = 0
    for step in range(steps.first, steps.last):
        least = min(clearance[step], clearance[step + 1])
        lower_bound = least  # 0 for a contact: then there is nothing to prove
        share, seen = -1.0, np.int64(-1)
        _go_on(surface, world, motion.path, step, state)
        for turn in range(-1, len(pairs)):
            pair = order[step] if turn < 0 else turn
            if turn == order[step] or least <= 0.0:
                continue
            bound = carried_bound(pairs, pair, carried)
            if bound >= least - allowed_gap(least, aim.gap, aim.fail):
                lower_bound = min(lower_bound, bound)
                tally[0] += 1
                continue
            asked = MovingPair(surface, state, motion, step, pair, aim, tally)
            over = prove_interval(asked, least, aim.gap, aim.most_parts, state.waiting)
            carry(pairs, pair, over.lower_bound, carried)
            if over.share >= 0.0:
                least, share, seen = over.least, over.share, pair
            lower_bound = min(lower_bound, over.lower_bound)
        bounds.lower[step] = max(0.0, min(lower_bound, least) * ROUNDED_DOWN)
        bounds.upper[step] = least
        bounds.share[step] = share
        bounds.pair[step] = seen
    return 0
