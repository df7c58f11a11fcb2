"""The least that errors leave of all pairs, at steps and in the motion between them.

Not for: one pair in one state (`left`).
"""

import math
from typing import NamedTuple

import numpy as np

from clearance.compile.jit import inline, kernel, shared
from clearance.compile.kernel_table import lend
from clearance.kernels.arithmetic.double_double import frames_of
from clearance.kernels.arithmetic.vec3 import rigid
from clearance.kernels.budget.left import Aim, LeftScratch, least_left
from clearance.kernels.budget.middle import Middle, go_to_part, motion_about, new_middle_of
from clearance.kernels.budget.pieces import new_pieces
from clearance.kernels.budget.rows import (
    REACH,
    SURFACE,
    fill_rows,
    fill_rows_of_standing,
    new_body_rows,
)
from clearance.kernels.budget.view import new_along_rows
from clearance.kernels.features.posed_pair import PosedPair
from clearance.kernels.mesh.surface import box_of
from clearance.kernels.motion.body_boxes import (
    BodyBoxes,
    bound_of_bodies,
    new_body_boxes,
    place_box,
)
from clearance.kernels.motion.certify import DEPTH, WIDER, begin_arcs
from clearance.kernels.motion.certify_pair import CHAIN_SLACK, allowed_gap
from clearance.kernels.motion.joint_motion_bound import orientation_rounding
from clearance.kernels.search.balls import radii_of
from clearance.kernels.search.scratch import new_scratch


class BudgetMoments(NamedTuple):
    """Which moments of a path are asked, and what is known of them.

    Attributes:
        intervals: (n,) the step before each. shares: (n,) how much of the interval from there has passed, 0 to 1.
        order: (n,) the pair to look at first, or -1. known: (n,) [m] the nominal clearance, or NaN.
        enough: [m] what is proven beyond it is not looked into.
    """

    intervals: np.ndarray
    shares: np.ndarray
    order: np.ndarray
    known: np.ndarray
    enough: float


class BudgetIntervals(NamedTuple):
    """Which intervals of a path are asked, and what is known of them.

    Attributes:
        intervals: (n,) the step before each. order: (n,) the pair to look at first, or -1.
        known: (n,) [m] the least that is proven at both of its ends. enough: as in `BudgetMoments`.
        gap, fail: [m] as in `CertificateGoal`. most_parts: of one pair and interval.
    """

    intervals: np.ndarray
    order: np.ndarray
    known: np.ndarray
    enough: float
    gap: float
    fail: float
    most_parts: int


class BudgetRows(NamedTuple):
    """What is found of each step or interval.

    Attributes:
        proven: (n,) [m]. pair: (n,) which pair decides it. faces: (n, 2) and which faces, or -1. share: (n,) where
            in the interval the least was seen, 0 to 1, or -1.
    """

    proven: np.ndarray
    pair: np.ndarray
    faces: np.ndarray
    share: np.ndarray


class SweepState(NamedTuple):
    """What is carried from step to step, and scratch."""

    middle: Middle
    boxes: BodyBoxes
    faces: np.ndarray
    waiting: np.ndarray
    work: LeftScratch


@shared
def _new_state(world, errors):
    n_links, n_bodies, n_pairs = len(world.links.parents), len(world.frames), len(world.pairs)
    work = LeftScratch(
        new_body_rows(n_bodies, errors.most_rows), new_along_rows(errors.most_rows), new_pieces(),
        new_scratch(),
    )  # fmt: skip
    return SweepState(
        new_middle_of(n_links), new_body_boxes(n_bodies), np.full((n_pairs, 2), -1),
        np.empty((DEPTH, 2)), work,
    )  # fmt: skip


@inline
def _fill_body(surface, world, errors, path, body, motion, state):
    """Writes the rows of a body about the middle."""
    found, middle = state.work.found, state.middle.state
    if world.frames[body] < 0:
        fill_rows_of_standing(surface, world, body, errors, found)
        return
    fill_rows(surface, world, body, errors, motion, middle.poses, found)
    if len(path.balls.links) > 0:
        box = box_of(surface, surface.roots[world.solids[body]])
        rounding = orientation_rounding(box, world.links, world.frames[body], path.balls, middle)
        for k in range(1, 4):  # both rests and the reach
            found.sums[body, k] += rounding


