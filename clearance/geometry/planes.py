"""The plane, centre and radius of each face, free of scale and of distance from the origin."""

from __future__ import annotations

from fractions import Fraction
from typing import NamedTuple

import numpy as np

from clearance.geometry.edges import rings_of

_DOUBTFUL = 2.0**-30
"""Below this part of the squared radius a float area vector has lost so many digits (error about 2^-49 of
the squared radius) that its direction is computed again in rationals."""


class Planes(NamedTuple):
    """For each of m faces.

    Attributes:
        normals: (m, 3) unit, counter-clockwise side; zero where the area is exactly zero.
        centres: (m, 3) [m] mean of the corners.
        radii: (m,) [m] from the centre to the farthest corner.
    """

    normals: np.ndarray
    centres: np.ndarray
    radii: np.ndarray


def planes_of(vertices: np.ndarray, starts: np.ndarray, flat: np.ndarray) -> Planes:
    """Planes, centres and radii of flat faces.

    Exactness: directions are right to about 2^-18 for slivers and 1e-15 for others; zero normals are exact.
    Source: Newell's area vector (Sutherland, Sproull and Schumacker 1974), about the first corner.
    """
    sizes = np.diff(starts)
    firsts = vertices[flat[starts[:-1]]]
    spans = vertices[flat] - np.repeat(firsts, sizes, axis=0)
    widths = np.maximum.reduceat(np.abs(spans).max(axis=1), starts[:-1])
    exponents = np.frexp(np.where(widths > 0.0, widths, 1.0))[1]
    spans = np.ldexp(spans, -np.repeat(exponents, sizes)[:, None])  # now of size 1/2 to 1, exactly
    means = np.add.reduceat(spans, starts[:-1], axis=0) / sizes[:, None]
    radii = np.sqrt(
        np.maximum.reduceat(
            ((spans - np.repeat(means, sizes, axis=0)) ** 2).sum(axis=1), starts[:-1]
        )
    )
    areas = _area_vectors(spans, starts)
    lengths = np.sqrt((areas**2).sum(axis=1))
    for i in np.flatnonzero(lengths < _DOUBTFUL * radii**2):
        areas[i] = _exact_direction(vertices[flat[starts[i] : starts[i + 1]]])
        lengths[i] = np.sqrt((areas[i] ** 2).sum())
    normals = np.divide(
        areas, lengths[:, None], out=np.zeros_like(areas), where=lengths[:, None] > 0.0
    )
    scale = exponents[:, None]
    return Planes(normals, firsts + np.ldexp(means, scale), np.ldexp(radii, exponents))


def _area_vectors(spans: np.ndarray, starts: np.ndarray) -> np.ndarray:
    """(m, 3) twice the area vectors of faces whose corners are given relative to their first."""
    if len(spans) == 3 * (len(starts) - 1):
        return np.cross(spans[1::3], spans[2::3])
    return np.add.reduceat(np.cross(spans, spans[rings_of(starts).ahead]), starts[:-1], axis=0)


def _exact_direction(corners: np.ndarray) -> np.ndarray:
    """(3,) the area vector of one face, rounded once and at a size near 1; zero where it is zero."""
    points = [[Fraction(float(x)) for x in corner] for corner in corners]
    spans = [[x - o for x, o in zip(point, points[0], strict=True)] for point in points[1:]]
    total = [Fraction(0)] * 3
    for (ax, ay, az), (bx, by, bz) in zip(spans, spans[1:], strict=False):
        total[0] += ay * bz - az * by
        total[1] += az * bx - ax * bz
        total[2] += ax * by - ay * bx
    largest = max(abs(x) for x in total)
    return np.array([float(x / largest) for x in total]) if largest else np.zeros(3)
