"""A proven lower bound on the clearance of motions by two clocks that nothing ties, or only to within a slack.

For each interval of clock a: over all its times, all times of clock b within the band, and all pairs of a body of
either clock. Rectangles of both times (`clock_rectangles`) are visited with the motion bounds of both clocks'
spans (`clock_tree`). A pair is done in a rectangle if its boxes prove the target, or the search about the middle
does (`rectangle_pair`). For the other pairs the rectangle is halved in the time of the body that moves more. Not
for: the steps (`unsynchronised_steps`), motion by one clock (`certify`).
"""

import math
from typing import NamedTuple

import numpy as np

from clearance.compile.declared import Floats, Integers
from clearance.compile.decorators import inline, kernel
from clearance.compile.lending import lend
from clearance.kernels.clocks.clock_rectangles import (
    ALL_TIMES,
    DEPTH,
    OpenRectangle,
    clipped,
    is_whole,
    meets_band,
    middle_occurs,
    new_rectangle_stack,
    put_open,
    put_rectangle,
    read_rectangle,
)
from clearance.kernels.clocks.clock_tree import is_leaf_of_clock, middle_leaf, n_leaves_of
from clearance.kernels.clocks.rectangle_pair import (
    RectangleGoal,
    RectangleState,
    prove_in_rectangle,
)
from clearance.kernels.clocks.two_clocks import TwoClocks
from clearance.kernels.mesh.surface import Surface
from clearance.kernels.motion.certify import ROUNDED_DOWN
from clearance.kernels.motion.halving import (
    WIDER,
    Visit,
    halve,
    put_halves,
    with_part,
    without_part,
)
from clearance.kernels.motion.interval_middle import begin_arcs, go_to_middle, new_middle
from clearance.kernels.motion.twist import CertificateGoal
from clearance.kernels.search.carried import nothing_carried
from clearance.kernels.search.proof import allowed_gap
from clearance.kernels.search.scratch import new_scratch


class TwoClockBounds(NamedTuple):
    """The bounds on each interval of clock a.

    Attributes:
        lower, upper: (m,) [m] proven, and the least distance seen.
        share_a: (m,) where in the interval it was seen, 0 to 1. step_b, share_b: (m,) the interval of clock b, and
            where in it. pair: (m,) which pair.
    """

    lower: Floats
    upper: Floats
    share_a: Floats
    step_b: Integers
    share_b: Floats
    pair: Integers


class StepsOfClock(NamedTuple):
    """The clearances of the steps of clock a.

    Attributes:
        clearance: (m + 1,) [m] the least over all steps of clock b in the band.
        step_b: (m + 1,) the step of clock b at which it occurs. pair: (m + 1,) which pair.
    """

    clearance: Floats
    step_b: Integers
    pair: Integers


@inline
def _bring(clocks, tree, span, at, part):
    """Puts `part` in the middle of a part of an interval, unless the node is whole or `part` is there already."""
    leaf = tree.start + tree.first[span.node]
    if is_whole(span) or (at[0] == leaf and at[1] == span.low and at[2] == span.high):
        return
    begin_arcs(clocks.world.links, clocks.path.balls, leaf)
    go_to_middle(clocks.world.links, clocks.path, leaf, span.low, span.high, part)
    at[0], at[1], at[2] = leaf, span.low, span.high


@inline
def _goal_of(clocks, rectangle, aim, bounds, state):
    """The bound to prove in a rectangle; the target is 0 where there is nothing to prove."""
    tree, node = clocks.tree_a, rectangle.a.node
    least, target, gap = 0.0, 0.0, aim.gap
    for row in range(tree.first[node], tree.last[node]):
        upper = bounds.upper[row]
        least = max(least, upper)
        target = max(target, upper - allowed_gap(upper, state.gaps[row], aim.fail))
        gap = state.gaps[row]
    one = is_leaf_of_clock(tree, node)
    counts = one and middle_occurs(tree, clocks.tree_b, rectangle, clocks.band)
    is_fine = one and is_leaf_of_clock(clocks.tree_b, rectangle.b.node)
    allowed = CertificateGoal(gap if one else aim.gap, aim.fail, aim.most_parts)
    return RectangleGoal(least, target, allowed, is_fine, counts)


