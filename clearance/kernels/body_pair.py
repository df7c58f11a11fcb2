"""The distance of two bodies: descent of their trees, then containment."""

from typing import NamedTuple

import numpy as np

from clearance.jit import inlined, kernel
from clearance.kernels.bounds import rounding_slack
from clearance.kernels.containment import contained
from clearance.kernels.descent import STACK_DEPTH, Scratch, Tally, descend, nothing_yet
from clearance.kernels.face_pair import Hit, nearest_of_faces
from clearance.kernels.vec3 import relative, rigid

NO_FACE = -1


class Measured(NamedTuple):
    """What is known of a body pair.

    Attributes:
        hit: the nearest points (frame of a), if nearer than the limit asked for; else faces of 2**62.
        lower_bound: [m] proven.
    """

    hit: Hit
    lower_bound: float
    tally: Tally


@inlined
def new_scratch():
    """Room for one search at a time."""
    return Scratch(np.empty((STACK_DEPTH, 2), dtype=np.int64), np.empty(STACK_DEPTH))


@inlined
def measure_pair(a, body_a, b, body_b, m, limit_sq, seed_a, seed_b, apart, scratch):
    """The nearest points of two bodies, or a proof that they are farther apart than the limit.

    Args:
        m: `a_from_b`.
        limit_sq: [m^2] pairs of points farther apart are not wanted.
        seed_a, seed_b: faces that were nearest before, or NO_FACE; they change the work, not the answer.
        apart: True if it is known that neither body is inside the other.
    """
    start = nothing_yet(limit_sq)
    best = start
    if seed_a >= 0:
        best = nearest_of_faces(a, seed_a, b, seed_b, m, False, best)
        if best.gap_sq == 0.0:  # which of several contacts is found must not depend on the seed
            best = start
    found = descend(a, a.roots[body_a], b, b.roots[body_b], m, best, scratch)
    if found.hit.gap_sq > 0.0 and not apart:
        inside, x = contained(a, body_a, b, body_b, m)
        if inside:
            return Measured(Hit(0.0, NO_FACE, NO_FACE, x, x), 0.0, found.tally)
    slack = rounding_slack(a, a.roots[body_a], b, b.roots[body_b], m)
    return Measured(found.hit, max(0.0, np.sqrt(found.floor_sq) - slack), found.tally)


@kernel
def nearest_bodies(a, b, world_from_a, world_from_b):
    """The nearest points of two bodies at given (4, 4) poses; points in the frame of a."""
    m = relative(rigid(world_from_a), rigid(world_from_b))
    return measure_pair(a, 0, b, 0, m, np.inf, NO_FACE, NO_FACE, False, new_scratch())
