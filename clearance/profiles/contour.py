"""A closed chain of lines and arcs: what profiles are made of.

Stored as vertices and bulges (the tangent of a quarter of the sweep, positive where the arc turns to the left), as
DXF polylines do, so that ends meet to the last bit. Not for: free-form curves (`clearance.planar`).
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from clearance.planar.curve import Curve


@dataclass(frozen=True, eq=False)
class Contour:
    """A closed chain of pieces; piece i goes from vertex i to the next.

    Attributes:
        vertices: (n, 2) [m], n >= 2.
        bulges: (n,) 0 for lines; magnitude below 1 (less than half a turn).
    """

    vertices: np.ndarray
    bulges: np.ndarray

    @property
    def n_pieces(self) -> int:
        """Number of lines and arcs."""
        return len(self.bulges)

    def curve(self) -> Curve:
        """The contour as one closed curve of rational quadratics; piece i has the parameters i to i + 1.

        Degree two throughout: a line has its middle as third control point, an arc the corner of its tangents.
        """
        n, following = self.n_pieces, np.roll(self.vertices, -1, axis=0)
        half = 2.0 * np.arctan(self.bulges)
        control = np.empty((2 * n + 1, 2))
        control[0:-1:2], control[-1] = self.vertices, self.vertices[0]
        _, left = self._chords()
        control[1::2] = 0.5 * (self.vertices + following) - 0.5 * np.tan(half)[:, None] * left
        weights = np.ones(2 * n + 1)
        weights[1::2] = np.cos(half)
        knots = np.concatenate([[0.0], np.repeat(np.arange(n + 1.0), 2), [float(n)]])
        return Curve.bspline(control, 2, knots, weights)

    def middles(self) -> np.ndarray:
        """(n, 2) [m] the point half-way along each piece."""
        _, left = self._chords()
        return (
            0.5 * (self.vertices + np.roll(self.vertices, -1, axis=0))
            - 0.5 * self.bulges[:, None] * left
        )

    def flattened(self, tolerance: float) -> np.ndarray:
        """(m, 2) vertices of a polygon whose edges are within `tolerance` [m] of the contour."""
        rows = []
        following = np.roll(self.vertices, -1, axis=0)
        for (x, y), (u, v), bulge in zip(self.vertices, following, self.bulges, strict=True):
            rows.append(_points(x, y, u, v, float(bulge), tolerance))
        return np.concatenate(rows)

    @property
    def area(self) -> float:
        """[m^2] enclosed, negative for a clockwise contour."""
        x, y = self.vertices.T
        u, v = np.roll(self.vertices, -1, axis=0).T
        chord, _ = self._chords()
        sweep = 4.0 * np.arctan(self.bulges)
        flat = np.abs(self.bulges) < 1e-4
        safe = np.where(flat, 1.0, self.bulges)
        radius_sq = (chord * (1.0 + safe * safe) / (4.0 * safe)) ** 2
        segment = np.where(
            flat, chord * chord * self.bulges / 3.0, 0.5 * radius_sq * (sweep - np.sin(sweep))
        )
        return float(0.5 * np.sum(x * v - u * y) + segment.sum())

    @property
    def length(self) -> float:
        """[m]"""
        chord, _ = self._chords()
        sweep = 4.0 * np.arctan(np.abs(self.bulges))
        stretch = np.where(
            sweep < 1e-8, 1.0, 0.5 * sweep / np.where(sweep < 1e-8, 1.0, np.sin(0.5 * sweep))
        )
        return float(np.sum(chord * stretch))

    def _chords(self) -> tuple[np.ndarray, np.ndarray]:
        along = np.roll(self.vertices, -1, axis=0) - self.vertices
        return np.hypot(*along.T), np.stack([-along[:, 1], along[:, 0]], axis=1)


def joined(contours: Sequence[Contour]) -> Curve:
    """All contours as one curve, in their order."""
    curves = [contour.curve() for contour in contours]
    return curves[0] if len(curves) == 1 else Curve.contours(curves)


def _points(x: float, y: float, u: float, v: float, bulge: float, tolerance: float) -> np.ndarray:
    """The start and points along one piece, without its end."""
    if bulge == 0.0:
        return np.array([[x, y]])
    sweep = 4.0 * math.atan(bulge)
    chord = math.hypot(u - x, v - y)
    radius = chord / (2.0 * math.sin(0.5 * abs(sweep)))
    reach = math.acos(max(0.0, 1.0 - tolerance / radius)) if radius > tolerance else 0.5 * math.pi
    n = max(1, math.ceil(abs(sweep) / (2.0 * reach)))
    lift = (1.0 - bulge * bulge) / (4.0 * bulge)
    center = np.array([0.5 * (x + u) - (v - y) * lift, 0.5 * (y + v) + (u - x) * lift])
    turn = sweep * np.arange(n) / n
    arm = np.array([x, y]) - center
    cosine, sine = np.cos(turn), np.sin(turn)
    rows = center + np.stack(
        [cosine * arm[0] - sine * arm[1], sine * arm[0] + cosine * arm[1]], axis=1
    )
    rows[0] = x, y
    return rows
