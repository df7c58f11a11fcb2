"""Triangles and segments to pixels, with a buffer of depths. The same input gives the same pixels.

A depth is one over the distance ahead, which is linear on the screen; 0 is infinitely far. Not for: what is drawn
in which colour (`drawing`).
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from clearance.report.still.camera import FIELD_OF_VIEW, Camera
from clearance.report.still.clipping import segments_ahead, segments_within, triangles_ahead

AT_ONCE = 1 << 18
"""Pixels of small triangles that are looked at together: some 50 MB."""

SMALL = 4096
"""Pixels of a triangle's box up to which it is looked at with others."""

NONE = -1


class PixelWindow(NamedTuple):
    """A part of the picture: columns and rows from the first to before the last."""

    left: int
    top: int
    right: int
    bottom: int


class Coverage(NamedTuple):
    """What is nearest in a window: (rows, columns) depth, and which triangle, or `NONE`."""

    window: PixelWindow
    depth: np.ndarray
    owner: np.ndarray


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
        seen = self.camera.seen_from_it(point[None])
        return self.flat(seen)[0] if seen[0, 2] > self.camera.near else None


def covered(screen: Screen, corners: np.ndarray) -> Coverage:
    """What triangles (n, 3, 3) [m] in the world cover."""
    seen = screen.camera.seen_from_it(corners.reshape(-1, 3)).reshape(-1, 3, 3)
    ahead, owners = triangles_ahead(seen, screen.camera.near)
    flat = screen.flat(ahead)
    boxes = _boxes(flat, screen)
    kept = np.flatnonzero((boxes[:, 2] > boxes[:, 0]) & (boxes[:, 3] > boxes[:, 1]))
    flat, owners, boxes = flat[kept], owners[kept], boxes[kept]
    window = _around(boxes)
    shape = (window.bottom - window.top, window.right - window.left)
    found = Coverage(window, np.zeros(shape), np.full(shape, NONE, dtype=np.int64))
    planes = _planes_of(flat)
    n_pixels = (boxes[:, 2] - boxes[:, 0]) * (boxes[:, 3] - boxes[:, 1])
    small = np.flatnonzero(n_pixels <= SMALL)
    ends = np.searchsorted(
        np.cumsum(n_pixels[small]), np.arange(AT_ONCE, n_pixels[small].sum(), AT_ONCE)
    )
    for rows in np.split(small, np.unique(ends)):
        _cover_small(found, planes.of(rows), owners[rows], boxes[rows])
    for i in np.flatnonzero(n_pixels > SMALL):
        _cover_large(found, planes.of(int(i)), int(owners[i]), boxes[i])
    return found


def _boxes(flat: np.ndarray, screen: Screen) -> np.ndarray:
    """(n, 4) int64 the windows of the pixels whose centres a triangle can cover."""
    low = np.ceil(flat[:, :, :2].min(axis=1) - 0.5)
    high = np.floor(flat[:, :, :2].max(axis=1) - 0.5) + 1.0
    most = np.array([screen.width, screen.height], dtype=np.float64)
    return np.hstack([np.clip(low, 0.0, most), np.clip(high, 0.0, most)]).astype(np.int64)


def _around(boxes: np.ndarray) -> PixelWindow:
    if not len(boxes):
        return PixelWindow(0, 0, 0, 0)
    return PixelWindow(*boxes[:, :2].min(axis=0).tolist(), *boxes[:, 2:].max(axis=0).tolist())


