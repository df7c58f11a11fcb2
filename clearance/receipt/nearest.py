"""The direction of the nearest points of two convex parts: by Gilbert, Johnson and Keerthi's method, many at once.

Whatever direction comes out, it only has to do; what it proves is decided elsewhere (`receipt.proof`).
"""

from __future__ import annotations

import itertools

import numpy as np

from clearance.receipt.proof.error_terms import along_of
from clearance.receipt.proof.halving import farthest, farthest_points
from clearance.receipt.proof.items import Items
from clearance.receipt.proof.placing import PlacedViews
from clearance.receipt.proof.separation import Sides, dot
from clearance.receipt.proof.stage import Stage

ROUNDS = 24
"""Points that are looked for at most."""

NEAR = 1e-10
"""[-] Of the distance: nearer to it nothing is gained."""

SUBSETS = [list(one) for size in (1, 2, 3, 4) for one in itertools.combinations(range(4), size)]


def nearest_directions(stage: Stage, items: Items) -> tuple[np.ndarray, np.ndarray]:
    """(3, k) unit vectors from the first to the second part of each item in the middle of its time; (k,) [m] how
    far they are apart there beyond what is wanted and what their motion is off straight.
    """
    n = len(items.pair)
    found, slack = np.zeros((3, n)), np.zeros(n)
    for rows, at, a, b in stage.middles(items):
        found[:, rows], apart = _directions(stage, at, a, b)
        own = items.of(rows)
        wanted = stage.wanted[own.pair, own.start + own.span // 2]
        lost = sum(at.rest[s.place] + stage.halves.radius[s.body] for s in (a, b))
        if at.terms is not None:
            u, back = found[:, rows], -found[:, rows]
            apart = apart - (_by_errors(stage, at, a, u) + _by_errors(stage, at, b, back))
        slack[rows] = apart - wanted - np.where(own.span > 1, 0.0, lost)
    return found, slack


def _by_errors(stage: Stage, at: PlacedViews, side: Sides, u: np.ndarray) -> np.ndarray:
    """(k,) [m] what errors at most do to a part along u (3, k), in one direction of time."""
    assert at.terms is not None
    turn, place = at.turn[:, :, side.place], at.at[:, side.place]
    errors = along_of(at.terms, turn, place, side.place, u)
    nothing = np.zeros((3, 1, len(side.place)))
    return farthest(stage.halves, side.body, side.node, nothing, errors)[0]


def _directions(stage: Stage, at: PlacedViews, a: Sides, b: Sides) -> tuple[np.ndarray, np.ndarray]:
    """Unit vectors and how far apart the parts are along them; 0 where they are not."""
    n = len(a.place)
    w = _support(stage, at, a, b, np.repeat([[1.0], [0.0], [0.0]], n, axis=1)).T
    points = np.tile(w[:, None], (1, 4, 1))
    best, u = np.full(n, -np.inf), np.zeros((3, n))
    active = np.arange(n)
    for _ in range(ROUNDS):
        toward = w[active].T
        length = np.sqrt(dot(toward, toward))
        own = Sides(*(c[active] for c in a)), Sides(*(c[active] for c in b))
        unit = toward / np.where(length > 0.0, length, 1.0)
        tip = _support(stage, at, *own, unit)
        apart = dot(tip, unit)
        better = apart > best[active]
        best[active[better]], u[:, active[better]] = apart[better], unit[:, better]
        going = (length > 0.0) & (apart < (1.0 - NEAR) * length)
        active, tip = active[going], tip[:, going]
        if not len(active):
            break
        points[active], w[active] = _nearest_in(points[active], tip.T)
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


def _nearest_in(points: np.ndarray, tip: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The points (k, 4, 3) with a tip (k, 3) among them, less those that are of no use, and their hulls' points
    (k, 3) nearest to the origin. The last of the four is free for the next tip.
    """
    corners = points.copy()
    corners[:, 3] = tip
    best, least, kept = np.zeros_like(tip), np.full(len(tip), np.inf), corners.copy()
    for subset in SUBSETS:
        own = corners[:, subset]
        share = _shares(own)
        point = np.einsum("kj,kji->ki", share, own)
        size = (point * point).sum(axis=1)
        better = (share >= 0.0).all(axis=1) & (size < least)
        best[better], least[better] = point[better], size[better]
        kept[better] = np.concatenate([own] + [own[:, :1]] * (4 - len(subset)), axis=1)[better]
    return kept, best


def _shares(own: np.ndarray) -> np.ndarray:
    """(k, m) barycentric coordinates of the point of m points' affine hull nearest to the origin; NaN if flat."""
    m = own.shape[1]
    if m == 1:
        return np.ones((len(own), 1))
    base = own[:, :1]
    edges = own[:, 1:] - base
    gram = np.einsum("kij,klj->kil", edges, edges)
    right = -np.einsum("kij,kj->ki", edges, base[:, 0])
    scale = np.trace(gram, axis1=1, axis2=2)[:, None, None] * 1e-13
    gram = gram + scale * np.eye(m - 1) + 1e-300 * np.eye(m - 1)
    rest = np.linalg.solve(gram, right[..., None])[..., 0]
    return np.concatenate([1.0 - rest.sum(axis=1, keepdims=True), rest], axis=1)
