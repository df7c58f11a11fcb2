"""Whether a body lies wholly inside another one whose surface it does not meet, decided exactly.

A point is inside where the winding number of the closed, consistently oriented components is not zero, so
that cavities are outside and overlapping components inside. Open surfaces have no inside. The winding number is
the signed count of the triangles that a ray along an axis of the world meets; only boxes of the tree that the ray
may meet are opened. Where the ray meets an edge or a corner, the point is moved aside by (e, e^2) for an
infinitely small e, in thought: the signs of the predicates (`predicates`) then follow from coordinates, so that
no ray is a special case. Source: Edelsbrunner & Mücke 1990, simulation of simplicity.

Components that are closed but for a few faults count with the caps that close them (`geometry.closing`), less the
caps' solid angles. So the number is that of the faces alone, whatever the caps: the generalized winding number. It
differs from a whole number by what is seen of all directions through the holes. Up to `MARGIN` that decides: caps
that leave the point on the other side are seen under at least three quarters of all directions. Source: Jacobson,
Kavan & Sorkine-Hornung 2013.
"""

import math
from typing import NamedTuple

import numpy as np

from clearance.compile.declared import Shorts2
from clearance.compile.decorators import inline, kernel
from clearance.kernels.arithmetic.double_double import Frames, size
from clearance.kernels.arithmetic.lanes import WIDTH
from clearance.kernels.arithmetic.predicates import (
    FILTER,
    ExactScratch,
    PosedVertex,
    orient_posed,
    set_poses,
    side_along,
    turn_along,
)
from clearance.kernels.arithmetic.vec3 import Vec3, cross, dot, inverse, move, move_back, row, sub
from clearance.kernels.features.bounds import LEAN, lower_bound_boxes, rounding_slack
from clearance.kernels.mesh.surface import Surface, box_of, is_leaf

AXIS = 2
"""The ray's coordinate axis."""

ROUNDING = 512.0 * 2.0**-53
"""Rounding of a moved point, relative to the sum of the coordinates' magnitudes, with room."""

MARGIN = 0.25
"""[turns] A point is outside up to this winding number, inside from 1 less this on, and undecided in between."""

ON_IT = 1e-9
"""[-] Of the product of the distances of its corners: a point as near a triangle, or an edge of it, is on it."""


@inline
def _rounding_of_box(box, d, far):
    """[m] what rounding can move a point at `d` from the centre of a box, against its sides."""
    return LEAN * size(d) + ROUNDING * (far + size(box.centre) + size(box.half))


@inline
def in_box(surface, node, x, far):
    """True unless `x` is outside the node's box by more than rounding."""
    box = box_of(surface, node)
    d = sub(x, box.centre)
    allowance = _rounding_of_box(box, d, far)
    if abs(dot(box.x, d)) > box.half.x + allowance or abs(dot(box.y, d)) > box.half.y + allowance:
        return False
    return abs(dot(box.z, d)) <= box.half.z + allowance


@inline
def _turn(a, b, x, exact):
    """1 or -1: how the points a, b and x, moved aside, turn seen along the ray; 0 if a and b are one there."""
    turn = turn_along(a, b, x, AXIS, exact)
    if turn == 0:
        turn = side_along(a, b, (AXIS + 2) % 3, exact)
    if turn == 0:
        turn = side_along(b, a, (AXIS + 1) % 3, exact)
    return turn


@inline
def _crossing(a, b, c, x, exact):
    """1 or -1 if the ray from x leaves or enters through the triangle a b c, 0 if it misses it."""
    turn = _turn(a, b, x, exact)
    if turn == 0 or _turn(b, c, x, exact) != turn or _turn(c, a, x, exact) != turn:
        return 0
    return turn if orient_posed(a, b, c, x, exact) == turn else 0


@inline
def _is_clear_of_ray(exact, a, b, c, x):
    """True if the triangle is clearly beside or below the ray: decided by the boxes of rounded coordinates."""
    for axis in range(3):
        turn_x, turn_a = row(exact.poses[x.body], axis), row(exact.poses[a.body], axis)
        at = dot(turn_x, x.v) + (x.body - a.body) * exact.shift[0, axis]
        p, q, r = dot(turn_a, a.v) - at, dot(turn_a, b.v) - at, dot(turn_a, c.v) - at
        far = size(x.v) + abs(exact.shift[0, axis]) + max(size(a.v), max(size(b.v), size(c.v)))
        error = 4.0 * FILTER * far
        if max(p, max(q, r)) < -error or (axis != AXIS and min(p, min(q, r)) > error):
            return True
    return False


