"""The least distance of all pairs under errors, at steps and in the motion between them.

Not for: the search of a pair (`search.proof`), and what lasts from moment to moment (`sweep_state`).
"""

import math
from typing import NamedTuple

import numpy as np

from clearance.compile.declared import Floats, Floats3, Integers
from clearance.compile.decorators import inline, kernel
from clearance.kernels.arithmetic.double_double import frames_of
from clearance.kernels.arithmetic.vec3 import turn as turned
from clearance.kernels.budget.error_rows import error_rows_of
from clearance.kernels.budget.errors import REACH
from clearance.kernels.budget.levers import fill_levers
from clearance.kernels.budget.middle import go_to_part, half_of
from clearance.kernels.budget.sweep_state import (
    MOVES,
    BudgetScene,
    answer_of,
    begin_anew,
    bound_by_boxes,
    fill_body,
    go_on,
    go_on_to_step,
    is_answered,
    note_answer,
    skin_of,
    start_at,
    start_before,
)
from clearance.kernels.features.posed_pair import PosedPair
from clearance.kernels.motion.halving import prove_interval, prove_part
from clearance.kernels.motion.interval_middle import begin_arcs
from clearance.kernels.motion.world import pose_of
from clearance.kernels.search.carried import carried_bound, carry, front_of, no_front
from clearance.kernels.search.front import LENGTH
from clearance.kernels.search.proof import Proof, ProofGoal, ProofStart, allowed_gap, prove

FEW = 16
"""Up to this many moments are proven as exactly as possible."""

EXACT_VISITS = 400
"""Visits before a nearly exact bound is enough, where moments are few."""

REFINED = 0.05
"""The gap allowed at a step, as a share of the loss by errors at the nearest points."""

REFINED_OF_MANY = 0.1
"""The same where moments are many: the deciding ones are proven once more."""

ROUGH_VISITS = -1
"""The visits where moments are many: a nearly exact bound is enough at once."""


class BudgetMoments(NamedTuple):
    """Moments of a path to prove, and their nominal answers.

    Attributes:
        intervals: (n,) the step before each. shares: (n,) the time in the interval from there, 0 to 1.
        order: (n,) the pair to ask first, or -1. known: (n,) [m] the nominal clearance, or NaN.
        points: (n, 2, 3) [m] its nearest points at the poses of the links, or NaN.
        enough: [m] no bound needs to be greater. exact_visits: as in `ProofGoal`.
    """

    intervals: Integers
    shares: Floats
    order: Integers
    known: Floats
    points: Floats3
    enough: float
    exact_visits: int


class BudgetIntervals(NamedTuple):
    """Intervals of a path to prove, and the bounds at their ends.

    Attributes:
        intervals: (n,) the step before each. order: (n,) the pair to ask first, or -1.
        known: (n,) [m] the least bound proven at its two ends. enough: as in `BudgetMoments`.
        gap, fail: [m] as in `CertificateGoal`. most_parts: of one pair and interval.
    """

    intervals: Integers
    order: Integers
    known: Floats
    enough: float
    gap: float
    fail: float
    most_parts: int


class BudgetRows(NamedTuple):
    """The results for each step or interval.

    Attributes:
        proven: (n,) [m]. pair: (n,) the pair with the least bound.
        share: (n,) where in the interval the least distance was seen, 0 to 1, or -1.
    """

    proven: Floats
    pair: Integers
    share: Floats


class PairPart(NamedTuple):
    """A pair, and a part of the motion.

    Attributes:
        pair: its number. half: [s] half of the part, 0 at a step.
        number: of the part; rows and boxes are made once for each number.
        goes_on: True to use and update the front of the pair: at steps and over whole intervals.
    """

    pair: int
    half: float
    number: int
    goes_on: bool


