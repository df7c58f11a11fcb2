"""A PNG of the worst moment: what the page shows first, the gap from near in a corner, and what it is in words.

Drawn with a buffer of depths (`raster`), since build servers have neither display nor GPU; matplotlib sets the
words. Every pixel is the mean of 2 × 2. Bodies that are seen through hide nothing; the farthest is drawn first, of
each its nearest surface. The same record gives the same bytes. Not for: what is seen from where (`still`).
"""

from __future__ import annotations

import io
import math
import warnings
from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from clearance.extras import importing
from clearance.findings.limit_lines import moment_line
from clearance.findings.verdict import Verdict
from clearance.record.record import Record
from clearance.record.replay import Replay
from clearance.record.wording import limits_text, of_rule
from clearance.report.raster import Screen, Surface, drawn_segments, surface
from clearance.report.still import (
    COLOURS,
    Camera,
    Still,
    StillBody,
    at_gap,
    overview,
    rgb,
    still_of,
)

if TYPE_CHECKING:
    from matplotlib.figure import Figure

WIDTH, HEIGHT = 1280, 800
"""[pixels]"""

INSET_WIDTH, INSET_HEIGHT, MARGIN = 400, 250, 20
"""[pixels] of the gap from near."""

FINER = 2
"""Pixels of the drawing to one of the picture, each way."""

PAPER, EDGE, GRID, REGION, WAY_OUT = map(rgb, (0xFAFBFC, 0x1C2530, 0xDDE2E6, 0xE01010, 0x4A0008))
SOLID_EDGE, CLEAR_EDGE, REGION_OPACITY = 0.35, 0.28, 0.45

LINE_PIXELS, DOT_PIXELS, ARROW_PIXELS = 2.4, 4.0, 78.0
"""Width of the line, radius of its dots, length of the arrow; as on the page."""

EDGE_BIAS = 2e-3
"""[-] By which share of its distance an edge is nearer than the faces that it is of."""

CREASE = math.radians(25.0)
"""By how much two faces are turned against one another at the least where their edge is seen."""

KEY_LIGHT = np.array([0.36, -0.48, 0.8])

_INK, _FAINT, _SUSPECT = "#17202b", "#5d6975", "#6b2fa0"
_DOTS_PER_INCH, _LETTERS_OF_SIZE_1 = 100, 1500

MOST_NOTES = 8
"""Lines below the limits in a picture."""


def png_of(record: Record, replay: Replay, verdict: Verdict) -> bytes:
    """The picture.

    Raises:
        Unavailable: matplotlib is not installed.
    """
    with importing("report", "a picture"):
        from matplotlib.backends.backend_agg import FigureCanvasAgg
        from matplotlib.figure import Figure
    figure = Figure((WIDTH / _DOTS_PER_INCH, HEIGHT / _DOTS_PER_INCH), _DOTS_PER_INCH)
    canvas = FigureCanvasAgg(figure)
    figure.figimage(_with_inset(still_of(replay)), origin="upper")
    _write_words(figure, record, verdict)
    file = io.BytesIO()
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # a letter that the font has not is a box
        canvas.print_png(file, metadata={"Software": None})
    return file.getvalue()


def _with_inset(still: Still) -> np.ndarray:
    """(HEIGHT, WIDTH, 3) uint8 the moment, and the gap from near in a frame in the lower left corner."""
    image = drawn(still, overview(still), WIDTH, HEIGHT)
    bottom = HEIGHT - MARGIN
    framed = image[bottom - INSET_HEIGHT - 2 : bottom, MARGIN : MARGIN + INSET_WIDTH + 2]
    framed[:] = (118, 130, 143)
    framed[1:-1, 1:-1] = drawn(still, at_gap(still), INSET_WIDTH, INSET_HEIGHT)
    return image


def _notes(verdict: Verdict) -> list[str]:
    """What bears on the verdict beside the clearance, what fails it first, and how many more lines there are."""
    found = [
        *(f"suspect {one.kind}: {one.line}" for one in verdict.suspects),
        *verdict.beside,
        *verdict.unproven_motion,
        *verdict.waiver_faults,
        *filter(None, (verdict.unproven, verdict.at_level)),
        *(f"waived: {text}" for text in verdict.waived),
        *verdict.with_tolerances,
        *([f"nearest of all {verdict.nearest}"] if verdict.nearest else []),
        *(f"warning: {text}" for text in verdict.warnings),
    ]
    if len(found) <= MOST_NOTES:
        return found
    more = len(found) - MOST_NOTES + 1
    return [*found[: MOST_NOTES - 1], f"and {more} more, in the report"]


