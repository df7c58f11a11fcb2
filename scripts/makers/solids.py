"""Closed triangle meshes from profiles: extruded plates, turned parts, and the STL files they go into.

All coordinates lie on a grid of 2^-16 m (15 µm). Single-precision STL holds such numbers exactly, so that
flat faces stay exactly flat and the files are the same bytes on every machine. Each solid is one closed
surface without self-intersection. Not for: obstacles that a case file can describe itself (box, pipe, …).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from scripts.makers.polygon import Loop, triangulate

GRID = 2.0**-16
"""[m] The step that every coordinate is a whole multiple of."""


@dataclass(frozen=True, eq=False)
class Solid:
    """A closed surface: vertices (n, 3) [m] and triangles (m, 3), counter-clockwise from outside."""

    vertices: np.ndarray
    triangles: np.ndarray

    def mirrored_y(self) -> Solid:
        """The mirror image in the plane y = 0."""
        return Solid(self.vertices * np.array([1.0, -1.0, 1.0]), self.triangles[:, ::-1])


def on_grid(values: np.ndarray | Sequence) -> np.ndarray:
    """The values moved to the nearest grid points."""
    return np.round(np.asarray(values, dtype=np.float64) / GRID) * GRID


def arc(centre: tuple[float, float], radius: float, degrees: tuple[float, float], n: int) -> Loop:
    """n points on an arc, both ends included, from the first angle to the second."""
    angles = np.radians(np.linspace(*degrees, n))
    return [(centre[0] + radius * np.cos(a), centre[1] + radius * np.sin(a)) for a in angles]


def circle(centre: tuple[float, float], radius: float, n: int) -> Loop:
    """The corners of a regular n-gon, counter-clockwise."""
    return arc(centre, radius, (0.0, 360.0 * (n - 1) / n), n)


def extruded(
    outline: Loop, low: float, high: float, axis: str = "z", holes: Sequence[Loop] = ()
) -> Solid:
    """A plate: a profile, counter-clockwise, with counter-clockwise holes, between two heights on `axis`.

    The profile lies in (x, y) for z, in (x, z) for y, in (y, z) for x [m].
    """
    loops = [on_grid(outline), *(on_grid(hole)[::-1] for hole in holes)]
    flat = np.concatenate(loops)
    cap = triangulate(loops)
    n = len(flat)
    bottom, top = on_grid(low), on_grid(high)
    vertices = np.vstack([np.column_stack([flat, np.full(n, z)]) for z in (bottom, top)])
    walls, start = [], 0
    for loop in loops:
        here = start + np.arange(len(loop))
        there = start + (np.arange(len(loop)) + 1) % len(loop)
        walls += [
            np.column_stack([here, there, there + n]),
            np.column_stack([here, there + n, here + n]),
        ]
        start += len(loop)
    return _along(axis, vertices, np.vstack([cap[:, ::-1], cap + n, *walls]))


def turned(
    profile: Sequence[tuple[float, float]],
    axis: str = "z",
    centre: tuple[float, float, float] = (0.0, 0.0, 0.0),
    n: int = 32,
) -> Solid:
    """A turned part: (radius, height) pairs [m] from the low end to the high end, closed by flat ends."""
    rings = _rings(profile, n)
    sides = [_band(i * n, (i + 1) * n, n) for i in range(len(profile) - 1)]
    fan = np.column_stack([np.zeros(n - 2, dtype=int), np.arange(1, n - 1), np.arange(2, n)])
    triangles = np.vstack([fan[:, ::-1], *sides, fan + (len(profile) - 1) * n])
    return _along(axis, rings, triangles, centre)


def ring(
    profile: Sequence[tuple[float, float]],
    axis: str = "z",
    centre: tuple[float, float, float] = (0.0, 0.0, 0.0),
    n: int = 32,
) -> Solid:
    """A turned part with a hole: a closed (radius, height) profile, counter-clockwise, radii above 0."""
    rings = _rings(profile, n)
    k = len(profile)
    bands = [_band(i * n, (i + 1) % k * n, n) for i in range(k)]
    return _along(axis, rings, np.vstack(bands), centre)


def box(low: Sequence[float], high: Sequence[float]) -> Solid:
    """A block between two corners [m]."""
    (x0, y0, z0), (x1, y1, z1) = low, high
    return extruded([(x0, y0), (x1, y0), (x1, y1), (x0, y1)], z0, z1)


def write_stl(path: Path, solid: Solid) -> None:
    """Writes a binary STL; the same solid gives the same bytes."""
    corners = solid.vertices[solid.triangles]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    rows = np.zeros(
        len(corners), dtype=[("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("pad", "<u2")]
    )
    rows["normal"] = np.round(normals, 6) + 0.0
    rows["corners"] = corners + 0.0
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_bytes(b"\0" * 80 + np.uint32(len(rows)).tobytes() + rows.tobytes())


def _rings(profile: Sequence[tuple[float, float]], n: int) -> np.ndarray:
    turn = 2.0 * np.pi * np.arange(n) / n
    circle_points = np.column_stack([np.cos(turn), np.sin(turn)])
    rings = [np.column_stack([r * circle_points, np.full(n, h)]) for r, h in profile]
    return on_grid(np.vstack(rings))


def _band(low: int, high: int, n: int) -> np.ndarray:
    """Triangles between two rings that start at vertices `low` and `high`."""
    here, there = np.arange(n), (np.arange(n) + 1) % n
    return np.vstack(
        [
            np.column_stack([low + here, low + there, high + there]),
            np.column_stack([low + here, high + there, high + here]),
        ]
    )


def _along(
    axis: str,
    vertices: np.ndarray,
    triangles: np.ndarray,
    centre: tuple[float, float, float] = (0.0, 0.0, 0.0),
) -> Solid:
    """The part made along z, laid along another axis; (x, z, y) is a mirror image, so faces turn round."""
    columns = {"x": [2, 0, 1], "y": [0, 2, 1], "z": [0, 1, 2]}[axis]
    faces = triangles[:, ::-1] if axis == "y" else triangles
    return Solid(vertices[:, columns] + on_grid(centre), np.ascontiguousarray(faces))
