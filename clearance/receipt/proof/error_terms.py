"""What errors do to a point along a direction, to the first order: what tolerances take of a distance.

With turns by up to e about axes a through c, slides by up to e along a, and frames that may turn by up to `angle`
about any axis through o and be off by up to xyz, a point x moves along U by no more than f(x) and a rest,

    f(x) = sum e |U . (a x (x - c))| + sum e |U . a| + sum angle |U x (x - o)| + |U| sum xyz.

f is convex: over a polygon it is greatest at a corner, over a box at most its value in the middle and its slope
times the radius. The rest is of the second order (`ways`). Not for: how large errors are (`motion_data`).
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

OUTWARD = 1.0 + 2.0**-40
"""Covers the rounding of bounds that are sums of positive numbers."""


class Error(NamedTuple):
    """One error on the way to a body, in some pieces: of `size` [rad or m].

    Attributes:
        axis: (n, 3) that it turns about or slides along; None for any.
        origin: (n, 3) [m] a point of the axis, or through which any goes; None where it slides.
    """

    size: float
    axis: np.ndarray | None
    origin: np.ndarray | None


class Terms(NamedTuple):
    """The errors of all views in all pieces, (..., k) each as in `placing.PlacedViews`; zero where it has none.

    Attributes:
        bars: (t, 3, k) size times axis of turns. pins: (t, 3, k) [m] where. slides: (s, 3, k) [m].
        centres: (f, 3, k) [m] of turns about any axis. angles: (f, k) [rad]. shift: (k,) [m] in any direction.
        turns: (k,) True where something turns.
        moments: (t, 3, k) bars x pins. angle: (k,) [rad] of all turns about an axis.
        anyway: (k,) [m] at most what shifts and turns about any axis do to the body in any direction.
    """

    bars: np.ndarray
    pins: np.ndarray
    slides: np.ndarray
    centres: np.ndarray
    angles: np.ndarray
    shift: np.ndarray
    turns: np.ndarray
    moments: np.ndarray
    angle: np.ndarray
    anyway: np.ndarray


def across_rows(u: np.ndarray, v: np.ndarray) -> np.ndarray:
    """(n, 3) vector products; `np.cross` takes three times as long for a few hundred."""
    found = np.empty(v.shape)
    for i, j, k in ((0, 1, 2), (1, 2, 0), (2, 0, 1)):
        found[:, i] = u[:, j] * v[:, k] - u[:, k] * v[:, j]
    return found


def terms_of(errors: Sequence[Sequence[Error]], n_pieces: int, anyway: np.ndarray) -> Terms:
    """The terms of views, by what may be off on the way to each, `anyway` (k,) [m]."""
    turns, slides, frames = (
        [[one for one in own if kind(one)] for own in errors]
        for kind in (
            lambda e: e.axis is not None and e.origin is not None,
            lambda e: e.axis is not None and e.origin is None,
            lambda e: e.axis is None and e.origin is not None,
        )
    )
    shift = [
        sum(one.size for one in own if one.axis is None and one.origin is None) for own in errors
    ]
    return Terms(
        _rows(turns, n_pieces, lambda e: e.size * e.axis),
        _rows(turns, n_pieces, lambda e: e.origin),
        _rows(slides, n_pieces, lambda e: e.size * e.axis),
        _rows(frames, n_pieces, lambda e: e.origin),
        _rows(frames, n_pieces, lambda e: np.full((n_pieces, 3), e.size))[:, 0],
        np.repeat(np.array(shift, dtype=np.float64), n_pieces),
        np.repeat([bool(a or b) for a, b in zip(turns, frames, strict=True)], n_pieces),
        _rows(turns, n_pieces, lambda e: e.size * across_rows(e.axis, e.origin)),
        np.repeat([OUTWARD * sum(e.size for e in own) for own in turns], n_pieces),
        anyway,
    )


def _rows(errors, n_pieces: int, of) -> np.ndarray:
    """(most, 3, k) what there is of each error, view by view."""
    most = max((len(own) for own in errors), default=0)
    found = np.zeros((most, 3, len(errors) * n_pieces))
    for view, own in enumerate(errors):
        for i, one in enumerate(own):
            found[i, :, view * n_pieces : (view + 1) * n_pieces] = of(one).T
    return found


class DirectionTerms(NamedTuple):
    """f of rows along their directions U, in the frames of their bodies: a point p there has

        f = constant + sum |turns . p + offsets| + sum angles |u x p - centres|.

    Attributes:
        turns: (t, 3, r). offsets: (t, r). u: (3, r). centres: (f, 3, r). angles: (f, r). constant: (r,).
    """

    turns: np.ndarray
    offsets: np.ndarray
    u: np.ndarray
    centres: np.ndarray
    angles: np.ndarray
    constant: np.ndarray

    def of(self, rows: np.ndarray) -> DirectionTerms:
        """Some of the rows."""
        return DirectionTerms(*(np.take(part, rows, axis=-1) for part in self))

    def at(self, points: np.ndarray) -> np.ndarray:
        """(c, r) f at points (3, c, r)."""
        x, y, z = points
        found = np.repeat(self.constant[None], len(x), axis=0)
        for (mx, my, mz), offset in zip(self.turns, self.offsets, strict=True):
            found += np.abs(x * mx + y * my + z * mz + offset)
        ux, uy, uz = self.u
        across = uy * z - uz * y, uz * x - ux * z, ux * y - uy * x
        for (ox, oy, oz), angle in zip(self.centres, self.angles, strict=True):
            dx, dy, dz = across[0] - ox, across[1] - oy, across[2] - oz
            found += angle * np.sqrt(dx * dx + dy * dy + dz * dz)
        return found * OUTWARD

    @property
    def slope(self) -> np.ndarray:
        """(r,) how much f changes at most from a point to one a metre off."""
        steep = np.sqrt((self.turns * self.turns).sum(axis=1)).sum(axis=0)
        length = np.sqrt((self.u * self.u).sum(axis=0))
        return (steep + length * self.angles.sum(axis=0)) * OUTWARD


def along_of(
    terms: Terms, turn: np.ndarray, at: np.ndarray, place: np.ndarray, u: np.ndarray
) -> DirectionTerms:
    """f of rows (r,) at places of `terms`, whose bodies are turned by (3, 3, r) and at (3, r), along u (3, r)."""
    if not terms.turns[place].any():
        names = "bars", "pins", "centres", "angles"
        terms = terms._replace(**{name: getattr(terms, name)[:0] for name in names})
    bars, pins, slides, centres = (np.take(part, place, axis=-1) for part in terms[:4])
    across = np.cross(u[None], bars, axis=1)
    offsets = (across * (at[None] - pins)).sum(axis=1)
    own_u = np.stack([(turn[:, k] * u).sum(axis=0) for k in range(3)])
    offset = centres - at[None]
    length = np.sqrt((u * u).sum(axis=0))
    constant = np.abs((slides * u[None]).sum(axis=1)).sum(axis=0) + length * terms.shift[place]
    return DirectionTerms(
        _turned_back(turn, across),
        offsets,
        own_u,
        np.cross(own_u[None], _turned_back(turn, offset), axis=1),
        terms.angles[:, place],
        constant,
    )


def most_of_balls(
    terms: Terms, place: np.ndarray, u: np.ndarray, centre: np.ndarray, radius: np.ndarray
) -> np.ndarray:
    """(r,) f is nowhere above this in balls about centre (3, r), of radius (r,) [m], along u (3, r).

    Turns about any axis are taken as what they do to the whole body in any direction.
    """
    length = np.sqrt((u * u).sum(axis=0))
    found = length * (terms.anyway[place] + radius * terms.angle[place])
    if len(terms.slides):
        found += np.abs((np.take(terms.slides, place, axis=-1) * u).sum(axis=1)).sum(axis=0)
    rows = np.flatnonzero(terms.angle[place] > 0.0)
    if len(rows):
        found[rows] += _most_of_turns(terms, place[rows], u[:, rows], centre[:, rows])
    return found * OUTWARD


def _most_of_turns(
    terms: Terms, place: np.ndarray, u: np.ndarray, centre: np.ndarray
) -> np.ndarray:
    """(r,) what turns about axes do to points (3, r): size a x (x - c) is size a x x less the moment."""
    bars, moments = (np.take(part, place, axis=-1) for part in (terms.bars, terms.moments))
    (x, y, z), (px, py, pz) = u, centre
    across = py * z - pz * y, pz * x - px * z, px * y - py * x
    found = sum(bars[:, k] * across[k] - moments[:, k] * u[k] for k in range(3))
    return np.abs(found).sum(axis=0)


def _turned_back(turn: np.ndarray, vectors: np.ndarray) -> np.ndarray:
    """(n, 3, r) vectors (n, 3, r) in the bodies' frames."""
    return np.stack([(turn[None, :, k] * vectors).sum(axis=1) for k in range(3)], axis=1)
