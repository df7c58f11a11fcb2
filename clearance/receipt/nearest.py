"""The direction of the nearest points of two convex parts: by Gilbert, Johnson and Keerthi's method, many at once.

Whatever direction comes out, it only has to do; what it proves is decided elsewhere (`receipt.proof`).
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from clearance.receipt.proof.error_terms import along_of
from clearance.receipt.proof.halving import farthest_points, over_corners
from clearance.receipt.proof.items import Items
from clearance.receipt.proof.placing import PlacedViews
from clearance.receipt.proof.separation import Sides, across, dot
from clearance.receipt.proof.stage import Stage

ROUNDS = 24
"""Points that are looked for at most."""

NEAR = 1e-10
"""[-] Of the distance: nearer to it nothing is gained."""

FLAT = 1e-13
"""[-] Of a triangle or a tetrahedron against its edges: flatter ones are left to their sides."""

TIP = 3
"""The number of the newest of four points."""


def nearest_directions(
    stage: Stage, items: Items, first: np.ndarray | None = None
) -> tuple[np.ndarray, np.ndarray]:
    """(3, k) unit vectors from the first to the second part of each item in the middle of its time; (k,) [m] how
    far they are apart there beyond what is wanted and what their motion is off straight.

    Args:
        first: (3, k) unit vectors to begin with.
    """
    n = len(items.pair)
    first = np.repeat([[1.0], [0.0], [0.0]], n, axis=1) if first is None else first
    found, slack = np.zeros((3, n)), np.zeros(n)
    for rows, at, a, b in stage.middles(items):
        found[:, rows], gap = _directions(stage, at, a, b, first[:, rows])
        own = items.of(rows)
        wanted = stage.wanted[own.pair, own.start + own.span // 2]
        lost = sum(at.rest[s.place] + stage.halves.radius[s.body] for s in (a, b))
        if at.terms is not None:
            u, back = found[:, rows], -found[:, rows]
            gap = gap - (_by_errors(stage, at, a, u) + _by_errors(stage, at, b, back))
        slack[rows] = gap - wanted - np.where(own.span > 1, 0.0, lost)
    return found, slack


def _by_errors(stage: Stage, at: PlacedViews, side: Sides, u: np.ndarray) -> np.ndarray:
    """(k,) [m] what errors at most do to a part along u (3, k), in one direction of time."""
    assert at.terms is not None
    turn, place = at.turn[:, :, side.place], at.at[:, side.place]
    errors = along_of(at.terms, turn, place, side.place, u)
    nothing = np.zeros((3, 1, len(side.place)))
    return over_corners(stage.halves, side.body, side.node, nothing, errors)[0]


def _directions(
    stage: Stage, at: PlacedViews, a: Sides, b: Sides, first: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Unit vectors and how far apart the parts are along them; 0 where they are not."""
    w = _support(stage, at, a, b, first)
    points = np.repeat(w[None], TIP, axis=0)
    best, u, active = dot(w, first), first.copy(), np.arange(len(a.place))
    for _ in range(ROUNDS):
        length = np.sqrt(dot(w, w))
        unit = w / np.where(length > 0.0, length, 1.0)
        own_a, own_b = (Sides(*(column[active] for column in side)) for side in (a, b))
        tip = _support(stage, at, own_a, own_b, unit)
        gap = dot(tip, unit)
        better = gap > best[active]
        best[active[better]], u[:, active[better]] = gap[better], unit[:, better]
        going = np.flatnonzero((length > 0.0) & (gap < (1.0 - NEAR) * length))
        points, w = nearest_in(points[:, :, going], tip[:, going])
        nearer = dot(w, w) < length[going] ** 2
        active, points, w = active[going[nearer]], points[:, :, nearer], w[:, nearer]
        if not len(active):
            break
    return u, np.maximum(best, 0.0)


def _support(stage: Stage, at: PlacedViews, a: Sides, b: Sides, u: np.ndarray) -> np.ndarray:
    """(3, k) the least point of the second part less the greatest of the first, along u (3, k)."""
    tips = []
    for side, sign in ((a, 1.0), (b, -1.0)):
        turn = at.turn[:, :, side.place]
        own = np.stack([dot(sign * u, turn[:, k]) for k in range(3)])
        point = farthest_points(stage.halves, side.body, side.node, own)
        turned = np.stack([dot(turn[k], point) for k in range(3)])
        tips.append(turned + at.at[:, side.place])
    return tips[1] - tips[0]


class _Nearest(NamedTuple):
    """The point of some hulls nearest to the origin, as far as they were looked at: (3, k), its square distance
    (k,), and which two points beside the tip it is between (k,) each; `TIP` for none.
    """

    point: np.ndarray
    size: np.ndarray
    one: np.ndarray
    other: np.ndarray

    def take(self, valid: np.ndarray, point: np.ndarray, one: int, other: int) -> None:
        """Takes other points (3, k) where they are valid and nearer."""
        size = dot(point, point)
        nearer = np.flatnonzero(valid & (size < self.size))
        self.point[:, nearer], self.size[nearer] = point[:, nearer], size[nearer]
        self.one[nearer], self.other[nearer] = one, other


def nearest_in(points: np.ndarray, tip: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Of hulls of three points (3, 3, k) and a tip (3, k) the points (3, k) nearest to the origin, and before them
    the three points (3, 3, k) that it is between.

    Only what has the tip in it is looked at: it is nearer than all that was known.
    """
    k = tip.shape[1]
    found = _Nearest(tip.copy(), dot(tip, tip), np.full(k, TIP), np.full(k, TIP))
    edges = points - tip
    toward = [-dot(edge, tip) for edge in edges]
    squares = [dot(edge, edge) for edge in edges]
    with np.errstate(divide="ignore", invalid="ignore"):
        for i in range(TIP):
            share = toward[i] / squares[i]
            found.take((share > 0.0) & (share <= 1.0), tip + share * edges[i], i, TIP)
        for i, j in ((0, 1), (0, 2), (1, 2)):
            product = dot(edges[i], edges[j])
            flat = squares[i] * squares[j]
            size = flat - product * product
            one = (toward[i] * squares[j] - toward[j] * product) / size
            other = (toward[j] * squares[i] - toward[i] * product) / size
            valid = (one > 0.0) & (other > 0.0) & (one + other <= 1.0) & (size > FLAT * flat)
            found.take(valid, tip + one * edges[i] + other * edges[j], i, j)
        inside = _holds_origin(edges, tip, squares)
    found.point[:, inside] = 0.0
    corners = np.concatenate([points, tip[None]])
    which = np.stack([found.one, found.other, np.full(k, TIP)])
    return np.take_along_axis(corners, which[:, None], axis=0), found.point


def _holds_origin(edges: np.ndarray, tip: np.ndarray, squares: list[np.ndarray]) -> np.ndarray:
    """(k,) True where a tetrahedron holds it."""
    a, b, c = edges
    normals = across(b, c), across(c, a), across(a, b)
    volume = dot(a, normals[0])
    shares = [-dot(tip, normal) / volume for normal in normals]
    flat = volume * volume <= FLAT * squares[0] * squares[1] * squares[2]
    inside = (shares[0] >= 0.0) & (shares[1] >= 0.0) & (shares[2] >= 0.0)
    return inside & (shares[0] + shares[1] + shares[2] <= 1.0) & ~flat
