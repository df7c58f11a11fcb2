"""Which bodies need a look, where only what is near is asked for: those that may have moved as far as they may.

A body may move as far as the bounds of all its pairs exceed what is asked, half of that where both of a pair move;
until then, by the positions of the joints alone (`stride`), no pair of it can come within what is asked. So every
body has a clock of its own: at a step at which none is due, no pose is made, and where one is, only its pairs are
looked at.
"""

from typing import NamedTuple

import numpy as np

from clearance.jit import inlined, merged, shared
from clearance.kernels.stride import fill_reach, stride_of


class Due(NamedTuple):
    """When each body was looked at, and how far it may move until it is due.

    Attributes:
        reach, noise: of `fill_reach`.
        spare: (bodies,) [m] how far each may move from where it was at the last look at it.
        rows, looks: (bodies,) the step and the number of that look; of a body that stands the look is -1.
        starts, pairs: (bodies + 1,), (2 p,) the pairs of body k are `pairs[starts[k]:starts[k + 1]]`.
        bodies: (bodies,) in front those that are looked at.
        asked: (p,) in front the pairs to look at. taken: (p,) the last look at which each was among them.
    """

    reach: np.ndarray
    noise: np.ndarray
    spare: np.ndarray
    rows: np.ndarray
    looks: np.ndarray
    starts: np.ndarray
    pairs: np.ndarray
    bodies: np.ndarray
    asked: np.ndarray
    taken: np.ndarray


@shared
def room_for_due(n_bodies, n_pairs, n_columns):
    """Nothing is said yet."""
    return Due(
        np.empty((n_bodies, n_columns)), np.empty(n_bodies), np.empty(n_bodies),
        np.zeros(n_bodies, dtype=np.int64), np.full(n_bodies, -1),
        np.zeros(n_bodies + 1, dtype=np.int64), np.empty(2 * n_pairs, dtype=np.int64),
        np.empty(n_bodies, dtype=np.int64), np.arange(n_pairs), np.full(n_pairs, -1),
    )  # fmt: skip


@inlined
def all_due(frames, due):
    """Makes all bodies due that links carry; the number of them. All pairs are to be looked at."""
    n_due = 0
    for body in range(len(frames)):
        due.spare[body] = np.inf
        if frames[body] >= 0:
            due.looks[body] = 0
            due.bodies[n_due] = body
            n_due += 1
    return n_due


@inlined
def fill_due(surface, world, positions, due):
    """Fills what is known of all steps beforehand."""
    fill_reach(surface, world.frames, world.links, positions, due.reach, due.noise)
    pairs, starts = world.pairs, due.starts
    for pair in range(len(pairs)):
        starts[pairs[pair, 0]] += 1
        starts[pairs[pair, 1]] += 1
    end = 0
    for body in range(len(starts)):
        end += starts[body]
        starts[body] = end
    for pair in range(len(pairs) - 1, -1, -1):
        for side in range(2):
            body = pairs[pair, side]
            starts[body] -= 1
            due.pairs[starts[body]] = pair


@merged
def find_due(frames, positions, row, due):
    """Finds who is due at a row of `positions`: (how many, [m] the least that the others may still move)."""
    n_due = 0
    least = np.inf
    for body in range(len(frames)):
        if frames[body] < 0:
            continue
        left = due.spare[body] - stride_of(positions, due.rows[body], row, due.reach[body], due.noise[body])
        if left <= 0.0:
            due.bodies[n_due] = body
            n_due += 1
        else:
            least = min(least, left)
    return n_due, least


@merged
def _comes_along(positions, row, look, body, due):
    """Notes that a body is looked at that is not due: what it may move is less by what it has moved."""
    due.spare[body] -= stride_of(positions, due.rows[body], row, due.reach[body], due.noise[body])
    due.rows[body] = row
    due.looks[body] = look


@merged
def gather(world, positions, row, look, n_due, due):
    """Fills `due.asked` with the pairs of the bodies that are due; `bodies` then holds the others of these too.

    Returns how many (pairs, bodies).
    """
    for i in range(n_due):
        body = due.bodies[i]
        due.spare[body] = np.inf
        due.rows[body] = row
        due.looks[body] = look
    n_pairs = 0
    n_bodies = n_due
    for i in range(n_due):
        body = due.bodies[i]
        for k in range(due.starts[body], due.starts[body + 1]):
            pair = due.pairs[k]
            if due.taken[pair] == look:
                continue
            due.taken[pair] = look
            due.asked[n_pairs] = pair
            n_pairs += 1
            other = world.pairs[pair, 0] + world.pairs[pair, 1] - body
            if world.frames[other] >= 0 and due.looks[other] != look:
                _comes_along(positions, row, look, other, due)
                due.bodies[n_bodies] = other
                n_bodies += 1
    return n_pairs, n_bodies


@merged
def spend(world, pair, spare_of_pair, due):
    """Notes how far the bodies of a pair may move from where they are: each half as far where both do."""
    body_a, body_b = world.pairs[pair, 0], world.pairs[pair, 1]
    if world.frames[body_a] >= 0 and world.frames[body_b] >= 0:
        spare_of_pair *= 0.5
    due.spare[body_a] = min(due.spare[body_a], spare_of_pair)
    due.spare[body_b] = min(due.spare[body_b], spare_of_pair)
