"""The volume of a thin common region, to the last digits: cut again in a frame that makes it round.

Only faces whose planes come near the region take part, each as the planes of the exact hull of its corners,
because a merged face is flat only to rounding, and that is large compared with a thin region.
"""

from __future__ import annotations

import functools

import numpy as np

from clearance.geometry.polytope import Polytope
from clearance.kernels.polytope.cut import CUT, N_ROWS, cut_by_planes
from clearance.kernels.polytope.faces import face_rings
from clearance.kernels.polytope.thin import stretched_planes, supporting_triples
from clearance.query.cutting import ON_PLANE, CuttingTask, by_edges
from clearance.query.region import Region

THIN = 0.02
"""[-] A region is thin if its volume is less than this times its reach squared times the smallest body's reach:
planes err by roundings of the body, and over the region's area these have cost it two digits or more."""

MOST_PLANES = 1000
MOST_CORNERS = 12

_CUBE = np.array([[x, y, z] for x in (-1.0, 1.0) for y in (-1.0, 1.0) for z in (-1.0, 1.0)])


def is_thin(task: CuttingTask, volume: float, reach: float) -> bool:
    """True if the volume [m^3] of a region with coordinates up to `reach` [m] has lost digits."""
    return volume < THIN * reach * reach * task.tolerance / ON_PLANE


def refined(task: CuttingTask, places: np.ndarray) -> tuple[Region, np.ndarray] | None:
    """(region, moments about the origin) given the corners (n, 3) of the region found; None if it fails.

    It fails where more than `MOST_PLANES` planes are near, or rounding leaves nothing.
    """
    for margin in (1.5, 8.0):
        frame, middle = _frame_of(places, margin)
        names, corners = _near_faces(task, frame, middle)
        if not 0 < len(names) <= MOST_PLANES:
            return None
        origin = task.origin + middle
        planes = stretched_planes(corners, origin[None, :], np.ascontiguousarray(frame))
        order = np.argsort(planes[:, 3], kind="stable")
        cut = _cut_box(planes[order])
        if cut is None:
            return None
        spots, (numbers, starts, rows), moments = cut
        if numbers.min() >= 6:
            region = Region(task, middle + spots @ frame.T, names[order][numbers - 6], starts, rows)
            return region, _unstretched(moments, frame, middle)
    return None


def _frame_of(places: np.ndarray, margin: float) -> tuple[np.ndarray, np.ndarray]:
    """(columns, middle): the region lies well inside the box middle + columns [-1, 1]^3."""
    axes = np.linalg.svd(places - places.mean(axis=0), full_matrices=False)[2].T
    low, high = (places @ axes).min(axis=0), (places @ axes).max(axis=0)
    return axes * (0.5 * margin * (high - low)), axes @ (0.5 * (low + high))


def _near_faces(
    task: CuttingTask, frame: np.ndarray, middle: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """(k,) plane numbers and (k, 3, 3) corners of all planes that come near the box."""
    names, corners = [], []
    for base, body in zip(task.bases, task.bodies, strict=False):
        over = np.abs(body.normals @ frame).sum(axis=1) - body.offsets_about(task.origin + middle)
        for face in np.flatnonzero(over > -8.0 * task.tolerance).tolist():
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


def _cut_box(planes: np.ndarray):
    """(places, rings, moments) in the stretched frame, or None."""
    rows = 64 + 4 * len(planes)
    block = np.zeros(12 * rows)  # as `kernels.polytope.cut.cut_in` says
    spots = block[: 4 * rows].reshape(-1, 4)
    mesh = block[4 * rows : 8 * rows].view(np.int32).reshape(-1, 8)
    spots[:8, :3], mesh[:8] = _box()
    state, table = np.array([0, 0, 8, 0]), np.zeros((6 + len(planes), 3), dtype=np.int32)
    if cut_by_planes(block, state, table, planes, 6, ON_PLANE) != CUT:
        return None
    moments = by_edges(block, state, table)
    return spots[:, :3], face_rings(mesh, state[N_ROWS]), moments[:4]


@functools.cache
def _box() -> tuple[np.ndarray, np.ndarray]:
    """(places, mesh) of the cube [-1, 1]^3 as arguments of kernels."""
    cube = Polytope(_CUBE)
    return cube.vertices[cube.trivalent.corner], cube.trivalent.mesh


def _unstretched(moments: np.ndarray, frame: np.ndarray, middle: np.ndarray) -> np.ndarray:
    scale = abs(np.linalg.det(frame))
    return scale * np.append(moments[0], frame @ moments[1:] + middle * moments[0])
