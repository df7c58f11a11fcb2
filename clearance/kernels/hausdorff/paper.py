"""Compiled trimming as Kim, Oh, Kim (2010) publish it: a page of pixels, bounds (1) and (2), equations (3)-(10).

Each pixel of the page holds the distance of its centre to the other curve's biarcs and the arc that is nearest,
the depth and the colour of the graphics buffer. Kept to the letter, to be measured and judged (`PAPER.md`);
what answers by default is `hausdorff`. Not for: the systems on what is left (`hausdorff.systems`).
"""

import math
from typing import NamedTuple

import numpy as np

from clearance.compile.declared import Flags, Floats2, Integers2
from clearance.compile.decorators import inline, kernel
from clearance.kernels.curve.arc import EPS, S0, S1, X0, X1, Y0, Y1, arc_distance
from clearance.kernels.curve.arc_fit import Leaves
from clearance.kernels.curve.bezier import Pieces, hypotenuse, jet
from clearance.kernels.hausdorff.trim import arc_covers, field, put_control_points


class Page(NamedTuple):
    """A page of pixels about one curve, in that curve's frame.

    Attributes:
        x0, y0: its lower left corner; pixel: the side of a pixel.
        depth, colour: (rows, columns) distance of each pixel's centre to the arcs, and the nearest arc.
    """

    x0: float
    y0: float
    pixel: float
    depth: Floats2
    colour: Integers2


@inline
def _pixel_of(x, y, page):
    """Row and column of the pixel that (x, y) lies on; the page's edge for points off it."""
    n_rows, n_columns = page.depth.shape
    row = min(n_rows - 1, max(0, math.floor((y - page.y0) / page.pixel)))
    return row, min(n_columns - 1, max(0, math.floor((x - page.x0) / page.pixel)))


@kernel
def greatest_depth(pa: Pieces, la: Leaves, shift_x: float, shift_y: float, page: Page) -> float:
    """The greatest depth read along curve A on the page of B."""
    most = 0.0
    for k in range(la.arcs.shape[0]):
        row = la.arcs[k]
        steps = max(1, math.ceil(hypotenuse(row[X1] - row[X0], row[Y1] - row[Y0]) / page.pixel))
        for j in range(steps + 1):
            t = row[S0] + (row[S1] - row[S0]) * j / steps
            here = jet(pa, la.piece[k], t)
            r, c = _pixel_of(here.x + shift_x, here.y + shift_y, page)
            most = max(most, page.depth[r, c])
    return most


@inline
def _likeliest(points, candidates, arcs):
    """Of the arcs seen at three control points the one whose farthest control point is nearest."""
    best, which = np.inf, candidates[0]
    for k in range(3):
        far = 0.0
        for i in range(3):
            far = max(far, arc_distance(arcs[candidates[k]], points[i, 0], points[i, 1]))
        if far < best:
            best, which = far, candidates[k]
    return which


@kernel
def paper_candidates(
    la: Leaves, lb: Leaves, shift_x: float, shift_y: float, page: Page, lower_bound: float
) -> Flags:
    """Which arcs of A (n,) equations (8) to (10) leave: one arc of B for each, epsilon 1 taken off once."""
    candidate_arcs = np.ones(la.arcs.shape[0], np.bool_)
    points, candidates = np.empty((3, 2)), np.empty(3, np.int64)
    epsilon = 0.0
    for k in range(lb.arcs.shape[0]):
        epsilon = max(epsilon, lb.arcs[k, EPS])
    for k in range(la.arcs.shape[0]):
        row = la.arcs[k]
        put_control_points(row, shift_x, shift_y, points)
        for i in range(3):
            r, c = _pixel_of(points[i, 0], points[i, 1], page)
            candidates[i] = page.colour[r, c]
        facing = lb.arcs[_likeliest(points, candidates, lb.arcs)]
        reach = lower_bound - epsilon
        candidate_arcs[k] = not (reach > 0.0 and arc_covers(points, facing, reach))
    return candidate_arcs


@kernel
def draw_page(lb: Leaves, x0: float, y0: float, pixel: float, n_rows: int, n_columns: int) -> Page:
    """The `Page` (n_rows, n_columns) whose lower left corner is (x0, y0), drawn about B."""
    depth, colour = np.empty((n_rows, n_columns)), np.empty((n_rows, n_columns), np.int64)
    xs = x0 + pixel * (np.arange(n_columns) + 0.5)
    ys = y0 + pixel * (np.arange(n_rows) + 0.5)
    field(lb, xs, ys, depth, colour)
    return Page(x0, y0, pixel, depth, colour)
