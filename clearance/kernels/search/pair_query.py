"""One body pair at many poses: each search begins with the results of the one before.

The pair, its scratch and its state are written once, and a call from Python passes one address. Passing two
surfaces array by array costs more than most searches: 50 µs against 0.8 µs on a busy machine. Not for: many pairs
at once (`sweep`).
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
from clearance.kernels.search.front import LONGEST, PairFront, carried_down, forget_front
from clearance.kernels.search.scratch import Scratch

FRONT_CAPACITY = 2 * LONGEST + 16
"""Capacity of the front of the pair, in node pairs: enough for the longest front."""

ROUNDED_UP = 1.0 + 2.0**-51
"""Rounds a sum of two lengths up, however many are added one after another."""

SURELY = 1e-7
"""[-] A matrix that is off orthonormal by less is a rotation; any other is left for the caller to check."""

FAR = 1.0
"""After a motion of more than this share of the smaller breadth, the search begins at the roots."""

POSES_ARE_RIGID, AFRESH = 1, 2
"""Options of `nearest_at_poses` in one number, since each argument from Python takes time."""


class TrackedPair(NamedTuple):
    """A body pair and the results of its last search.

    Attributes:
        a, b: their surfaces, one body each.
        scratch: arrays for the search.
        poses: (2, 4, 4) of both bodies at the last search [m].
        carried: of one pair; `moved` of the first body is the motion of both, that of the second is 0.
        stride: [m] after a greater motion between two poses a search from the roots is better.
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


def track_pair(a: Surface, b: Surface, capacity: int, scratch: Scratch):
    """A pair of surfaces without results yet, and the capacity of its front in node pairs."""
    tracked = TrackedPair(
        a, b, scratch, np.zeros((2, 4, 4)), nothing_carried(2, 1, capacity),
        FAR * min(_breadth(a), _breadth(b)),
    )  # fmt: skip
    return Written(tracked, TrackedPair)


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
    """The fields of `TrackedPair` that change from question to question."""

    poses: Floats3
    carried: Annotated[Carried, LentTo]
    stride: float


@inline
def _accumulated_displacement(a, b, state, pose_a, pose_b, frames):
    """[m] an upper bound on the total motion of the points of both bodies, up to these poses.

    Infinite where the bodies may touch, or have moved too far for the front to help. From a front, finding the
    first contact can take a hundred times as long as from the roots.
    """
    displaced = displacement(a, a.roots[0], state.poses[0], pose_a)
    displaced += displacement(b, b.roots[0], state.poses[1], pose_b)
    carried = state.carried
    if not displaced <= state.stride:
        return np.inf
    displaced += rounding_slack(a, a.roots[0], b, b.roots[0], frames)  # where motions cancel
    moved = (carried.moved[0] + displaced) * ROUNDED_UP
    return moved if carried.lower_bounds[0] > moved else np.inf


@inline
def _measure(a, b, lent_a, lent_b, state, scratch, pose_a, pose_b):
    """The answer of `search` for a pair.

    Many arguments: they are grouped in tuples already.
    """
    frames = frames_of(rigid(pose_a), rigid(pose_b))
    moved = _accumulated_displacement(a, b, state, pose_a, pose_b, frames)
    carried = state.carried
    carried.lower_bounds[0] = -np.inf  # until the search has ended
    face_a, face_b = carried.faces[0, 0], carried.faces[0, 1]
    question = PairQuestion(np.inf, np.inf, face_a, face_b, True, TO_THE_END, False)
    if moved == np.inf:
        moved = 0.0
        question = PairQuestion(np.inf, np.inf, NO_FACE, NO_FACE, False, TO_THE_END, False)
        forget_front(carried.fronts, 0)
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
    tracked: TrackedPair,
    poses_a: Floats3,
    poses_b: Floats3,
    how: int,
    numbers: Floats2,
    points: Floats3,
    counts: Integers2,
) -> int:
    """Fills a row for each pose and returns -1, or fills none and returns the first row with a doubtful pose.

    Args:
        poses_a, poses_b: (n, 4, 4) `world_from_body` [m]; (1, 4, 4) for a standing body.
        how: `POSES_ARE_RIGID` to skip the check of the poses, `AFRESH` to ignore earlier results, their sum or 0.
        numbers: (n, 2) [m] distance, error bound.
        points: (n, 2, 3) [m] witness points in the world.
        counts: (n, 5) faces of a and b, then the number of nodes, faces and exact decisions.
    """
    last_a, last_b = len(poses_a) - 1, len(poses_b) - 1
    for i in range(0 if how & POSES_ARE_RIGID else len(numbers)):
        if not (
            _is_surely_rigid(poses_a[min(i, last_a)]) and _is_surely_rigid(poses_b[min(i, last_b)])
        ):
            return i
    state = PairState(tracked.poses, tracked.carried, tracked.stride)
    _nearest(
        tracked.a, tracked.b, state, tracked.scratch, poses_a, poses_b, how, numbers, points, counts
    )
    return -1


@inline
def _nearest(a, b, state, scratch, poses_a, poses_b, how, numbers, points, counts):
    """Fills a row for each pose.

    Many arguments: they are grouped in tuples already.
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