@inline
def _pose(world, body, state):
    frame = world.frames[body]
    return rigid(state.middle.state.poses[frame] if frame >= 0 else world.standing[body])


@inline
def _go_to(surface, world, errors, path, step, low, high, state):
    """Brings all links and bodies to the middle of a part."""
    go_to_part(world.links, path, errors, step, low, high, state.middle)
    motion = motion_about(path, step, low, high, state.middle)
    for body in range(len(world.frames)):
        _fill_body(surface, world, errors, path, body, motion, state)


@inline
def _ask(lent, world, pair, aim, state, tally):
    """What errors leave of a pair in the state in the middle."""
    body_a, body_b = world.pairs[pair, 0], world.pairs[pair, 1]
    frames = frames_of(_pose(world, body_a, state), _pose(world, body_b, state))
    bodies = PosedPair(lent, world.solids[body_a], lent, world.solids[body_b], frames)
    tally[1] += 1
    left = least_left(bodies, body_a, body_b, state.faces[pair], aim, state.work, tally)
    if left.face_a >= 0:
        state.faces[pair, 0], state.faces[pair, 1] = left.face_a, left.face_b
    return left


@inline
def _thin(surface, world, pair, state):
    """[m] the surfaces and balls of both bodies of a pair."""
    body_a, body_b = world.pairs[pair, 0], world.pairs[pair, 1]
    sums = state.work.found.sums
    radii = radii_of(surface, world.solids[body_a], surface, world.solids[body_b])
    return radii.both + sums[body_a, SURFACE] + sums[body_b, SURFACE]


@inline
def _by_boxes(surface, world, pair, state, enough):
    """[m] a bound on what is left of a pair by the boxes of both bodies; one above `enough` will do."""
    body_a, body_b = world.pairs[pair, 0], world.pairs[pair, 1]
    sums = state.work.found.sums
    taken = sums[body_a, REACH] + sums[body_b, REACH] + _thin(surface, world, pair, state)
    apart = bound_of_bodies(state.boxes, body_a, body_b, enough + taken)
    slacks = state.boxes.slacks[body_a] + state.boxes.slacks[body_b]
    return apart - CHAIN_SLACK * slacks - taken


@kernel
def budget_moments(surface, world, path, errors, asked, rows, tally, table):
    """Fills `rows` with what errors leave of the nearest pair at each of some moments.

    A moment at which bodies touch is not looked into: what is left is what errors could take of that pair.

    Args:
        surface: every face owns all its features. path: of at least two steps. errors: `Errors`.
        asked: `BudgetMoments`. tally: (4,) pairs passed over, searches, nodes and faces looked at.
    """
    lent = lend(surface)
    state = _new_state(world, errors)
    n_pairs = len(world.pairs)
    for i in range(len(tally)):
        tally[i] = 0
    for place in range(len(asked.intervals)):
        interval, share = asked.intervals[place], asked.shares[place]
        begin_arcs(world.links, path.balls, interval)
        _go_to(surface, world, errors, path, interval, share, share, state)
        for body in range(len(world.frames)):
            place_box(
                surface,
                surface.roots[world.solids[body]],
                body,
                _pose(world, body, state),
                state.boxes,
            )
        order = asked.order[place]
        best, winner = math.inf, np.int64(-1)
        if asked.known[place] <= 0.0 and order >= 0:
            sums = state.work.found.sums
            taken = sums[world.pairs[order, 0], REACH] + sums[world.pairs[order, 1], REACH]
            best, winner = -taken - _thin(surface, world, order, state), order
        elif order < 0:
            order = np.int64(0)
            for pair in range(n_pairs):
                bound = _by_boxes(surface, world, pair, state, math.inf)
                if bound < best:
                    best, order = bound, np.int64(pair)
            best = math.inf
        touches = winner >= 0
        lowest = best
        for turn in range(-1, n_pairs):
            pair = order if turn < 0 else np.int64(turn)
            if touches or turn == order:
                continue
            target = min(best, asked.enough)
            if turn >= 0:
                bound = _by_boxes(surface, world, pair, state, target)
                if bound >= target:
                    lowest = min(lowest, bound)
                    tally[0] += 1
                    continue
            aim = Aim(target, math.inf, 0.0, 0.0, True)
            left = _ask(lent, world, pair, aim, state, tally)
            lowest = min(lowest, left.lower_bound)
            if left.lower_bound < best:
                best = left.lower_bound
                winner = pair
        rows.proven[place] = lowest
        rows.pair[place] = winner
        rows.share[place] = -1.0
        if winner >= 0:
            rows.faces[place, 0], rows.faces[place, 1] = (
                state.faces[winner, 0],
                state.faces[winner, 1],
            )


