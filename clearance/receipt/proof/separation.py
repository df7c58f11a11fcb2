"""Whether the motion of two parts of bodies keeps them apart along a direction, or as balls; rounding included.

Along U, of any length, and for |t| <= 1 in a piece, the least of U . (y + t v(y)) over one part less the greatest
of U . (x + t v(x)) over the other is concave in t, so it is least at t = -1 or 1. What it is there, over |U|, less
what both may be off straight, is a bound of the distance. Not for: which parts (`items`).
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np

from clearance.receipt.proof.error_terms import OUTWARD, along_of, most_of_balls
from clearance.receipt.proof.halving import Halves, over_boxes, over_corners
from clearance.receipt.proof.placing import PlacedViews

BYTE, SHORT, LONG = 2**7 - 1, 2**15 - 1, 2**31 - 1
"""The greatest coordinate of directions of one, two and four bytes a coordinate."""


class Sides(NamedTuple):
    """One body of each row: (k,) its place in `PlacedViews`, and its body and node in `Halves`."""

    place: np.ndarray
    body: np.ndarray
    node: np.ndarray

    def of(self, rows: np.ndarray) -> Sides:
        """Some of the rows."""
        return Sides(self.place[rows], self.body[rows], self.node[rows])


class Swung(NamedTuple):
    """Parts, and what they are looked at along at t = -1 and 1.

    Attributes:
        body, node: (k,). along: (3, 2, k) u in their frames. moved: (2, k) [m] what it comes to in their origins.
    """

    body: np.ndarray
    node: np.ndarray
    along: np.ndarray
    moved: np.ndarray

    def of(self, rows: np.ndarray) -> Swung:
        """Some of the rows."""
        return Swung(*(np.take(part, rows, axis=-1) for part in self))


def directions(codes: np.ndarray, most: int) -> np.ndarray:
    """(3, k) the vectors of whole numbers that codes (k, 2) from `-most` to `most` stand for.

    |x| + |y| + |z| = most: an octahedron, of which the lower half is folded outward.
    """
    x, y = codes.astype(np.int64).T
    z = most - np.abs(x) - np.abs(y)
    fold = np.where(z < 0)[0]
    ux, uy = x.copy(), y.copy()
    ux[fold] = (most - np.abs(y[fold])) * np.where(x[fold] < 0, -1, 1)
    uy[fold] = (most - np.abs(x[fold])) * np.where(y[fold] < 0, -1, 1)
    return np.stack([ux, uy, z]).astype(np.float64)


def along(
    halves: Halves, placed: PlacedViews, a: Sides, b: Sides, u: np.ndarray, enough: np.ndarray
) -> np.ndarray:
    """(k,) [m] no row's parts come nearer than this, by directions u (3, k) from a to b; -inf where u is 0.

    Rows of which boxes of the parts show what is `enough` (k,) [m] are looked at no closer, then those of which
    corners do with errors taken off by balls about the parts.
    """
    length, lost = np.sqrt(dot(u, u)), _lost(halves, placed, a, b, placed.rest)
    lost_to_errors = np.zeros(len(length))
    if placed.terms is not None:
        lost_to_errors = _most_errors(halves, placed, a, u) + _most_errors(halves, placed, b, -u)
    both = [_swung(placed, a, u), _swung(placed, b, -u)]
    found = _shown(halves, both, over_boxes, length, lost_to_errors) - lost
    rows = np.flatnonzero(~(found >= enough))
    both, length, lost = [one.of(rows) for one in both], length[rows], lost[rows]
    closer = _shown(halves, both, over_corners, length, lost_to_errors[rows]) - lost
    found[rows] = np.maximum(found[rows], closer)
    if placed.terms is None:
        return found
    rows = np.flatnonzero(~(found >= enough))
    if len(rows):
        closest = _with_errors(halves, placed, a.of(rows), b.of(rows), u[:, rows])
        lost = _lost(halves, placed, a.of(rows), b.of(rows), placed.rest)
        found[rows] = np.maximum(found[rows], closest - lost)
    return found


def _shown(
    halves: Halves,
    both: Sequence[Swung],
    over: Callable[[Halves, np.ndarray, np.ndarray, np.ndarray], np.ndarray],
    length: np.ndarray,
    lost_to_errors: np.ndarray,
) -> np.ndarray:
    """(k,) [m] how far parts keep apart along directions, over boxes or corners, less what errors take."""
    a, b = (over(halves, one.body, one.node, one.along) + one.moved for one in both)
    return _per_length(-(a + b).max(axis=0) - lost_to_errors, length)


def _with_errors(
    halves: Halves, placed: PlacedViews, a: Sides, b: Sides, u: np.ndarray
) -> np.ndarray:
    """(k,) [m] the same with what errors do at each corner."""
    assert placed.terms is not None
    most = np.zeros((2, len(a.place)))
    for side, own in ((a, u), (b, -u)):
        turn, at = (np.take(part, side.place, axis=-1) for part in placed[:2])
        errors = along_of(placed.terms, turn, at, side.place, own)
        one = _swung(placed, side, own)
        most += over_corners(halves, one.body, one.node, one.along, errors) + one.moved
    return _per_length(-most.max(axis=0), np.sqrt(dot(u, u)))


def _per_length(gap: np.ndarray, length: np.ndarray) -> np.ndarray:
    """(k,) no more than gap / length; -inf where the length is 0."""
    with np.errstate(divide="ignore", invalid="ignore"):
        bound = gap / length
    bound = bound - np.abs(bound) * (OUTWARD - 1.0)
    return np.where(length > 0.0, bound, -np.inf)


def _swung(placed: PlacedViews, side: Sides, u: np.ndarray) -> Swung:
    turn, at, omega, v0 = (np.take(part, side.place, axis=-1) for part in placed[:4])
    bent, shift = across(u, omega), dot(u, v0)
    g = np.stack([u - bent, u + bent], axis=1)
    own = np.stack([dot(g, turn[:, k, None]) for k in range(3)])
    moved = dot(g, at[:, None]) + np.stack([-shift, shift])
    return Swung(side.body, side.node, own, moved)


def _most_errors(halves: Halves, placed: PlacedViews, side: Sides, u: np.ndarray) -> np.ndarray:
    """(k,) no more than this is what errors do to any point of each part along u, by a ball that holds it."""
    assert placed.terms is not None
    node = halves.first_node[side.body] + side.node
    half = 0.5 * (halves.high[:, node] - halves.low[:, node])
    centre = centre_of(halves, placed, side)
    return most_of_balls(placed.terms, side.place, u, centre, np.sqrt(dot(half, half)))


def as_balls(halves: Halves, placed: PlacedViews, a: Sides, b: Sides) -> np.ndarray:
    """(k,) [m] no row's parts come nearer than this, by balls that hold them and as far as they can move."""
    between = centre_of(halves, placed, b) - centre_of(halves, placed, a)
    radii = np.zeros(len(a.place))
    for side in (a, b):
        node = halves.first_node[side.body] + side.node
        half = 0.5 * (halves.high[:, node] - halves.low[:, node])
        radii = radii + np.sqrt(dot(half, half))
    gap = np.sqrt(dot(between, between)) / OUTWARD - radii * OUTWARD
    return gap - _lost(halves, placed, a, b, placed.way)


def centre_of(halves: Halves, placed: PlacedViews, side: Sides) -> np.ndarray:
    """(3, k) [m] the middles of the parts' boxes."""
    node = halves.first_node[side.body] + side.node
    middle = 0.5 * (halves.low[:, node] + halves.high[:, node])
    turn = placed.turn[:, :, side.place]
    turned = np.stack([dot(turn[k], middle) for k in range(3)])
    return turned + placed.at[:, side.place]


def _lost(halves: Halves, placed: PlacedViews, a: Sides, b: Sides, moves: np.ndarray) -> np.ndarray:
    """(k,) [m] what balls about corners, rounding, and `moves` of both sides take away."""
    own = halves.radius[a.body] + halves.radius[b.body]
    sides = sum(moves[s.place] + placed.rounding[s.place] for s in (a, b))
    return (own + sides) * OUTWARD


def dot(u: np.ndarray, v: np.ndarray) -> np.ndarray:
    """Products of vectors whose first axis is x, y, z."""
    return u[0] * v[0] + u[1] * v[1] + u[2] * v[2]


def across(u: np.ndarray, v: np.ndarray) -> np.ndarray:
    """Vector products, the same way."""
    return np.stack(
        [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]]
    )