@inline
def _note_seen(clocks, rectangle, pair, distance, bounds):
    """Notes a distance that occurs in the middle of a rectangle [m], the least in its interval so far."""
    a, b, tree_b = rectangle.a, rectangle.b, clocks.tree_b
    row = clocks.tree_a.first[a.node]
    bounds.upper[row], bounds.pair[row] = distance, pair
    bounds.share_a[row] = 0.5 * (a.low + a.high)
    bounds.step_b[row] = tree_b.start + middle_leaf(tree_b, b.node)
    bounds.share_b[row] = 0.5 * (b.low + b.high) if is_leaf_of_clock(tree_b, b.node) else 0.5


@inline
def _visit_pairs(surface, clocks, rectangle, count, aim, bounds, state):
    """Visits the listed pairs in a rectangle: (how many stay open, True to halve it in a's time).

    The open pairs are listed.

    Many arguments: they are grouped in tuples already.
    """
    r, listed, lower_bounds = rectangle, state.waiting.listed, state.lower_bounds
    one_a = is_leaf_of_clock(clocks.tree_a, r.a.node)
    one_b = is_leaf_of_clock(clocks.tree_b, r.b.node)
    goal = _goal_of(clocks, r, aim, bounds, state)
    most_a, most_b = 0.0, 0.0
    n_open = 0
    for place in range(count):
        if goal.target <= 0.0:
            lower_bounds[r.a.node] = min(lower_bounds[r.a.node], 0.0)
            return 0, True
        pair = listed[place]
        seen = prove_in_rectangle(surface, clocks, r, pair, goal, state)
        if seen.is_done:
            lower_bounds[r.a.node] = min(lower_bounds[r.a.node], seen.lower_bound)
        else:
            listed[n_open] = pair
            n_open += 1
            most_a, most_b = max(most_a, seen.moved_a), max(most_b, seen.moved_b)
        if goal.counts and seen.least < goal.least:
            _note_seen(clocks, r, pair, seen.least, bounds)
            goal = _goal_of(clocks, r, aim, bounds, state)
    in_a = most_a > most_b
    if one_a and not one_b and not goal.counts:
        in_a = False  # the times of clock b extend beyond the band
    elif not one_a and one_b:
        in_a = True  # a distance counts only in one interval of clock a
    return n_open, in_a


@inline
def _seen_at(clocks, rectangle, in_a, bounds):
    """[s] the time by one clock at which the least distance of a rectangle's intervals was seen."""
    row = middle_leaf(clocks.tree_a, rectangle.a.node)
    step, share = bounds.step_b[row], bounds.share_b[row]
    if in_a:
        step, share = clocks.tree_a.start + row, bounds.share_a[row]
    times = clocks.path.times
    return times[step] + share * (times[step + 1] - times[step])


@inline
def _begin(clocks, steps, aim, bounds, state):
    """Takes the nearer end of each interval as the least distance seen, and queues all times of both clocks."""
    n_steps = n_leaves_of(clocks.tree_b) + 1
    for row in range(len(bounds.upper)):
        end = 1 if steps.clearance[row + 1] < steps.clearance[row] else 0
        step_b = steps.step_b[row + end]
        bounds.upper[row], bounds.pair[row] = steps.clearance[row + end], steps.pair[row + end]
        bounds.share_a[row] = end
        bounds.step_b[row] = min(step_b, n_steps - 2)
        bounds.share_b[row] = step_b - bounds.step_b[row]
        state.gaps[row] = aim.gap
    for pair in range(len(state.waiting.listed)):
        state.waiting.listed[pair] = pair
    put_rectangle(ALL_TIMES, len(state.waiting.listed), state.waiting, 0)


