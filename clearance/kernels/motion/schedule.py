"""Which bodies need a visit, where only near pairs are asked for: those that may have used up their bound.

The least bound of a body's pairs exceeds the distance asked for by some margin. Until the body has moved by that
margin (`interval_motion_bound`), no pair of it can come within that distance. So each body is due at its own
times. At a step without due bodies no pose is computed; at others only the pairs of due bodies are visited.

Bodies with pairs that both move form a group and are visited together. A group is due where one of its bodies is,
or where its two greatest motions may have used up the least bound between its bodies.
"""

from typing import NamedTuple

import numpy as np

from clearance.compile.declared import Flags, Floats, Floats2, Integers
from clearance.compile.decorators import inline
from clearance.kernels.motion.interval_motion_bound import interval_motion_bound_of

ROUNDED_UP = 1.0 + 2.0**-51
"""Rounds a sum of two lengths up."""


class Schedule(NamedTuple):
    """The last visit of each body, and its bounds then.

    Attributes:
        motion_radii, noise: of `fill_motion_radii`.
        nearest: (bodies,) [m] the least bound of the pairs of each at its last visit.
        rows, visits: (bodies,) the step of that visit and its number.
        bodies: (bodies,) the due ones first.
        between: (groups,) [m] the least bound at the last visit of the pairs of two moving bodies.
        moved: (bodies,) [m] scratch: the motion of each since. most: (groups, 2) [m] scratch: the two greatest.
        is_due: (groups,) scratch.
    """

    motion_radii: Floats2
    noise: Floats
    nearest: Floats
    rows: Integers
    visits: Integers
    bodies: Integers
    between: Floats
    moved: Floats
    most: Floats2
    is_due: Flags


@inline
def new_schedule(n_bodies, n_columns):
    """A schedule without visits."""
    return Schedule(
        np.empty((n_bodies, n_columns)), np.empty(n_bodies), np.empty(n_bodies),
        np.zeros(n_bodies, dtype=np.int64), np.zeros(n_bodies, dtype=np.int64),
        np.empty(n_bodies, dtype=np.int64), np.full(n_bodies, np.inf), np.empty(n_bodies),
        np.zeros((n_bodies, 2)), np.zeros(n_bodies, dtype=np.bool_),
    )  # fmt: skip


@inline
def all_due(frames, schedule):
    """Makes all bodies that links carry due; the number of them."""
    n_due = 0
    for body in range(len(frames)):
        if frames[body] >= 0:
            schedule.bodies[n_due] = body
            n_due += 1
    return n_due


@inline(force=True)
def find_due(world, positions, row, visit, within, schedule):
    """Finds the bodies that can come `within` [m] at a row of `positions`: (how many, [m] a bound on all others).

    Args:
        visit: the number of the visit that follows.
    """
    frames, groups, most = world.frames, world.groups, schedule.most
    for body in range(len(frames)):
        group = groups[body]
        most[group, 0], most[group, 1], schedule.is_due[group] = 0.0, 0.0, False
    for body in range(len(frames)):
        if frames[body] < 0:
            continue
        group = groups[body]
        moved = interval_motion_bound_of(
            positions, schedule.rows[body], row, schedule.motion_radii[body], schedule.noise[body]
        )
        schedule.moved[body] = moved
        if moved > most[group, 1]:
            most[group, 0], most[group, 1] = max(moved, most[group, 0]), min(moved, most[group, 0])
        if schedule.nearest[body] - moved <= within:
            schedule.is_due[group] = True
    n_due = 0
    least = np.inf
    for body in range(len(frames)):
        if frames[body] < 0:
            continue
        group = groups[body]
        separation = schedule.between[group] - (most[group, 0] + most[group, 1]) * ROUNDED_UP
        if schedule.is_due[group] or separation <= within:
            schedule.bodies[n_due], schedule.visits[body] = body, visit
            n_due += 1
        else:
            least = min(least, min(separation, schedule.nearest[body] - schedule.moved[body]))
    return n_due, least


@inline(force=True)
def forget_between(groups, bodies, schedule):
    """Resets the bounds between the bodies of these bodies' groups."""
    for body in bodies:
        schedule.between[groups[body]] = np.inf


@inline(force=True)
def note_between(group, bound, schedule):
    """Notes a bound of a pair of two moving bodies [m]."""
    schedule.between[group] = min(schedule.between[group], bound)


@inline(force=True)
def note_visit(body, row, nearest, schedule):
    """Notes a visit of a body, and the least bound of its pairs [m]."""
    schedule.rows[body], schedule.nearest[body] = row, nearest
