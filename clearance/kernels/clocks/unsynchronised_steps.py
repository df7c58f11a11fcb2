"""The least clearance of each step of one clock over all steps of another that can occur with it, exactly.

As in `unsynchronised`, rectangles of both clocks' steps are visited. A pair is measured in the middle, and the
motion of both bodies in the rectangle is subtracted. So one measured distance bounds many pairs of steps, and it
occurs at one of them. A rectangle is skipped only if it is strictly farther than the best. Ties go to the least
pair, then to the least step of the other clock. Not for: motion between the steps.
"""

from typing import NamedTuple

import numpy as np

from clearance.compile.declared import Floats, Floats3, Integers
from clearance.compile.decorators import inline, kernel
from clearance.compile.lending import lend
from clearance.kernels.arithmetic.double_double import frames_of
from clearance.kernels.arithmetic.vec3 import rigid
from clearance.kernels.clocks.clock_rectangles import (
    ALL_TIMES,
    DEPTH,
    OpenRectangle,
    RectangleStack,
    meets_band,
    middle_occurs,
    new_rectangle_stack,
    put_open,
    put_rectangle,
    read_rectangle,
)
from clearance.kernels.clocks.clock_tree import is_leaf_of_clock, middle_leaf, n_leaves_of
from clearance.kernels.clocks.two_clocks import TwoClocks, bound_coarsely
from clearance.kernels.features.face_pair import write_points
from clearance.kernels.features.posed_pair import PosedPair
from clearance.kernels.mesh.surface import Surface
from clearance.kernels.motion.body_boxes import bound_between
from clearance.kernels.motion.halving import Visit, halve, put_halves, with_part, without_part
from clearance.kernels.motion.sweep_state import NOT_LESS
from clearance.kernels.search.body_pair import (
    NOTHING_MEASURED,
    TO_THE_END,
    PairQuestion,
    search,
)
from clearance.kernels.search.carried import Carried, carry_faces, nothing_carried
from clearance.kernels.search.front import PairFront
from clearance.kernels.search.proof import CHAIN_SLACK
from clearance.kernels.search.scratch import Scratch, new_scratch

SAMPLED_STEPS = 16
"""Steps of the other clock, evenly spread, at which all pairs are measured before the first rectangle."""

WALK = 16
"""Most steps of the other clock to walk from the best one of the step before."""


class StepMinima(NamedTuple):
    """The least clearance of each step of clock a.

    Attributes:
        clearance: (m,) [m] the least distance. step_b: (m,) the step of clock b. pair: (m,) which pair.
        points: (m, 2, 3) witness points in the world, each of its body at its own time [m].
        gaps_sq: (m,) [m^2] their squares.
    """

    clearance: Floats
    step_b: Integers
    pair: Integers
    points: Floats3
    gaps_sq: Floats


class StepsState(NamedTuple):
    """Scratch: waiting rectangles, the witness faces of each pair, and scratch of a search."""

    waiting: RectangleStack
    carried: Carried
    scratch: Scratch


class StepsPair(NamedTuple):
    """A pair at one step of each clock.

    Attributes:
        bodies: a `PosedPair`. not_nested: True if boxes prove it. within: [m] greatest distance of interest.
    """

    pair: int
    bodies: PosedPair
    not_nested: bool
    within: float


@inline
def _rows_of(clocks, pair, leaf_a, leaf_b):
    """The rows of a pair's bodies in both trees."""
    tree_a, tree_b, pairs = clocks.tree_a, clocks.tree_b, clocks.world.pairs
    row_a = leaf_a * tree_a.moved.shape[1] + clocks.columns[pairs[pair, 0]]
    return row_a, leaf_b * tree_b.moved.shape[1] + clocks.columns[pairs[pair, 1]]


@inline
def _bodies_at(lent, clocks, pair, row_a, row_b):
    """A pair's bodies at one step of each clock."""
    solids, pairs = clocks.world.solids, clocks.world.pairs
    pose_a, pose_b = rigid(clocks.tree_a.poses[row_a]), rigid(clocks.tree_b.poses[row_b])
    return PosedPair(
        lent, solids[pairs[pair, 0]], lent, solids[pairs[pair, 1]], frames_of(pose_a, pose_b)
    )


