"""Triangles and segments to pixels, with a buffer of depths. The same input gives the same pixels.

A depth is one over the distance ahead, which is linear on the screen; 0 is infinitely far. Not for: what is drawn
in which colour (`picture`).
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from clearance.report.still import FIELD_OF_VIEW, Camera

AT_ONCE = 1 << 18
"""Rows, or pixels, of triangles that are looked at together: some 50 MB."""


class Screen(NamedTuple):
    """A camera and the pixels that it fills."""

    camera: Camera
    width: int
    height: int

    @property
    def scale(self) -> float:
        """Pixels of what is as long as it is far."""
        return 0.5 * self.height / math.tan(0.5 * FIELD_OF_VIEW)

    def flat(self, seen: np.ndarray) -> np.ndarray:
        """(..., 3) x and y [pixels] from the upper left corner, and depth, of points as the camera sees them."""
        depth = 1.0 / seen[..., 2]
        x = 0.5 * self.width + self.scale * seen[..., 0] * depth
        y = 0.5 * self.height - self.scale * seen[..., 1] * depth
        return np.stack([x, y, depth], axis=-1)

    def point(self, point: np.ndarray) -> np.ndarray | None:
        """(3,) of one point in the world, None if it is behind the camera."""
        seen = self.camera.seen_from_it(point)
        return self.flat(seen) if seen[2] > self.camera.near else None


class Surface(NamedTuple):
    """What is nearest: (k,) places of pixels, row by row, their depths, and which triangle each shows."""

    pixels: np.ndarray
    depth: np.ndarray
    owner: np.ndarray


def surface(screen: Screen, corners: np.ndarray) -> Surface:
    """What triangles (n, 3, 3) [m] in the world show of themselves."""
    ahead, owners = _ahead(screen.camera.seen_from_it(corners), screen.camera.near)
    flat = screen.flat(ahead)
    with np.errstate(divide="ignore", invalid="ignore"):
        slopes = np.cross(flat[:, 1] - flat[:, 0], flat[:, 2] - flat[:, 0])
        slopes = -slopes[:, :2] / slopes[:, 2:]  # of the depth, by x and by y
    depths = np.zeros(screen.width * screen.height)
    shown = np.full(len(depths), -1)
    for of, row, columns in _pixels(flat, np.all(np.isfinite(slopes), axis=1), screen):
        x, y = columns + 0.5 - flat[of, 0, 0], row + 0.5 - flat[of, 0, 1]
        depth = flat[of, 0, 2] + slopes[of, 0] * x + slopes[of, 1] * y
        pixels = row * screen.width + columns
        before = depths[pixels]
        np.maximum.at(depths, pixels, depth)
        wins = (depth == depths[pixels]) & (depth > before)
        shown[pixels[wins]] = owners[of[wins]]
    seen = np.flatnonzero(shown >= 0)
    return Surface(seen, depths[seen], shown[seen])


def _ahead(corners: np.ndarray, near: float) -> tuple[np.ndarray, np.ndarray]:
    """(m, 3, 3) triangles as a camera sees them, without what is not farther than `near` [m]; which each is of."""
    ahead = corners[:, :, 2] > near
    whole = ahead.all(axis=1)
    parts, owners = [*corners[whole]], [*np.flatnonzero(whole).tolist()]
    for i in np.flatnonzero(ahead.any(axis=1) & ~whole).tolist():
        ring = []
        for one, other in zip(corners[i], np.roll(corners[i], -1, axis=0), strict=True):
            if one[2] > near:
                ring.append(one)
            if (one[2] > near) != (other[2] > near):
                ring.append(one + (near - one[2]) / (other[2] - one[2]) * (other - one))
        parts += [np.array([ring[0], *ring[k : k + 2]]) for k in range(1, len(ring) - 1)]
        owners += [i] * (len(ring) - 2)
    return np.array(parts).reshape(-1, 3, 3), np.array(owners, dtype=np.int64)


def _pixels(
    flat: np.ndarray, is_wide: np.ndarray, screen: Screen
) -> Iterator[tuple[np.ndarray, np.ndarray, np.ndarray]]:
    """Which of some triangles cover which rows and columns: those whose middle they hold, part by part."""
    rows = _window(flat[:, :, 1].min(axis=1), flat[:, :, 1].max(axis=1), screen.height)
    rows[~is_wide] = 0
    for part in _parts(rows[:, 1] - rows[:, 0]):
        of, row = _spread(part, rows)
        one, other = flat[of, :, :2], np.roll(flat[of, :, :2], -1, axis=1)
        y = (row + 0.5)[:, None]
        crosses = (one[:, :, 1] <= y) != (other[:, :, 1] <= y)
        with np.errstate(divide="ignore", invalid="ignore"):
            share = (y - one[:, :, 1]) / (other[:, :, 1] - one[:, :, 1])
            x = one[:, :, 0] + share * (other[:, :, 0] - one[:, :, 0])
        first = np.where(crosses, x, np.inf).min(axis=1)
        columns = _window(first, np.where(crosses, x, -np.inf).max(axis=1), screen.width)
        for spans in _parts(columns[:, 1] - columns[:, 0]):
            span, column = _spread(spans, columns)
            yield of[span], row[span], column


def _window(low: np.ndarray, high: np.ndarray, most: int) -> np.ndarray:
    """(n, 2) int64 the first of the pixels whose middles are between two values, and the one after the last."""
    ends = np.stack([np.ceil(low - 0.5), np.floor(high - 0.5) + 1.0], axis=1)
    found = np.clip(np.nan_to_num(ends, posinf=most, neginf=0.0), 0, most).astype(np.int64)
    found[:, 1] = np.maximum(found[:, 0], found[:, 1])
    return found


def _parts(counts: np.ndarray) -> Iterator[np.ndarray]:
    """Places of what has something, so many at a time that their counts are about `AT_ONCE`."""
    places = np.flatnonzero(counts)
    part = np.cumsum(counts[places]) // AT_ONCE
    return iter(np.split(places, np.flatnonzero(np.diff(part)) + 1)) if len(places) else iter(())


def _spread(places: np.ndarray, windows: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Each pixel of the windows at some places: which window it is of, and its number."""
    first, last = windows[places].T
    n = last - first
    start = np.repeat(np.cumsum(n) - n, n)
    return np.repeat(places, n), np.repeat(first, n) + np.arange(len(start)) - start


