"""Polygons as unions of fan triangles: distance and touching, on the integer grid.

Two unions of triangles are as far apart as the nearest of their corners, edges and triangles:
either an edge of one pierces a triangle of the other, or the minimum is attained corner to
triangle or edge to edge. Candidates whose boxes are farther apart than the best so far are
skipped; boxes and their gaps are integers, so that this is exact as well.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from fractions import Fraction

from tests.oracle.rationals import Point, exact_points, on_grid
from tests.oracle.simplices import pierces, point_triangle_sq, segments_sq

Box = tuple[Point, Point]


@dataclass(frozen=True)
class Fan:
    """A polygon's corners, edges (diagonals of the fan included) and triangles, each with its
    box."""

    corners: list[tuple[Box, Point]]
    edges: list[tuple[Box, tuple[Point, ...]]]
    triangles: list[tuple[Box, tuple[Point, ...]]]
    box: Box


def polygon_distance_sq(p: Iterable[Iterable], q: Iterable[Iterable]) -> Fraction:
    """The exact squared distance of two polygons (n, 3) and (m, 3), n, m >= 1."""
    scale, (grid_p, grid_q) = on_grid(exact_points(p), exact_points(q))
    return fans_sq(fan(grid_p), fan(grid_q)) / scale**2


def point_polygon_distance_sq(point: Iterable, polygon: Iterable[Iterable]) -> Fraction:
    """The exact squared distance of a point (3,) from a polygon (n, 3)."""
    return polygon_distance_sq([point], polygon)


def polygons_touch(p: Iterable[Iterable], q: Iterable[Iterable]) -> bool:
    """True if the two polygons have a point in common, exactly."""
    return polygon_distance_sq(p, q) == 0


def fan(corners: list[Point]) -> Fan:
    """The fan of a polygon; one or two corners make a point or a segment."""
    if not corners:
        raise ValueError("a polygon without corners has no distance")
    first, *rest = corners
    triangles = [(first, b, c) for b, c in itertools.pairwise(rest)]
    edges = {
        _ordered(pair) for t in triangles for pair in ((t[0], t[1]), (t[1], t[2]), (t[2], t[0]))
    }
    if not triangles:
        edges = {_ordered((corners[0], corners[-1]))}
        triangles = [(corners[0], corners[-1], corners[-1])]
    return Fan(
        corners=[((x, x), x) for x in sorted(set(corners))],
        edges=[(box_of(edge), edge) for edge in sorted(edges)],
        triangles=[(box_of(triangle), triangle) for triangle in triangles],
        box=box_of(corners),
    )


def fans_sq(a: Fan, b: Fan, best: Fraction | None = None) -> Fraction:
    """The squared distance of two fans, or `best` where that is less."""
    if best is not None and gap_sq(a.box, b.box) >= best:
        return best
    if _any_pierces(a, b) or _any_pierces(b, a):
        return Fraction(0)
    best = _least(a.corners, b.triangles, lambda x, t: point_triangle_sq(x, *t), best)
    best = _least(b.corners, a.triangles, lambda x, t: point_triangle_sq(x, *t), best)
    edges_a, edges_b = _nearer(a.edges, b.box, best), _nearer(b.edges, a.box, best)
    return _least(edges_a, edges_b, lambda e, f: segments_sq(*e, *f), best)


def box_of(points: Iterable[Point]) -> Box:
    """The least and greatest coordinates."""
    axes = tuple(zip(*points, strict=True))
    return tuple(map(min, axes)), tuple(map(max, axes))


def gap_sq(one: Box, other: Box) -> int:
    """Squared distance of two boxes: nothing in them is nearer."""
    (low_x, low_y, low_z), (high_x, high_y, high_z) = one
    (from_x, from_y, from_z), (to_x, to_y, to_z) = other
    x = max(from_x - high_x, low_x - to_x, 0)
    y = max(from_y - high_y, low_y - to_y, 0)
    z = max(from_z - high_z, low_z - to_z, 0)
    return x * x + y * y + z * z


def _nearer(ones: list, box: Box, best: Fraction) -> list:
    """Those whose boxes are nearer to a box than `best`."""
    beyond = math.ceil(best)
    return [one for one in ones if gap_sq(one[0], box) < beyond]


def _least(ones: list, others: list, measure: Callable, best: Fraction | None) -> Fraction:
    """The least of `best` and all candidates; an integer is less than `best` where it is less than its ceiling."""
    beyond = math.inf if best is None else math.ceil(best)
    for box, one in ones:
        for other_box, other in others:
            if gap_sq(box, other_box) < beyond:
                found = measure(one, other)
                if best is None or found < best:
                    best, beyond = found, math.ceil(found)
    return best


def _any_pierces(a: Fan, b: Fan) -> bool:
    return gap_sq(a.box, b.box) == 0 and any(
        gap_sq(edge_box, box) == 0 and pierces(*edge, *triangle)
        for edge_box, edge in a.edges
        for box, triangle in b.triangles
    )


def _ordered(pair: tuple[Point, Point]) -> tuple[Point, Point]:
    return (min(pair), max(pair))
