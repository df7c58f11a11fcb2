"""The motion of both bodies of a pair over an interval as a displacement, and the proof for the pair under it.

Not for: choosing pairs and intervals, and halving them (`certify`).
"""

import math
from typing import NamedTuple

from clearance.compile.declared import Integers
from clearance.compile.decorators import inline, kernel
from clearance.kernels.arithmetic.lanes import square_root
from clearance.kernels.arithmetic.vec3 import dot, move
from clearance.kernels.features.bounds import margin_of, rounding_slack
from clearance.kernels.features.face_pair import nearest_of_faces, nothing_yet
from clearance.kernels.features.posed_pair import PosedPair, parts
from clearance.kernels.mesh.surface import box_of
from clearance.kernels.motion.joint_motion_bound import (
    MotionBound,
    PairMotion,
    motion_bound_of_box,
    motion_bound_of_box_along,
    velocity_at,
)
from clearance.kernels.search.balls import radii_of
from clearance.kernels.search.displacement import (
    Turn,
    direction_of_search,
    errors_of_point_along,
    is_nearly_still,
    movement_of_box,
    movement_of_box_along,
    movement_of_point,
    movement_of_point_along,
    movement_of_point_in_search,
    prepare_along,
    still_turned_away,
    turned_away_while,
)
from clearance.kernels.search.front import PairFront
from clearance.kernels.search.proof import (
    CHAIN_SLACK,
    Proof,
    ProofGoal,
    ProofStart,
    allowed_gap,
    prove,
)
from clearance.kernels.search.scratch import Scratch


class CertificateGoal(NamedTuple):
    """The bound to prove.

    Attributes:
        gap: [m] allowed between `lower` and `upper`, the least distance seen.
        fail: [m] the limit to decide, if need be with a smaller gap.
        most_parts: of one interval and pair; after these, and again after as many, the gap grows fourfold.
    """

    gap: float
    fail: float
    most_parts: int


class Twist(NamedTuple):
    """The motion of both bodies about the middle of an interval.

    Attributes:
        slack: [m] the most that rounding can raise a bound. b_moves: False if b stands; that saves half of the
            work.
        turn: of both bodies together.
    """

    slack: float
    a: MotionBound
    b: MotionBound
    b_moves: bool
    turn: Turn


@inline(force=True)
def _of_side(twist, side):
    return twist.b if side == 1 else twist.a


@movement_of_box.register
def _(twist: Twist, box, side):
    rounding = 0.5 * twist.slack + 0.0 * box.half.x  # as many lanes
    if side == 1 and not twist.b_moves:
        return rounding
    return rounding + motion_bound_of_box(box, _of_side(twist, side))


@movement_of_box_along.register
def _(twist: Twist, box, side, u):
    if side == 1 and not twist.b_moves:
        return 0.0 * box.half.x
    return motion_bound_of_box_along(box, u, _of_side(twist, side))


@still_turned_away.register
def _(twist: Twist, cones, d, marks, bounds):
    return turned_away_while(twist.turn, cones, d, marks)


@prepare_along.register
def _(twist: Twist, direction):
    pass


@movement_of_point_along.register
def _(twist: Twist, x, side, u):
    if side == 1 and not twist.b_moves:
        return 0.0 * x.x
    motion = _of_side(twist, side)
    return abs(dot(u, velocity_at(motion, x))) + motion.rest


@movement_of_point_in_search.register
def _(twist: Twist, x, side, u):
    return movement_of_point_along(twist, x, side, u)


@errors_of_point_along.register
def _(twist: Twist, x, side, u):
    return 0.0


@movement_of_point.register
def _(twist: Twist, x, side):
    motion = _of_side(twist, side)
    v = velocity_at(motion, x)
    return square_root(dot(v, v)) + motion.rest


@direction_of_search.register
def _(twist: Twist, direction):
    return direction


@is_nearly_still.register
def _(twist: Twist, motion, little):
    return twist.turn.movement < little


@inline
def _twist_of(roots, motion, slack):
    moved = motion_bound_of_box(box_of(roots.surface_a, roots.a), motion.a)
    if motion.b_moves:
        moved += motion_bound_of_box(box_of(roots.surface_b, roots.b), motion.b)
    angle = max(motion.a.turn, motion.b.turn)  # the greatest turn of a normal of either
    turn = Turn(angle, math.cos(angle), math.sin(angle), moved)
    return Twist(slack, motion.a, motion.b, motion.b_moves, turn)


@inline
def _start(roots, witness_faces, slack):
    """The nearest points of the faces that were nearest before, or the bodies' centres."""
    a, b, m = roots.surface_a, roots.surface_b, roots.frames.m
    if witness_faces[0] >= 0:
        margin = margin_of(slack)
        face_a, face_b = witness_faces[0], witness_faces[1]
        near = nearest_of_faces(a, face_a, b, face_b, m, margin, nothing_yet(math.inf)).best
        if near.face_a != 2**62:
            return ProofStart(near.p, near.q, math.sqrt(near.gap_sq) + margin, face_a, face_b)
    p, q = box_of(a, roots.a).centre, move(m, box_of(b, roots.b).centre)
    return ProofStart(p, q, math.inf, witness_faces[0], witness_faces[1])


@kernel
def prove_while_moving(
    bodies: PosedPair,
    witness_faces: Integers,
    motion: PairMotion,
    least: float,
    aim: CertificateGoal,
    front: PairFront,
    scratch: Scratch,
) -> Proof:
    """A `Proof` over the interval for one pair, within the allowed gap below `least` or the distance found.

    Args:
        bodies: of surfaces in which every face owns all its features.
        witness_faces: (2,) the faces that were nearest before, or -1; overwritten.
        least: [m] given.
    """
    a, b = bodies.surface_a, bodies.surface_b
    roots = parts(bodies, a.roots[bodies.a], b.roots[bodies.b])
    slack = CHAIN_SLACK * rounding_slack(a, roots.a, b, roots.b, bodies.frames)
    target = least - allowed_gap(least, aim.gap, aim.fail)
    skin = radii_of(a, bodies.a, b, bodies.b).both
    goal = ProofGoal(target, least, aim.gap, aim.fail, skin, False, True, 0, 0.0)
    start = _start(roots, witness_faces, slack)
    proof = prove(roots, _twist_of(roots, motion, slack), start, goal, front, scratch)
    witness_faces[0], witness_faces[1] = proof.face_a, proof.face_b
    return proof