@inline
def _measured(asked, state, tally):
    """The answer of `search` for a `StepsPair`."""
    faces = state.carried.faces[asked.pair]
    question = PairQuestion(
        asked.within, asked.within, faces[0], faces[1], asked.not_nested, TO_THE_END, False
    )
    front = PairFront(state.carried.fronts, asked.pair, 0.0)
    found = search(asked.bodies, question, front, state.scratch)
    carry_faces(asked.pair, found, state.carried)
    tally[2] += 1
    tally[3] += found.tally.nodes
    tally[4] += found.tally.faces
    return found


@inline
def _note(row, step_b, pair, hit, found):
    """Notes a distance at a step of clock a, if it is the least so far; True if it is.

    Ties go to the least pair, then to the least step of clock b.
    """
    best = found.gaps_sq[row]
    is_before = pair < found.pair[row] or (pair == found.pair[row] and step_b < found.step_b[row])
    if hit.face_a == 2**62 or hit.gap_sq == np.inf:
        return False
    if hit.gap_sq > best or (hit.gap_sq == best and not is_before):
        return False
    found.gaps_sq[row], found.pair[row], found.step_b[row] = hit.gap_sq, pair, step_b
    found.clearance[row] = np.sqrt(hit.gap_sq)
    write_points(hit, found.points[row])
    return True


@inline
def _at_steps(lent, clocks, pair, row, step_b, state, found, tally):
    """Measures a pair at a step of either clock, if it can be the least there; True if it is.

    Many arguments: they are grouped in tuples already.
    """
    row_a, row_b = _rows_of(clocks, pair, row, step_b)
    within = found.clearance[row] * NOT_LESS
    bound = bound_between(clocks.tree_a.boxes, row_a, clocks.tree_b.boxes, row_b, within)
    if bound > within:
        return False
    bodies = _bodies_at(lent, clocks, pair, row_a, row_b)
    hit = _measured(StepsPair(pair, bodies, bound > 0.0, within), state, tally).hit
    return _note(row, step_b, pair, hit, found)


@inline
def _occur(clocks, row, step_b):
    """True if two steps can occur together."""
    times = clocks.path.times
    not_nested = abs(times[clocks.tree_a.start + row] - times[step_b])
    return not_nested <= clocks.band.slack + 2.0 * clocks.band.rounding


@inline
def _nearest_step(clocks, row):
    """The step of clock b that is nearest in time to a step of clock a; it occurs with it if any does."""
    times = clocks.path.times
    time, low, high = times[clocks.tree_a.start + row], 0, n_leaves_of(clocks.tree_b) - 1
    while low < high:
        middle = (low + high) // 2
        if times[middle] < time:
            low = middle + 1
        else:
            high = middle
    return low - 1 if low > 0 and time - times[low - 1] < times[low] - time else low


@inline
def _sample_step(lent, clocks, row, state, found, tally):
    """Measures all pairs of a step of clock a at a few steps of clock b, for a distance near the least."""
    n_b = n_leaves_of(clocks.tree_b)
    own = _nearest_step(clocks, row)
    if not _occur(clocks, row, own):
        return
    for pair in range(len(clocks.world.pairs)):
        _at_steps(lent, clocks, pair, row, own, state, found, tally)
    for k in range(SAMPLED_STEPS):
        step_b = (n_b - 1) * k // (SAMPLED_STEPS - 1)
        if _occur(clocks, row, step_b):
            for pair in range(len(clocks.world.pairs)):
                _at_steps(lent, clocks, pair, row, step_b, state, found, tally)


