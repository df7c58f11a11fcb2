"""A convex body packed for the kernels: planes, neighbours and the map of directions in two flat arrays.

Made once a body; the layout is described in `kernels.polytope.body`. Not for: users.
"""

from __future__ import annotations

import numpy as np

from clearance.kernels.polytope import exits as kernels
from clearance.kernels.polytope.body import HEAD, LEAD, ROW, PackedBody

FACES_PER_CELL = 0.5


def packed(
    vertices: np.ndarray,
    rings: tuple[np.ndarray, np.ndarray],
    centroid: np.ndarray,
    planes: tuple[np.ndarray, np.ndarray, np.ndarray],
    neighbours: np.ndarray,
) -> PackedBody:
    """The arrays of a body with faces `rings` (starts, corners), planes (normals, a corner of each, distance
    from the centroid) and `neighbours`, the face over each edge, as the edges stand in `rings`."""
    normals, anchors, widths = planes
    size = np.linalg.norm(np.ptp(vertices, axis=0))
    f = len(normals)
    k = int(np.clip(np.ceil(np.sqrt(f / FACES_PER_CELL / 6.0)), 1, 128))
    round_from_body, body_from_round, pad = _rounding_map(vertices - centroid)
    cells, faces = kernels.exit_cells((vertices - centroid) @ round_from_body.T, *rings, k, pad)
    order = np.argsort(cells, kind="stable")
    lead = LEAD + 6 * k * k + 1
    starts = lead + np.searchsorted(cells[order], np.arange(6 * k * k + 1))
    begin = lead + len(faces)
    first, n_edges = begin + f + 1, len(neighbours)
    lead_numbers = [f, k, begin, n_edges, HEAD + ROW * f + 6 * k * k, 0, 0, 0]
    parts = lead_numbers, starts, faces[order], rings[0] + first, rings[1], neighbours
    indices = np.concatenate(parts).astype(np.int32)
    head = np.concatenate([centroid, round_from_body.ravel(), [widths.max(), size, 0.0, 0.0]])
    rows = np.column_stack([normals, 1.0 / widths, anchors, widths])
    numbers = np.concatenate([head, rows.ravel(), np.zeros(6 * k * k), vertices.ravel()])
    body = PackedBody(numbers, indices)
    kernels.bound_cells(body, body_from_round)
    return body


def _rounding_map(corners: np.ndarray) -> tuple[np.ndarray, np.ndarray, float]:
    """(3, 3) to a frame in which the corners spread alike in all directions, back, and the cells' margin."""
    values, axes = np.linalg.eigh(corners.T @ corners / len(corners))
    spread = np.sqrt(np.maximum(values, values.max() * 1e-24))
    there = (axes / spread) @ axes.T
    back = (axes * spread) @ axes.T
    return there, back, 1e-9 + 1e-14 * float(spread.max() / spread.min())