@inline
def _end(clocks, bounds, state):
    """Passes the bounds of the nodes of clock a down to its intervals."""
    tree, lower_bounds = clocks.tree_a, state.lower_bounds
    for node in range(len(tree.first)):
        earlier = tree.earlier[node]
        if earlier < 0:
            row = tree.first[node]
            lower = min(lower_bounds[node], bounds.upper[row] * ROUNDED_DOWN)
            bounds.lower[row] = max(0.0, lower)
        else:
            lower_bounds[earlier] = min(lower_bounds[earlier], lower_bounds[node])
            lower_bounds[earlier + 1] = min(lower_bounds[earlier + 1], lower_bounds[node])


@kernel
def certify_unsynchronised(
    surface: Surface,
    clocks: TwoClocks,
    steps: StepsOfClock,
    aim: CertificateGoal,
    bounds: TwoClockBounds,
    tally: Integers,
):
    """Fills `bounds` of the intervals of clock a that are the leaves of its tree.

    Args:
        surface: every face owns all its features.
        clocks: `TwoClocks`, with trees of intervals. steps: `StepsOfClock`, a clearance of 0 for a contact.
        aim: a `CertificateGoal`; its `most_parts` are rectangles of one interval of clock a.
        tally: (5,) counts: rectangles, pairs that boxes separate, searches, nodes and faces visited.
    """
    n_links, n_rows = len(clocks.world.links.parents), len(bounds.upper)
    n_pairs = len(clocks.world.pairs)
    state = lend(RectangleState(
        new_rectangle_stack(n_pairs), np.empty(n_rows), np.zeros(n_rows, dtype=np.int64),
        np.full(len(clocks.tree_a.first), math.inf), nothing_carried(0, n_pairs, 0),
        new_middle(n_links), new_middle(n_links), np.full((2, 3), -1.0), new_scratch(), tally,
    ))  # fmt: skip
    for i in range(len(tally)):
        tally[i] = 0
    _begin(clocks, steps, aim, bounds, state)
    halve(RectangleProofs(lend(surface), clocks, aim, bounds, state), DEPTH)
    _end(clocks, bounds, state)


class RectangleProofs(NamedTuple):
    """The arguments of a visit of a rectangle; surface, clocks, bounds and state are lent."""

    surface: Surface
    clocks: TwoClocks
    aim: CertificateGoal
    bounds: TwoClockBounds
    state: RectangleState


@with_part.register
def _(search: RectangleProofs, place):
    clocks, aim, bounds, state = search.clocks, search.aim, search.bounds, search.state
    tree_a, tree_b = clocks.tree_a, clocks.tree_b
    r, count = read_rectangle(state.waiting, place)
    if not meets_band(tree_a, tree_b, r, clocks.band):
        return Visit(search, OpenRectangle(r, True, 0, 0.0), False)
    state.tally[0] += 1
    if is_leaf_of_clock(tree_a, r.a.node):
        row = tree_a.first[r.a.node]
        state.n_visits[row] += 1
        if state.n_visits[row] % aim.most_parts == 0:
            state.gaps[row] *= WIDER
        if is_leaf_of_clock(tree_b, r.b.node):
            r = clipped(tree_a, tree_b, r, clocks.band)
    _bring(clocks, tree_a, r.a, state.at[0], state.part_a)
    _bring(clocks, tree_b, r.b, state.at[1], state.part_b)
    n_open, in_a = _visit_pairs(search.surface, clocks, r, count, aim, bounds, state)
    seen = _seen_at(clocks, r, in_a, bounds)
    return Visit(search, OpenRectangle(r, in_a, n_open, seen), n_open > 0)


@without_part.register
def _(search: RectangleProofs, part):
    search.state.lower_bounds[part.rectangle.a.node] = 0.0
    return search


@put_halves.register
def _(search: RectangleProofs, part, place):
    clocks = search.clocks
    put_open(clocks.tree_a, clocks.tree_b, part, search.state.waiting, place)