class _Over(NamedTuple):
    """A pair over an interval: [m] bound and least seen, and where that was, or -1."""

    lower_bound: float
    least: float
    share: float


@inline
def _hold(lent, surface, world, path, errors, step, pair, least, asked, state, tally):
    """What errors leave of a pair over the interval after `step`, halved until that is proven."""
    waiting = state.waiting
    waiting[0, 0], waiting[0, 1] = 0.0, 1.0
    n_waiting, n_parts = 1, 0
    lower_bound, share, gap = math.inf, -1.0, asked.gap
    body_a, body_b = world.pairs[pair, 0], world.pairs[pair, 1]
    while n_waiting > 0:
        n_waiting -= 1
        n_parts += 1
        low, high = waiting[n_waiting, 0], waiting[n_waiting, 1]
        if n_parts % asked.most_parts == 0 or n_waiting + 2 > DEPTH:
            gap *= WIDER
        if n_parts > 1:
            go_to_part(world.links, path, errors, step, low, high, state.middle)
            motion = motion_about(path, step, low, high, state.middle)
            _fill_body(surface, world, errors, path, body_a, motion, state)
            _fill_body(surface, world, errors, path, body_b, motion, state)
        target = min(asked.enough, least - allowed_gap(least, gap, asked.fail))
        aim = Aim(target, least, gap, asked.fail, False)
        left = _ask(lent, world, pair, aim, state, tally)
        if left.least < least:
            least, share = left.least, 0.5 * (low + high)
        if left.completed:
            lower_bound = min(lower_bound, left.lower_bound)
        elif n_waiting + 2 > DEPTH:
            lower_bound = -math.inf
        else:
            at = 0.5 * (low + high)
            waiting[n_waiting, 0], waiting[n_waiting, 1] = at, high
            waiting[n_waiting + 1, 0], waiting[n_waiting + 1, 1] = low, at
            n_waiting += 2
    return _Over(lower_bound, least, share), n_parts > 1


@kernel
def budget_intervals(surface, world, path, errors, asked, rows, tally, table):
    """Fills `rows` with what errors leave of all pairs in the motion from each of some steps to the next.

    Args: as of `budget_moments`; ball joints are among the links as joints that turn, whose fixed parts and
        axes are written for each interval.
    """
    lent = lend(surface)
    state = _new_state(world, errors)
    n_pairs = len(world.pairs)
    for i in range(len(tally)):
        tally[i] = 0
    for place in range(len(asked.intervals)):
        step, least = asked.intervals[place], asked.known[place]
        lower_bound, share, winner = least, -1.0, np.int64(-1)
        begin_arcs(world.links, path.balls, step)
        _go_to(surface, world, errors, path, step, 0.0, 1.0, state)
        for body in range(len(world.frames)):
            place_box(
                surface,
                surface.roots[world.solids[body]],
                body,
                _pose(world, body, state),
                state.boxes,
            )
        order = asked.order[place]
        moved = False
        for turn in range(-1, n_pairs):
            pair = order if turn < 0 else np.int64(turn)
            if turn == order or pair < 0:
                continue
            if moved:
                _go_to(surface, world, errors, path, step, 0.0, 1.0, state)
                moved = False
            target = min(asked.enough, least - allowed_gap(least, asked.gap, asked.fail))
            bound = _by_boxes(surface, world, pair, state, target)
            if bound >= target:
                lower_bound = min(lower_bound, bound)
                tally[0] += 1
                continue
            over, moved = _hold(
                lent, surface, world, path, errors, step, pair, least, asked, state, tally
            )
            if over.share >= 0.0 and over.least < least:
                least, share = over.least, over.share
            if over.lower_bound < lower_bound:
                lower_bound, winner = over.lower_bound, pair
        rows.proven[place] = lower_bound
        rows.pair[place] = winner
        rows.share[place] = share
        rows.faces[place, 0] = rows.faces[place, 1] = -1
