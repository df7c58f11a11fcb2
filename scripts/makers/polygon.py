"""Plane polygons with holes cut into triangles by ear clipping, shortest cut first.

Our own thirty lines instead of a library's, because the committed meshes must come out as the same bytes
whatever versions are installed. For profiles of some hundred corners; it is cubic.
"""

from __future__ import annotations

import itertools
from collections.abc import Sequence

import numpy as np

Loop = list[tuple[float, float]]


def triangulate(loops: Sequence[np.ndarray]) -> np.ndarray:
    """(m, 3) triangles over the loops' points counted through, counter-clockwise.

    Args:
        loops: (k, 2) each; the outline counter-clockwise, then holes clockwise, none touching another.
    """
    points = np.concatenate(loops)
    starts = np.cumsum([0, *(len(loop) for loop in loops)])
    rest = list(range(starts[1]))
    holes = [list(range(a, b)) for a, b in itertools.pairwise(starts[1:])]
    for hole in sorted(holes, key=lambda h: (-points[h, 0].max(), h[0])):
        rest = _joined(points, rest, hole)
    triangles = []
    while len(rest) > 3:
        at = _shortest_ear(points, rest)
        triangles.append((rest[at - 1], rest[at], rest[(at + 1) % len(rest)]))
        del rest[at]
    triangles.append(tuple(rest))
    return np.array(triangles)


def _joined(points: np.ndarray, outline: list[int], hole: list[int]) -> list[int]:
    """The outline with a hole spliced in over the shortest bridge that crosses no edge."""
    gaps = ((points[outline][:, None] - points[hole][None]) ** 2).sum(axis=2)
    edges = _edges(points, outline) + _edges(points, hole)
    for flat in np.argsort(gaps, axis=None, kind="stable"):
        i, j = divmod(int(flat), len(hole))
        if not any(_crosses(points[outline[i]], points[hole[j]], p, q) for p, q in edges):
            around = hole[j:] + hole[: j + 1]
            return outline[: i + 1] + around + outline[i:]
    raise AssertionError("a hole lies outside its outline")


def _edges(points: np.ndarray, loop: list[int]) -> list[tuple[np.ndarray, np.ndarray]]:
    return [(points[a], points[b]) for a, b in zip(loop, loop[1:] + loop[:1], strict=True)]


def _turn(a: np.ndarray, b: np.ndarray, c: np.ndarray) -> float:
    return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])


def _crosses(a: np.ndarray, b: np.ndarray, p: np.ndarray, q: np.ndarray) -> bool:
    """True if the open segments cross properly."""
    return _turn(a, b, p) * _turn(a, b, q) < 0 and _turn(p, q, a) * _turn(p, q, b) < 0


def _shortest_ear(points: np.ndarray, rest: list[int]) -> int:
    corners = points[rest]
    before, after = np.roll(corners, 1, axis=0), np.roll(corners, -1, axis=0)
    cuts = ((after - before) ** 2).sum(axis=1)
    for at in np.argsort(cuts, kind="stable"):
        triangle = (before[at], corners[at], after[at])
        if _turn(*triangle) > 0 and not _holds_another(triangle, corners):
            return int(at)
    raise AssertionError("the outline crosses itself")


def _holds_another(triangle: tuple[np.ndarray, ...], corners: np.ndarray) -> bool:
    """True if a corner other than the triangle's own lies in it or on its rim."""
    inside = np.ones(len(corners), dtype=bool)
    for p, q in zip(triangle, triangle[1:] + triangle[:1], strict=True):
        side = (q[0] - p[0]) * (corners[:, 1] - p[1]) - (q[1] - p[1]) * (corners[:, 0] - p[0])
        inside &= (side >= 0) & (corners != p).any(axis=1)
    return bool(inside.any())
