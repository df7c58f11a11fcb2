"""Which bodies need a look, where only what is near is asked for: those that may have moved as far as they may.

A body may move as far as the least bound of its pairs exceeds what is asked; until then, by the positions of the
joints alone (`interval_motion_bound`), no pair of it can come within what is asked. So every body has a clock of
its own: at a step at which none is due, no pose is made, and where one is, only its pairs are looked at.

Bodies between which there are pairs that both move are one group, looked at together: it is due where one of its
bodies is, or where the two that have moved farthest may have come as near as the least bound between its bodies.
"""

from typing import NamedTuple

import numpy as np

from clearance.compile.declared import Flags, Floats, Floats2, Integers
from clearance.compile.decorators import inline
from clearance.kernels.motion.interval_motion_bound import interval_motion_bound_of

ROUNDED_UP = 1.0 + 2.0**-51
"""Makes a sum of two lengths no less than the true one."""


class Schedule(NamedTuple):
    """When each body was looked at, and how far it may move until it is due.

    Attributes:
        motion_radii, noise: of `fill_motion_radii`.
        nearest: (bodies,) [m] the least bound of the pairs of each at the last look at it.
        rows, looks: (bodies,) the step of that look and its number.
        bodies: (bodies,) in front those that are due.
        between: (groups,) [m] the least bound of the pairs at the last look of which both bodies move.
        ways: (bodies,) [m] and most: (groups, 2) [m] room: how far each may have moved, and the farthest two.
        is_due: (groups,) room.
    """

    motion_radii: Floats2
    noise: Floats
    nearest: Floats
    rows: Integers
    looks: Integers
    bodies: Integers
    between: Floats
    ways: Floats
    most: Floats2
    is_due: Flags


@inline
def new_schedule(n_bodies, n_columns):
    """Nothing is said yet."""
    return Schedule(
        np.empty((n_bodies, n_columns)), np.empty(n_bodies), np.empty(n_bodies),
        np.zeros(n_bodies, dtype=np.int64), np.zeros(n_bodies, dtype=np.int64),
        np.empty(n_bodies, dtype=np.int64), np.full(n_bodies, np.inf), np.empty(n_bodies),
        np.zeros((n_bodies, 2)), np.zeros(n_bodies, dtype=np.bool_),
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
def find_due(world, positions, row, look, within, due):
    """Finds who can come `within` [m] at a row of `positions`: (how many, [m] how near the others can be).

    Args:
        look: the number of the look that follows.
    """
    frames, groups, most = world.frames, world.groups, due.most
    for body in range(len(frames)):
        group = groups[body]
        most[group, 0], most[group, 1], due.is_due[group] = 0.0, 0.0, False
    for body in range(len(frames)):
        if frames[body] < 0:
            continue
        group = groups[body]
        way = interval_motion_bound_of(
            positions, due.rows[body], row, due.motion_radii[body], due.noise[body]
        )
        due.ways[body] = way
        if way > most[group, 1]:
            most[group, 0], most[group, 1] = max(way, most[group, 0]), min(way, most[group, 0])
        if due.nearest[body] - way <= within:
            due.is_due[group] = True
    n_due = 0
    least = np.inf
    for body in range(len(frames)):
        if frames[body] < 0:
            continue
        group = groups[body]
        apart = due.between[group] - (most[group, 0] + most[group, 1]) * ROUNDED_UP
        if due.is_due[group] or apart <= within:
            due.bodies[n_due], due.looks[body] = body, look
            n_due += 1
        else:
            least = min(least, min(apart, due.nearest[body] - due.ways[body]))
    return n_due, least


@inline(force=True)
def forget_between(groups, bodies, due):
    """Nothing is known of the pairs between the bodies of these bodies' groups."""
    for body in bodies:
        due.between[groups[body]] = np.inf


@inline(force=True)
def note_between(group, bound, due):
    """Notes a bound of a pair of which both bodies move [m]."""
    due.between[group] = min(due.between[group], bound)


@inline(force=True)
def note_look(body, row, nearest, due):
    """Notes that a body was looked at, and the least bound of its pairs [m]."""
    due.rows[body], due.nearest[body] = row, nearest
