"""Cylinder, sphere, capsule and ellipsoid, faceted from outside with as few flat faces as the tolerance allows.

A sphere is a stack of rings: n sectors round the axis times bands that touch the sphere, wider towards the
poles, and one flat polygon at each pole. Not for: anything with a bore (`pipe`).
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from functools import lru_cache

import numpy as np

from clearance.errors import BadDimension
from clearance.geometry.polyhedron import Polyhedron
from clearance.geometry.shapes.dimension import (
    at_least_zero,
    positive,
    sections_for,
    three_positive,
)
from clearance.geometry.shapes.rings import family_around, ring_around, stacked
from clearance.tolerance import TESSELLATION

_FINEST = 1e-5
"""[-] Least tolerance over radius for spheres: four hundred thousand faces."""


def cylinder(
    radius: float, length: float, tolerance: float = TESSELLATION, sections: int | None = None
) -> Polyhedron:
    """A prism that contains the cylinder along z: `sections` sides, or as many as the tolerance [m] needs.

    Raises:
        BadDimension: radius, length or tolerance not above 0, or fewer than three sections.

    Exactness: the cylinder lies inside; no corner is farther than `excess` from it. All faces are flat to
        the last bit.
    """
    radius, length = positive(radius, "radius"), positive(length, "length")
    n = sections_for(radius, tolerance, sections)
    ring = ring_around(radius, n)
    vertices, faces = stacked(np.stack([ring, ring]), np.array([-0.5, 0.5]) * length)
    return Polyhedron(
        vertices, faces, excess=_farthest_outside(vertices, radius, 0.5 * length, False)
    )


def sphere(radius: float, tolerance: float = TESSELLATION) -> Polyhedron:
    """A polyhedron that contains the sphere, whose corners stand at most the tolerance [m] outside it.

    Raises:
        BadDimension: radius or tolerance not above 0, or a tolerance below 1e-5 of the radius.
    """
    radius = positive(radius, "radius")
    n, upper = _upper_rings(radius, tolerance)
    return _ball(radius, 0.0, n, upper)


def capsule(radius: float, length: float, tolerance: float = TESSELLATION) -> Polyhedron:
    """A polyhedron that contains the capsule: the points within `radius` of a line of `length` [m] along z.

    Raises:
        BadDimension: radius or tolerance not above 0, length below 0, or a tolerance too fine.
    """
    radius, half = positive(radius, "radius"), 0.5 * at_least_zero(length, "length")
    n, upper = _upper_rings(radius, tolerance)
    return _ball(radius, half, n, upper)


def _ball(radius: float, half: float, n: int, upper: np.ndarray) -> Polyhedron:
    """The faceted capsule with caps `upper` (k, 2): ring radius and height of a unit half, bottom first."""
    radii = np.concatenate([upper[:, 0][::-1], upper[:, 0]]) * radius
    heights = np.concatenate([-half - radius * upper[::-1, 1], half + radius * upper[:, 1]])
    heights[0], heights[-1] = (
        -np.nextafter(half + radius, np.inf),
        np.nextafter(half + radius, np.inf),
    )
    vertices, faces = stacked(family_around(radii, n), heights)
    return Polyhedron(vertices, faces, excess=_farthest_outside(vertices, radius, half, True))


def _farthest_outside(vertices: np.ndarray, radius: float, half: float, rounded: bool) -> float:
    """[m] an upper bound of how far the hull of the vertices stands outside a cylinder or capsule.

    The distance to a convex solid is a convex function, so that it is greatest at a vertex.
    """
    across = np.hypot(vertices[:, 0], vertices[:, 1])
    beyond = np.maximum(np.abs(vertices[:, 2]) - half, 0.0)
    if rounded:
        outside = np.hypot(across, beyond) - radius
    else:
        outside = np.hypot(np.maximum(across - radius, 0.0), beyond)
    return float(outside.max() + 8.0 * np.spacing(across.max() + half))


def _upper_rings(radius: float, tolerance: float) -> tuple[int, np.ndarray]:
    ratio = positive(tolerance, "tolerance") / radius
    if ratio < _FINEST:
        raise BadDimension(
            f"{radius:.9g} m is too large for a tolerance of {tolerance:.9g} m",
            where="radius",
            valid=f"at most {tolerance / _FINEST:.9g} m; is this millimetres?",
        )
    return _fewest_faces(min(ratio, 0.25))


@lru_cache(maxsize=64)
def _fewest_faces(ratio: float) -> tuple[int, np.ndarray]:
    """Sectors n and the rings of the upper half, (radius, height) for a unit sphere, with the fewest faces.

    `ratio` is how far corners may stand outside, of which 2^-21 is reserved for coarse rounding (`COARSE`).
    The best n is near 1.18 times the least possible (NOTES.md); up to a hundred from 1 to 1.6 times are tried.
    """
    reach = 1.0 + ratio - 2.0**-21
    least = int(np.ceil(np.pi / np.arccos(1.0 / reach))) + 1
    tried = range(max(least, 6), int(1.6 * least) + 6, 1 + least // 160)
    latitudes = {n: _latitudes(reach, n) for n in tried}
    n = min(tried, key=lambda n: (n * (2 * len(latitudes[n]) - 3), n))
    return n, _rings(_evened(latitudes[n]))


def _latitudes(reach: float, n: int) -> np.ndarray:
    """Latitudes at which flat bands touch, from the pole to the equator or below, with the widest possible gaps.

    Neighbours touching at latitudes a > b meet at radius 1 / cos((a - b) / 2) on the meridian (a + b) / 2,
    and stand farther out at the corners of the sectors: norm^2 = sec^2(gap) (1 + cos^2(mean) tan^2(pi / n)).
    """
    widening = math.tan(math.pi / n) ** 2
    latitudes = [0.5 * math.pi]
    half_gap = math.acos(1.0 / reach)
    while latitudes[-1] > 0.0:
        for _ in range(12):  # a fixed point: the mean latitude depends on the gap, weakly
            mean = latitudes[-1] - half_gap
            half_gap = math.acos(math.sqrt(1.0 + math.cos(mean) ** 2 * widening) / reach)
        latitudes.append(latitudes[-1] - 2.0 * half_gap)
    return np.array(latitudes)


def _evened(latitudes: np.ndarray) -> np.ndarray:
    """The latitudes with the last moved to the equator exactly and the rest pulled up in proportion.

    Gaps shrink and bands move to the pole: corners come closer to the sphere, never farther from it.
    """
    colatitudes = 0.5 * np.pi - latitudes
    return 0.5 * np.pi - colatitudes * (0.5 * np.pi / colatitudes[-1])


def _rings(latitudes: np.ndarray) -> np.ndarray:
    """(k, 2) radius (to the sides, not the corners) and height of the rings, from the equator to the pole."""
    half_gaps = 0.5 * (latitudes[:-1] - latitudes[1:])
    means = 0.5 * (latitudes[:-1] + latitudes[1:])
    outward = 1.0 / np.cos(half_gaps)
    rings = np.stack([outward * np.cos(means), outward * np.sin(means)], axis=1)
    return rings[::-1]


def ellipsoid(radii: Sequence[float], tolerance: float = TESSELLATION) -> Polyhedron:
    """A polyhedron that contains the ellipsoid with semi-axes `radii` along x, y, z [m].

    Raises:
        BadDimension: not three finite numbers above 0, tolerance not above 0, or below 1e-5 of the largest.

    Exactness: the ellipsoid lies inside; no corner is farther than `excess`, at most the tolerance [m], from it:
        a corner at distance 1 + e from the unit ball's centre comes to lie within e times the largest semi-axis
        of where its foot on the ball does. Stretching rounds by 2^-53, for which the facets are large enough.
    """
    sizes = three_positive(radii, "radii")
    ratio = positive(tolerance, "tolerance") / float(sizes.max())
    return sphere(1.0, ratio).scaled(sizes.tolist())
