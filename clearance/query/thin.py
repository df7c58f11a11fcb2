"""The volume of a thin common region, to the last digits: found again in a frame that makes it round.

Only faces whose planes come near the region take part, each as the planes of the exact hull of its corners,
because a merged face is flat only to rounding, and that is large compared with a thin region. Not for: finding the
region (`region`).
"""

from __future__ import annotations

import numpy as np

from clearance.geometry.polytope import Polytope, ring_moments
from clearance.kernels.polytope.thin import stretched_planes, supporting_triples
from clearance.query.region import ON_PLANE, Region, SharedPlanes, dual_rings

THIN = 0.02
"""[-] A region is thin if its volume is less than this times its reach squared times the smallest body's reach:
planes err by roundings of the body, and over the region's area these have cost it two digits or more."""

MOST_PLANES = 1000
MOST_CORNERS = 12

_WALLS = np.concatenate([np.eye(3), -np.eye(3)])
"""Normals of the cube [-1, 1]^3 about a region in its own frame."""


def is_thin(region: Region, volume: float) -> bool:
    """True if the volume [m^3] of a region has lost digits."""
    reach = float(np.abs(region.places).max())
    return volume < THIN * reach * reach * region.shared.tolerance / ON_PLANE


def refined(region: Region) -> tuple[Region, np.ndarray] | None:
    """(region, moments about the origin) given the region found; None if it fails.

    It fails where more than `MOST_PLANES` planes are near, or rounding leaves nothing.
    """
    shared, places = region.shared, region.places
    for margin in (1.5, 8.0):
        frame, middle = _frame_of(places, margin)
        names, corners = _near_faces(shared, frame, middle)
        if not 0 < len(names) <= MOST_PLANES:
            return None
        origin = shared.origin + middle
        planes = stretched_planes(corners, origin[None, :], np.ascontiguousarray(frame))
        normals = np.concatenate([planes[:, :3], _WALLS])
        inner = np.linalg.solve(frame, places.mean(axis=0) - middle)
        offsets = np.append(planes[:, 3], np.ones(len(_WALLS))) - normals @ inner
        dual = dual_rings(normals, offsets)
        if dual is None:
            return None
        spots, (numbers, starts, rows), _ = dual
        if numbers.max() < len(names):  # no wall of the cube is left
            spots = spots + inner
            found = Region(shared, middle + spots @ frame.T, names[numbers], starts, rows)
            moments = ring_moments(spots, starts, rows, inner)
            moments[1:] += inner * moments[0]
            return found, _unstretched(moments, frame, middle)
    return None


def _frame_of(places: np.ndarray, margin: float) -> tuple[np.ndarray, np.ndarray]:
    """(columns, middle): the region lies well inside the box middle + columns [-1, 1]^3."""
    axes = np.linalg.svd(places - places.mean(axis=0), full_matrices=False)[2].T
    axes[:, 0] *= np.sign(np.linalg.det(axes))  # a mirrored frame would turn faces inside out
    low, high = (places @ axes).min(axis=0), (places @ axes).max(axis=0)
    return axes * (0.5 * margin * (high - low)), axes @ (0.5 * (low + high))


def _near_faces(
    shared: SharedPlanes, frame: np.ndarray, middle: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """(k,) plane numbers and (k, 3, 3) corners of all planes that come near the box."""
    names, corners = [], []
    for base, body in zip(shared.bases, shared.bodies, strict=False):
        over = np.abs(body.normals @ frame).sum(axis=1) - body.offsets_about(shared.origin + middle)
        for face in np.flatnonzero(over > -8.0 * shared.tolerance).tolist():
            for triple in _exact_triples(body, face):
                names.append(base + face)
                corners.append(triple)
    return np.array(names), np.array(corners).reshape(-1, 3, 3)


def _exact_triples(body: Polytope, face: int) -> list[np.ndarray]:
    """Corners of the planes of the exact hull of a face: one, or more where it is flat only to rounding."""
    ring = body.face(face)
    k = len(ring)
    if k == 3:
        return [ring]
    found = supporting_triples(ring) if k <= MOST_CORNERS else np.array([[0, k // 3, 2 * k // 3]])
    triples = ring[found]
    triples = triples[_bound(body, triples)]
    return list(triples) if len(triples) else [ring[[0, k // 3, 2 * k // 3]]]


def _bound(body: Polytope, triples: np.ndarray) -> np.ndarray:
    """(t,) True unless the body stands out of the plane by more than rounding, as where corners are in a line."""
    first, second = (triples[:, i] - triples[:, 0] for i in (1, 2))
    normals = (
        first[:, [1, 2, 0]] * second[:, [2, 0, 1]] - first[:, [2, 0, 1]] * second[:, [1, 2, 0]]
    )
    most = (normals @ body.vertices.T).max(axis=1) - (normals * triples[:, 0]).sum(axis=1)
    lengths = np.sqrt((normals**2).sum(axis=1))
    reach = body.size + np.abs(triples[:, 0]).max(axis=1)
    return (lengths > 0.0) & (most <= ON_PLANE * reach * lengths)


def _unstretched(moments: np.ndarray, frame: np.ndarray, middle: np.ndarray) -> np.ndarray:
    scale = abs(np.linalg.det(frame))
    return scale * np.append(moments[0], frame @ moments[1:] + middle * moments[0])
