"""Builds the bounding tree of one body in its own frame: oriented boxes, one face a leaf.

Each box takes the frame of least surface area of two: the principal axes of its corner points, which make
flat patches thin whatever their tilt, and the axes of the body. Not for: bounds between boxes (`bounds`).
"""

import math
from typing import NamedTuple

import numpy as np

from clearance.compile.declared import Floats2, Integers, Shorts2, Singles2
from clearance.compile.decorators import inline, kernel
from clearance.kernels.arithmetic.lanes import WIDTH

OUTWARD = 1.0 + 1e-15
"""Half sizes are stretched by this, and by as much of the coordinates' magnitude: rounding stays inside."""

TURNED = 2.0**-21
"""Eight times the rounding of a number to single precision, relative to it."""

SMALL = 16 * WIDTH
"""Parts of up to this many faces are cut into whole groups of leaves, so that few lanes stay empty."""

LEAST_HALF = 2.0**-125
"""[m] half sizes are no less, so that none is lost below the least normal number in single precision."""


@inline
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


@inline
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


@inline
def _fit(points, starts, order, first, last, v, low, high):
    """Writes the extent of the faces' corners along the columns of `v`; the surface area of that box."""
    low[:] = np.inf
    high[:] = -np.inf
    for i in range(first, last):
        for k in range(starts[order[i]], starts[order[i] + 1]):
            for axis in range(3):
                x = (
                    points[k, 0] * v[0, axis]
                    + points[k, 1] * v[1, axis]
                    + points[k, 2] * v[2, axis]
                )
                low[axis] = min(low[axis], x)
                high[axis] = max(high[axis], x)
    a, b, c = high[0] - low[0], high[1] - low[1], high[2] - low[2]
    return a * b + b * c + c * a


@inline
def _store(v, low, high, centre, box):
    """Writes one box: axes as rows, then half sizes rounded outward; centre in the body frame.

    Rounding turns an axis by at most 2^-24, so a coordinate along it changes by that share of the others; sixteen
    times as much is added.
    """
    reach = 0.0
    for axis in range(3):
        reach = max(reach, max(abs(low[axis]), abs(high[axis])))
    for row in range(3):
        centre[row] = 0.0
        for axis in range(3):
            box[3 * axis + row] = v[row, axis]
            centre[row] += v[row, axis] * 0.5 * (low[axis] + high[axis])
    scratch = reach * (OUTWARD - 1.0) + LEAST_HALF
    for axis in range(3):
        scratch += TURNED * (high[axis] - low[axis])
    for axis in range(3):
        box[9 + axis] = (0.5 * (high[axis] - low[axis]) * OUTWARD + scratch) * (1.0 + TURNED)


@inline
def _enclose(points, starts, order, first, last, scratch, centre, box):
    """Writes the box of the faces `order[first:last]`: the better of two frames; its surface area."""
    _principal_axes(points, starts, order, first, last, scratch.v, scratch.c)
    area = _fit(points, starts, order, first, last, scratch.v, scratch.low, scratch.high)
    area_body = _fit(
        points, starts, order, first, last, scratch.body, scratch.low_body, scratch.high_body
    )
    if area_body <= area:
        _store(scratch.body, scratch.low_body, scratch.high_body, centre, box)
        return area_body
    _store(scratch.v, scratch.low, scratch.high, centre, box)
    return area


@inline
def _split(points, starts, order, first, last, box, middles):
    """Reorders `order[first:last]` about the mean along the longest axis of their box; the cut."""
    longest = 0
    for axis in range(1, 3):
        if box[9 + axis] > box[9 + longest]:
            longest = axis
    x, y, z = box[3 * longest], box[3 * longest + 1], box[3 * longest + 2]
    mean = 0.0
    for i in range(first, last):
        face = order[i]
        least, most = np.inf, -np.inf
        for k in range(starts[face], starts[face + 1]):
            at = points[k, 0] * x + points[k, 1] * y + points[k, 2] * z
            least, most = min(least, at), max(most, at)
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
    if WIDTH < last - first <= SMALL:
        return _full_groups(order, first, last, cut, middles)
    return cut


