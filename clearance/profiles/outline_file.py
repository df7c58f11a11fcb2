"""Outlines from any file that has one: a profile, a sketch, a list of curves, a DXF drawing."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from clearance.errors import BadShape, at
from clearance.kernels.curve.arc import RADIUS
from clearance.plain_yaml import yaml_file
from clearance.planar.curve import Curve
from clearance.planar.curve_file import curve_of_document, read_curve
from clearance.planar.dxf import read_drawing
from clearance.profiles.profile import Profile
from clearance.profiles.profile_read import is_profile, profile_of

if TYPE_CHECKING:
    from clearance.profiles.region import Region
    from clearance.sketch import Sketch

FINE = 1e-4
"""[-] Ten times how far chords stray in areas and pictures, relative to the outline's size."""


@dataclass(frozen=True, eq=False)
class DrawnOutline:
    """An outline and what it came from.

    Attributes:
        name: for messages and pictures.
        curve: all contours.
        profile: with makers and bounds, where it is a profile of ours.
        in_metres: its file says its unit, so that the curve is in metres; else lengths are as they stand there.
        notes: what the curve leaves out, or rests on; one line each.
    """

    name: str
    curve: Curve
    profile: Profile | None = None
    in_metres: bool = False
    notes: tuple[str, ...] = ()

    @cached_property
    def region(self) -> Region:
        """The region that the contours enclose, by parity; for areas and pictures, not for bounds.

        Raises: BadShape (an open contour).
        """
        from clearance.profiles.region import region_of

        require_closed(self.curve, self.name)
        return region_of(rings_of_curve(self.curve))

    @cached_property
    def region_fault(self) -> str:
        """Why the contours enclose no region, as one is open or two overlap; "" if they do."""
        from clearance.profiles.gap import ClosedContours

        try:
            require_closed(self.curve, self.name)
            if self.profile is None:
                ClosedContours.of_curve(self.curve).require_apart(self.name)
        except BadShape as fault:
            return str(fault)
        return ""


def require_closed(curve: Curve, name: str) -> None:
    """Nothing, if every contour ends where it starts.

    Raises: BadShape, with the ends that do not meet.
    """
    for k in range(int(curve.contour[-1]) + 1):
        own = np.flatnonzero(curve.contour == k)
        ends = curve.point(np.array([curve.limits[own[0], 0], curve.limits[own[-1], 1] - 0.0]))
        first = curve.pieces.control[curve.pieces.first[own[0]]]
        last = curve.pieces.control[curve.pieces.first[own[-1] + 1] - 1]
        gap = np.hypot(*(first[:2] / first[2] - last[:2] / last[2]))
        if gap > 1e-9 * curve.size:
            raise BadShape(
                f"contour {k + 1} is open: it ends {gap:g} away from its start "
                f"({ends[0][0]:g}, {ends[0][1]:g})",
                where=name,
                valid="closed contours, since a region is asked for",
            )


def rings_of_curve(curve: Curve) -> list[np.ndarray]:
    """Each contour as points dense enough for areas and pictures, (n, 2)."""
    if curve.highest_degree == 1:
        points = curve.point(curve.limits[:, 0])
        owner = curve.contour
    else:
        piece, local = curve.spread_on_leaves(_chord_counts(curve))
        low, high = curve.limits[piece].T
        points = curve.point(low + local * (high - low))
        owner = curve.contour[piece]
    return np.split(points, np.flatnonzero(np.diff(owner)) + 1)


def _chord_counts(curve: Curve) -> np.ndarray:
    """(n,) chords of each leaf, so that they stay within about FINE / 10 of the size of the curve."""
    radius = curve.leaves.arcs[:, RADIUS]
    radius = np.where(radius > 0.0, radius, np.inf)
    count = np.ceil(curve.leaf_chords / np.sqrt(8.0 * radius * 0.1 * FINE * curve.size))
    free = np.diff(curve.pieces.first)[curve.leaves.piece] > 3
    return np.clip(count + 3 * free, 1, 64).astype(int)


def read_outline(path: str | Path) -> DrawnOutline:
    """The outline in a profile (.yaml), a sketch (.yaml), a list of curves (.yaml) or a drawing (.dxf).

    Raises:
        MissingFile, BadSyntax and what the readers of each kind raise, with the file.
    """
    path = Path(path)
    if path.suffix.lower() == ".dxf":
        drawing = read_drawing(path)
        return DrawnOutline(
            path.name, drawing.curve, in_metres=drawing.in_metres, notes=drawing.notes
        )
    if path.suffix.lower() not in (".yaml", ".yml"):
        return DrawnOutline(path.name, read_curve(str(path)))
    with at(str(path)):
        document = yaml_file(path, "a profile, sketch, curve file or DXF")
        if is_profile(document):
            found = profile_of(document)
            return DrawnOutline(path.name, found.curve, found, in_metres=True, notes=found.notes)
        if isinstance(document, dict) and "curves" not in document and "points" in document:
            from clearance.sketch import Sketch
            from clearance.sketch.sketch_file import sketch_of

            sketch = sketch_of(document, Sketch)
            require_solved(sketch)
            return DrawnOutline(path.name, sketch.curves())
        return DrawnOutline(path.name, curve_of_document(document))


def require_solved(sketch: Sketch) -> None:
    """Solves a sketch.

    Raises: BadShape (constraints that contradict each other, or are not solved in time, by name).
    """
    result = sketch.solve()
    if not result.solved:
        raise BadShape(result.fault, valid="a sketch that can be drawn")
