"""A raster of what is certainly covered: pixels that lie wholly inside the union of plane loops.

The loops of one body at one instant are directed edges with whole multiplicities whose winding number counts
the layers over a point (it is never negative). A pixel that no edge touches and whose centre has a positive
count is covered whole: the count is constant on it. Polygons within covered pixels add nothing to a union.
"""

import math
from typing import NamedTuple

import numpy as np

from clearance.compile.declared import Flags2, Floats3, Integers, Integers2, Shorts2, Signs2
from clearance.compile.decorators import inline, kernel

SAFE = 1e-9
"""[m] How much wider edges are drawn than they are: a thousand times the rounding of a coordinate near 1e4 m."""


class Raster(NamedTuple):
    """A grid of square pixels.

    Attributes:
        x, y: [m] the lower left corner.
        pixel: [m] the side of a pixel.
        covered: (rows, columns) True for pixels that are covered whole.
    """

    x: float
    y: float
    pixel: float
    covered: Flags2


@inline
def column_of(raster, x):
    """The column of pixels that x lies in."""
    return math.floor((x - raster.x) / raster.pixel)


@inline
def row_of(raster, y):
    """The row of pixels that y lies in."""
    return math.floor((y - raster.y) / raster.pixel)


@inline
def draw_edge(raster, ax, ay, bx, by, count, touched, steps):
    """Marks the pixels of an edge and, in each row that it crosses at mid-height, where the count changes."""
    if ay > by:
        ax, ay, bx, by, count = bx, by, ax, ay, -count
    slope = (bx - ax) / (by - ay) if by > ay else 0.0
    for row in range(row_of(raster, ay - SAFE), row_of(raster, by + SAFE) + 1):
        bottom = raster.y + row * raster.pixel
        low, high = max(ay, bottom - SAFE), min(by, bottom + raster.pixel + SAFE)
        if by - ay <= 4.0 * SAFE:
            first, last = min(ax, bx), max(ax, bx)
        else:
            one, two = ax + (low - ay) * slope, ax + (high - ay) * slope
            first, last = max(min(one, two), min(ax, bx)), min(max(one, two), max(ax, bx))
        for column in range(column_of(raster, first - SAFE), column_of(raster, last + SAFE) + 1):
            touched[row, column] = True
        middle = bottom + 0.5 * raster.pixel
        if ay <= middle < by:
            x = ax + (middle - ay) * slope
            # Pixels whose centre is left of an edge that runs upward have it on their right: count more.
            steps[row, math.ceil((x - raster.x) / raster.pixel - 0.5)] += count


@inline
def add_inside(raster, first_row, last_row, first_column, last_column, touched, steps):
    """Marks what the edges drawn so far surround, and clears them."""
    for row in range(first_row, last_row + 1):
        count = 0
        for column in range(last_column, first_column - 1, -1):
            count += steps[row, column + 1]
            steps[row, column + 1] = 0
            if count > 0 and not touched[row, column]:
                raster.covered[row, column] = True
            touched[row, column] = False
        steps[row, first_column] = 0


class SweptEdges(NamedTuple):
    """The edges of a body: (e, 2) their vertices, and the faces along them.

    Attributes:
        starts: (e + 1,) where each edge's `faces` begin.
        ways: of each of these, 1 where it runs from the edge's first vertex to the second, -1 where back.
    """

    ends: Integers2
    starts: Integers
    faces: Integers
    ways: Integers


@kernel
def add_cover(raster: Raster, points: Floats3, edges: SweptEdges, signs: Signs2):
    """Marks what one body covers at several instants.

    Args:
        raster: holds every point with a pixel to spare.
        points: (k, v, 2) [m] its vertices in the plane at each instant.
        edges: its `SweptEdges`.
        signs: (k, f) 1 for faces seen from the front at each instant, -1 from behind, 0 edge-on.
    """
    rows, columns = raster.covered.shape
    ends, starts, faces, ways = edges.ends, edges.starts, edges.faces, edges.ways
    touched = np.zeros((rows, columns + 1), np.bool_)
    steps = np.zeros((rows, columns + 1), np.int32)
    for k in range(points.shape[0]):
        first_row = max(0, row_of(raster, points[k, :, 1].min()) - 1)
        last_row = min(rows - 1, row_of(raster, points[k, :, 1].max()) + 1)
        first_column = max(0, column_of(raster, points[k, :, 0].min()) - 1)
        last_column = min(columns - 1, column_of(raster, points[k, :, 0].max()) + 1)
        for e in range(ends.shape[0]):
            count = 0
            for use in range(starts[e], starts[e + 1]):
                count += ways[use] * signs[k, faces[use]]
            if count != 0:
                a, b = ends[e, 0], ends[e, 1]
                draw_edge(
                    raster, points[k, a, 0], points[k, a, 1], points[k, b, 0], points[k, b, 1],
                    count, touched, steps,
                )  # fmt: skip
        add_inside(raster, first_row, last_row, first_column, last_column, touched, steps)


@kernel
def row_sums(covered: Flags2) -> Shorts2:
    """(rows, columns + 1) the number of covered pixels before each column of each row."""
    rows, columns = covered.shape
    sums = np.zeros((rows, columns + 1), np.int32)
    for row in range(rows):
        for column in range(columns):
            sums[row, column + 1] = sums[row, column] + covered[row, column]
    return sums


@inline
def lies_covered(raster, sums, corners, n):
    """True if the convex polygon `corners[:n]` (counter-clockwise or not) lies in covered pixels alone."""
    low, high = corners[0, 1], corners[0, 1]
    for i in range(1, n):
        low, high = min(low, corners[i, 1]), max(high, corners[i, 1])
    for row in range(row_of(raster, low - SAFE), row_of(raster, high + SAFE) + 1):
        bottom = raster.y + row * raster.pixel - SAFE
        top = bottom + raster.pixel + 2.0 * SAFE
        first, last = math.inf, -math.inf
        for i in range(n):
            ax, ay = corners[i, 0], corners[i, 1]
            bx, by = corners[(i + 1) % n, 0], corners[(i + 1) % n, 1]
            if bottom <= ay <= top:
                first, last = min(first, ax), max(last, ax)
            for level in (bottom, top):
                if (ay < level) != (by < level):
                    x = ax + (bx - ax) * ((level - ay) / (by - ay))
                    first, last = min(first, x), max(last, x)
        if first <= last:
            left, right = column_of(raster, first - SAFE), column_of(raster, last + SAFE)
            if left < 0 or right >= raster.covered.shape[1]:
                return False
            if sums[row, right + 1] - sums[row, left] != right + 1 - left:
                return False
    return True
