"""The profile that a motion sweeps: instants, covered pixels, polygons, their union, and the outline around it.

The continuous motion is meant, joints moving linearly between steps, or on cubics where the trajectory has
velocities. Not for: measuring clearances.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from clearance.errors import BadDimension, BadInput, NothingToMeasure
from clearance.kernels.profile.swept_cover import Raster, row_sums
from clearance.profiles.contour import Contour
from clearance.profiles.outline import outline_of
from clearance.profiles.plane import Plane
from clearance.profiles.profile import Origin, Profile
from clearance.profiles.region import (
    Region,
    covered_region,
    nearest_parts,
    polygons,
    touching,
    union,
    widened,
)
from clearance.profiles.silhouette import Hulls, Silhouette
from clearance.profiles.swept_bodies import (
    RecordHolder,
    SweptBody,
    TimedCase,
    notes_on_sweep,
    over_time,
    swept_bodies,
)
from clearance.progress import Progress
from clearance.world.body import require_no_shortfall
from clearance.world.case import Case

if TYPE_CHECKING:
    from clearance.profiles.cross_section import CrossSection
    from clearance.record.record import Record

TOLERANCE = 5e-4
"""[m] How far a swept profile may exceed what is swept, by default."""

PIXELS = 1000
"""Pixels along the longer side of the page; any number gives the same region (measured: least time)."""

WIDTH = 1e-7
"""[m] What polygons without area are widened by to either side; part of the bound."""

SHARE = 0.22
"""Of the tolerance: how far points may leave their chords. It counts twice; the rest is for the arcs."""

MOST_POLYGONS = 20_000
"""Polygons that are collected before those inside the outline so far are dropped."""

TWIST = 0.08
"""Of the tolerance: how far hulls of turning edges may exceed their sweep."""

OFF_SHARE = 0.05
"""How far what is swept in corner zones may be exceeded."""

CUT_SHARE = 0.15
"""The same for sections, where it counts three times."""


def swept_profile(
    run: Case | TimedCase | Record | RecordHolder,
    plane: str = "xy",
    *,
    links: Sequence[str] | None = None,
    obstacles: Sequence[str] = (),
    section: float | None = None,
    tolerance: float = TOLERANCE,
    per_link: bool = False,
    progress: Progress | None = None,
) -> Profile:
    """The outline in a plane of everything that the robots' links sweep, with its holes.

    An obstacle is swept by the link that carries it while it does, or that it is mounted on.

    Args:
        run: a `Run` or `Record` (its motions), or a `Case` (the trajectories themselves).
        plane: xy, xz, yz, or a point and a normal as six numbers; the projection is along the normal.
        links: names or patterns, `robot/link` where there are several robots; None for all.
        obstacles: names or patterns of obstacles to be drawn as well, wherever they are during the run, e.g.
            with no links a wall and its openings.
        section: [m] cut at this height along the plane's normal instead of projecting.
        tolerance: [m] how far the profile may exceed what is swept.
        per_link: also each body's own profile, in `parts`.
        progress: called with links done and all links.

    Exactness: contains what the faceted links sweep, joints moving linearly between steps or on their cubics, and
        obstacles straight and about one axis, and all that links may sweep in corner zones of programs; no point
        is farther than `Profile.bound` <= `tolerance` from a swept point. Holes narrower than that may be filled.
    Raises:
        BadInput: not a plane; a section of a program with corner zones. BadDimension: not a tolerance.
        UnknownLink, UnknownObstacle.
        NothingToMeasure: the plane cuts nothing.
    """
    if not 1e-6 <= tolerance < math.inf:
        raise BadDimension(
            f"{tolerance:g} m", where="tolerance", valid="at least 1e-6 m (0.001 mm)"
        )
    seen_on, moved = Plane.of(plane, section), over_time(run)
    name, bodies = moved.case.name, swept_bodies(moved, links, obstacles)
    if not bodies:
        raise NothingToMeasure("no link and no obstacle is asked for", where="links")
    parts = {}
    if per_link:
        for label in _labels(bodies):
            own = [one for one in bodies if one.label == label]
            parts[label] = _swept(name, own, seen_on, section, tolerance, None, None)
    found = _swept(name, bodies, seen_on, section, tolerance, progress, parts)
    return replace(found, notes=(*found.notes, *notes_on_sweep(moved, bodies)))


def _labels(bodies: Sequence[SweptBody]) -> tuple[str, ...]:
    return tuple(dict.fromkeys(one.label for one in bodies))


def _swept(
    name: str,
    bodies: Sequence[SweptBody],
    plane: Plane,
    section: float | None,
    tolerance: float,
    progress: Progress | None,
    parts: dict[str, Profile] | None,
) -> Profile:
    require_no_shortfall([one.body for one in bodies], "a profile")
    off = max(one.off for one in bodies)
    if off > 0.0 and section is not None:
        fault = (
            f"links may be {off * 1e3:.3g} mm off in corner zones, which a section does not count"
        )
        raise BadInput(fault, where="section", valid="the projection, or a program without zones")
    views = _views(bodies, plane, section, tolerance)
    raster = _page(views)
    for view in views:
        view.cover(raster)
    collected = PolygonCollection(covered_region(raster))
    # what is off reaches beyond pixels that cover it where it is not
    rasters = {is_off: _without(raster) if is_off else raster for is_off in (off > 0.0, False)}
    sums = {is_off: row_sums(one.covered) for is_off, one in rasters.items()}
    labels = _labels(bodies)
    for i, (view, one) in enumerate(zip(views, bodies, strict=True)):
        is_off = one.off > 0.0
        for hulls in view.hulls(rasters[is_off], sums[is_off], WIDTH, TWIST * tolerance):
            collected.add(hulls, labels.index(one.label), one.off, OFF_SHARE * tolerance)
        if progress:
            progress(i + 1, len(views))
    region = collected.region()
    if region.is_empty:
        raise NothingToMeasure(
            f"the plane {plane.name} at {section} m cuts no link at any step",
            where="section",
            valid="a height that a link passes",
        )
    short = max(float(view.short) for view in views) + 2.0 * WIDTH
    excess = max(float(view.excess) for view in views) + 2.0 * WIDTH + TWIST * tolerance
    excess += OFF_SHARE * tolerance if off > 0.0 else 0.0
    outline = outline_of(region, short, tolerance - excess)
    return Profile(
        contours=outline.contours,
        name=name,
        plane=plane.name,
        plane_origin=plane.origin,
        plane_axes=plane.axes,
        section=section,
        tolerance=tolerance,
        bound=outline.outer + excess,
        facets=max(one.body.shape.excess for one in bodies),
        n_steps=_last_step(bodies) + 1,
        origin=collected.origin(outline.contours, labels),
        parts=parts or {},
        notes=(*_notes(off), *dict.fromkeys(note for view in views for note in view.notes)),
    )


def _notes(off: float) -> Iterator[str]:
    if off > 0.0:
        yield f"in corner zones links are up to {off * 1e3:.3g} mm off, which is swept as well"


def _without(raster: Raster) -> Raster:
    """The same page with nothing covered."""
    return raster._replace(covered=np.zeros_like(raster.covered))


def _last_step(bodies: Sequence[SweptBody]) -> int:
    return max(0 if one.chain is None else one.first + one.chain.n_steps - 1 for one in bodies)


def _views(
    bodies: Sequence[SweptBody], plane: Plane, section: float | None, tolerance: float
) -> list[Silhouette | CrossSection]:
    if section is None:
        limit = SHARE * tolerance
        return [
            Silhouette(one.body.shape, one.knots(plane, limit, solid=False), plane)
            for one in bodies
        ]
    from clearance.profiles.cross_section import CrossSection

    limit = CUT_SHARE * tolerance
    return [
        CrossSection(one.label, one.body.shape, one.knots(plane, limit, solid=True), plane)
        for one in bodies
    ]


def _page(views: Sequence[Silhouette | CrossSection]) -> Raster:
    boxes = np.array([view.box() for view in views])
    low, high = boxes[:, 0].min(axis=0), boxes[:, 1].max(axis=0)
    pixel = float((high - low).max()) / PIXELS
    shape = tuple((np.ceil((high - low) / pixel).astype(int) + 5)[::-1])
    return Raster(
        float(low[0] - 2 * pixel), float(low[1] - 2 * pixel), pixel, np.zeros(shape, bool)
    )


class PolygonCollection:
    """The polygons so far; those that no longer reach the outline are dropped now and then."""

    def __init__(self, covered: Region) -> None:
        self._whole = covered
        self._parts = np.zeros(0, dtype=object)
        self._makers = np.zeros((0, 2), dtype=np.int64)
        self._fresh = 0

    def add(self, hulls: Hulls, i_view: int, off: float = 0.0, excess: float = 0.0) -> None:
        """Adds polygons; with all points within `off` [m] of them, and none beyond that and `excess`."""
        given = hulls.corners, hulls.n_corners
        made = widened(*given, off, excess) if off > 0.0 and len(given[1]) else polygons(*given)
        makers = np.stack([np.full(len(made), i_view), hulls.instant.astype(np.int64)], axis=1)
        self._parts = np.concatenate([self._parts, made])
        self._makers = np.concatenate([self._makers, makers])
        self._fresh += len(made)
        if self._fresh > MOST_POLYGONS:
            self.region()

    def region(self) -> Region:
        """The union of all so far."""
        if self._fresh:
            fresh = self._parts[len(self._parts) - self._fresh :]
            self._whole = union([self._whole, union(fresh)])
            reaching = touching(self._whole, self._parts)
            self._parts, self._makers, self._fresh = (
                self._parts[reaching],
                self._makers[reaching],
                0,
            )
        return self._whole

    def origin(self, contours: Sequence[Contour], labels: tuple[str, ...]) -> Origin:
        """The maker of each piece: whose polygon is nearest to its middle, the first on ties."""
        middles = np.concatenate([contour.middles() for contour in contours])
        makers = self._makers[nearest_parts(self._parts, middles)]
        return Origin(labels, makers[:, 0].copy(), makers[:, 1].copy())
