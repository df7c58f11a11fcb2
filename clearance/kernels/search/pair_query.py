"""One body pair at many poses: what a search has found is held, and the next one goes on from there.

The pair, its room to search in and what it knows are written down once, and a call from Python hands over the
address; two surfaces handed over array by array cost more than most searches: 50 µs against 0.8 µs
on a busy machine. Not for: many pairs at once (`sweep`).
"""

from typing import Annotated, NamedTuple

import numpy as np

from clearance.compile.calls import Written
from clearance.compile.declared import Floats2, Floats3, Integers2, LentTo
from clearance.compile.decorators import inline, kernel
from clearance.compile.lending import lend
from clearance.kernels.arithmetic.double_double import frames_of
from clearance.kernels.arithmetic.vec3 import rigid
from clearance.kernels.features.bounds import displacement, rounding_slack
from clearance.kernels.features.face_pair import write_points
from clearance.kernels.features.posed_pair import PosedPair
from clearance.kernels.mesh.surface import Surface, box_of
from clearance.kernels.search.body_pair import NO_FACE, TO_THE_END, PairQuestion, search
from clearance.kernels.search.carried import Carried, carry_faces, nothing_carried
from clearance.kernels.search.front import LONGEST, PairFront, carried_down, forget
from clearance.kernels.search.scratch import Scratch

ROOM = 2 * LONGEST + 16
"""Node pairs that the front of the pair has room for: as many as the longest front asks for."""

ROUNDED_UP = 1.0 + 2.0**-51
"""Makes a sum of two lengths no less than the true one, however many are added one after another."""

SURELY = 1e-7
"""[-] A matrix that is off orthonormal by less is a rotation; of one that is off by more this is not said."""

FAR = 1.0
"""Bodies that move farther than this share of the smaller one's breadth are searched from the roots again."""

POSES_ARE_RIGID, AFRESH = 1, 2
"""How `nearest_at_poses` is asked; numbers, since each argument that Python hands over takes time."""


class HeldPair(NamedTuple):
    """A body pair and what is known of it.

    Attributes:
        a, b: their surfaces, one body each.
        scratch: arrays for the search.
        poses: (2, 4, 4) of both bodies at the last search [m].
        carried: of one pair; what both bodies have moved stands at the first, the second has moved nothing.
        stride: [m] how far they may move at once before a search from the roots is better.
    """

    a: Surface
    b: Surface
    scratch: Scratch
    poses: Floats3
    carried: Carried
    stride: float


@inline
def _breadth(surface):
    """[m] the greatest extent of a body along an axis of its box."""
    half = box_of(surface, surface.roots[0]).half
    return 2.0 * max(half.x, max(half.y, half.z))


def hold_pair(a: Surface, b: Surface, room: int, scratch: Scratch):
    """A pair of surfaces of which nothing is known yet, with room for a front of so many node pairs."""
    held = HeldPair(
        a, b, scratch, np.zeros((2, 4, 4)), nothing_carried(2, 1, room),
        FAR * min(_breadth(a), _breadth(b)),
    )  # fmt: skip
    return Written(held, HeldPair)


@inline
def _is_surely_rigid(pose):
    """True if a (4, 4) matrix is a rigid motion beyond doubt; False for NaN."""
    if not (pose[3, 0] == 0.0 and pose[3, 1] == 0.0 and pose[3, 2] == 0.0 and pose[3, 3] == 1.0):
        return False
    for i in range(3):
        if not abs(pose[i, 3]) <= 1e100:
            return False
        for j in range(3):
            product = pose[0, i] * pose[0, j] + pose[1, i] * pose[1, j] + pose[2, i] * pose[2, j]
            if not abs(product - (1.0 if i == j else 0.0)) <= SURELY:
                return False
    x = pose[1, 0] * pose[2, 1] - pose[2, 0] * pose[1, 1]
    y = pose[2, 0] * pose[0, 1] - pose[0, 0] * pose[2, 1]
    z = pose[0, 0] * pose[1, 1] - pose[1, 0] * pose[0, 1]
    return x * pose[0, 2] + y * pose[1, 2] + z * pose[2, 2] > 0.0


class PairState(NamedTuple):
    """What is known of a pair: the fields of `HeldPair` that change from question to question."""

    poses: Floats3
    carried: Annotated[Carried, LentTo]
    stride: float


