"""Whether a body is inside another: surfaces that keep apart do not tell.

A point is inside a closed surface that winds about it: the sum of the solid angles of its triangles is not 0.
Closed are those whose edges are run along as often one way as the other; others hold nothing. Source: Van Oosterom
& Strackee 1983 for the angle of a triangle. Not for: distances.
"""

from __future__ import annotations

import numpy as np

from clearance.receipt.proof.motion_data import Shape

SURELY_NONE = 0.25
"""Turns: windings are whole numbers, and rounded by far less."""

BLOCK = 2**18
"""Angles that are worked out together."""


def components(faces: np.ndarray, n_points: int) -> np.ndarray:
    """(m,) a number for each face, the same for those that hang together by points."""
    label = np.arange(n_points)
    while True:
        least = label[faces].min(axis=1)
        lower = label.copy()
        for k in range(faces.shape[1]):
            np.minimum.at(lower, faces[:, k], least)
        lower = lower[lower]
        if np.array_equal(lower, label):
            return label[faces[:, 0]]
        label = lower


def closed_faces(shape: Shape) -> np.ndarray:
    """(k, 3) the triangles of those components that hold something."""
    if shape.faces.shape[1] != 3:
        return np.empty((0, 3), dtype=np.int64)
    faces, n = shape.faces, len(shape.points)
    component = components(faces, n)
    ahead = np.concatenate([faces[:, k] * n + faces[:, (k + 1) % 3] for k in range(3)])
    back = np.concatenate([faces[:, (k + 1) % 3] * n + faces[:, k] for k in range(3)])
    edges, which = np.unique(np.concatenate([ahead, back]), return_inverse=True)
    one_way = np.bincount(which[: len(ahead)], minlength=len(edges))
    balance = one_way - np.bincount(which[len(ahead) :], minlength=len(edges))
    open_ones = np.unique(np.tile(component, 3)[balance[which[: len(ahead)]] != 0])
    return faces[~np.isin(component, open_ones)]


def one_point_each(shape: Shape) -> np.ndarray:
    """(c, 3) [m] a point of each component."""
    first = np.unique(components(shape.faces, len(shape.points)), return_index=True)[1]
    return shape.points[shape.faces[first, 0]]


def winds_about_none(points: np.ndarray, corners: np.ndarray) -> bool:
    """True if closed triangles (m, 3, 3) surely wind about none of some points (c, 3), all in one frame."""
    if not len(corners):
        return True
    turns = np.zeros(len(points))
    size = max(1, BLOCK // len(points))
    for start in range(0, len(corners), size):
        a, b, c = np.moveaxis(corners[None, start : start + size] - points[:, None, None], 2, 0)
        la, lb, lc = (np.sqrt((v * v).sum(axis=2)) for v in (a, b, c))
        volume = (a * np.cross(b, c)).sum(axis=2)
        rest = la * lb * lc + (a * b).sum(axis=2) * lc + (b * c).sum(axis=2) * la
        rest = rest + (c * a).sum(axis=2) * lb
        turns += np.arctan2(volume, rest).sum(axis=1) / (2.0 * np.pi)
    return bool((np.abs(turns) <= SURELY_NONE).all())
