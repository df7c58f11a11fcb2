"""Polygons round circles, and surfaces of stacked rings about the z axis with exactly flat faces.

A ring is a polygon that contains a circle even after its corners are rounded; two rings of one family have the
same directions, and products of direction and radius that are exact, so that the quadrilaterals between
them are flat to the last bit. Not for: which rings make which shape.
"""

from __future__ import annotations

import numpy as np

PUSH = 2.0**-48
"""[-] A ring's corners are moved this part outward (inward for bores): rounding moves a corner by at most
2^-51 of the radius (cosine, product), and a side between two corners no farther than them."""

COARSE = 2.0**-24
"""[-] The same for directions and radii of 26 bits, which are off by at most 2^-26 each."""


def corner_factor(n: int) -> float:
    """Corner radius over side distance of a regular n-gon, rounded up."""
    return (1.0 + 2.0**-51) / float(np.cos(np.pi / n))


def ring_around(radius: float, n: int) -> np.ndarray:
    """(n, 2) corners, counter-clockwise, of a polygon that contains the circle of that radius."""
    return _directions(n) * (radius * corner_factor(n) * (1.0 + PUSH))


def ring_within(radius: float, n: int) -> np.ndarray:
    """(n, 2) corners, counter-clockwise, of a polygon inside the circle of that radius."""
    return _directions(n) * (radius * (1.0 - PUSH))


def family_around(radii: np.ndarray, n: int) -> np.ndarray:
    """(k, n, 2) rings that contain circles of the k radii, with the same directions exactly.

    Exactness: directions and radii have 26 bits, so their products are exact and side i of every ring is
        parallel to side i of every other. Radii grow by up to 2^-22 of themselves and of the greatest.
    """
    directions = _coarse(_directions(n) * (corner_factor(n) * (1.0 + COARSE)))
    grown = radii * (1.0 + COARSE) + COARSE * np.max(radii)
    return _coarse(grown)[:, None, None] * directions


def stacked(rings: np.ndarray, heights: np.ndarray) -> tuple[np.ndarray, list[list[int]]]:
    """Vertices and faces of the solid between rings (k, n, 2) at heights (k,), lowest first, with flat ends."""
    k, n = rings.shape[:2]
    vertices = np.concatenate([rings, np.broadcast_to(heights[:, None, None], (k, n, 1))], axis=2)
    here = np.arange(n)
    ahead = np.roll(here, -1)
    faces = [np.arange(n)[::-1].tolist()]
    for level in range(k - 1):
        low, high = level * n, (level + 1) * n
        sides = np.stack([low + here, low + ahead, high + ahead, high + here], axis=1)
        faces.extend(sides.tolist())
    faces.append(((k - 1) * n + here).tolist())
    return vertices.reshape(-1, 3), faces


def _directions(n: int) -> np.ndarray:
    """(n, 2) unit vectors at equal angles, the first along x, each to an ulp; symmetric where n allows."""
    angles = np.arange(n) * (2.0 * np.pi / n)
    return np.stack([np.cos(angles), np.sin(angles)], axis=1)


def _coarse(values: np.ndarray) -> np.ndarray:
    """The values rounded to 26 significant bits."""
    mantissa, exponent = np.frexp(values)
    return np.ldexp(np.round(np.ldexp(mantissa, 26)), exponent - 26)