@inline
def _walk(lent, clocks, row, state, found, tally):
    """Measures a step of clock a near the best of the step before, for a distance near the least."""
    n_b = n_leaves_of(clocks.tree_b)
    pair, step_b = found.pair[row - 1], found.step_b[row - 1]
    own = _nearest_step(clocks, row)
    if step_b < 0 or not _occur(clocks, row, own):
        _sample_step(lent, clocks, row, state, found, tally)
        return
    while not _occur(clocks, row, step_b):
        step_b += 1 if step_b < own else -1
    _at_steps(lent, clocks, pair, row, step_b, state, found, tally)
    for side in (-1, 1):
        at = step_b
        for _ in range(WALK):
            at += side
            if at < 0 or at >= n_b or not _occur(clocks, row, at):
                break
            if not _at_steps(lent, clocks, pair, row, at, state, found, tally):
                break


@inline
def _is_settled(clocks, rectangle, pair, found):
    """True if a known contact at the only step of clock a comes before every contact of a pair here."""
    row = clocks.tree_a.first[rectangle.a.node]
    if found.gaps_sq[row] > 0.0 or not is_leaf_of_clock(clocks.tree_a, rectangle.a.node):
        return False
    first = clocks.tree_b.first[rectangle.b.node]
    return pair > found.pair[row] or (pair == found.pair[row] and first >= found.step_b[row])


@inline
def _within(clocks, node, found):
    """[m] the least distance seen at each step of a node, the greatest of these."""
    within = 0.0
    for row in range(clocks.tree_a.first[node], clocks.tree_a.last[node]):
        within = max(within, found.clearance[row])
    return within


@inline
def _measure_in_middle(surface, asked, seen_enough, state, tally):
    """(the answer for a pair in the middle of a rectangle, True if its distance exceeds `asked.within`).

    Args:
        seen_enough: [m] a pair that may be nearer is measured; for others it is enough to know that they are
            within.
    """
    planes, is_near = bound_coarsely(
        surface, asked.bodies, state.carried.faces[asked.pair], asked.within, seen_enough, state.scratch
    )  # fmt: skip
    if is_near or planes > asked.within:
        return NOTHING_MEASURED, not is_near
    near = _measured(asked, state, tally)
    return near, near.lower_bound > asked.within


@inline
def _visit_pairs(surface, clocks, rectangle, count, state, found, tally):
    """Visits the listed pairs in a rectangle: (how many stay open, True to halve it in a's time).

    Many arguments: they are grouped in tuples already.
    """
    r, tree_a, tree_b, listed = rectangle, clocks.tree_a, clocks.tree_b, state.waiting.listed
    pairs, columns = clocks.world.pairs, clocks.columns
    leaf_a, leaf_b = middle_leaf(tree_a, r.a.node), middle_leaf(tree_b, r.b.node)
    one_a, one_b = is_leaf_of_clock(tree_a, r.a.node), is_leaf_of_clock(tree_b, r.b.node)
    occurs = middle_occurs(tree_a, tree_b, r, clocks.band)
    most_a, most_b = 0.0, 0.0
    n_open = 0
    for place in range(count):
        pair = listed[place]
        if _is_settled(clocks, r, pair, found):
            continue
        moved_a = tree_a.moved[r.a.node, columns[pairs[pair, 0]]]
        moved_b = tree_b.moved[r.b.node, columns[pairs[pair, 1]]]
        row_a, row_b = _rows_of(clocks, pair, leaf_a, leaf_b)
        slack = CHAIN_SLACK * (tree_a.boxes.slacks[row_a] + tree_b.boxes.slacks[row_b])
        within = (_within(clocks, r.a.node, found) + moved_a + moved_b) * NOT_LESS + slack
        bound = bound_between(tree_a.boxes, row_a, tree_b.boxes, row_b, within)
        if bound > within:
            tally[1] += 1
            continue
        asked = StepsPair(
            pair, _bodies_at(surface, clocks, pair, row_a, row_b), bound > 0.0, within
        )
        seen_enough = found.clearance[leaf_a] if occurs else 0.0
        if one_a and one_b:
            seen_enough = np.inf
        near, is_far = _measure_in_middle(surface, asked, seen_enough, state, tally)
        if occurs:
            _note(leaf_a, tree_b.start + leaf_b, pair, near.hit, found)
        if not (is_far or (one_a and one_b)):
            listed[n_open] = pair
            n_open += 1
            most_a, most_b = max(most_a, moved_a), max(most_b, moved_b)
    return n_open, one_b or (most_a > most_b and not one_a)


