"""Polyhedra in the form that kernels search: owned features, plane data and the bounding volume tree.

Built once a polyhedron and cached in it; `join` lays several behind one another so that one compiled call
can serve a whole robot and scene. A point of a cloud is a face of one corner, which it owns. It has no edge, no
normal and no cone, so that the search for surfaces serves clouds as it is.
"""

from __future__ import annotations

import weakref
from collections.abc import Sequence

import numpy as np

from clearance.geometry.closing import Closing, closing_of
from clearance.geometry.cones import face_cones, no_cones, node_cones
from clearance.geometry.copies import Copies, copies_of
from clearance.geometry.edges import Ring, edge_keys, rings_of, twins
from clearance.geometry.point_cloud import PointCloud
from clearance.geometry.polyhedron import Polyhedron
from clearance.geometry.surface_cache import cached_surface
from clearance.kernels.arithmetic.lanes import WIDTH
from clearance.kernels.mesh.face_planes import face_planes
from clearance.kernels.mesh.surface import ANYTHING, LISTED, Surface
from clearance.kernels.mesh.tree_build import build_tree, most_groups
from clearance.ordered import ascending

_built: weakref.WeakKeyDictionary[Polyhedron, Surface] = weakref.WeakKeyDictionary()
_joined: weakref.WeakKeyDictionary[Polyhedron, tuple[tuple[weakref.ref, ...], Surface]]
_joined = weakref.WeakKeyDictionary()

LARGE = 200
"""Faces of a shape in a scene whose searchable form is cached for later runs; others are built in 1 to 2 ms."""

_NO_CAPS = np.empty((0, 3))


def surface_of(shape: Polyhedron) -> Surface:
    """The searchable form of one polyhedron, built at the first call."""
    if shape not in _built:
        _built[shape] = cloud_surface(shape) if isinstance(shape, PointCloud) else _build(shape)
    return _built[shape]


def join(shapes: Sequence[Polyhedron]) -> Surface:
    """The searchable form of several polyhedra; `roots[i]` is the tree of `shapes[i]`.

    The last one that begins with the same shape is cached, for runs of one case after another.
    """
    if len(shapes) == 1:
        return surface_of(shapes[0])
    known = _joined.get(shapes[0])
    if known is not None and len(known[0]) == len(shapes):
        if all(ref() is shape for ref, shape in zip(known[0], shapes, strict=True)):
            return known[1]
    for shape in shapes:
        if shape not in _built and shape.n_faces >= LARGE and not isinstance(shape, PointCloud):
            _built[shape] = cached_surface(shape, _build)
    joined = _join([surface_of(shape) for shape in shapes])
    _joined[shapes[0]] = (tuple(weakref.ref(shape) for shape in shapes), joined)
    return joined


_ROWS_OF = {
    "face_vertices": "vertices", "owned_vertices": "vertices", "owned_edges": "vertices",
    "probes": "vertices", "roots": "children",
}  # fmt: skip
"""Columns of a `Surface` that are rows of another one."""

_STARTS_OF = {
    "face_starts": "face_vertices", "vertex_starts": "owned_vertices", "edge_starts": "owned_edges",
    "probe_starts": "probes", "cap_starts": "caps",
}  # fmt: skip
"""Columns that say where each item's rows of another one begin, and after the last where they end."""