class ScreenPlanes(NamedTuple):
    """Of triangles on the screen: what grows evenly over them, from their first corner.

    Attributes:
        corner: (..., 2) [pixels] the first corner.
        slopes: (..., 3, 2) of the second corner's share, the third one's, and the depth, by x and by y.
        depth: (...) at the first corner.
    """

    corner: np.ndarray
    slopes: np.ndarray
    depth: np.ndarray

    def of(self, rows: np.ndarray | int) -> ScreenPlanes:
        """Those of some triangles."""
        return ScreenPlanes(self.corner[rows], self.slopes[rows], self.depth[rows])

    def at(self, x: np.ndarray, y: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Whether points are in the triangles, and the depth there."""
        x, y = x - self.corner[..., 0], y - self.corner[..., 1]
        second, third, depth = (
            self.slopes[..., k, 0] * x + self.slopes[..., k, 1] * y for k in range(3)
        )
        return (second >= 0.0) & (third >= 0.0) & (second + third <= 1.0), self.depth + depth


def _planes_of(flat: np.ndarray) -> ScreenPlanes:
    """The planes of triangles (n, 3, 3); of one without area nothing is inside."""
    a, b, c = flat[:, 0], flat[:, 1] - flat[:, 0], flat[:, 2] - flat[:, 0]
    area = b[:, 0] * c[:, 1] - b[:, 1] * c[:, 0]
    turned = np.stack([c[:, 1], -c[:, 0], -b[:, 1], b[:, 0]], axis=1).reshape(-1, 2, 2)
    with np.errstate(divide="ignore", invalid="ignore"):
        shares = turned / area[:, None, None]
    depth = b[:, 2, None] * shares[:, 0] + c[:, 2, None] * shares[:, 1]
    return ScreenPlanes(a[:, :2], np.concatenate([shares, depth[:, None]], axis=1), a[:, 2])


def _cover_small(
    found: Coverage, planes: ScreenPlanes, owners: np.ndarray, boxes: np.ndarray
) -> None:
    """Takes in triangles, all pixels of their boxes at once."""
    wide, high = boxes[:, 2] - boxes[:, 0], boxes[:, 3] - boxes[:, 1]
    of = np.repeat(np.arange(len(boxes)), wide * high)
    place = np.arange(len(of)) - np.repeat(np.cumsum(wide * high) - wide * high, wide * high)
    x, y = boxes[of, 0] + place % wide[of], boxes[of, 1] + place // wide[of]
    is_in, depth = planes.of(of).at(x + 0.5, y + 0.5)
    of, depth = of[is_in], depth[is_in]
    x, y = x[is_in] - found.window.left, y[is_in] - found.window.top
    before = found.depth[y, x]
    np.maximum.at(found.depth, (y, x), depth)
    wins = (depth == found.depth[y, x]) & (depth > before)
    found.owner[y[wins], x[wins]] = owners[of[wins]]


def _cover_large(found: Coverage, planes: ScreenPlanes, owner: int, box: np.ndarray) -> None:
    """Takes in one triangle."""
    left, top, right, bottom = box.tolist()
    x, y = np.arange(left, right)[None] + 0.5, np.arange(top, bottom)[:, None] + 0.5
    is_in, depth = planes.at(x, y)
    rows = slice(top - found.window.top, bottom - found.window.top)
    columns = slice(left - found.window.left, right - found.window.left)
    wins = is_in & (depth > found.depth[rows, columns])
    found.depth[rows, columns][wins] = depth[wins]
    found.owner[rows, columns][wins] = owner


def drawn_segments(screen: Screen, ends: np.ndarray, depth: np.ndarray, bias: float) -> np.ndarray:
    """(rows, columns) whether a pixel is on one of the segments (n, 2, 3) [m] that nothing hides, two pixels wide.

    Args:
        depth: (rows, columns) of what may hide them. bias: by which share of its distance a segment is taken to
            be nearer.
    """
    drawn = np.zeros(depth.shape, dtype=bool)
    seen = screen.camera.seen_from_it(ends.reshape(-1, 3)).reshape(-1, 2, 3)
    flat = segments_within(
        screen.flat(segments_ahead(seen, screen.camera.near)), screen.width - 1, screen.height - 1
    )
    n = (
        np.ceil(np.abs(flat[:, 1, :2] - flat[:, 0, :2]).max(axis=1, initial=0.0)).astype(np.int64)
        + 1
    )
    of = np.repeat(np.arange(len(flat)), n)
    share = (np.arange(len(of)) - np.repeat(np.cumsum(n) - n, n)) / np.maximum(n[of] - 1, 1)
    points = flat[of, 0] + share[:, None] * (flat[of, 1] - flat[of, 0])
    x, y = points[:, 0].astype(np.int64), points[:, 1].astype(np.int64)
    free = points[:, 2] * (1.0 + bias) >= depth[y, x]
    for right, down in ((0, 0), (1, 0), (0, 1), (1, 1)):
        drawn[
            np.minimum(y[free] + down, screen.height - 1),
            np.minimum(x[free] + right, screen.width - 1),
        ] = True
    return drawn
