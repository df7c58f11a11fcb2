"""A still, drawn by a camera: solid bodies, what is seen through, edges, the line over all. Deterministic.

Every pixel is the mean of 2 × 2. Bodies that are seen through hide nothing; the farthest is drawn first, and of
each its nearest surface. Not for: words on the picture (`picture`).
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence

import numpy as np

from clearance.report.still.camera import Camera
from clearance.report.still.edges import normals, seen_edges
from clearance.report.still.raster import NONE, PixelWindow, Screen, covered, drawn_segments
from clearance.report.still.scene import Still, StillBody, rgb

PAPER, EDGE, GRID, REGION, WAY_OUT = map(rgb, (0xFAFBFC, 0x1C2530, 0xDDE2E6, 0xE01010, 0x4A0008))

FINER = 2
"""Pixels of the drawing to one of the picture, each way."""

LINE_PIXELS, DOT_PIXELS, ARROW_PIXELS = 2.4, 4.0, 78.0
"""Width of the line, radius of its dots, length of the arrow; as on the page."""

SOLID_EDGE, CLEAR_EDGE, REGION_OPACITY = 0.35, 0.28, 0.45

EDGE_BIAS, GRID_BIAS = 2e-3, 0.0
"""By which share of its distance an edge is nearer than the faces that it is of."""

KEY_LIGHT = np.array([0.36, -0.48, 0.8])


def drawn(
    still: Still, camera: Camera, width: int, height: int, edges: Sequence[np.ndarray]
) -> np.ndarray:
    """(height, width, 3) uint8 sRGB.

    Args:
        edges: of each shape, as `edges_of` finds them.
    """
    screen = Screen(camera, FINER * width, FINER * height)
    image = np.empty((screen.height, screen.width, 3), dtype=np.float32)
    image[:] = PAPER
    depth = np.zeros(image.shape[:2])
    solid = [body for body in still.bodies if body.opacity == 1.0]
    clear = [body for body in still.bodies if body.opacity < 1.0]
    _draw_solid(image, depth, screen, still, solid)
    _blend(image, drawn_segments(screen, _grid(still), depth, GRID_BIAS), GRID, 1.0)
    _blend(image, _edges(screen, still, solid, edges, depth), EDGE, SOLID_EDGE)
    for body in _far_first(still, clear, camera):
        _draw_clear(image, depth, screen, still, body)
    _blend(image, _edges(screen, still, clear, edges, depth), EDGE, CLEAR_EDGE)
    _draw_overlap(image, screen, still)
    _draw_line(image, screen, still)
    return _mean(image)


def edges_of(still: Still) -> list[np.ndarray]:
    """Of each shape (k, 2) vertices at the ends of the edges that are drawn."""
    return [seen_edges(*shape) for shape in still.shapes]


def _mean(image: np.ndarray) -> np.ndarray:
    height, width = image.shape[0] // FINER, image.shape[1] // FINER
    mean = image.reshape(height, FINER, width, FINER, 3).mean(axis=(1, 3))
    return np.floor(mean * 255.0 + 0.5).astype(np.uint8)


def _placed(still: Still, body: StillBody) -> np.ndarray:
    """(n, 3, 3) [m] a body's triangles in the world."""
    vertices, triangles = still.shapes[body.i_shape]
    return (vertices.astype(np.float64) @ body.pose[:3, :3].T + body.pose[:3, 3])[triangles]


def _shaded(corners: np.ndarray, colour: np.ndarray, eye: np.ndarray) -> np.ndarray:
    """(n, 3) the colour of each triangle, lit on the side that is seen."""
    turned = normals(corners)
    ahead = eye - corners.mean(axis=1)
    ahead /= np.linalg.norm(ahead, axis=1, keepdims=True)
    facing = (turned * ahead).sum(axis=1)
    key = np.maximum((turned @ KEY_LIGHT) * np.sign(facing), 0.0)
    return colour * np.minimum(0.6 + 0.34 * key + 0.2 * np.abs(facing), 1.15)[:, None]


def _draw_solid(
    image: np.ndarray, depth: np.ndarray, screen: Screen, still: Still, bodies: Sequence[StillBody]
) -> None:
    if not bodies:
        return
    corners = [_placed(still, body) for body in bodies]
    found = covered(screen, np.concatenate(corners))
    colours = np.concatenate(
        [
            _shaded(of, body.colour, screen.camera.eye)
            for of, body in zip(corners, bodies, strict=True)
        ]
    )
    seen = found.owner != NONE
    _in(image, found.window)[seen] = np.minimum(colours[found.owner[seen]], 1.0)
    _in(depth, found.window)[:] = found.depth


def _draw_clear(
    image: np.ndarray, depth: np.ndarray, screen: Screen, still: Still, body: StillBody
) -> None:
    corners = _placed(still, body)
    found = covered(screen, corners)
    seen = (found.owner != NONE) & (found.depth > _in(depth, found.window))
    colours = np.minimum(_shaded(corners, body.colour, screen.camera.eye), 1.0)
    place = _in(image, found.window)
    place[seen] += body.opacity * (colours[found.owner[seen]] - place[seen])