@inline
def _ray_may_meet(surface, node, x, along_ray, far):
    """False only if the node's box is beside or behind the ray by more than rounding."""
    box = box_of(surface, node)
    d = sub(box.centre, x)
    allowance = 8.0 * _rounding_of_box(box, d, far)
    p = Vec3(dot(box.x, d), dot(box.y, d), dot(box.z, d))
    t = Vec3(dot(box.x, along_ray), dot(box.y, along_ray), dot(box.z, along_ray))
    h, u, v, w = box.half, abs(t.x), abs(t.y), abs(t.z)
    return (
        dot(p, t) + h.x * u + h.y * v + h.z * w >= -allowance
        and abs(p.y * t.z - p.z * t.y) <= h.y * w + h.z * v + allowance
        and abs(p.z * t.x - p.x * t.z) <= h.z * u + h.x * w + allowance
        and abs(p.x * t.y - p.y * t.x) <= h.x * v + h.y * u + allowance
    )


@inline
def _crossings(surface, face, side, x, exact):
    """The signed count of the triangles of a face's fan that the ray from x meets."""
    number = 0
    start = surface.face_starts[face]
    first = PosedVertex(row(surface.exact, surface.face_vertices[start]), side)
    for k in range(start + 2, surface.face_starts[face + 1]):
        second = PosedVertex(row(surface.exact, surface.face_vertices[k - 1]), side)
        third = PosedVertex(row(surface.exact, surface.face_vertices[k]), side)
        if not _is_clear_of_ray(exact, first, second, third, x):
            number += _crossing(first, second, third, x, exact)
    return number


@inline
def solid_angle(a, b, c):
    """[rad] of the triangle with corners at `a`, `b`, `c` from the origin, positive where seen from behind.

    NaN where the origin is on the triangle (`ON_IT`).
    Source: Van Oosterom and Strackee, The solid angle of a plane triangle, 1983, equation 8.
    """
    la, lb, lc = np.sqrt(dot(a, a)), np.sqrt(dot(b, b)), np.sqrt(dot(c, c))
    volume = dot(a, cross(b, c))
    spread = la * lb * lc + dot(a, b) * lc + dot(b, c) * la + dot(c, a) * lb
    if max(abs(volume), spread) <= ON_IT * la * lb * lc:
        return np.nan
    return 2.0 * math.atan2(volume, spread)


class Probe(NamedTuple):
    """A vertex of the other body that may be inside.

    Attributes:
        vertex: in that body's frame, exact.
        x: the same in the body's own frame, rounded by no more than ROUNDING of `far` [m].
    """

    vertex: Vec3
    x: Vec3
    far: float


@inline
def _wait_for_children(surface, node, waiting, n_waiting):
    """Lets the children of a node wait; how many nodes wait."""
    first = WIDTH * np.int64(surface.children[node, 0])
    for k in range(np.int64(surface.children[node, 1])):
        waiting[n_waiting, 0] = first + k
        n_waiting += 1
    return n_waiting


@inline
def _gained_by_caps(surface, body, side, probe, exact):
    """[turns] what the ray from a point counts of the body's caps, less their solid angles; NaN on a cap."""
    number, angles = 0, 0.0
    vertex = PosedVertex(probe.vertex, 1 - side)
    for i in range(surface.cap_starts[body], surface.cap_starts[body + 1], 3):
        a, b, c = row(surface.caps, i), row(surface.caps, i + 1), row(surface.caps, i + 2)
        one, two, three = PosedVertex(a, side), PosedVertex(b, side), PosedVertex(c, side)
        if not _is_clear_of_ray(exact, one, two, three, vertex):
            number += _crossing(one, two, three, vertex, exact)
        angle = abs(solid_angle(sub(a, probe.x), sub(b, probe.x), sub(c, probe.x)))
        angles += angle if orient_posed(one, two, three, vertex, exact) > 0 else -angle
    return number - angles / (4.0 * math.pi)