@kernel
def prove_pair(
    scene: BudgetScene, part: PairPart, start: ProofStart, goal: ProofGoal, tally: Integers
) -> Proof:
    """A `Proof` of a pair under its errors and its motion in the part: the search that both sweeps call."""
    surface, world, state, pair = scene.surface, scene.world, scene.state, part.pair
    body_a, body_b = world.pairs[pair, 0], world.pairs[pair, 1]
    fill_body(scene, body_a, part.half, part.number)
    fill_body(scene, body_b, part.half, part.number)
    poses = state.middle.state.poses
    pose = pose_of(world, body_a, poses)
    frames = frames_of(pose, pose_of(world, body_b, poses))
    root_a, root_b = surface.roots[world.solids[body_a]], surface.roots[world.solids[body_b]]
    roots = PosedPair(surface, root_a, surface, root_b, frames)
    carried = state.carried
    front = front_of(world.pairs, pair, carried) if part.goes_on else no_front(carried)
    rows = error_rows_of(state.seen, roots, body_a, body_b)
    proof = prove(roots, rows, start, goal, front, state.scratch)
    tally[1] += 1
    tally[2] += proof.n_nodes
    tally[3] += proof.n_faces
    tally[4] += proof.n_cut
    u = turned(pose, proof.u)
    state.directions[pair, 0], state.directions[pair, 1], state.directions[pair, 2] = u.x, u.y, u.z
    return proof


@inline
def _greatest_loss(scene, pair, number):
    """[m] the greatest loss by errors of a pair whose bodies touch."""
    loss = skin_of(scene, pair)
    for side in range(2):
        body = scene.world.pairs[pair, side]
        fill_body(scene, body, 0.0, number)
        loss += scene.state.seen.found.sums[body, REACH]
    return loss


@inline
def _with_boxes(scene, pair, half, number, target, carried):
    """[m] the greater of the carried bound of a pair and the bound by its boxes, which is then stored."""
    by_boxes = bound_by_boxes(scene, pair, half, number, target)
    if by_boxes > carried:
        carry(scene.world.pairs, pair, by_boxes, scene.state.carried)
        return by_boxes
    return carried


@inline
def _at_moment(scene, part, start, target, exact_visits, tally):
    """A `Proof` of a pair at a moment up to a target [m]: the last answer if it is valid, else a new one."""
    proof = answer_of(scene, part.pair)
    if is_answered(scene, part.pair, target):
        tally[0] += 1
    else:
        refined = REFINED_OF_MANY if exact_visits < EXACT_VISITS else REFINED
        skin = skin_of(scene, part.pair)
        goal = ProofGoal(target, math.inf, 0.0, 0.0, skin, True, False, exact_visits, refined)
        proof = prove_pair(scene, part, start, goal, tally)
        note_answer(scene, part.pair, target, proof)
        carry(scene.world.pairs, part.pair, proof.lower_bound, scene.state.carried)
    return proof


@kernel
def budget_moments(scene: BudgetScene, asked: BudgetMoments, rows: BudgetRows, tally: Integers):
    """Fills `rows` with the least distance of all pairs under errors at each of some moments.

    If bodies touch at a moment, its result is minus the greatest loss by errors of that pair, without a search.

    Args:
        scene: `BudgetScene`, with a path of at least two steps; its state is reset.
        asked: `BudgetMoments`. tally: (5,) pairs skipped, searches, nodes and faces visited, and faces cut.
    """
    surface, world, path = scene.surface, scene.world, scene.path
    errors, state = scene.errors, scene.state
    begin_anew(world, state)
    fill_levers(surface, world, path, errors, state.levers)
    n_pairs, is_rough = len(world.pairs), asked.exact_visits < EXACT_VISITS
    tally[:] = 0
    last, before, was_step = np.int64(-1), np.int64(-1), True
    for place in range(len(asked.intervals)):
        interval, share = asked.intervals[place], asked.shares[place]
        is_step = share == 0.0 or share == 1.0
        begin_arcs(world.links, path.balls, interval)
        go_to_part(world.links, path, errors, interval, share, share, state.middle)
        if not (is_step and was_step):
            state.carried.lower_bounds[:] = -math.inf
            state.answers[:, MOVES] = -1.0
            state.carried.fronts.spans[:, LENGTH] = 0
        was_step = is_step
        if is_step:
            go_on_to_step(scene, before, interval + np.int64(share))
            before = interval + np.int64(share)
        order = asked.order[place]
        best, enough, winner = math.inf, asked.enough, np.int64(-1)
        touches = asked.known[place] <= 0.0 and order >= 0
        if touches:
            best, winner = -_greatest_loss(scene, order, place), order
        lowest = best
        for turn in range(-2, n_pairs):
            pair = order if turn == -2 else last if turn == -1 else np.int64(turn)
            if touches or pair < 0 or (turn == -1 and pair == order):
                continue
            if turn >= 0 and (turn == order or turn == last):
                continue
            target = min(best, enough)
            carried = carried_bound(world.pairs, pair, state.carried)
            if turn >= 0 and carried < target:
                carried = _with_boxes(scene, pair, 0.0, place, target, carried)
            if carried >= target:
                lowest = min(lowest, carried)
                tally[0] += 1
                continue
            start = start_before(scene, pair)
            if turn == -2 and asked.points[place, 0, 0] == asked.points[place, 0, 0]:
                start = start_at(scene, pair, asked.points[place])
            part = PairPart(pair, 0.0, place, is_step and is_rough)
            proof = _at_moment(scene, part, start, target, asked.exact_visits, tally)
            lowest = min(lowest, proof.lower_bound)
            if winner < 0 or (proof.lower_bound < best and proof.least < math.inf):
                winner = pair
            best = min(best, proof.lower_bound)
            if is_rough:
                enough = min(enough, proof.enough)
        last = winner
        rows.proven[place] = lowest
        rows.pair[place] = winner
        rows.share[place] = -1.0