def _in(whole: np.ndarray, window: PixelWindow) -> np.ndarray:
    return whole[window.top : window.bottom, window.left : window.right]


def _far_first(still: Still, bodies: Sequence[StillBody], camera: Camera) -> list[StillBody]:
    def distance(body: StillBody) -> float:
        vertices = still.shapes[body.i_shape][0]
        middle = 0.5 * (vertices.min(axis=0) + vertices.max(axis=0)).astype(np.float64)
        return float(np.linalg.norm(body.pose[:3, :3] @ middle + body.pose[:3, 3] - camera.eye))

    return sorted(bodies, key=distance, reverse=True)


def _edges(
    screen: Screen,
    still: Still,
    bodies: Sequence[StillBody],
    edges: Sequence[np.ndarray],
    depth: np.ndarray,
) -> np.ndarray:
    """(rows, columns) where edges of bodies are seen."""
    ends = [np.empty((0, 2, 3))]
    for body in bodies:
        placed = (
            still.shapes[body.i_shape][0].astype(np.float64) @ body.pose[:3, :3].T
            + body.pose[:3, 3]
        )
        ends.append(placed[edges[body.i_shape]])
    return drawn_segments(screen, np.concatenate(ends), depth, EDGE_BIAS)


def _blend(image: np.ndarray, where: np.ndarray, colour: np.ndarray, opacity: float) -> None:
    image[where] += opacity * (colour - image[where])


def _grid(still: Still) -> np.ndarray:
    """(n, 2, 3) [m] lines a round length apart, under the room, on z = 0 or below what is lower."""
    spacing = 10.0 ** round(math.log10(still.size / 12.0))
    n = math.ceil(0.9 * still.size / spacing)
    centre = np.round(still.room.mean(axis=0) / spacing) * spacing
    at = np.arange(-n, n + 1) * spacing
    height = min(0.0, float(still.room[0, 2]))
    ends = np.empty((2, len(at), 2, 3))
    ends[..., 2] = height
    for along in (0, 1):
        ends[along, :, 0, along], ends[along, :, 1, along] = (
            centre[along] + at[0],
            centre[along] + at[-1],
        )
        ends[along, :, :, 1 - along] = (centre[1 - along] + at)[:, None]
    return ends.reshape(-1, 2, 3)


def _draw_overlap(image: np.ndarray, screen: Screen, still: Still) -> None:
    """The region that two bodies share, through all that is before it, and the way out of it."""
    if still.region is None or still.way_out is None:
        return
    vertices, triangles = still.region
    if len(triangles):
        found = covered(screen, vertices.astype(np.float64)[triangles])
        _blend(_in(image, found.window), found.owner != NONE, REGION, REGION_OPACITY)
    foot, direction = still.way_out
    ends = [screen.point(foot), screen.point(foot + direction * 0.01 * still.size)]
    if ends[0] is None or ends[1] is None:
        return
    start, way = ends[0][:2], ends[1][:2] - ends[0][:2]
    tip = start + way / max(float(np.linalg.norm(way)), 1e-9) * ARROW_PIXELS * FINER
    for part in _arrow(start, tip):
        _stroke(image, *part, FINER * LINE_PIXELS / 2, WAY_OUT)


def _arrow(start: np.ndarray, tip: np.ndarray) -> Iterator[tuple[np.ndarray, np.ndarray]]:
    """The segments of an arrow, from end to end [pixels]."""
    yield start, tip
    back = 0.2 * (start - tip)
    for turn in (0.45, -0.45):
        turned = np.array([[math.cos(turn), -math.sin(turn)], [math.sin(turn), math.cos(turn)]])
        yield tip, tip + turned @ back


def _draw_line(image: np.ndarray, screen: Screen, still: Still) -> None:
    """The line between the witness points and its dots, over everything."""
    ends = [screen.point(end) for end in still.line]
    for one in ends:
        if one is not None:
            _stroke(image, one[:2], one[:2], FINER * DOT_PIXELS, still.colour)
    if ends[0] is not None and ends[1] is not None:
        _stroke(image, ends[0][:2], ends[1][:2], FINER * LINE_PIXELS / 2, still.colour)


def _stroke(
    image: np.ndarray, start: np.ndarray, end: np.ndarray, radius: float, colour: np.ndarray
) -> None:
    """Draws the pixels whose centres are within a radius of a segment, all in pixels."""
    most = np.array(image.shape[1::-1], dtype=np.float64)
    low = np.clip(np.minimum(start, end) - radius, 0.0, most).astype(np.int64)
    high = np.clip(np.maximum(start, end) + radius + 1.0, 0.0, most).astype(np.int64)
    x = np.arange(low[0], high[0])[None] + 0.5 - start[0]
    y = np.arange(low[1], high[1])[:, None] + 0.5 - start[1]
    way = end - start
    length_sq = float(way @ way)
    share = np.clip((x * way[0] + y * way[1]) / length_sq, 0.0, 1.0) if length_sq > 0.0 else 0.0
    near = (x - share * way[0]) ** 2 + (y - share * way[1]) ** 2 <= radius**2
    _blend(image[low[1] : high[1], low[0] : high[0]], near, colour, 1.0)