def _write_words(figure: Figure, record: Record, verdict: Verdict) -> None:
    """The verdict, the moment, the limits that judge it, what was not checked, and notes, one below the other."""
    hue, judge = COLOURS.get(verdict.shade), verdict.worst.rule
    colour, limits = _SUSPECT if hue is None else f"#{hue:06x}", record.rule(judge).limits
    below = ", ".join([limits_text(limits.fail, limits.warn) + of_rule(judge), *verdict.scope])
    lines = (
        (f"{verdict.headline(str.upper)}   {record.case.name}", 15, colour, "bold"),
        (moment_line(record, verdict.worst), 12, _INK, "normal"),
        (below, 10, _FAINT, "normal"),
        *((text, 10, _FAINT, "normal") for text in _notes(verdict)),
    )
    top = MARGIN
    box = {"facecolor": "#fafbfc", "alpha": 0.8, "edgecolor": "none", "pad": 2}
    for text, size, ink, weight in lines:
        most = _LETTERS_OF_SIZE_1 // size
        shown = text if len(text) <= most else f"{text[: most - 1]}…"
        figure.text(
            MARGIN / WIDTH, 1.0 - top / HEIGHT, shown, va="top", parse_math=False, fontsize=size,
            color=ink, weight=weight, family="DejaVu Sans", bbox=box,
        )  # fmt: skip
        top += round(size * _DOTS_PER_INCH / 72 * 1.5)
    above = (MARGIN + INSET_HEIGHT + 8) / HEIGHT
    figure.text(
        MARGIN / WIDTH, above, "the gap from near", va="bottom", fontsize=9, color=_FAINT, family="DejaVu Sans"
    )  # fmt: skip


def normals(corners: np.ndarray) -> np.ndarray:
    """(n, 3) of triangles (n, 3, 3), of length 1; 0 for those without area."""
    found = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    lengths = np.linalg.norm(found, axis=1, keepdims=True)
    return np.divide(found, lengths, out=np.zeros_like(found), where=lengths > 0.0)


def seen_edges(vertices: np.ndarray, triangles: np.ndarray) -> np.ndarray:
    """(k, 2) vertices at the ends of edges that two triangles with an angle share, or that not exactly two share.

    Vertices at the same place are one.
    """
    if not len(triangles):
        return np.empty((0, 2), dtype=np.int64)
    _, firsts, names = np.unique(vertices, axis=0, return_index=True, return_inverse=True)
    turned = normals(vertices.astype(np.float64)[triangles])
    corners = firsts[names.reshape(-1)[triangles]]
    pairs = np.sort(corners[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2), axis=1)
    order = np.lexsort((pairs[:, 1], pairs[:, 0]))
    pairs, faces = pairs[order], np.repeat(np.arange(len(triangles)), 3)[order]
    starts = np.flatnonzero(np.append(True, (pairs[1:] != pairs[:-1]).any(axis=1)))
    counts = np.diff(np.append(starts, len(pairs)))
    others = np.minimum(starts + 1, len(pairs) - 1)
    cosines = (turned[faces[starts]] * turned[faces[others]]).sum(axis=1)
    is_seen = (counts != 2) | (cosines < math.cos(CREASE))
    return pairs[starts[is_seen & (pairs[starts, 0] != pairs[starts, 1])]]


def drawn(still: Still, camera: Camera, width: int, height: int) -> np.ndarray:
    """(height, width, 3) uint8 sRGB."""
    screen = Screen(camera, FINER * width, FINER * height)
    image = np.empty((screen.height, screen.width, 3), dtype=np.float32)
    image[:] = PAPER
    depth = np.zeros(image.shape[:2])
    solid = [body for body in still.bodies if body.opacity == 1.0]
    clear = [body for body in still.bodies if body.opacity < 1.0]
    if solid:
        found = _paint(image, screen, still, solid, depth)
        depth.reshape(-1)[found.pixels] = found.depth
    _blend(image, drawn_segments(screen, _grid(still), depth, 0.0), GRID, 1.0)
    _blend(image, _edges(screen, still, solid, depth), EDGE, SOLID_EDGE)
    for body in sorted(clear, key=lambda body: _distance(still, body, camera), reverse=True):
        _paint(image, screen, still, [body], depth)
    _blend(image, _edges(screen, still, clear, depth), EDGE, CLEAR_EDGE)
    _draw_overlap(image, screen, still)
    _draw_line(image, screen, still)
    mean = image.reshape(height, FINER, width, FINER, 3).mean(axis=(1, 3))
    return np.floor(mean * 255.0 + 0.5).astype(np.uint8)


