"""The least that errors leave of all pairs, at steps and in the motion between them.

Not for: one pair in one state (`pair_proof`).
"""

import math
from typing import NamedTuple

import numpy as np

from clearance.compile.declared import Floats, Floats3, Integers
from clearance.compile.decorators import inline, kernel
from clearance.compile.lending import lend
from clearance.kernels.budget.errors import REACH
from clearance.kernels.budget.levers import fill_levers
from clearance.kernels.budget.middle import go_to_part, half_of
from clearance.kernels.budget.pair_proof import Look, prove_pair
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
    start_at,
    start_before,
    thin_of,
)
from clearance.kernels.motion.halving import prove_interval, prove_part
from clearance.kernels.motion.interval_middle import begin_arcs
from clearance.kernels.search.carried import carried_bound, carry
from clearance.kernels.search.proof import Goal, allowed_gap

FEW = 16
"""Moments that are looked at as exactly as can be."""

EXACT_LOOKS = 400
"""Visits before what is nearly the least is enough, where moments are few."""

REFINED = 0.05
"""The share of what errors take at the nearest points that a bound at a step may stay below what occurs there."""

REFINED_OF_MANY = 0.1
"""The same where moments are many: those that decide are looked at once more."""

ROUGH_LOOKS = -1
"""The same where they are many."""


class BudgetMoments(NamedTuple):
    """Which moments of a path are asked, and what is known of them.

    Attributes:
        intervals: (n,) the step before each. shares: (n,) how much of the interval from there has passed, 0 to 1.
        order: (n,) the pair to look at first, or -1. known: (n,) [m] the nominal clearance, or NaN.
        points: (n, 2, 3) [m] its nearest points where the links are at, or NaN.
        enough: [m] what is proven beyond it is not looked into. exact_looks: visits, as in `Goal`.
    """

    intervals: Integers
    shares: Floats
    order: Integers
    known: Floats
    points: Floats3
    enough: float
    exact_looks: int


