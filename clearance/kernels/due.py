"""Which bodies need a look, where only what is near is asked for: those that may have moved as far as they may.

A body may move as far as the least bound of its pairs exceeds what is asked; until then, by the positions of the
joints alone (`stride`), no pair of it can come within what is asked. So every body has a clock of its own: at a
step at which none is due, no pose is made, and where one is, only its pairs are looked at.
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
        rows, looks: (bodies,) the step and the number of that look.
        starts, pairs: (bodies + 1,), (p,) the pairs of body k are `pairs[starts[k]:starts[k + 1]]`.
        bodies: (bodies,) in front those that are due. asked: (p,) in front the pairs to look at.
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


@shared
def room_for_due(n_bodies, n_pairs, n_columns):
    """Every pair is to be looked at; nothing else is said yet."""
    return Due(
        np.empty((n_bodies, n_columns)), np.empty(n_bodies), np.full(n_bodies, np.inf),
        np.zeros(n_bodies, dtype=np.int64), np.zeros(n_bodies, dtype=np.int64),
        np.zeros(n_bodies + 1, dtype=np.int64), np.empty(n_pairs, dtype=np.int64),
        np.empty(n_bodies, dtype=np.int64), np.arange(n_pairs),
    )  # fmt: skip


@inlined
def all_due(frames, due):
    """Makes all bodies due that links carry; the number of them."""
    n_due = 0
    for body in range(len(frames)):
        if frames[body] >= 0:
            due.bodies[n_due] = body
            n_due += 1
    return n_due


@inlined
def fill_due(surface, world, positions, due):
    """Fills what is known of all steps beforehand."""
    fill_reach(surface, world.frames, world.links, positions, due.reach, due.noise)
    starts = due.starts
    for pair in range(len(world.pairs)):
        starts[world.pairs[pair, 0]] += 1
    end = 0
    for body in range(len(starts)):
        end += starts[body]
        starts[body] = end
    for pair in range(len(world.pairs) - 1, -1, -1):
        body = world.pairs[pair, 0]
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
def gather(row, look, n_due, due):
    """Fills `due.asked` with the pairs of the bodies that are due and looked at now; how many."""
    n_pairs = 0
    for i in range(n_due):
        body = due.bodies[i]
        due.spare[body], due.rows[body], due.looks[body] = np.inf, row, look
        for k in range(due.starts[body], due.starts[body + 1]):
            due.asked[n_pairs] = due.pairs[k]
            n_pairs += 1
    return n_pairs


@merged
def spend(body, spare, due):
    """Notes that a body may move no farther than `spare` [m] from where it is, for one of its pairs."""
    due.spare[body] = min(due.spare[body], spare)