@inline
def _full_groups(order, first, last, cut, middles):
    """Sorts `order[first:last]` and moves the cut to where whole groups of leaves fit before it."""
    for i in range(first + 1, last):
        face = order[i]
        k = i
        while k > first and middles[order[k - 1]] > middles[face]:
            order[k] = order[k - 1]
            k -= 1
        order[k] = face
    groups = (cut - first + WIDTH // 2) // WIDTH
    most = (last - first - 1) // WIDTH
    return first + WIDTH * min(max(groups, 1), most)


class BuildScratch(NamedTuple):
    """Memory to fit boxes, and the up to four parts of the current node: first and last, area, box."""

    v: np.ndarray
    c: np.ndarray
    body: np.ndarray
    low: np.ndarray
    high: np.ndarray
    low_body: np.ndarray
    high_body: np.ndarray
    spans: np.ndarray
    areas: np.ndarray
    centres: np.ndarray
    boxes: np.ndarray


@inline
def _new_scratch():
    return BuildScratch(
        np.empty((3, 3)), np.empty((3, 3)), np.eye(3), np.empty(3), np.empty(3), np.empty(3), np.empty(3),
        np.empty((WIDTH, 2), dtype=np.int64), np.empty(WIDTH), np.empty((WIDTH, 3)),
        np.empty((WIDTH, 12), dtype=np.float32),
    )  # fmt: skip


@inline
def _set_part(points, starts, order, part, first, last, scratch):
    scratch.spans[part, 0], scratch.spans[part, 1] = first, last
    scratch.areas[part] = _enclose(
        points, starts, order, first, last, scratch, scratch.centres[part], scratch.boxes[part]
    )


@inline
def _parts(points, starts, order, middles, scratch):
    """Splits the part in `scratch`, widest first, into up to four until all fit into a group; their number."""
    n_parts = 1
    few = (
        WIDTH if scratch.spans[0, 1] - scratch.spans[0, 0] > WIDTH else 1
    )  # so that few lanes stay empty
    while n_parts < WIDTH:
        widest = -1
        for part in range(n_parts):
            if scratch.spans[part, 1] - scratch.spans[part, 0] > few:
                if widest < 0 or scratch.areas[part] > scratch.areas[widest]:
                    widest = part
        if widest < 0:
            break
        first, last = scratch.spans[widest, 0], scratch.spans[widest, 1]
        cut = _split(points, starts, order, first, last, scratch.boxes[widest], middles)
        _set_part(points, starts, order, widest, first, cut, scratch)
        _set_part(points, starts, order, n_parts, cut, last, scratch)
        n_parts += 1
    return n_parts


@inline
def _write_group(scratch, n_parts, group, centres, boxes):
    """The boxes of the parts as a group of nodes; lanes without one repeat the first."""
    for k in range(WIDTH):
        part = k if k < n_parts else 0
        for i in range(3):
            centres[3 * group + i, k] = scratch.centres[part, i]
        for i in range(12):
            boxes[12 * group + i, k] = scratch.boxes[part, i]


@kernel
def build_tree(
    points: Floats2,
    starts: Integers,
    order: Integers,
    centres: Floats2,
    boxes: Singles2,
    children: Shorts2,
) -> int:
    """Fills the nodes of a tree over the f faces in `order`, with corners `points[starts[i]:starts[i + 1]]`.

    The order becomes that of the leaves. `centres`, `boxes` and `children` are those of `Surface`, with a capacity
    of `most_groups(f)`; node 0 is the root. Returns the number of groups.
    """
    n_faces = len(order)
    middles = np.empty(len(starts) - 1)
    scratch = _new_scratch()
    waiting = np.empty((3 * n_faces + 1, 3), dtype=np.int64)
    _set_part(points, starts, order, 0, 0, n_faces, scratch)
    _write_group(scratch, 1, 0, centres, boxes)
    children[:] = -1
    waiting[0, 0], waiting[0, 1], waiting[0, 2] = 0, 0, n_faces
    n_waiting = 1
    n_groups = 1
    while n_waiting > 0:
        n_waiting -= 1
        node, first, last = waiting[n_waiting, 0], waiting[n_waiting, 1], waiting[n_waiting, 2]
        if last - first == 1:
            children[node, 0], children[node, 1] = order[first], 0
            continue
        _begin_with(node, first, last, centres, boxes, scratch)
        n_parts = _parts(points, starts, order, middles, scratch)
        _write_group(scratch, n_parts, n_groups, centres, boxes)
        children[node, 0], children[node, 1] = n_groups, n_parts
        for part in range(n_parts - 1, -1, -1):
            waiting[n_waiting, 0] = WIDTH * n_groups + part
            waiting[n_waiting, 1], waiting[n_waiting, 2] = (
                scratch.spans[part, 0],
                scratch.spans[part, 1],
            )
            n_waiting += 1
        n_groups += 1
    return n_groups


@inline
def _begin_with(node, first, last, centres, boxes, scratch):
    """Makes a written node the first part in `scratch`."""
    group, k = node // WIDTH, node % WIDTH
    scratch.spans[0, 0], scratch.spans[0, 1] = first, last
    for i in range(12):
        scratch.boxes[0, i] = boxes[12 * group + i, k]


def most_groups(n_faces):
    """Groups that a tree over so many faces has at most: one for the root, one a node that is no leaf."""
    return 1 + (2 * n_faces + 1) // 3
