"""The greatest motion of a body's points by its errors. Not for: the errors (`rows`)."""

import math
from typing import NamedTuple

from clearance.compile.decorators import inline
from clearance.kernels.arithmetic.lanes import square_root
from clearance.kernels.arithmetic.vec3 import Vec3, add, cross, dot, sub
from clearance.kernels.budget.errors import (
    CHORD,
    FIRST,
    FIRST_AT_REST,
    FRAME,
    KIND,
    OFFSET,
    OFFSETS,
    REACH,
    RESIDUAL,
    REST_AT_REST,
    SLIDE,
    SLIDE_LENGTH,
    TOGETHER,
    TURN,
)
from clearance.kernels.features.bounds import LEAN


class Ball(NamedTuple):
    """A ball about a body, in its frame [m]."""

    t: Vec3
    radius: float


@inline
def from_axis(ball, origin, axis):
    """[m] the greatest distance of any point of a ball from a line."""
    away = cross(sub(ball.t, origin), axis)
    return math.sqrt(dot(away, away)) + ball.radius


@inline
def reach_of_ball(rows, n, ball):
    """[m] the greatest motion of any point of a ball by the errors: the recursion from tip to base."""
    moved = 0.0
    for k in range(n):
        r = rows[k]
        kind = r[KIND]
        origin = Vec3(r[0], r[1], r[2])
        if kind == TURN:
            axis = Vec3(r[3], r[4], r[5])
            moved += r[CHORD] * (from_axis(ball, origin, axis) + moved)
        elif kind == SLIDE:
            moved += r[SLIDE_LENGTH]
        elif kind == FRAME:
            d = sub(ball.t, origin)
            moved += r[CHORD] * (math.sqrt(dot(d, d)) + ball.radius + moved) + r[OFFSET]
    return moved


@inline
def reach_of_point(found, body, x):
    """[m] the greatest motion of a point of a body (body frame) by the errors: the recursion from tip to base."""
    return reach_of_ball(found.rows[body], found.n_rows[body], Ball(x, 0.0))


@inline
def residual_of_velocity(rows, n, ball):
    """[m] the greatest first-order motion of any point of a ball, without the one motion together of its rows.

    -1 unless exactly the last row is a motion together, and not zero.
    """
    if n == 0 or rows[n - 1, KIND] != TOGETHER:
        return -1.0
    r = rows[n - 1]
    if r[0] == 0.0 and r[1] == 0.0 and r[2] == 0.0 and r[3] == 0.0 and r[4] == 0.0 and r[5] == 0.0:
        return -1.0
    moved = 0.0
    for k in range(n - 1):
        r = rows[k]
        kind, first = r[KIND], r[FIRST]
        origin = Vec3(r[0], r[1], r[2])
        if kind == TOGETHER:
            return -1.0
        if kind == TURN:
            moved += first * from_axis(ball, origin, Vec3(r[3], r[4], r[5]))
        elif kind == SLIDE:
            moved += first
        else:
            d = sub(ball.t, origin)
            moved += first * (math.sqrt(dot(d, d)) + ball.radius) + r[OFFSET]
    return moved


class BodyReach(NamedTuple):
    """The motion of a body: of a point x by velocity + spin x x [m], and by up to `residual` [m] more."""

    velocity: Vec3
    spin: Vec3
    residual: float


@inline
def reach_of_body(found, body):
    """The `BodyReach` of a body, with or without one motion together."""
    residual, nothing = found.sums[body, RESIDUAL], Vec3(0.0, 0.0, 0.0)
    if residual < 0.0:
        return BodyReach(nothing, nothing, found.sums[body, REACH])
    r = found.rows[body, found.n_rows[body] - 1]
    return BodyReach(Vec3(r[0], r[1], r[2]), Vec3(r[3], r[4], r[5]), residual)


@inline(force=True)
def reach_of_box(box, reach):
    """[m] the greatest motion of any point of a box, or of four in lanes."""
    v = add(reach.velocity, cross(reach.spin, box.centre))
    radius = square_root(dot(box.half, box.half))
    turned = math.sqrt(dot(reach.spin, reach.spin)) * radius
    return (square_root(dot(v, v)) + turned) * (1.0 + LEAN) + reach.residual


@inline
def along_at_rest(found, body, u, x):
    """[m] the greatest motion of a point of a body along a unit direction by errors alone, clocks included."""
    moved = found.sums[body, OFFSETS] + found.sums[body, REST_AT_REST]
    rows = found.rows[body]
    for k in range(found.n_rows[body]):
        r = rows[k]
        kind = r[KIND]
        o, a = Vec3(r[0], r[1], r[2]), Vec3(r[3], r[4], r[5])
        if kind == TURN:
            moved += r[FIRST_AT_REST] * abs(dot(cross(u, a), sub(x, o)))
        elif kind == SLIDE:
            moved += r[FIRST_AT_REST] * abs(dot(u, a))
        elif kind == FRAME:
            c = cross(u, sub(x, o))
            moved += r[FIRST_AT_REST] * math.sqrt(dot(c, c))
        else:
            moved += r[FIRST_AT_REST] * abs(dot(u, add(o, cross(a, x))))
    return moved
