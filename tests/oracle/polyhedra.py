"""Whole surfaces and solids: brute force over all pairs of faces, and containment by rays.

The only shortcut is the order: pairs of faces are taken by a float lower bound of their gap along
some directions, and the loop ends where the bound exceeds the best exact distance. The bound is proven in
`_lower_bounds`.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterable, Sequence
from fractions import Fraction

import numpy as np

from tests.oracle.polygons import Fan, fan, fans_sq
from tests.oracle.rationals import Point, cross, dot, exact_points, minus, on_grid, posed
from tests.oracle.simplices import point_triangle_sq

Faces = Sequence[Sequence[int]]

DIRECTIONS = [(1, 0, 0), (0, 1, 0), (0, 0, 1)] + [
    d for d in itertools.product((-1, 0, 1), repeat=3) if d > (0, 0, 0) and sum(map(abs, d)) > 1
]
"""The axes, then others: along each the gap of two faces bounds their distance."""


def polyhedron_distance_sq(
    verts_a: Iterable[Iterable],
    faces_a: Faces,
    verts_b: Iterable[Iterable],
    faces_b: Faces,
    pose_a: Iterable[Iterable] | None = None,
    pose_b: Iterable[Iterable] | None = None,
) -> Fraction:
    """The exact squared distance of two surfaces; one wholly inside the other is not zero.

    Args:
        verts_a, verts_b: (n, 3). faces_a, faces_b: vertex indices of each face.
        pose_a, pose_b: (4, 4) world_from_body, taken exactly as given.
    """
    scale, (grid_a, grid_b) = on_grid(posed(verts_a, pose_a), posed(verts_b, pose_b))
    return _surfaces_sq(_fans(grid_a, faces_a), _fans(grid_b, faces_b), scale) / scale**2


def nearest_faces(
    verts_a: Iterable[Iterable],
    faces_a: Faces,
    verts_b: Iterable[Iterable],
    faces_b: Faces,
    pose_a: Iterable[Iterable] | None = None,
    pose_b: Iterable[Iterable] | None = None,
) -> tuple[Fraction, list[tuple[int, int]]]:
    """The exact squared distance of two surfaces and the pairs of faces that are so near, in order.

    Where the surfaces touch, one pair that does.
    """
    scale, (grid_a, grid_b) = on_grid(posed(verts_a, pose_a), posed(verts_b, pose_b))
    fans_a, fans_b = _fans(grid_a, faces_a), _fans(grid_b, faces_b)
    found: dict[tuple[int, int], Fraction] = {}
    least = None
    for i, j, bound in _by_lower_bound(fans_a, fans_b, scale):
        if least is not None and (bound > least or least == 0):
            break
        found[i, j] = fans_sq(fans_a[i], fans_b[j])
        least = found[i, j] if least is None else min(least, found[i, j])
    return least / scale**2, sorted(pair for pair, sq in found.items() if sq == least)


def solid_distance_sq(
    verts_a: Iterable[Iterable],
    faces_a: Faces,
    verts_b: Iterable[Iterable],
    faces_b: Faces,
    pose_a: Iterable[Iterable] | None = None,
    pose_b: Iterable[Iterable] | None = None,
    closed_a: bool = True,
    closed_b: bool = True,
) -> Fraction:
    """The exact squared distance of two solids: zero too where a part of one is inside the other.

    Surfaces that share no point lie wholly inside or outside each other, component by component,
    so one corner of each component decides. A body that is not `closed` holds nothing.
    """
    world_a, world_b = posed(verts_a, pose_a), posed(verts_b, pose_b)
    surfaces = polyhedron_distance_sq(world_a, faces_a, world_b, faces_b)
    if surfaces == 0:
        return surfaces
    inside = (
        closed_b and any(contains(x, world_b, faces_b) for x in _one_each(world_a, faces_a))
    ) or (closed_a and any(contains(x, world_a, faces_a) for x in _one_each(world_b, faces_b)))
    return Fraction(0) if inside else surfaces


def contains(
    point: Iterable, verts: Iterable[Iterable], faces: Faces, pose: Iterable[Iterable] | None = None
) -> bool:
    """True if the point is on the surface or inside it (winding number not zero), exactly.

    Raises:
        ValueError: the surface is not closed, or not consistently oriented.
    """
    _, ((x,), grid) = on_grid(exact_points([point]), posed(verts, pose))
    triangles = _triangles(grid, faces)
    return any(_touches(x, t) for t in triangles) or _winding(x, triangles) != 0


def winding_number(
    point: Iterable, verts: Iterable[Iterable], faces: Faces, pose: Iterable[Iterable] | None = None
) -> int:
    """How often the surface, its faces counter-clockwise from outside, encloses a point off the
    surface.

    Raises:
        ValueError: the surface is not closed, or not consistently oriented.
    """
    _, ((x,), grid) = on_grid(exact_points([point]), posed(verts, pose))
    return _winding(x, _triangles(grid, faces))


def _touches(x: Point, triangle: tuple[Point, ...]) -> bool:
    """True if the point lies on the triangle."""
    axes = zip(x, *triangle, strict=True)
    is_near = all(min(a, b, c) <= at <= max(a, b, c) for at, a, b, c in axes)
    return is_near and point_triangle_sq(x, *triangle) == 0


def _winding(x: Point, triangles: list[tuple[Point, ...]]) -> int:
    """Signed crossings of rays from x that meet no edge; three rays must agree."""
    crossings = (_crossings(x, direction, triangles) for direction in _directions())
    first, *others = itertools.islice((n for n in crossings if n is not None), 3)
    if any(n != first for n in others):
        raise ValueError(f"rays count {[first, *others]}: the surface is not closed and oriented")
    return first


def _crossings(x: Point, direction: Point, triangles: list[tuple[Point, ...]]) -> int | None:
    """Crossings outwards less crossings inwards, None if the ray meets an edge or lies in a
    plane."""
    corners = {corner for triangle in triangles for corner in triangle}
    from_x = {corner: minus(corner, x) for corner in corners}
    beside = {corner: cross(direction, seen) for corner, seen in from_x.items()}
    total = 0
    for a, b, c in triangles:
        turns = (
            dot(beside[a], from_x[b]),
            dot(beside[b], from_x[c]),
            dot(beside[c], from_x[a]),
        )  # six times the volumes of the ray and each edge
        if min(turns) < 0 < max(turns):
            continue  # the whole line passes beside the triangle
        normal = cross(minus(b, a), minus(c, a))
        if not any(normal):
            continue  # no area
        height, slope = dot(normal, from_x[a]), dot(normal, direction)
        if 0 in turns or slope == 0:
            return None
        if (height > 0) == (slope > 0) and height != 0:
            total += 1 if slope > 0 else -1
    return total


def _directions() -> Iterable[Point]:
    """Integer directions of no symmetry; only finitely many planes of edges can be met by one."""
    for k in itertools.count(1):
        yield (997 + 31 * k * k, -613 + 17 * k, 389 - 7 * k * k * k)
        yield (-499 - 13 * k, 821 + 11 * k * k, 1009 + 3 * k * k * k)


def _surfaces_sq(fans_a: list[Fan], fans_b: list[Fan], scale: int) -> Fraction:
    best = None
    for i, j, bound in _by_lower_bound(fans_a, fans_b, scale):
        if best is not None and bound > best:
            break
        best = fans_sq(fans_a[i], fans_b[j], best)
        if best == 0:
            break
    return best


def _by_lower_bound(
    fans_a: list[Fan], fans_b: list[Fan], scale: int
) -> Iterable[tuple[int, int, int]]:
    """All pairs of faces and what their squared distance is not below, least first."""
    bounds = _lower_bounds(fans_a, fans_b, scale)
    for flat in np.argsort(bounds, axis=None, kind="stable"):
        i, j = divmod(int(flat), len(fans_b))
        n, d = float(bounds[i, j]).as_integer_ratio()
        yield i, j, (n * scale // d) ** 2


def _lower_bounds(fans_a: list[Fan], fans_b: list[Fan], scale: int) -> np.ndarray:
    """(n, m) floats, none above the true distance of two faces: their greatest gap along a direction.

    A gap along d is at most |d| times the distance. With u = 2^-53, all coordinates |x| <= M and |d|_1 <= 3:
    x . d is an integer on the grid, Python's int / int rounds it correctly, so it is off by at most 3 u M, the
    difference of two by 6 u M and its own rounding by u 6 M (1 + u). To divide by |d| >= 1 and to take the
    margin off round by less than 12 u M. Underflow adds less than 1e-320.
    """
    low_a, high_a = _extents(fans_a, scale)
    low_b, high_b = _extents(fans_b, scale)
    largest = max(np.abs(x[:3]).max() for x in (low_a, high_a, low_b, high_b))
    bounds = np.zeros((len(fans_a), len(fans_b)))
    for k, direction in enumerate(DIRECTIONS):
        gaps = np.maximum(low_b[k] - high_a[k][:, None], low_a[k][:, None] - high_b[k])
        np.maximum(bounds, gaps / math.hypot(*direction), out=bounds)
    return np.maximum(bounds - (32 * 2.0**-53 * largest + 1e-320), 0.0)


def _extents(fans: list[Fan], scale: int) -> tuple[np.ndarray, np.ndarray]:
    """(k, n) the least and the greatest x . d of each face, for each direction."""
    along = [
        [[dot(x, direction) for _, x in one.corners] for one in fans] for direction in DIRECTIONS
    ]
    low = np.array([[min(each) / scale for each in faces] for faces in along])
    high = np.array([[max(each) / scale for each in faces] for faces in along])
    assert np.isfinite(low).all() and np.isfinite(high).all()
    return low, high


def _fans(grid: list[Point], faces: Faces) -> list[Fan]:
    return [fan([grid[int(i)] for i in face]) for face in faces]


def _triangles(grid: list[Point], faces: Faces) -> list[tuple[Point, ...]]:
    corners = [[grid[int(i)] for i in face] for face in faces]
    return [(c[0], c[k], c[k + 1]) for c in corners for k in range(1, len(c) - 1)]


def _one_each(points: Sequence, faces: Faces) -> list:
    """One corner of each component; corners at one place are one corner."""
    numbers = {point: i for i, point in enumerate(dict.fromkeys(points))}
    own = [[numbers[points[int(i)]] for i in face] for face in faces]
    parent = {i: i for face in own for i in face}

    def top(i):
        while parent[i] != i:
            parent[i] = i = parent[parent[i]]
        return i

    for first, *others in own:
        for i in others:
            parent[top(i)] = top(first)
    places = list(numbers)
    return sorted(places[i] for i in {top(i) for i in parent})
