"""The graphs of a polytope's surface: twins, vertex neighbours, face neighbours and the trivalent form.

Made once a polytope, with whole arrays; the kernels walk on them.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from clearance.geometry.edges import rings_of


class TrivalentPolytope(NamedTuple):
    """A polytope in which each vertex lies on three planes; see `kernels.polytope.cut`.

    Attributes:
        corner: (t,) which corner each vertex is at. planes, across: (t, 3). mesh: (t, 8) int32, both as the
            kernels take them.
    """

    corner: np.ndarray
    planes: np.ndarray
    across: np.ndarray
    mesh: np.ndarray


def twins(face_starts: np.ndarray, face_vertices: np.ndarray, n_vertices: int) -> np.ndarray | None:
    """(e,) for each directed edge the entry of its reverse; None if some edge has not exactly one."""
    tail, head = face_vertices, face_vertices[rings_of(face_starts).ahead]
    keys, reverse = tail * n_vertices + head, head * n_vertices + tail
    order = np.argsort(keys, kind="stable")
    found = order[np.minimum(np.searchsorted(keys[order], reverse), len(keys) - 1)]
    whole = (keys[found] == reverse).all() and len(np.unique(keys)) == len(keys)
    return found if whole else None


def vertex_graph(
    face_starts: np.ndarray, face_vertices: np.ndarray, n_vertices: int
) -> tuple[np.ndarray, np.ndarray]:
    """(n + 1,) starts and (e,) neighbours of each vertex over the edges."""
    order = np.argsort(face_vertices, kind="stable")
    starts = np.searchsorted(face_vertices[order], np.arange(n_vertices + 1))
    return starts, face_vertices[rings_of(face_starts).ahead][order]


def trivalent_form(
    face_starts: np.ndarray, face_vertices: np.ndarray, twin: np.ndarray, n_vertices: int
) -> TrivalentPolytope:
    """Each vertex of d faces as d - 2 vertices of three faces, a fan of its dual polygon; in its order."""
    ring = rings_of(face_starts)
    before = np.empty_like(ring.ahead)
    before[ring.ahead] = np.arange(len(before))
    turn = twin[before]
    first = np.full(n_vertices, -1)
    first[face_vertices[::-1]] = np.arange(len(face_vertices))[::-1]
    i, j = turn[first], turn[turn[first]]
    vertex, vertices, fans = np.arange(n_vertices), [], []
    while len(vertex):
        vertices.append(vertex)
        fans.append(np.stack([ring.face[first[vertex]], ring.face[i], ring.face[j]], axis=1))
        i, j = j, turn[j]
        more = j != first[vertex]
        vertex, i, j = vertex[more], i[more], j[more]
    corners = np.concatenate(vertices)
    near = np.argsort(corners, kind="stable")
    planes = np.concatenate(fans)[near]
    across = _across(planes, len(face_starts) - 1)
    mesh = np.column_stack([across, planes, np.zeros((len(near), 2), dtype=np.int64)])
    return TrivalentPolytope(corners[near], planes, across, mesh.astype(np.int32))


def _across(planes: np.ndarray, n_faces: int) -> np.ndarray:
    """(t, 3) the other vertex that shares the two planes besides plane k."""
    a, b = np.roll(planes, -1, axis=1).ravel(), np.roll(planes, -2, axis=1).ravel()
    order = np.argsort(np.minimum(a, b) * n_faces + np.maximum(a, b), kind="stable").reshape(-1, 2)
    across = np.empty(planes.size, dtype=np.int64)
    across[order[:, 0]] = order[:, 1] // 3
    across[order[:, 1]] = order[:, 0] // 3
    return across.reshape(-1, 3)