class BudgetIntervals(NamedTuple):
    """Which intervals of a path are asked, and what is known of them.

    Attributes:
        intervals: (n,) the step before each. order: (n,) the pair to look at first, or -1.
        known: (n,) [m] the least that is proven at both of its ends. enough: as in `BudgetMoments`.
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
    """What is found of each step or interval.

    Attributes:
        proven: (n,) [m]. pair: (n,) of which the least occurs.
        share: (n,) where in the interval that was seen, 0 to 1, or -1.
    """

    proven: Floats
    pair: Integers
    share: Floats


@inline
def _most_taken(lent, pair, look):
    """[m] what errors can take of a pair at most, whose bodies touch."""
    scene = lent
    taken = thin_of(lent, pair)
    for side in range(2):
        body = scene.world.pairs[pair, side]
        fill_body(lent, body, 0.0, look)
        taken += scene.state.seen.found.sums[body, REACH]
    return taken


@inline
def _with_boxes(lent, pair, half, look, target, carried):
    """[m] the bound that is carried of a pair, or that of its boxes where it is better; then it is kept."""
    scene = lent
    by_boxes = bound_by_boxes(lent, pair, half, look, target)
    if by_boxes > carried:
        carry(scene.world.pairs, pair, by_boxes, scene.state.carried)
        return by_boxes
    return carried


@inline
def _at_moment(lent, look, start, target, exact_looks, tally):
    """What errors leave of a pair at a moment, looked into as far as a target [m], if that is not known."""
    scene = lent
    left = answer_of(lent, look.pair)
    if is_answered(lent, look.pair, target):
        tally[0] += 1
    else:
        refined = REFINED_OF_MANY if exact_looks < EXACT_LOOKS else REFINED
        thin = thin_of(lent, look.pair)
        goal = Goal(target, math.inf, 0.0, 0.0, thin, True, False, exact_looks, refined)
        left = prove_pair(lent, look, start, goal, tally)
        note_answer(lent, look.pair, target, left)
        carry(scene.world.pairs, look.pair, left.lower_bound, scene.state.carried)
    return left


@kernel
def budget_moments(scene: BudgetScene, asked: BudgetMoments, rows: BudgetRows, tally: Integers):
    """Fills `rows` with what errors leave of the nearest pair at each of some moments.

    A moment at which bodies touch is not looked into: what is left is what errors could take of that pair.

    Args:
        scene: `BudgetScene`, with a path of at least two steps; what its state holds is forgotten.
        asked: `BudgetMoments`. tally: (5,) pairs passed over, searches, nodes and
            faces looked at, and faces cut.
    """
    lent = lend(scene)
    surface, world, path = scene.surface, scene.world, scene.path
    errors, state = scene.errors, scene.state
    begin_anew(world, state)
    fill_levers(surface, world, path, errors, state.levers)
    n_pairs, is_rough = len(world.pairs), asked.exact_looks < EXACT_LOOKS
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
            state.carried.fronts.spans[:, 1] = 0
        was_step = is_step
        if is_step:
            go_on_to_step(lent, before, interval + np.int64(share))
            before = interval + np.int64(share)
        order = asked.order[place]
        best, enough, winner = math.inf, asked.enough, np.int64(-1)
        touches = asked.known[place] <= 0.0 and order >= 0
        if touches:
            best, winner = -_most_taken(lent, order, place), order
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
                carried = _with_boxes(lent, pair, 0.0, place, target, carried)
            if carried >= target:
                lowest = min(lowest, carried)
                tally[0] += 1
                continue
            start = start_before(lent, pair)
            if turn == -2 and asked.points[place, 0, 0] == asked.points[place, 0, 0]:
                start = start_at(lent, pair, asked.points[place])
            look = Look(pair, 0.0, place, is_step and is_rough)
            left = _at_moment(lent, look, start, target, asked.exact_looks, tally)
            lowest = min(lowest, left.lower_bound)
            if winner < 0 or (left.lower_bound < best and left.least < math.inf):
                winner = pair
            best = min(best, left.lower_bound)
            if is_rough:
                enough = min(enough, left.enough)
        last = winner
        rows.proven[place] = lowest
        rows.pair[place] = winner
        rows.share[place] = -1.0


class PairWithErrors(NamedTuple):
    """A pair in the interval after a step.

    Attributes:
        scene: lent. look: the number of the look at the whole interval. asked: of which it is one. tally: counts.
    """

    scene: BudgetScene
    step: int
    pair: int
    look: int
    asked: BudgetIntervals
    tally: Integers


@prove_part.register
def _(pair: PairWithErrors, low, high, n_parts, least, gap):
    lent, asked = pair.scene, pair.asked
    scene = lent
    path, state = scene.path, scene.state
    if n_parts > 1:
        links = scene.world.links
        go_to_part(links, path, scene.errors, pair.step, low, high, state.middle)
    target = min(asked.enough, least - allowed_gap(least, gap, asked.fail))
    thin = thin_of(lent, pair.pair)
    goal = Goal(target, least, gap, asked.fail, thin, False, False, 0, REFINED)
    half, number = half_of(path, pair.step, low, high), pair.look + n_parts - 1
    look = Look(pair.pair, half, number, n_parts == 1)
    return prove_pair(lent, look, start_before(lent, pair.pair), goal, pair.tally)


@kernel
def budget_intervals(scene: BudgetScene, asked: BudgetIntervals, rows: BudgetRows, tally: Integers):
    """Fills `rows` with what errors leave of all pairs in the motion from each of some steps to the next.

    Args: as of `budget_moments`; ball joints are among the links as joints that turn, whose fixed parts and
        axes are written for each interval.
    """
    lent = lend(scene)
    surface, world, path = scene.surface, scene.world, scene.path
    errors, state = scene.errors, scene.state
    begin_anew(world, state)
    fill_levers(surface, world, path, errors, state.levers)
    n_pairs = len(world.pairs)
    tally[:] = 0
    look, before = np.int64(0), asked.intervals[0]
    for place in range(len(asked.intervals)):
        step, least = asked.intervals[place], asked.known[place]
        lower_bound, share, winner = least, -1.0, np.int64(-1)
        begin_arcs(world.links, path.balls, step)
        go_on(lent, before, step + 1)
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
                    look += 1
                    go_to_part(world.links, path, errors, step, 0.0, 1.0, state.middle)
                    moved = False
                carried = _with_boxes(lent, pair, half, look, target, carried)
            if carried >= target:
                lower_bound = min(lower_bound, carried)
                tally[0] += 1
                continue
            of_pair = PairWithErrors(lent, step, pair, look, asked, tally)
            over = prove_interval(of_pair, least, asked.gap, asked.most_parts, state.waiting)
            moved, look = over.n_parts > 1, look + over.n_parts - 1
            carry(world.pairs, pair, over.lower_bound, state.carried)
            if over.share >= 0.0 and over.least < least:
                least, share = over.least, over.share
            if over.lower_bound < lower_bound:
                lower_bound, winner = over.lower_bound, pair
        rows.proven[place] = lower_bound
        rows.pair[place] = winner
        rows.share[place] = share