class PairWithErrors(NamedTuple):
    """A pair in the interval after a step.

    Attributes:
        scene: lent. number: of the whole interval as a part. asked: the intervals. tally: counts.
    """

    scene: BudgetScene
    step: int
    pair: int
    number: int
    asked: BudgetIntervals
    tally: Integers


@prove_part.register
def _(pair: PairWithErrors, low, high, n_parts, least, gap):
    scene, asked = pair.scene, pair.asked
    path, state = scene.path, scene.state
    if n_parts > 1:
        links = scene.world.links
        go_to_part(links, path, scene.errors, pair.step, low, high, state.middle)
    target = min(asked.enough, least - allowed_gap(least, gap, asked.fail))
    skin = skin_of(scene, pair.pair)
    goal = ProofGoal(target, least, gap, asked.fail, skin, False, False, 0, REFINED)
    half, number = half_of(path, pair.step, low, high), pair.number + n_parts - 1
    part = PairPart(pair.pair, half, number, n_parts == 1)
    return prove_pair(scene, part, start_before(scene, pair.pair), goal, pair.tally)


@kernel
def budget_intervals(scene: BudgetScene, asked: BudgetIntervals, rows: BudgetRows, tally: Integers):
    """Fills `rows` with the least distance of all pairs under errors in the motion from some steps to the next.

    Args: as of `budget_moments`. Ball joints are joints that turn, with fixed parts and axes written anew for each
        interval.
    """
    surface, world, path = scene.surface, scene.world, scene.path
    errors, state = scene.errors, scene.state
    begin_anew(world, state)
    fill_levers(surface, world, path, errors, state.levers)
    n_pairs = len(world.pairs)
    tally[:] = 0
    number, before = np.int64(0), asked.intervals[0]
    for place in range(len(asked.intervals)):
        step, least = asked.intervals[place], asked.known[place]
        lower_bound, share, winner = least, -1.0, np.int64(-1)
        begin_arcs(world.links, path.balls, step)
        go_on(scene, before, step + 1)
        before = step + 1
        order = asked.order[place]
        moved, half = True, half_of(path, step, 0.0, 1.0)
        for turn in range(-1, n_pairs):
            pair = order if turn < 0 else np.int64(turn)
            if turn == order or pair < 0:
                continue
            target = min(asked.enough, least - allowed_gap(least, asked.gap, asked.fail))
            carried = carried_bound(world.pairs, pair, state.carried)
            if carried < target:
                if moved:
                    number += 1
                    go_to_part(world.links, path, errors, step, 0.0, 1.0, state.middle)
                    moved = False
                carried = _with_boxes(scene, pair, half, number, target, carried)
            if carried >= target:
                lower_bound = min(lower_bound, carried)
                tally[0] += 1
                continue
            of_pair = PairWithErrors(scene, step, pair, number, asked, tally)
            over = prove_interval(of_pair, least, asked.gap, asked.most_parts, state.waiting)
            moved, number = over.n_parts > 1, number + over.n_parts - 1
            carry(world.pairs, pair, over.lower_bound, state.carried)
            if over.share >= 0.0 and over.least < least:
                least, share = over.least, over.share
            if over.lower_bound < lower_bound:
                lower_bound, winner = over.lower_bound, pair
        rows.proven[place] = lower_bound
        rows.pair[place] = winner
        rows.share[place] = share
