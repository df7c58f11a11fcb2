"""The polygon, segment or point in which bodies touch that share no inner point.

All of it lies in one face's plane (a face with a positive weight in the certificate); there the half-spaces
of all bodies cut a large square down to it. Not for: bodies with a region in common.
"""

from __future__ import annotations

import numpy as np

from clearance.geometry.polytope import Polytope
from clearance.query.common_point import ROUNDING, CommonPoint


def touching_set(bodies: list[Polytope], met: CommonPoint) -> np.ndarray:
    """(k, 3) [m] corners in order: three or more of a polygon, two of a segment, one point."""
    proof, point = met.certificate, met.point
    assert proof is not None and point is not None, "bodies that touch have both"
    heaviest = int(proof.weights.argmax())
    normal = bodies[proof.parts[heaviest]].normals[proof.faces[heaviest]]
    aside = np.cross(normal, np.eye(3)[np.abs(normal).argmin()])
    aside /= np.linalg.norm(aside)
    axes = np.stack([aside, np.cross(normal, aside)])
    size = min(body.size for body in bodies)
    slack = ROUNDING * max(body.size for body in bodies)
    ring = 2.0 * size * np.array([[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]])
    for body in bodies:
        flat, offsets = body.normals @ axes.T, body.offsets_about(point)
        for i in np.flatnonzero(np.abs(flat).sum(axis=1) * 3.0 * size > offsets - slack):
            ring = _cut(ring, flat[i], offsets[i], slack)
    ring = _distinct(ring, 8.0 * slack)
    return point + ring @ axes if len(ring) else point[None, :]


def _cut(ring: np.ndarray, normal: np.ndarray, offset: float, slack: float) -> np.ndarray:
    """The corners of the ring on or below the line, with those where it crosses."""
    heights = ring @ normal - offset
    if not len(ring) or heights.max() <= slack:
        return ring
    inside = []
    for i, high in enumerate(heights):
        j = (i + 1) % len(ring)
        if high <= slack:
            inside.append(ring[i])
        if (high < -slack and heights[j] > slack) or (high > slack and heights[j] < -slack):
            inside.append(ring[i] + (ring[j] - ring[i]) * (high / (high - heights[j])))
    return np.array(inside).reshape(-1, 2)


def _distinct(ring: np.ndarray, slack: float) -> np.ndarray:
    """The corners without repeats; the two ends where they lie on a line; one where all agree."""
    if not len(ring):
        return ring
    corners = [ring[0]]
    for corner in ring[1:]:
        if min(np.linalg.norm(corner - other) for other in corners) > slack:
            corners.append(corner)
    inside = np.array(corners)
    if len(inside) < 2:
        return inside
    far = inside[np.linalg.norm(inside - inside[0], axis=1).argmax()]
    end = inside[np.linalg.norm(inside - far, axis=1).argmax()]
    along = (far - end) / np.linalg.norm(far - end)
    off = (inside - end) @ np.array([-along[1], along[0]])
    return inside if np.abs(off).max() > slack else np.stack([end, far])
