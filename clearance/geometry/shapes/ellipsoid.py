"""The ellipsoid, faceted from outside: a faceted ball, stretched. Not for: balls (`round`)."""

from __future__ import annotations

from collections.abc import Sequence

from clearance.geometry.polyhedron import Polyhedron
from clearance.geometry.shapes.dimension import positive, three_positive
from clearance.geometry.shapes.round import sphere
from clearance.tolerance import TESSELLATION


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