def drawn_segments(screen: Screen, ends: np.ndarray, depth: np.ndarray, bias: float) -> np.ndarray:
    """(rows, columns) whether a pixel is on one of the segments (n, 2, 3) [m] that nothing hides, two pixels wide.

    Args:
        depth: (rows, columns) of what may hide them. bias: by which share of its distance a segment is taken to
            be nearer.
    """
    flat = screen.flat(_in_view(screen, screen.camera.seen_from_it(ends)))
    n = (
        np.ceil(np.abs(flat[:, 1, :2] - flat[:, 0, :2]).max(axis=1, initial=0.0)).astype(np.int64)
        + 1
    )
    of = np.repeat(np.arange(len(flat)), n)
    share = (np.arange(len(of)) - np.repeat(np.cumsum(n) - n, n)) / np.maximum(n[of] - 1, 1)
    points = flat[of, 0] + share[:, None] * (flat[of, 1] - flat[of, 0])
    most = np.array([screen.width, screen.height]) - 1
    x, y = np.clip(points[:, :2].astype(np.int64), 0, most).T
    free = points[:, 2] * (1.0 + bias) >= depth[y, x]
    found = np.zeros(depth.shape, dtype=bool)
    for right, low in ((0, 0), (1, 0), (0, 1), (1, 1)):
        found[np.minimum(y[free] + low, most[1]), np.minimum(x[free] + right, most[0])] = True
    return found


def _in_view(screen: Screen, ends: np.ndarray) -> np.ndarray:
    """The parts of segments (n, 2, 3), as a camera sees them, that are in the picture."""
    wide, high = 0.5 * screen.width / screen.scale, 0.5 * screen.height / screen.scale
    sides = [
        (0.0, 0.0, 1.0),
        (1.0, 0.0, wide),
        (-1.0, 0.0, wide),
        (0.0, 1.0, high),
        (0.0, -1.0, high),
    ]
    for i, normal in enumerate(sides):
        beyond = ends @ np.array(normal) - (screen.camera.near if i == 0 else 0.0)
        ahead = (beyond > 0.0).any(axis=1)
        ends, beyond = ends[ahead], beyond[ahead]
        with np.errstate(divide="ignore", invalid="ignore"):
            share = beyond[:, :1] / (beyond[:, :1] - beyond[:, 1:])
            cut = ends[:, 0] + share * (ends[:, 1] - ends[:, 0])
        ends = np.where((beyond > 0.0)[:, :, None], ends, cut[:, None])
    return ends
