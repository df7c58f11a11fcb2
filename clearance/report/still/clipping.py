"""What lies behind the camera, or beside the picture, cut away. Not for: which pixels are covered (`raster`)."""

from __future__ import annotations

import numpy as np


def triangles_ahead(corners: np.ndarray, near: float) -> tuple[np.ndarray, np.ndarray]:
    """The parts of triangles (n, 3, 3), as a camera sees them, that are farther ahead than `near` [m].

    Returns:
        (m, 3, 3) triangles, and (m,) which of the n each is part of.
    """
    is_ahead = corners[:, :, 2] > near
    n_ahead = is_ahead.sum(axis=1)
    whole = np.flatnonzero(n_ahead == 3)
    parts, owners = [corners[whole]], [whole]
    for count in (1, 2):
        rows = np.flatnonzero(n_ahead == count)
        if len(rows):
            cut = _cut(corners[rows], is_ahead[rows] == (count == 1), near, count)
            parts.append(cut)
            owners.append(np.tile(rows, count))
    return np.concatenate(parts), np.concatenate(owners)


def _cut(corners: np.ndarray, is_odd: np.ndarray, near: float, n_ahead: int) -> np.ndarray:
    """Triangles of which one corner is on the other side than both others."""
    order = (np.argmax(is_odd, axis=1)[:, None] + np.arange(3)) % 3
    odd, second, third = np.moveaxis(np.take_along_axis(corners, order[:, :, None], axis=1), 1, 0)
    to_second, to_third = _crossing(odd, second, near), _crossing(odd, third, near)
    if n_ahead == 1:
        return np.stack([odd, to_second, to_third], axis=1)
    return np.concatenate(
        [
            np.stack([to_second, second, third], axis=1),
            np.stack([to_second, third, to_third], axis=1),
        ]
    )


def _crossing(one: np.ndarray, other: np.ndarray, near: float) -> np.ndarray:
    share = (near - one[:, 2]) / (other[:, 2] - one[:, 2])
    return one + share[:, None] * (other - one)


def segments_ahead(ends: np.ndarray, near: float) -> np.ndarray:
    """(m, 2, 3) the parts of (n, 2, 3) segments that are farther ahead than `near` [m]."""
    ahead = ends[:, :, 2] > near
    ends = ends[ahead.any(axis=1)].copy()
    ahead = ahead[ahead.any(axis=1)]
    for i in (0, 1):
        rows = np.flatnonzero(~ahead[:, i])
        ends[rows, i] = _crossing(ends[rows, 1 - i], ends[rows, i], near)
    return ends


def segments_within(ends: np.ndarray, width: int, height: int) -> np.ndarray:
    """(m, 2, 3) the parts of (n, 2, 3) segments, x and y in pixels, that are in the picture.

    Source: Liang and Barsky, A new concept and method for line clipping, 1984.
    """
    start, way = ends[:, 0], ends[:, 1] - ends[:, 0]
    first, last = np.zeros(len(ends)), np.ones(len(ends))
    for axis, most in ((0, width), (1, height)):
        with np.errstate(divide="ignore", invalid="ignore"):
            shares = np.sort((np.array([[0.0], [most]]) - start[:, axis]) / way[:, axis], axis=0)
        stands = way[:, axis] == 0.0
        inside = (start[:, axis] >= 0.0) & (start[:, axis] <= most)
        first = np.where(stands, np.where(inside, first, 2.0), np.maximum(first, shares[0]))
        last = np.where(stands, last, np.minimum(last, shares[1]))
    kept = first < last
    shares = np.stack([first, last], axis=1)[kept]
    return start[kept, None] + shares[:, :, None] * way[kept, None]
