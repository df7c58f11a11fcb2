"""What lies inside a closed surface, by the winding number: FCL does not know, it measures surfaces
only.

Two surfaces that do not touch either stand apart or one part of one lies wholly inside the other;
so one vertex of each connected part decides (field: a box wholly inside another is 0.4 m "away" for
FCL).
"""

from __future__ import annotations

import numpy as np

from clearance.crosscheck.triangles import TriangleSoup

MARGIN = 0.25
"""[turns] A point is inside where its winding number is no farther from a whole one, and that is not 0."""

_MOST_ANGLES = 2_000_000  # solid angles held at once: about 150 MB of temporaries


def is_inside(soup: TriangleSoup, points: np.ndarray) -> np.ndarray:
    """(n,) True where a point (n, 3) [m] in the body frame is inside the closed surface.

    Exactness: the winding number of a closed surface is an integer; float64 rounding is far below
    the margin for points that are not on the surface. Where the surface is closed but for a few faults,
    points from which more than a quarter of all directions is open are not said to be inside.
    """
    inside = np.zeros(len(points), dtype=bool)
    if not soup.holds:
        return inside
    low, high = soup.bounds
    candidates = np.flatnonzero(((points > low) & (points < high)).all(axis=1))
    corners, turns = soup.corners, None if soup.encloses else soup.turns
    chunk = max(1, _MOST_ANGLES // len(corners))
    for start in range(0, len(candidates), chunk):
        chosen = candidates[start : start + chunk]
        number = np.abs(winding_number(corners, points[chosen], turns))
        inside[chosen] = number >= 1.0 - MARGIN
    return inside


def winding_number(
    corners: np.ndarray, points: np.ndarray, turns: np.ndarray | None = None
) -> np.ndarray:
    """(n,) how often the triangles (m, 3, 3), each counted `turns` (m,) times, go round each point (n, 3).

    Source: van Oosterom & Strackee 1983, equation 8 (solid angle of a triangle).
    """
    a, b, c = (corners[None, :, k] - points[:, None] for k in range(3))
    la, lb, lc = (np.sqrt(np.einsum("nmk,nmk->nm", v, v)) for v in (a, b, c))
    volume = np.einsum("nmk,nmk->nm", a, np.cross(b, c))
    ab, bc, ca = (np.einsum("nmk,nmk->nm", u, v) for u, v in ((a, b), (b, c), (c, a)))
    spread = la * lb * lc + ab * lc + bc * la + ca * lb
    parts = np.arctan2(volume, spread) / (2.0 * np.pi)
    return parts.sum(axis=1) if turns is None else (parts * turns).sum(axis=1)