@kernel
def winding_number(
    surface: Surface,
    body: int,
    is_b: bool,
    probe: Probe,
    frames: Frames,
    exact: ExactScratch,
    nodes: Shorts2,
) -> float:
    """How often the components of a body wind round a point that is not on its surface.

    Exactness: a whole number of a body without caps; else what is not whole is to rounding, and NaN on a cap.

    Args:
        is_b: True if the body is b.
        probe: the point, a `Probe`.
        nodes: (k, 2) scratch for nodes that wait.
    """
    set_poses(frames, exact)
    side = 1 if is_b else 0
    along_ray = row(exact.poses[side], AXIS)
    vertex = PosedVertex(probe.vertex, 1 - side)
    number = 0
    n_waiting = 1
    nodes[0, 0] = surface.roots[body]
    while n_waiting > 0:
        n_waiting -= 1
        node = np.int64(nodes[n_waiting, 0])
        if not _ray_may_meet(surface, node, probe.x, along_ray, probe.far):
            continue
        first = np.int64(surface.children[node, 0])
        if not is_leaf(surface, node):
            n_waiting = _wait_for_children(surface, node, nodes, n_waiting)
        elif surface.turns[first] != 0:
            number += np.int64(surface.turns[first]) * _crossings(
                surface, first, side, vertex, exact
            )
    return number + _gained_by_caps(surface, body, side, probe, exact)


@inline
def _is_inside(one, at, two, body_two, is_a, frames, scratch):
    """(True if vertex `at` of a body is inside the other, the vertex, the same in the other's frame)."""
    v = row(one.vertices, at)
    x = move_back(frames.m, v) if is_a else move(frames.m, v)
    away = size(frames.m.t) + size(v)
    inside = False
    if in_box(two, two.roots[body_two], x, away):
        probe = Probe(row(one.exact, at), x, away)
        arguments = (two, body_two, is_a, probe, frames, scratch.exact, scratch.nodes)
        inside = abs(winding_number(*arguments)) >= 1.0 - MARGIN
    return inside, v, x


@inline
def _is_probe(surface, body, at):
    """True if vertex `at` is a probe of a cloud."""
    low, high = surface.probe_starts[body], surface.probe_starts[body + 1]
    while low < high:
        middle = (low + high) // 2
        if surface.probes[middle] < at:
            low = middle + 1
        else:
            high = middle
    return low < surface.probe_starts[body + 1] and surface.probes[low] == at


@inline
def _of_cloud(one, body_one, two, body_two, is_a, frames, scratch):
    """The same of all probes of a cloud, those in nodes that reach into the other body's box."""
    m = inverse(frames.m) if is_a else frames.m  # from the cloud to the other body
    slack = rounding_slack(one, one.roots[body_one], two, two.roots[body_two], frames)
    waiting, n_waiting = scratch.entries, 1
    waiting[0, 0] = one.roots[body_one]
    box = box_of(two, two.roots[body_two])
    while n_waiting > 0:
        n_waiting -= 1
        node = np.int64(waiting[n_waiting, 0])
        if lower_bound_boxes(box, box_of(one, node), m, slack) > 0.0:
            continue
        first = np.int64(one.children[node, 0])
        if not is_leaf(one, node):
            n_waiting = _wait_for_children(one, node, waiting, n_waiting)
            continue
        at = one.face_vertices[one.face_starts[first]]
        if _is_probe(one, body_one, at):
            inside, v, x = _is_inside(one, at, two, body_two, is_a, frames, scratch)
            if inside:
                return True, v, x
    return False, frames.m.t, frames.m.t


@inline
def contained(a, body_a, b, body_b, frames, scratch):
    """(found, point): a point (frame of a) of one body inside the other; their surfaces must not meet.

    Exactness: right for the float vertices under the float poses of `frames`.
    """
    one, body_one, two, body_two = a, body_a, b, body_b
    for side in range(2):
        is_a = side == 0
        if one.radii[body_one] > 0.0:
            inside, v, x = _of_cloud(one, body_one, two, body_two, is_a, frames, scratch)
            if inside:
                return True, v if is_a else x
        else:
            for i in range(one.probe_starts[body_one], one.probe_starts[body_one + 1]):
                at = one.probes[i]
                inside, v, x = _is_inside(one, at, two, body_two, is_a, frames, scratch)
                if inside:
                    return True, v if is_a else x
        one, body_one, two, body_two = b, body_b, a, body_a
    return False, frames.m.t
