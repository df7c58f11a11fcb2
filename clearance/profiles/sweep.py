"""The profile that a motion sweeps: instants, covered pixels, polygons, their union, and the outline around it.

The continuous motion is meant, joints moving linearly between steps. Not for: measuring clearances.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from clearance.errors import (
    BadDimension,
    NothingToMeasure,
    UnknownLink,
    UnknownObstacle,
    nearest_name,
)
from clearance.kernels.swept_cover import Raster, row_sums
from clearance.profiles.chords import Knots, knots_of, standing
from clearance.profiles.outline import outline_of
from clearance.profiles.plane import Plane
from clearance.profiles.profile import Origin, Profile
from clearance.profiles.region import Nearest, Region, covered_region, polygons, touching, union
from clearance.profiles.silhouette import Silhouette
from clearance.simulate.kinematic import kinematic_motion
from clearance.simulate.record import Record
from clearance.world.body import Body
from clearance.world.case import Case
from clearance.world.motion import Motion

TOLERANCE = 5e-4
"""[m] How far a swept profile may exceed what is swept, by default."""

PIXELS = 1000
"""Pixels along the longer side of the page; any number gives the same region (measured: least time)."""

WIDTH = 1e-7
"""[m] What polygons without area are widened by to either side; part of the bound."""

SHARE = 0.22
"""Of the tolerance: how far points may leave their chords. It counts twice; the arcs take what is left."""

TWIST = 0.08
"""Of the tolerance: how far hulls of what turns may exceed what it sweeps."""

CUT_SHARE = 0.15
"""The same for sections, where it counts three times."""

MOST_KEPT = 20_000
"""Polygons that are held before those inside the outline so far are let go."""

Progress = Callable[[int, int], None]


@dataclass(frozen=True, eq=False)
class _Moving:
    """A body of one of the motions, or one that stands at a pose."""

    label: str
    body: Body
    motion: Motion | None
    pose: np.ndarray | None = None

    @property
    def n_steps(self) -> int:
        return 1 if self.motion is None else self.motion.n_steps

    def knots(self, plane: Plane, limit: float, *, solid: bool) -> Knots:
        """The instants at which it is looked at."""
        if self.motion is None:
            return standing(self.pose)
        return knots_of(self.motion, self.body, plane, limit, solid=solid)


def swept_profile(
    run,
    plane: str = "xy",
    *,
    links: Sequence[str] | None = None,
    obstacles: Sequence[str] = (),
    section: float | None = None,
    tolerance: float = TOLERANCE,
    per_link: bool = False,
    progress: Progress | None = None,
) -> Profile:
    """The outline in a plane of everything that the robot's links sweep, with its holes.

    Args:
        run: a `Run` or `Record` (its motions), or a `Case` (the trajectory itself).
        plane: xy, xz, yz, or a point and a normal as six numbers; the projection is along the normal.
        links: names; None for all links with geometry.
        obstacles: names of obstacles to be drawn as well, e.g. with no links a wall and its openings.
        section: [m] cut at this height along the plane's normal instead of projecting.
        tolerance: [m] how far the profile may exceed what is swept.
        per_link: also each link's own profile, in `parts`.
        progress: called with links done and all links.

    Exactness: contains what the faceted links sweep, joints moving linearly between steps; no point is farther
        than `Profile.bound` <= `tolerance` from a swept point. Holes narrower than that may be filled.
    Raises:
        BadInput: not a plane. BadDimension: not a tolerance.
        UnknownLink, UnknownObstacle.
        NothingToMeasure: the plane cuts nothing.
    """
    if not 1e-6 <= tolerance < math.inf:
        raise BadDimension(
            f"{tolerance:g} m", where="tolerance", valid="at least 1e-6 m (0.001 mm)"
        )
    name, motions = _motions(run)
    seen_on = Plane.of(plane, section)
    moving = [*_chosen(motions, links), *_standing(run, obstacles)]
    if not moving:
        raise NothingToMeasure("no link and no obstacle is asked for", where="links")
    parts = {}
    if per_link:
        for one in moving:
            parts[one.label] = _swept(name, [one], seen_on, section, tolerance, None, None)
    return _swept(name, moving, seen_on, section, tolerance, progress, parts)


def _motions(run) -> tuple[str, tuple[Motion, ...]]:
    if isinstance(run, Case):
        return run.name, tuple(kinematic_motion(placed) for placed in run.robots)
    record: Record = getattr(run, "record", run)
    return record.case.name, record.motions


def _chosen(motions: Sequence[Motion], links: Sequence[str] | None) -> list[_Moving]:
    several = len(motions) > 1
    found = [
        _Moving(f"{motion.placed.robot.name}/{body.name}" if several else body.name, body, motion)
        for motion in motions
        for body in motion.placed.robot.bodies
    ]
    if links is None:
        return found
    known = {one.label: one for one in found}
    for label in links:
        if label not in known:
            raise UnknownLink(
                f"unknown link {label!r}", where="links", valid=nearest_name(label, known)
            )
    return [one for one in found if one.label in set(links)]


def _standing(run, names: Sequence[str]) -> list[_Moving]:
    case: Case = run if isinstance(run, Case) else getattr(run, "record", run).case
    known = {obstacle.name: obstacle for obstacle in case.obstacles}
    for name in names:
        if name not in known:
            raise UnknownObstacle(
                f"unknown obstacle {name!r}", where="obstacles", valid=nearest_name(name, known)
            )
    return [_Moving(name, known[name].body, None, known[name].world_from_body) for name in names]


def _swept(name, moving, plane, section, tolerance, progress, parts) -> Profile:
    views = _views(moving, plane, section, tolerance)
    raster = _page(views)
    for view in views:
        view.cover(raster)
    collected = _Collected(covered_region(raster))
    sums = row_sums(raster.covered)
    for i, view in enumerate(views):
        for hulls in view.hulls(raster, sums, WIDTH, TWIST * tolerance):
            collected.add(hulls, i)
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
        facets=max(one.body.shape.excess for one in moving),
        n_steps=max(one.n_steps for one in moving),
        origin=collected.origin(outline.contours, tuple(one.label for one in moving)),
        parts=parts or {},
        notes=tuple(note for view in views for note in view.notes),
    )


def _views(
    moving: Sequence[_Moving], plane: Plane, section: float | None, tolerance: float
) -> list:
    if section is None:
        return [
            Silhouette(
                one.body.shape,
                one.knots(plane, SHARE * tolerance, solid=False),
                plane,
            )
            for one in moving
        ]
    from clearance.profiles.section import Section

    return [
        Section(
            one.label,
            one.body.shape,
            one.knots(plane, CUT_SHARE * tolerance, solid=True),
            plane,
        )
        for one in moving
    ]


def _page(views: Sequence) -> Raster:
    boxes = np.array([view.box() for view in views])
    low, high = boxes[:, 0].min(axis=0), boxes[:, 1].max(axis=0)
    pixel = float((high - low).max()) / PIXELS
    shape = tuple((np.ceil((high - low) / pixel).astype(int) + 5)[::-1])
    return Raster(
        float(low[0] - 2 * pixel), float(low[1] - 2 * pixel), pixel, np.zeros(shape, bool)
    )


class _Collected:
    """The polygons kept so far; those that no longer come to the outline are let go now and then."""

    def __init__(self, covered: Region) -> None:
        self._whole = covered
        self._parts = np.zeros(0, dtype=object)
        self._makers = np.zeros((0, 2), dtype=np.int64)
        self._fresh = 0

    def add(self, hulls, i_view: int) -> None:
        made = polygons(hulls.corners, hulls.n_corners)
        makers = np.stack([np.full(len(made), i_view), hulls.instant.astype(np.int64)], axis=1)
        self._parts = np.concatenate([self._parts, made])
        self._makers = np.concatenate([self._makers, makers])
        self._fresh += len(made)
        if self._fresh > MOST_KEPT:
            self.region()

    def region(self) -> Region:
        """The union of all so far."""
        if self._fresh:
            fresh = self._parts[len(self._parts) - self._fresh :]
            self._whole = union([self._whole, union(fresh)])
            keep = touching(self._whole, self._parts)
            self._parts, self._makers, self._fresh = self._parts[keep], self._makers[keep], 0
        return self._whole

    def origin(self, contours, labels: tuple[str, ...]) -> Origin:
        """The maker of each piece: whose polygon is nearest to its middle, the first on ties."""
        middles = np.concatenate([contour.middles() for contour in contours])
        makers = self._makers[Nearest(self._parts)(middles)]
        return Origin(labels, makers[:, 0].copy(), makers[:, 1].copy())