@inline
def _accumulated_displacement(a, b, state, pose_a, pose_b, frames):
    """[m] an upper bound on what the points of both bodies have moved in all, by the time of these poses.

    Infinite where they may have come to touch, or where little of what is known can be of use: from a front, the
    first contact can take a hundred times the search that it takes from the roots, and then that one as well.
    """
    way = displacement(a, a.roots[0], state.poses[0], pose_a)
    way += displacement(b, b.roots[0], state.poses[1], pose_b)
    carried = state.carried
    if not way <= state.stride:
        return np.inf
    way += rounding_slack(a, a.roots[0], b, b.roots[0], frames)  # where motions cancel
    moved = (carried.moved[0] + way) * ROUNDED_UP
    return moved if carried.lower_bounds[0] > moved else np.inf


@inline
def _measure(a, b, lent_a, lent_b, state, scratch, pose_a, pose_b):
    """The nearest points of a pair, as `search` gives them.

    Many arguments: what belongs together is in tuples already.
    """
    frames = frames_of(rigid(pose_a), rigid(pose_b))
    moved = _accumulated_displacement(a, b, state, pose_a, pose_b, frames)
    carried = state.carried
    carried.lower_bounds[0] = -np.inf  # until the search has come to its end
    face_a, face_b = carried.faces[0, 0], carried.faces[0, 1]
    question = PairQuestion(np.inf, np.inf, face_a, face_b, True, TO_THE_END, False)
    if moved == np.inf:
        moved = 0.0
        question = PairQuestion(np.inf, np.inf, NO_FACE, NO_FACE, False, TO_THE_END, False)
        forget(carried.fronts, 0)
    bodies = PosedPair(lent_a, 0, lent_b, 0, frames)
    measured = search(bodies, question, PairFront(carried.fronts, 0, moved), scratch)
    carried.moved[0] = moved
    carried.lower_bounds[0] = carried_down(measured.lower_bound, moved)
    carry_faces(0, measured, carried)
    for i in range(4):
        for k in range(4):
            state.poses[0, i, k], state.poses[1, i, k] = pose_a[i, k], pose_b[i, k]
    return measured


@kernel
def nearest_at_poses(
    held: HeldPair,
    poses_a: Floats3,
    poses_b: Floats3,
    how: int,
    numbers: Floats2,
    points: Floats3,
    counts: Integers2,
) -> int:
    """Fills a row for each pose and returns -1, or nothing and the first row with a pose that is in doubt.

    Args:
        poses_a, poses_b: (n, 4, 4) `world_from_body` [m]; (1, 4, 4) for a body that stands.
        how: `POSES_ARE_RIGID` if none is to be doubted, `AFRESH` if nothing is to be taken from what was asked
            before, their sum or 0.
        numbers: (n, 2) [m] distance, error bound.
        points: (n, 2, 3) [m] witness points in the world.
        counts: (n, 5) faces of a and b, then nodes, faces and exact decisions that it took.
    """
    last_a, last_b = len(poses_a) - 1, len(poses_b) - 1
    for i in range(0 if how & POSES_ARE_RIGID else len(numbers)):
        if not (
            _is_surely_rigid(poses_a[min(i, last_a)]) and _is_surely_rigid(poses_b[min(i, last_b)])
        ):
            return i
    state = PairState(held.poses, held.carried, held.stride)
    _nearest(held.a, held.b, state, held.scratch, poses_a, poses_b, how, numbers, points, counts)
    return -1


@inline
def _nearest(a, b, state, scratch, poses_a, poses_b, how, numbers, points, counts):
    """Fills a row for each pose.

    Many arguments: what belongs together is in tuples already.
    """
    lent_a, lent_b = lend(a), lend(b)
    last_a, last_b = len(poses_a) - 1, len(poses_b) - 1
    for i in range(len(numbers)):
        if how & AFRESH:
            state.carried.lower_bounds[0] = -np.inf
        pose_a, pose_b = poses_a[min(i, last_a)], poses_b[min(i, last_b)]
        measured = _measure(a, b, lent_a, lent_b, state, scratch, pose_a, pose_b)
        hit, tally = measured.hit, measured.tally
        numbers[i, 0], numbers[i, 1] = np.sqrt(hit.gap_sq), measured.error
        write_points(hit, points[i])
        counts[i, 0], counts[i, 1] = hit.face_a, hit.face_b
        counts[i, 2], counts[i, 3], counts[i, 4] = tally.nodes, tally.faces, tally.exact_decisions
