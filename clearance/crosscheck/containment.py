"""What lies inside a closed surface, by the winding number: FCL cannot tell, it measures surfaces
only.

Two surfaces that do not touch either stand apart or one part of one lies wholly inside the other;
so one vertex of each connected part decides (field: a box wholly inside another is 0.4 m "away" for
FCL).
"""

from __future__ import annotations

import numpy as np

from clearance.crosscheck.triangles import TriangleSoup

_MOST_ANGLES = 2_000_000  # solid angles held at once: about 150 MB of temporaries


def is_inside(soup: TriangleSoup, points: np.ndarray) -> np.ndarray:
    """(n,) True where a point (n, 3) [m] in the body frame is inside the closed surface.

    Exactness: the winding number of a closed surface is an integer; float64 rounding is far below
    the threshold of one half for points that are not on the surface.
    """
    inside = np.zeros(len(points), dtype=bool)
    if not soup.encloses:
        return inside
    low, high = soup.bounds
    candidates = np.flatnonzero(((points > low) & (points < high)).all(axis=1))
    corners = soup.corners
    chunk = max(1, _MOST_ANGLES // len(corners))
    for start in range(0, len(candidates), chunk):
        chosen = candidates[start : start + chunk]
        inside[chosen] = np.abs(winding_number(corners, points[chosen])) > 0.5
    return inside


def winding_number(corners: np.ndarray, points: np.ndarray) -> np.ndarray:
    """(n,) how often the triangles (m, 3, 3) go round each point (n, 3).

    Source: van Oosterom & Strackee 1983, equation 8 (solid angle of a triangle).
    """
    a, b, c = (corners[None, :, k] - points[:, None] for k in range(3))
    la, lb, lc = (np.sqrt(np.einsum("nmk,nmk->nm", v, v)) for v in (a, b, c))
    volume = np.einsum("nmk,nmk->nm", a, np.cross(b, c))
    ab, bc, ca = (np.einsum("nmk,nmk->nm", u, v) for u, v in ((a, b), (b, c), (c, a)))
    spread = la * lb * lc + ab * lc + bc * la + ca * lb
    return np.arctan2(volume, spread).sum(axis=1) / (2.0 * np.pi)
