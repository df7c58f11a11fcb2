"""Builds the bounding tree of one body in its own frame: oriented boxes, one face a leaf.

Each box takes the frame of least surface area of two: the principal axes of its corner points, which make
flat patches thin whatever their tilt, and the axes of the body. Not for: bounds between boxes (`bounds`).
"""

import math

import numpy as np

from clearance.jit import inlined, kernel

OUTWARD = 1.0 + 1e-15
"""Half sizes are stretched by this, and by as much of the coordinates' magnitude: rounding stays inside."""

TURNED = 2.0**-21
"""Eight times the rounding of a number to single precision, relative to it."""

LEAST_HALF = 2.0**-125
"""[m] half sizes are no less, so that none is lost below the least normal number in single precision."""


@inlined
def _rotate(c, v, i, j):
    """One Jacobi rotation that makes c[i, j] zero; the columns of `v` follow."""
    if c[i, j] == 0.0:
        return
    theta = (c[j, j] - c[i, i]) / (2.0 * c[i, j])
    t = math.copysign(1.0, theta) / (abs(theta) + math.sqrt(theta * theta + 1.0))
    cosine = 1.0 / math.sqrt(t * t + 1.0)
    sine = t * cosine
    for k in range(3):
        c[k, i], c[k, j] = cosine * c[k, i] - sine * c[k, j], sine * c[k, i] + cosine * c[k, j]
    for k in range(3):
        c[i, k], c[j, k] = cosine * c[i, k] - sine * c[j, k], sine * c[i, k] + cosine * c[j, k]
        v[k, i], v[k, j] = cosine * v[k, i] - sine * v[k, j], sine * v[k, i] + cosine * v[k, j]


@inlined
def _principal_axes(points, starts, order, first, last, v, c):
    """Writes the principal axes of the corners of the faces `order[first:last]` into the columns of `v`."""
    n = 0
    mean_x, mean_y, mean_z = 0.0, 0.0, 0.0
    for i in range(first, last):
        for k in range(starts[order[i]], starts[order[i] + 1]):
            mean_x += points[k, 0]
            mean_y += points[k, 1]
            mean_z += points[k, 2]
            n += 1
    mean_x, mean_y, mean_z = mean_x / n, mean_y / n, mean_z / n
    c[:] = 0.0
    for i in range(first, last):
        for k in range(starts[order[i]], starts[order[i] + 1]):
            x, y, z = points[k, 0] - mean_x, points[k, 1] - mean_y, points[k, 2] - mean_z
            c[0, 0] += x * x
            c[0, 1] += x * y
            c[0, 2] += x * z
            c[1, 1] += y * y
            c[1, 2] += y * z
            c[2, 2] += z * z
    c[1, 0], c[2, 0], c[2, 1] = c[0, 1], c[0, 2], c[1, 2]
    v[:] = 0.0
    v[0, 0] = v[1, 1] = v[2, 2] = 1.0
    for _ in range(6):
        for turn in range(3):
            _rotate(c, v, turn // 2, min(turn + 1, 2))


@inlined
def _fit(points, starts, order, first, last, v, low, high):
    """Writes the extent of the faces' corners along the columns of `v`; the surface area of that box."""
    low[:] = np.inf
    high[:] = -np.inf
    for i in range(first, last):
        for k in range(starts[order[i]], starts[order[i] + 1]):
            for axis in range(3):
                x = points[k, 0] * v[0, axis] + points[k, 1] * v[1, axis] + points[k, 2] * v[2, axis]
                low[axis] = min(low[axis], x)
                high[axis] = max(high[axis], x)
    a, b, c = high[0] - low[0], high[1] - low[1], high[2] - low[2]
    return a * b + b * c + c * a


@inlined
def _store(v, low, high, centre, box):
    """Writes one box: axes as rows, then half sizes rounded outward; centre in the body frame.

    An axis is turned by rounding by at most 2^-24, so that a coordinate along it changes by that share of
    the others; sixteen times as much is given.
    """
    reach = 0.0
    for axis in range(3):
        reach = max(reach, max(abs(low[axis]), abs(high[axis])))
    for row in range(3):
        centre[row] = 0.0
        for axis in range(3):
            box[3 * axis + row] = v[row, axis]
            centre[row] += v[row, axis] * 0.5 * (low[axis] + high[axis])
    room = reach * (OUTWARD - 1.0) + LEAST_HALF
    for axis in range(3):
        room += TURNED * (high[axis] - low[axis])
    for axis in range(3):
        box[9 + axis] = (0.5 * (high[axis] - low[axis]) * OUTWARD + room) * (1.0 + TURNED)


@inlined
def _split(points, starts, order, first, last, v, low, high, middles):
    """Reorders `order[first:last]` about the mean of the longest axis of the box; the cut."""
    long_axis = 0
    for axis in range(1, 3):
        if high[axis] - low[axis] > high[long_axis] - low[long_axis]:
            long_axis = axis
    mean = 0.0
    for i in range(first, last):
        face = order[i]
        least, most = np.inf, -np.inf
        for k in range(starts[face], starts[face + 1]):
            x = (
                points[k, 0] * v[0, long_axis]
                + points[k, 1] * v[1, long_axis]
                + points[k, 2] * v[2, long_axis]
            )
            least, most = min(least, x), max(most, x)
        middles[face] = least + most
        mean += middles[face]
    mean /= last - first
    cut = first
    for i in range(first, last):
        face = order[i]
        if middles[face] < mean:
            order[i] = order[cut]
            order[cut] = face
            cut += 1
    if cut == first or cut == last:
        cut = (first + last) // 2
    return cut


@kernel
def build_tree(points, starts, centres, boxes, children):
    """Fills the (2 f - 1) nodes of a tree over f faces with corners `points[starts[i]:starts[i + 1]]`.

    `centres` (n, 3), `boxes` (n, 12) and `children` (n, 2) are those of `Surface`; node 0 is the root.
    """
    n_faces = len(starts) - 1
    order = np.arange(n_faces)
    middles = np.empty(n_faces)
    v, c, body = np.empty((3, 3)), np.empty((3, 3)), np.eye(3)
    low, high, low_body, high_body = np.empty(3), np.empty(3), np.empty(3), np.empty(3)
    waiting = np.empty((2 * n_faces + 1, 3), dtype=np.int64)
    waiting[0, 0], waiting[0, 1], waiting[0, 2] = 0, 0, n_faces
    n_waiting = 1
    n_nodes = 1
    while n_waiting > 0:
        n_waiting -= 1
        node, first, last = waiting[n_waiting, 0], waiting[n_waiting, 1], waiting[n_waiting, 2]
        _principal_axes(points, starts, order, first, last, v, c)
        area = _fit(points, starts, order, first, last, v, low, high)
        if _fit(points, starts, order, first, last, body, low_body, high_body) <= area:
            for i in range(3):
                low[i], high[i] = low_body[i], high_body[i]
                for k in range(3):
                    v[i, k] = body[i, k]
        _store(v, low, high, centres[node], boxes[node])
        if last - first == 1:
            children[node, 0] = order[first]
            children[node, 1] = -1
            continue
        cut = _split(points, starts, order, first, last, v, low, high, middles)
        children[node, 0] = n_nodes
        children[node, 1] = n_nodes + 1
        waiting[n_waiting, 0], waiting[n_waiting, 1], waiting[n_waiting, 2] = n_nodes + 1, cut, last
        n_waiting += 1
        waiting[n_waiting, 0], waiting[n_waiting, 1], waiting[n_waiting, 2] = n_nodes, first, cut
        n_waiting += 1
        n_nodes += 2