@inline
def _sample_few(lent, clocks, state, found, tally):
    """Measures some steps of clock a, evenly spread; at the others only nearer pairs are of interest."""
    n_a, least = len(found.clearance), np.inf
    for k in range(SAMPLED_STEPS):
        row = (n_a - 1) * k // (SAMPLED_STEPS - 1)
        _sample_step(lent, clocks, row, state, found, tally)
        least = min(least, found.clearance[row])
    for row in range(n_a):
        if found.clearance[row] > least:
            found.clearance[row], found.gaps_sq[row] = least, least * least * NOT_LESS
            found.pair[row], found.step_b[row] = len(clocks.world.pairs), -1  # not seen here


@kernel
def least_of_unsynchronised_steps(
    surface: Surface, clocks: TwoClocks, least_only: bool, found: StepMinima, tally: Integers
):
    """Fills `found` of the steps of clock a that are the leaves of its tree.

    Args:
        clocks: `TwoClocks`, with trees of steps; that of b has all steps.
        least_only: True if only the least of all these steps is wanted; distances of others may be too great.
        tally: (5,) as in `certify_unsynchronised`.
    """
    n_pairs = len(clocks.world.pairs)
    state = lend(
        StepsState(
            new_rectangle_stack(n_pairs),
            nothing_carried(0, n_pairs, 0),
            new_scratch(),
        )
    )
    for i in range(len(tally)):
        tally[i] = 0
    for row in range(len(found.clearance)):
        found.clearance[row], found.gaps_sq[row] = np.inf, np.inf
        found.pair[row], found.step_b[row] = n_pairs, -1
    _least_of_steps(surface, clocks, least_only, state, found, tally)


@inline
def _least_of_steps(surface, clocks, least_only, state, found, tally):
    """The same, with the arrays of its state."""
    lent = lend(surface)
    waiting = state.waiting
    if least_only:
        _sample_few(lent, clocks, state, found, tally)
    else:
        _sample_step(lent, clocks, 0, state, found, tally)
        for row in range(1, len(found.clearance)):
            _walk(lent, clocks, row, state, found, tally)
    put_rectangle(ALL_TIMES, len(waiting.listed), waiting, 0)
    halve(RectanglesOfSteps(lent, clocks, state, found, tally), DEPTH)


class RectanglesOfSteps(NamedTuple):
    """The arguments of a visit of a rectangle; all but the counts are lent."""

    surface: Surface
    clocks: TwoClocks
    state: StepsState
    found: StepMinima
    tally: Integers


@with_part.register
def _(search: RectanglesOfSteps, place):
    clocks, state, found, tally = search.clocks, search.state, search.found, search.tally
    tree_a, tree_b = clocks.tree_a, clocks.tree_b
    r, count = read_rectangle(state.waiting, place)
    if not meets_band(tree_a, tree_b, r, clocks.band):
        return Visit(search, OpenRectangle(r, True, 0, 0.0), False)
    tally[0] += 1
    n_open, in_a = _visit_pairs(search.surface, clocks, r, count, state, found, tally)
    row = middle_leaf(tree_a, r.a.node)
    step = tree_a.start + row if in_a else found.step_b[row]
    seen = clocks.path.times[step] if step >= 0 else -np.inf
    return Visit(search, OpenRectangle(r, in_a, n_open, seen), n_open > 0)


@without_part.register
def _(search: RectanglesOfSteps, part):
    if part.count > 0:  # the result would lack these pairs
        raise AssertionError("too many rectangles wait")
    return search


@put_halves.register
def _(search: RectanglesOfSteps, part, place):
    clocks = search.clocks
    put_open(clocks.tree_a, clocks.tree_b, part, search.state.waiting, place)
