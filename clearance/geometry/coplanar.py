"""Triangles to convex polygons: coplanar neighbours merged exactly, and needles without area put away.

Two triangles are joined only where an exact predicate says that they lie in one plane and their union is
convex; the set of points stays the same. Not for: surfaces that are flat only nearly (they stay as they are).
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from clearance.geometry.edges import distinct_vertices, edge_keys, edge_use, rings_of, twins
from clearance.kernels.arithmetic.union_find import joined_labels
from clearance.kernels.mesh import coplanar as kernels

_EXACT_RANGE = 2.0**300
"""Coordinates between the inverse of this and this, in magnitude, cause no underflow in the predicates."""


class Polygons(NamedTuple):
    """Convex polygons with the same points as the triangles that they were made of.

    Attributes:
        vertices: (n, 3) [m], all different but for those that a face without area repeats.
        face_starts, face_vertices: as in `Polyhedron`.
        n_dropped: zero-area triangles dropped, because a proper face contains all their points.
        n_degenerate: zero-area faces that stay, because none does.
    """

    vertices: np.ndarray
    face_starts: np.ndarray
    face_vertices: np.ndarray
    n_dropped: int
    n_degenerate: int


class _Faces(NamedTuple):
    """Flat faces and, for each, its plane: group, axis and sign as in `coplanar.FacePlanes`."""

    starts: np.ndarray
    flat: np.ndarray
    group: np.ndarray
    axes: np.ndarray
    signs: np.ndarray

    def ends(self) -> tuple[np.ndarray, np.ndarray]:
        """Tails and heads of all half-edges."""
        return self.flat, self.flat[rings_of(self.starts).ahead]

    def half_edges(self) -> kernels.HalfEdges:
        """The faces as the kernels split them: rings of half-edges, each with its twin."""
        ring = rings_of(self.starts)
        twin = twins(self.flat, self.flat[ring.ahead])
        return kernels.HalfEdges(self.flat, ring.ahead, ring.behind, twin, ring.face)


def merge_coplanar(vertices: np.ndarray, triangles: np.ndarray) -> Polygons:
    """The triangles as few convex polygons.

    Args:
        vertices: (n, 3) [m], finite; equal ones count as one.
        triangles: (m, 3) indices, all in range.

    Exactness: all decisions are signs of exact determinants; the union of the faces is the same set of
        points, and an edge that joined two faces still does. Coordinates whose magnitudes range over more
        than 2^300 stay unmerged.
    Ties: the longest edges go first, equal ones by index; the result is the same every time.
    """
    vertices = np.array(vertices, dtype=np.float64)
    firsts, kinds = distinct_vertices(vertices)
    points = vertices[firsts] + 0.0
    corners = np.ascontiguousarray(kinds[np.asarray(triangles, dtype=np.int64)])
    if not _within_exact_range(points):
        return _unmerged(points, corners)
    axes, signs = kernels.triangle_axes(points, corners)
    covered = _covered_outright(corners, axes)
    faces = _grouped(points, corners[~covered], axes[~covered], signs[~covered])
    faces = _with_needles_absorbed(points, faces)
    n_needles = int(np.count_nonzero(axes == kernels.DEGENERATE))
    faces = _merged(points, faces)
    n_degenerate = int(np.count_nonzero(faces.axes == kernels.DEGENERATE))
    return _compact(points, faces, n_needles - n_degenerate, n_degenerate)


def _within_exact_range(points: np.ndarray) -> bool:
    sizes = np.abs(points[points != 0.0])
    return not sizes.size or (sizes.min() > 1 / _EXACT_RANGE and sizes.max() < _EXACT_RANGE)


def _unmerged(points: np.ndarray, corners: np.ndarray) -> Polygons:
    none = np.full(len(corners), kernels.DEGENERATE)
    faces = _Faces(np.arange(0, corners.size + 1, 3), corners.ravel(), none, none, none)
    return _compact(points, faces, 0, 0)


def _covered_outright(corners: np.ndarray, axes: np.ndarray) -> np.ndarray:
    """(m,) True for triangles with a repeated corner whose edge or point a proper triangle has."""
    repeated = (corners == np.roll(corners, 1, axis=1)).any(axis=1)
    covered = np.zeros(len(corners), dtype=bool)
    if not repeated.any():
        return covered
    proper = corners[axes != kernels.DEGENERATE]
    edges = {frozenset(pair) for pair in _edge_rows(proper)}
    points = set(proper.ravel().tolist())
    for i in np.flatnonzero(repeated):
        own = frozenset(corners[i].tolist())
        covered[i] = own in edges if len(own) == 2 else next(iter(own)) in points
    return covered


def _edge_rows(corners: np.ndarray) -> list[list[int]]:
    return np.concatenate([corners[:, [0, 1]], corners[:, [1, 2]], corners[:, [2, 0]]]).tolist()


def _grouped(
    points: np.ndarray, corners: np.ndarray, axes: np.ndarray, signs: np.ndarray
) -> _Faces:
    """The triangles with those of one plane, connected through edges, in one group."""
    starts = np.arange(0, 3 * len(corners) + 1, 3)
    flat = corners.ravel()
    if not len(flat):
        return _Faces(starts, flat, axes, axes, signs)
    twin = twins(flat, np.roll(corners, -1, axis=1).ravel())
    flags = kernels.coplanar_twins(points, corners, axes, signs, twin)
    joined = np.flatnonzero(flags)
    group = joined_labels(len(corners), joined // 3, twin[joined] // 3)
    leaders = np.unique(group, return_index=True)[
        1
    ]  # one axis for each group: its first triangle's
    proper = axes != kernels.DEGENERATE
    return _Faces(
        starts, flat, np.where(proper, group, -1), axes[leaders][group], signs[leaders][group]
    )


def _with_needles_absorbed(points: np.ndarray, faces: _Faces) -> _Faces:
    if (faces.axes != kernels.DEGENERATE).all():
        return faces
    half_edges, parents = faces.half_edges(), np.arange(len(faces.axes))
    kernels.absorb_needles(points, half_edges, faces.axes, parents)
    return _without_covered_needles(points, _read_back(faces, half_edges, parents))


def _without_covered_needles(points: np.ndarray, faces: _Faces) -> _Faces:
    """Leaves out needles whose longest edge is an edge of a proper face that is not their only neighbour."""
    proper = np.repeat(faces.axes != kernels.DEGENERATE, np.diff(faces.starts))
    tails, heads = faces.ends()
    needles = np.flatnonzero(faces.axes == kernels.DEGENERATE)
    longest = np.empty((len(needles), 2), dtype=np.int64)
    for k, i in enumerate(needles):
        corners = faces.flat[faces.starts[i] : faces.starts[i + 1]]
        spread = np.abs(points[corners][:, None] - points[corners][None]).max(axis=2)
        longest[k] = corners[list(np.unravel_index(spread.argmax(), spread.shape))]
    edges = edge_keys(tails[proper], heads[proper], len(points))
    proper = np.ones(len(faces.axes), dtype=bool)
    proper[needles] = ~np.isin(edge_keys(longest[:, 0], longest[:, 1], len(points)), edges)
    return _selected(faces, proper)


def _selected(faces: _Faces, proper: np.ndarray) -> _Faces:
    sizes = np.diff(faces.starts)
    starts = np.concatenate([[0], np.cumsum(sizes[proper])])
    return _Faces(
        starts,
        faces.flat[np.repeat(proper, sizes)],
        faces.group[proper],
        faces.axes[proper],
        faces.signs[proper],
    )


def _read_back(faces: _Faces, half_edges: kernels.HalfEdges, parents: np.ndarray) -> _Faces:
    starts, flat, label = kernels.rings(half_edges, parents, len(faces.axes))
    return _Faces(starts, flat, faces.group[label], faces.axes[label], faces.signs[label])


def _merged(points: np.ndarray, faces: _Faces) -> _Faces:
    """Removes edges and then straight corners until nothing changes."""
    while True:
        before = len(faces.flat)
        faces = _without_straight_corners(points, _with_edges_removed(points, faces))
        if len(faces.flat) == before:
            return faces


def _with_edges_removed(points: np.ndarray, faces: _Faces) -> _Faces:
    if not len(faces.flat):
        return faces
    half_edges = faces.half_edges()
    tail, ahead, _, twin, face = half_edges
    candidates = np.flatnonzero(twin > np.arange(len(twin)))
    of_one_plane = faces.group[face[candidates]] == faces.group[face[twin[candidates]]]
    candidates = candidates[of_one_plane]
    lengths = points[tail[candidates]] - points[tail[ahead[candidates]]]
    scale = np.abs(lengths).max(initial=0.0) or 1.0
    order = candidates[np.argsort(-((lengths / scale) ** 2).sum(axis=1), kind="stable")]
    parents = np.arange(len(faces.axes))
    planes = kernels.FacePlanes(faces.group, faces.axes, faces.signs)
    kernels.merge_rings(points, order, half_edges, planes, parents)
    return _read_back(faces, half_edges, parents)


def _without_straight_corners(points: np.ndarray, faces: _Faces) -> _Faces:
    """Leaves out vertices that lie straight between the same two neighbours in every face that has them."""
    if not len(faces.flat):
        return faces
    removable = _straight_vertices(points, faces)
    sizes_at = np.bincount(faces.flat, minlength=len(points))
    while removable.any():
        staying = ~removable[faces.flat]
        thinner = _with_corners(faces, staying)
        clashing = _clashing_vertices(faces, staying, thinner, sizes_at)
        if not len(clashing):
            return thinner
        removable[clashing] = False
    return faces


def _with_corners(faces: _Faces, staying: np.ndarray) -> _Faces:
    starts = np.concatenate([[0], np.cumsum(staying)])[faces.starts]
    return faces._replace(starts=starts, flat=faces.flat[staying])


def _straight_vertices(points: np.ndarray, faces: _Faces) -> np.ndarray:
    ring = rings_of(faces.starts)
    before, after = faces.flat[ring.behind], faces.flat[ring.ahead]
    low, high = np.minimum(before, after), np.maximum(before, after)
    order = np.argsort(faces.flat, kind="stable")
    firsts = np.flatnonzero(np.diff(faces.flat[order], prepend=-1))
    same = np.ones(len(firsts), dtype=bool)
    for ends in (low, high):
        same &= np.minimum.reduceat(ends[order], firsts) == np.maximum.reduceat(ends[order], firsts)
    proper = (faces.axes != kernels.DEGENERATE)[ring.face].astype(np.int64)
    same &= np.minimum.reduceat(proper[order], firsts) == 1
    corners = order[firsts[same]]
    straight = kernels.straight_corners(
        points, before[corners], faces.flat[corners], after[corners]
    )
    removable = np.zeros(len(points), dtype=bool)
    removable[faces.flat[corners[straight]]] = True
    return removable


def _clashing_vertices(
    faces: _Faces, staying: np.ndarray, thinner: _Faces, n_corners: np.ndarray
) -> np.ndarray:
    """Vertices that must stay after all: without them, edges that were different would have the same two ends."""
    use = edge_use(*thinner.ends())
    n_uses = np.empty(len(thinner.flat), dtype=np.int64)
    n_uses[use.order] = np.repeat(use.n_uses, use.n_uses)
    followers = faces.flat[rings_of(faces.starts).ahead[staying]]  # the next one before the removal
    _, heads = thinner.ends()
    skipped = followers != heads
    return followers[skipped & (n_uses != n_corners[followers])]


def _compact(points: np.ndarray, faces: _Faces, n_dropped: int, n_degenerate: int) -> Polygons:
    used = np.unique(faces.flat)
    index = np.zeros(len(points), dtype=np.int64)
    index[used] = np.arange(len(used))
    flat = index[faces.flat]
    repeated = np.flatnonzero(flat == flat[rings_of(faces.starts).behind])
    vertices = np.concatenate([points[used], points[used][flat[repeated]]])
    flat[repeated] = len(used) + np.arange(len(repeated))  # no index twice in a row, same points
    return Polygons(vertices, faces.starts, flat, n_dropped, n_degenerate)