def _join(parts: Sequence[Surface]) -> Surface:
    n_before = {
        name: _offsets([len(getattr(part, name)) for part in parts]) for name in Surface._fields
    }

    def joined(name: str) -> np.ndarray:
        columns = [getattr(part, name) for part in parts]
        if name == "children":
            return _joined_children(parts, n_before[name] // WIDTH, n_before["normals"])
        if name in _STARTS_OF:
            items = n_before[_STARTS_OF[name]]
            rows = [column[:-1] + n for column, n in zip(columns, items, strict=True)]
            return np.concatenate([*rows, columns[-1][-1:] + items[-1]])
        if name in _ROWS_OF:
            shifts = n_before[_ROWS_OF[name]]
            columns = [column + n for column, n in zip(columns, shifts, strict=True)]
        return np.concatenate(columns)

    return Surface(*map(joined, Surface._fields))


def _offsets(lengths: Sequence[int]) -> np.ndarray:
    return np.concatenate([[0], np.cumsum(lengths)[:-1]]).astype(np.int64)


def _joined_children(
    parts: Sequence[Surface], group_shifts: np.ndarray, face_shifts: np.ndarray
) -> np.ndarray:
    rows = []
    for part, group_shift, face_shift in zip(parts, group_shifts, face_shifts, strict=True):
        children = part.children.copy()
        leaf = children[:, 1] == 0
        children[:, 0] += np.where(leaf, face_shift, group_shift).astype(np.int32)
        rows.append(children)
    return np.concatenate(rows)


def _build(shape: Polyhedron) -> Surface:
    vertices, weld = np.unique(
        shape.vertices + 0.0, axis=0, return_inverse=True
    )  # + 0.0: -0.0 is 0.0
    corners = weld.reshape(-1)[shape.face_vertices].astype(np.int64)
    starts = shape.face_starts.copy()
    ring = rings_of(starts)
    normals, blunt, width = (
        np.empty((shape.n_faces, 3)),
        np.empty(shape.n_faces),
        np.empty(shape.n_faces),
    )
    bent = np.empty(shape.n_faces, dtype=np.bool_)
    face_planes(vertices, starts, corners, normals, blunt, width, bent)
    first_corners, vertex_starts = _owned(corners, ring.face, shape.n_faces)
    heads = corners[ring.ahead]
    edges = np.stack([corners, heads], axis=1)
    keys = edge_keys(corners, heads, len(vertices))
    first_uses, edge_starts = _owned(keys, ring.face, shape.n_faces)
    owned_edges = np.sort(edges[first_uses], axis=1)
    owned_edges, edge_starts = _with_diagonals(
        owned_edges, edge_starts, corners, ring.face, starts, bent
    )
    twin = twins(corners, heads)
    copies = copies_of(corners, starts, ring, twin, bent)
    centres, boxes, children = nodes_over(vertices[corners], starts, copies.kept)
    _, first_faces = np.unique(shape.face_component, return_index=True)
    probes = corners[starts[first_faces]]
    closing = closing_of(shape)
    caps = _NO_CAPS if closing is None else closing.caps.reshape(-1, 3)
    return Surface(
        vertices=vertices,
        exact=vertices,
        face_starts=starts,
        face_vertices=corners,
        normals=normals,
        blunt=blunt,
        width=width,
        bent=bent,
        corner_normals=_corner_normals(vertices, edges, normals[ring.face]),
        vertex_starts=vertex_starts,
        owned_vertices=corners[first_corners],
        edge_starts=edge_starts,
        owned_edges=owned_edges,
        owns=_owns(first_corners, first_uses, ring.face, starts, bent),
        centres=centres,
        boxes=boxes,
        cones=node_cones(
            children, boxes, *_cones(copies.kept, ring, twin, vertices, corners, normals, bent)
        ),
        children=children,
        roots=np.zeros(1, dtype=np.int64),
        probe_starts=np.array([0, len(probes)]),
        probes=probes,
        turns=_turns(copies, shape.component_closed[shape.face_component], closing),
        cap_starts=np.array([0, len(caps)]),
        caps=caps,
        radii=np.zeros(1),
    )


def _unit(vectors: np.ndarray) -> np.ndarray:
    """The vectors at length 1; zero vectors stay zero. Scaled first, so that nothing under- or overflows."""
    largest = np.abs(vectors).max(axis=1, keepdims=True)
    scaled = np.divide(vectors, largest, out=np.zeros_like(vectors), where=largest > 0.0)
    length = np.sqrt((scaled**2).sum(axis=1, keepdims=True))
    return np.divide(scaled, length, out=np.zeros_like(vectors), where=length > 0.0)


def _corner_normals(vertices: np.ndarray, edges: np.ndarray, normals: np.ndarray) -> np.ndarray:
    """(c, 3) unit vectors in the faces' planes, outward across the edge that starts at each corner."""
    return _unit(np.cross(vertices[edges[:, 1]] - vertices[edges[:, 0]], normals))


def _owned(
    features: np.ndarray, face_of_corner: np.ndarray, n_faces: int
) -> tuple[np.ndarray, np.ndarray]:
    """The corners where features (vertices or edges, by number) first occur, and where each face's begin."""
    _, first = np.unique(features, return_index=True)
    first.sort()
    counts = np.bincount(face_of_corner[first], minlength=n_faces)
    return first, np.concatenate([[0], np.cumsum(counts)]).astype(np.int64)


def _with_diagonals(
    owned: np.ndarray, owned_starts: np.ndarray,
    corners: np.ndarray, face: np.ndarray, starts: np.ndarray, bent: np.ndarray,
) -> tuple[np.ndarray, np.ndarray]:  # fmt: skip
    """`Surface.owned_edges` and `edge_starts`: after the edges of a bent face the diagonals of its fan."""
    if not bent.any():
        return owned, owned_starts
    place = np.arange(len(corners)) - starts[face]
    at = np.flatnonzero(bent[face] & (place >= 2) & (place < np.diff(starts)[face] - 1))
    diagonals = np.stack([corners[starts[face[at]]], corners[at]], axis=1)
    of_face = np.concatenate([np.repeat(np.arange(len(bent)), np.diff(owned_starts)), face[at]])
    order = np.argsort(of_face, kind="stable")
    counts = np.bincount(of_face, minlength=len(bent))
    both = np.concatenate([owned, diagonals])
    return both[order], np.concatenate([[0], np.cumsum(counts)]).astype(np.int64)


def _owns(
    first_corners: np.ndarray,
    first_uses: np.ndarray,
    face: np.ndarray,
    starts: np.ndarray,
    bent: np.ndarray,
) -> np.ndarray:
    """(f,) `Surface.owns`, from the corners whose vertex their face owns, and those where an edge of it starts."""
    place = np.arange(len(face)) - starts[face]
    bit = 1 << np.minimum(place, LISTED - 1)
    owned = np.zeros(len(face), dtype=np.int64)
    owned[first_corners] = bit[first_corners]
    owned[first_uses] |= bit[first_uses] << LISTED
    bits = np.bitwise_or.reduceat(owned, starts[:-1])
    return np.where(bent | (np.diff(starts) > LISTED), ANYTHING, bits).astype(np.uint16)


def _turns(copies: Copies, closed: np.ndarray, closing: Closing | None) -> np.ndarray:
    """(f,) `Surface.turns`, from whether each face is of a closed component, and how others close."""
    turns = np.zeros(len(closed), dtype=np.int32)
    np.add.at(turns, copies.first, copies.way * closed)
    return turns if closing is None else turns + closing.turns.astype(np.int32)


def _cones(
    chosen: np.ndarray, ring: Ring, twin: np.ndarray, vertices: np.ndarray, corners: np.ndarray,
    normals: np.ndarray, bent: np.ndarray,
) -> tuple[np.ndarray, np.ndarray]:  # fmt: skip
    """`face_cones` of the chosen faces, as if there were no others."""
    n_faces = len(bent)
    if len(chosen) == n_faces:
        return face_cones(ring, twin, vertices, corners, normals, bent)
    remaining = corners[np.isin(ring.face, chosen)]
    ring = rings_of(np.concatenate([[0], np.cumsum(np.bincount(ring.face)[chosen])]))
    axes, angles = np.zeros((3, n_faces)), np.full(n_faces, np.inf)
    twin = twins(remaining, remaining[ring.ahead])
    axes[:, chosen], angles[chosen] = face_cones(
        ring, twin, vertices, remaining, normals[chosen], bent[chosen]
    )
    return axes, angles


_OWNS_ITS_CORNER = 1

_ROUNDED_UP = 1.0 + 2.0**-21


def cloud_surface(cloud: PointCloud) -> Surface:
    """The searchable form of a cloud."""
    points, n = cloud.vertices.copy(), cloud.n_points
    starts, each = np.arange(n + 1), np.arange(n)
    nothing = np.zeros((n, 3))
    centres, boxes, children = nodes_over(points, starts, each)
    _, firsts = np.unique(cloud.face_component, return_index=True)
    probes = ascending(np.sort(firsts))  # halved to test whether a point is one
    return Surface(
        vertices=points,
        exact=points,
        face_starts=starts,
        face_vertices=each,
        normals=nothing,
        blunt=np.ones(n),
        width=np.zeros(n),
        bent=np.zeros(n, dtype=np.bool_),
        corner_normals=nothing,
        vertex_starts=starts,
        owned_vertices=each,
        edge_starts=np.zeros(n + 1, dtype=np.int64),
        owned_edges=np.empty((0, 2), dtype=np.int64),
        owns=np.full(n, _OWNS_ITS_CORNER, dtype=np.uint16),
        centres=centres,
        boxes=_with_balls(boxes, cloud.ball_radius),
        cones=no_cones(boxes),
        children=children,
        roots=np.zeros(1, dtype=np.int64),
        probe_starts=np.array([0, len(probes)]),
        probes=probes.astype(np.int64),
        turns=np.zeros(n, dtype=np.int32),
        cap_starts=np.zeros(2, dtype=np.int64),
        caps=np.empty((0, 3)),
        radii=np.array([cloud.ball_radius]),
    )


def _with_balls(boxes: np.ndarray, radius: float) -> np.ndarray:
    """The boxes, with that of the root and its equivalents large enough for the balls."""
    grown = boxes.copy()
    grown[9:12, :WIDTH] += np.float32(radius * _ROUNDED_UP)
    grown[9:12, :WIDTH] *= np.float32(_ROUNDED_UP)
    return grown


def nodes_over(
    corner_points: np.ndarray, starts: np.ndarray, faces: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """`Surface.centres`, `boxes` and `children` of a tree over some `faces` (k,).

    Args:
        corner_points: (c, 3) [m] of all faces, which begin at `starts` (f + 1,).
    """
    most = most_groups(len(faces))
    centres = np.empty((3 * most, WIDTH))
    boxes = np.empty((12 * most, WIDTH), dtype=np.float32)
    children = np.empty((WIDTH * most, 2), dtype=np.int32)
    n = build_tree(corner_points, starts, faces.copy(), centres, boxes, children)
    return centres[: 3 * n].copy(), boxes[: 12 * n].copy(), children[: WIDTH * n].copy()
