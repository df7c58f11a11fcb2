"""The least distance of two circular arcs or segments, in closed form: what cells of curves cannot say soon.

Curves that run alongside each other have a distance that hardly changes; bounds that err by the square of a cell's
length then need a cell for each stretch of the last digits' root. As arcs their distance is known at once: between
ends and arcs, along the line of the centres, or nothing where they cross. Not for: curves far from their arcs.
"""

import math

import numpy as np

from clearance.compile.declared import Floats
from clearance.compile.decorators import inline, kernel
from clearance.kernels.curve.arc import (
    CX,
    CY,
    EPS,
    RADIUS,
    SENSE,
    X0,
    X1,
    Y0,
    Y1,
    Chord,
    arc_distance,
    arc_error,
    set_arc,
    set_segment,
)
from clearance.kernels.curve.arc_fit import end_tangent
from clearance.kernels.curve.bezier import hypotenuse

ROUNDINGS = 64.0 * 2.0**-53
"""Relative to centres, radii and coordinates: the candidates are a few dozen operations each."""


@inline
def _in_sector(row, x, y):
    """Whether the direction from the arc's centre to (x, y) meets the arc."""
    ox, oy = x - row[CX], y - row[CY]
    after = (row[X0] - row[CX]) * oy - (row[Y0] - row[CY]) * ox
    before = ox * (row[Y1] - row[CY]) - oy * (row[X1] - row[CX])
    return after * row[SENSE] >= 0.0 and before * row[SENSE] >= 0.0


@inline
def _segments_cross(a, b):
    ux, uy, vx, vy = a[X1] - a[X0], a[Y1] - a[Y0], b[X1] - b[X0], b[Y1] - b[Y0]
    p = ux * (b[Y0] - a[Y0]) - uy * (b[X0] - a[X0])
    q = ux * (b[Y1] - a[Y0]) - uy * (b[X1] - a[X0])
    r = vx * (a[Y0] - b[Y0]) - vy * (a[X0] - b[X0])
    s = vx * (a[Y1] - b[Y0]) - vy * (a[X1] - b[X0])
    return p * q < 0.0 and r * s < 0.0


@inline
def _segment_and_arc(line, arc):
    """The least distance of places inside both: at the foot of the centre, or 0 where they cross."""
    ux, uy = line[X1] - line[X0], line[Y1] - line[Y0]
    length = hypotenuse(ux, uy)
    if length == 0.0:
        return np.inf
    ux, uy = ux / length, uy / length
    t = (arc[CX] - line[X0]) * ux + (arc[CY] - line[Y0]) * uy
    fx, fy = line[X0] + t * ux, line[Y0] + t * uy
    off = hypotenuse(fx - arc[CX], fy - arc[CY])
    found = np.inf
    if 0.0 <= t <= length and _in_sector(arc, fx, fy):
        found = abs(off - arc[RADIUS])
    if off < arc[RADIUS]:
        half = math.sqrt((arc[RADIUS] - off) * (arc[RADIUS] + off))
        for k in range(2):
            s = half if k == 0 else -half
            if 0.0 <= t + s <= length and _in_sector(arc, fx + s * ux, fy + s * uy):
                found = 0.0
    return found


@inline
def _arc_and_arc(a, b):
    """The least distance of places inside both: on the line of the centres, or 0 where they cross."""
    ux, uy = b[CX] - a[CX], b[CY] - a[CY]
    distance = hypotenuse(ux, uy)
    if distance == 0.0:  # about one centre: ends decide, or the radii all along
        return np.inf
    ux, uy = ux / distance, uy / distance
    found = np.inf
    for k in range(4):
        p = a[RADIUS] if k & 1 else -a[RADIUS]
        q = b[RADIUS] if k & 2 else -b[RADIUS]
        if _in_sector(a, a[CX] + p * ux, a[CY] + p * uy) and _in_sector(
            b, b[CX] + q * ux, b[CY] + q * uy
        ):
            found = min(found, abs(distance + q - p))
    along = 0.5 * (distance + (a[RADIUS] - b[RADIUS]) * ((a[RADIUS] + b[RADIUS]) / distance))
    if abs(along) < a[RADIUS]:
        half = math.sqrt((a[RADIUS] - along) * (a[RADIUS] + along))
        for k in range(2):
            s = half if k == 0 else -half
            x, y = a[CX] + along * ux - s * uy, a[CY] + along * uy + s * ux
            if _in_sector(a, x, y) and _in_sector(b, x, y):
                found = 0.0
    return found


@kernel
def arcs_distance(a: Floats, b: Floats) -> tuple[float, float]:
    """The least distance of two arcs to rounding, and a bound of that rounding.

    A crossing or a foot that rounding puts just beside the end of an arc is missed, but then that end is as near.
    """
    least = min(arc_distance(b, a[X0], a[Y0]), arc_distance(b, a[X1], a[Y1]))
    least = min(least, arc_distance(a, b[X0], b[Y0]), arc_distance(a, b[X1], b[Y1]))
    if a[RADIUS] > 0.0 and b[RADIUS] > 0.0:
        least = min(least, _arc_and_arc(a, b))
    elif a[RADIUS] > 0.0:
        least = min(least, _segment_and_arc(b, a))
    elif b[RADIUS] > 0.0:
        least = min(least, _segment_and_arc(a, b))
    elif _segments_cross(a, b):
        least = 0.0
    scale = a[RADIUS] + b[RADIUS]
    for k in (X0, Y0, X1, Y1, CX, CY):
        scale = max(scale, abs(a[k]), abs(b[k]))
    return least, ROUNDINGS * scale


@inline
def _set_cell_arc(points, n, shift_x, shift_y, work, row):
    """Makes `row` the arc of a cell of a curve by its control points, shifted, with its error."""
    x0, y0 = points[0, 0] / points[0, 2], points[0, 1] / points[0, 2]
    x1, y1 = points[n, 0] / points[n, 2], points[n, 1] / points[n, 2]
    chord = Chord(x0, y0, x1, y1)
    if n == 1:
        set_segment(row, 0.0, 1.0, chord)
    else:
        tx, ty = end_tangent(points, n, False)
        flat = ROUNDINGS * (abs(x0) + abs(y0) + abs(x1) + abs(y1))
        set_arc(row, 0.0, 1.0, chord, tx, ty, flat)
        row[EPS] = arc_error(row, points, n, work)
    row[X0], row[X1], row[CX] = row[X0] + shift_x, row[X1] + shift_x, row[CX] + shift_x
    row[Y0], row[Y1], row[CY] = row[Y0] + shift_y, row[Y1] + shift_y, row[CY] + shift_y


@inline
def lower_bound_cells(p, n, q, m, shift_x, shift_y, work, rows):
    """A lower bound of the distance of two cells by their arcs, and how much of what it lacks is rounding.

    Args: p (n + 1), q (m + 1): homogeneous control points; the shift is added to p. rows (2, WIDTH) is scratch.
    """
    _set_cell_arc(p, n, shift_x, shift_y, work, rows[0])
    _set_cell_arc(q, m, 0.0, 0.0, work, rows[1])
    least, rounding = arcs_distance(rows[0], rows[1])
    return least - rows[0, EPS] - rows[1, EPS] - rounding, 2.0 * rounding
