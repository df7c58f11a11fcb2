"""The sweep of a body's cut with a plane: its covered pixels, and the polygons that matter beyond them.

A closed part cuts a filled region, an open surface only its own line. A point of the profile may be where the
body never quite is: the bound holds in space. Not for: silhouettes.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from clearance.geometry.polyhedron import Polyhedron
from clearance.kernels.profile.swept_cover import Raster
from clearance.kernels.profile.swept_cut import add_cut_cover, cut_hulls, cut_segments
from clearance.profiles.chords import BodyKnots
from clearance.profiles.plane import Plane
from clearance.profiles.profile import NOT_CLOSED
from clearance.profiles.silhouette import CHUNK, Hulls, PlaneView


class CrossSection(PlaneView):
    """The cross-section of one body, at its knots."""

    def __init__(self, label: str, shape: Polyhedron, knots: BodyKnots, plane: Plane) -> None:
        axes = np.vstack([plane.axes, np.cross(*plane.axes)])
        super().__init__(shape.outward(), knots, plane.origin, axes)
        self._closed = self.shape.component_closed[self.shape.face_component]
        self._label = label

    @property
    def excess(self) -> float:
        """[m] how far any point of them may be from a swept point in space: off the plane, and off a chord."""
        return 2.0 * self.short

    def cover(self, raster: Raster) -> None:
        """Marks the pixels that are filled at any knot."""
        shape = self.shape
        for start in range(0, len(self.knots.instant), CHUNK):
            points = self.placed(self.knots.poses[start : start + CHUNK], shape.vertices)
            add_cut_cover(raster, points, shape.face_starts, shape.face_vertices, self._closed)

    def hulls(
        self, raster: Raster, sums: np.ndarray, width: float, slack: float
    ) -> Iterator[Hulls]:
        """The polygons that are not covered, a few instants at a time."""
        knots, vertices = self.knots, self.shape.vertices
        yield self._filled()
        triangles = self.shape.triangles()
        moving = np.flatnonzero(knots.moves).tolist()
        runs = [(0, 0, 0.0)] + [(i, i + 1, float(knots.chord[i])) for i in moving]
        for i, j, reach in runs:
            start, end = self.placed(knots.poses[[i, j]], vertices)
            rows = cut_hulls(raster, sums, start, end, triangles, reach, width, slack)
            if len(rows) and not self._closed.all():
                self.notes = (f"{self._label} {NOT_CLOSED}",)
            yield Hulls.of(rows, knots.instant[i:])

    def _filled(self) -> Hulls:
        """The sections of closed parts at the first knot, part by part, as convex polygons."""
        from clearance.profiles.region import convex_parts, union

        shape, points = self.shape, self.placed(self.knots.poses[:1], self.shape.vertices)[0]
        cuts = np.empty((shape.n_faces, 4))
        filled = []
        for component in np.flatnonzero(shape.component_closed):
            chosen = shape.face_component == component
            n = cut_segments(points, shape.face_starts, shape.face_vertices, chosen, cuts)
            filled.append(region_of_cuts(cuts[:n]))
        corners, count = convex_parts(union(filled))
        return Hulls(corners, count, np.zeros(len(count)))


def region_of_cuts(cuts: np.ndarray):
    """The region that directed segments (n, 4) enclose that meet end to end to the last bit."""
    from clearance.profiles.region import region_of

    following: dict[tuple[float, float], list[tuple[float, float]]] = {}
    for row in cuts.tolist():
        following.setdefault((row[0], row[1]), []).append((row[2], row[3]))
    rings = []
    while following:
        first, ring = next(iter(following)), []
        at = first
        while at in following:
            ring.append(at)
            ends = following[at]
            after = ends.pop()
            if not ends:
                del following[at]
            at = after
        if len(ring) >= 3:
            rings.append(np.array(ring))
    return region_of(rings)
