"""Which bodies need a look, where only what is near is asked for: those that may have moved as far as they may.

A body may move as far as the least bound of its pairs exceeds what is asked; until then, by the positions of the
joints alone (`interval_motion_bound`), no pair of it can come within what is asked. So every body has a clock of
its own: at a step at which none is due, no pose is made, and where one is, only its pairs are looked at.
"""

from typing import NamedTuple

import numpy as np

from clearance.compile.jit import inline, shared
from clearance.kernels.motion.interval_motion_bound import interval_motion_bound_of


class Schedule(NamedTuple):
    """When each body was looked at, and how far it may move until it is due.

    Attributes:
        motion_radii, noise: of `fill_motion_radii`.
        nearest: (bodies,) [m] the least bound of the pairs of each at the last look at it.
        rows, looks: (bodies,) the step of that look and its number.
        bodies: (bodies,) in front those that are due.
    """

    motion_radii: np.ndarray
    noise: np.ndarray
    nearest: np.ndarray
    rows: np.ndarray
    looks: np.ndarray
    bodies: np.ndarray


@shared
def new_schedule(n_bodies, n_columns):
    """Nothing is said yet."""
    return Schedule(
        np.empty((n_bodies, n_columns)), np.empty(n_bodies), np.empty(n_bodies),
        np.zeros(n_bodies, dtype=np.int64), np.zeros(n_bodies, dtype=np.int64),
        np.empty(n_bodies, dtype=np.int64),
    )  # fmt: skip


@inline
def all_due(frames, due):
    """Makes all bodies due that links carry; the number of them."""
    n_due = 0
    for body in range(len(frames)):
        if frames[body] >= 0:
            due.bodies[n_due] = body
            n_due += 1
    return n_due


@inline(force=True)
def find_due(frames, positions, row, look, within, due):
    """Finds who can come `within` [m] at a row of `positions`: (how many, [m] how near the others can be).

    Args:
        look: the number of the look that follows.
    """
    n_due = 0
    least = np.inf
    for body in range(len(frames)):
        if frames[body] < 0:
            continue
        way = interval_motion_bound_of(
            positions, due.rows[body], row, due.motion_radii[body], due.noise[body]
        )
        if due.nearest[body] - way <= within:
            due.bodies[n_due], due.looks[body] = body, look
            n_due += 1
        else:
            least = min(least, due.nearest[body] - way)
    return n_due, least


@inline(force=True)
def note_look(body, row, nearest, due):
    """Notes that a body was looked at, and the least bound of its pairs [m]."""
    due.rows[body], due.nearest[body] = row, nearest