def _paint(
    image: np.ndarray, screen: Screen, still: Still, bodies: Sequence[StillBody], depth: np.ndarray
) -> Surface:
    """Puts bodies of one opacity into the picture, before what is at the depths; what they show of themselves."""
    corners = [still.placed(body)[still.shapes[body.i_shape][1]] for body in bodies]
    eye = screen.camera.eye
    colours = np.concatenate(
        [_shaded(of, body.colour, eye) for of, body in zip(corners, bodies, strict=True)]
    )
    found = surface(screen, np.concatenate(corners))
    seen = found.depth > depth.reshape(-1)[found.pixels]
    _mix(image, found.pixels[seen], colours[found.owner[seen]], bodies[0].opacity)
    return found


def _shaded(corners: np.ndarray, colour: np.ndarray, eye: np.ndarray) -> np.ndarray:
    """(n, 3) the colour of each triangle, lit on the side that is seen."""
    turned = normals(corners)
    ahead = eye - corners.mean(axis=1)
    ahead /= np.linalg.norm(ahead, axis=1, keepdims=True)
    facing = (turned * ahead).sum(axis=1)
    key = np.maximum((turned @ KEY_LIGHT) * np.sign(facing), 0.0)
    light = np.minimum(0.6 + 0.34 * key + 0.2 * np.abs(facing), 1.15)
    return np.minimum(colour * light[:, None], 1.0)


def _mix(image: np.ndarray, pixels: np.ndarray, colour: np.ndarray, opacity: float) -> None:
    flat = image.reshape(-1, 3)
    flat[pixels] += opacity * (colour - flat[pixels])


def _blend(image: np.ndarray, where: np.ndarray, colour: np.ndarray, opacity: float) -> None:
    image[where] += opacity * (colour - image[where])


def _distance(still: Still, body: StillBody, camera: Camera) -> float:
    """[m] From the camera to the middle of a body's own box."""
    vertices = still.shapes[body.i_shape][0]
    middle = 0.5 * (vertices.min(axis=0) + vertices.max(axis=0)).astype(np.float64)
    return float(np.linalg.norm(body.pose[:3, :3] @ middle + body.pose[:3, 3] - camera.eye))


def _edges(
    screen: Screen, still: Still, bodies: Sequence[StillBody], depth: np.ndarray
) -> np.ndarray:
    """(rows, columns) where edges of bodies are seen."""
    ends = [still.placed(body)[seen_edges(*still.shapes[body.i_shape])] for body in bodies]
    return drawn_segments(screen, np.concatenate([np.empty((0, 2, 3)), *ends]), depth, EDGE_BIAS)


def _grid(still: Still) -> np.ndarray:
    """(n, 2, 3) [m] lines a round length apart, under the room, on z = 0 or below what is lower."""
    spacing = 10.0 ** round(math.log10(still.size / 12.0))
    n = math.ceil(0.9 * still.size / spacing)
    centre = np.round(still.view_box.mean(axis=0) / spacing) * spacing
    at = np.arange(-n, n + 1) * spacing
    ends = np.empty((2, len(at), 2, 3))
    ends[..., 2] = min(0.0, float(still.view_box[0, 2]))
    for along in (0, 1):
        ends[along, :, :, along] = centre[along] + at[[0, -1]]
        ends[along, :, :, 1 - along] = (centre[1 - along] + at)[:, None]
    return ends.reshape(-1, 2, 3)


def _draw_overlap(image: np.ndarray, screen: Screen, still: Still) -> None:
    """The region that two bodies share, through all that is before it, and the separation vector as an arrow."""
    if still.region is None or still.separation is None:
        return
    vertices, triangles = still.region
    if len(triangles):
        found = surface(screen, vertices.astype(np.float64)[triangles])
        _mix(image, found.pixels, REGION, REGION_OPACITY)
    foot, direction = still.separation
    start, end = screen.point(foot), screen.point(foot + direction * 0.01 * still.size)
    if start is None or end is None:
        return
    way = (end - start)[:2] / max(float(np.linalg.norm((end - start)[:2])), 1e-9)
    tip = start[:2] + way * ARROW_PIXELS * FINER
    for turn in (0.0, 0.45, -0.45):
        turned = np.array([[math.cos(turn), -math.sin(turn)], [math.sin(turn), math.cos(turn)]])
        back = (start[:2] - tip) * (0.2 if turn else 1.0)
        _stroke(image, tip, tip + turned @ back, FINER * LINE_PIXELS / 2, WAY_OUT)


def _draw_line(image: np.ndarray, screen: Screen, still: Still) -> None:
    """The line between the witness points and its dots, over everything."""
    ends = [end[:2] for end in map(screen.point, still.line) if end is not None]
    for end in ends:
        _stroke(image, end, end, FINER * DOT_PIXELS, still.colour)
    if len(ends) == 2:
        _stroke(image, ends[0], ends[1], FINER * LINE_PIXELS / 2, still.colour)


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
