"""A convex body by its corners, merged faces and half-spaces: what intersections are made of.

A `Polytope` that exists is solid: at least four corners, closed outward faces, a volume above 0. Graphs that
the kernels walk on are made when first asked for and then kept. Not for: concave bodies (`Polyhedron`).
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple, Self

import numpy as np

from clearance.errors import BadPolygon
from clearance.geometry.edges import fans_of, rings_of, twins
from clearance.geometry.polyhedron import Polyhedron
from clearance.geometry.polytope_hull import (
    NotSolid,
    checked_rows,
    corners_of_half_spaces,
    hull_faces,
)
from clearance.kernels.polytope.body import HEAD, LEAD, ROW, PackedBody
from clearance.kernels.polytope.exits import bound_cells, exit_cells
from clearance.kernels.polytope.faces import face_areas, ring_moments


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


FACES_PER_CELL = 0.5


@dataclass(frozen=True, eq=False, init=False)
class Polytope:
    """The convex hull of points.

    Args:
        points: (n, 3) [m], four or more, not in one plane; inner points are left out.

    Raises:
        EmptyMesh, BadShape, NotFinite: the points are none, not (n, 3), not finite.
        NotSolid: they lie in one plane.

    Exactness: the corners are the given numbers; faces that Qhull finds coplanar to rounding are merged.
    """

    vertices: np.ndarray
    face_starts: np.ndarray
    face_vertices: np.ndarray

    def __init__(self, points: np.ndarray) -> None:
        vertices, starts, flat = hull_faces(checked_rows(points, 3, "points"))
        for name, value in (
            ("vertices", vertices),
            ("face_starts", starts),
            ("face_vertices", flat),
        ):
            array = np.ascontiguousarray(value)
            array.setflags(write=False)
            object.__setattr__(self, name, array)
        if not self.volume > 0.0:
            raise NotSolid(f"the points hold a volume of {self.volume}", valid="a solid body")

    @classmethod
    def from_half_spaces(cls, rows: np.ndarray) -> Self:
        """The points x with rows[:, :3] x + rows[:, 3] <= 0; rows (n, 4).

        Raises:
            Unbounded: a direction is left open. NotSolid: nothing strictly inside. Else as the constructor.
        """
        return cls(corners_of_half_spaces(checked_rows(rows, 4, "half-spaces")))

    @classmethod
    def from_polyhedron(cls, body: Polyhedron) -> Self:
        """The convex body that a closed convex surface bounds.

        Raises:
            BadPolygon: the surface is not closed or not convex.
        """
        if body.volume is None:
            raise BadPolygon(
                "the surface is not closed and oriented", valid="a closed convex surface"
            )
        made = cls(body.vertices[np.unique(body.face_vertices)])
        if abs(abs(body.volume) - made.volume) > 1e-9 * made.volume:
            raise BadPolygon(
                f"the surface holds {abs(body.volume)} m^3, its hull {made.volume}",
                valid="a convex one",
            )
        return made

    def moved(self, pose: np.ndarray) -> Self:
        """The body after a rigid motion (4, 4): corners moved, faces the same; no hull is made again.

        A merged face stays as flat as rounding of the corners leaves it.
        """
        made = object.__new__(type(self))
        pose = np.asarray(pose, dtype=np.float64)
        corners = np.ascontiguousarray(self.vertices @ pose[:3, :3].T + pose[:3, 3])
        corners.setflags(write=False)
        for name, value in (
            ("vertices", corners),
            ("face_starts", self.face_starts),
            ("face_vertices", self.face_vertices),
            ("trivalent", self.trivalent),
            ("_twin", self._twin),
        ):
            object.__setattr__(made, name, value)
        return made

    @property
    def n_faces(self) -> int:
        """Number of merged faces."""
        return len(self.face_starts) - 1

    def face(self, i_face: int) -> np.ndarray:
        """The (k, 3) corners [m] of one face, counter-clockwise from outside."""
        return self.vertices[
            self.face_vertices[self.face_starts[i_face] : self.face_starts[i_face + 1]]
        ]

    def polyhedron(self) -> Polyhedron:
        """The same surface as a `Polyhedron`."""
        return Polyhedron.from_triangles(self.vertices, self.triangles())

    def triangles(self) -> np.ndarray:
        """(t, 3) vertex indices: each face cut from its first vertex, faces in order."""
        return self.face_vertices[fans_of(self.face_starts)[0]]

    @cached_property
    def size(self) -> float:
        """[m] the diagonal of the box around it."""
        return float(np.linalg.norm(np.ptp(self.vertices, axis=0)))

    @cached_property
    def box(self) -> np.ndarray:
        """(2, 3) [m] the least and the greatest coordinates."""
        return np.stack([self.vertices.min(axis=0), self.vertices.max(axis=0)])

    @cached_property
    def normals(self) -> np.ndarray:
        """(f, 3) outward unit normals: Newell's sums about a corner of each face."""
        firsts = self.face_starts[:-1]
        counts = np.diff(self.face_starts)
        off = self.vertices[self.face_vertices] - np.repeat(
            self.vertices[self.face_vertices[firsts]], counts, axis=0
        )
        ahead = rings_of(self.face_starts).ahead
        sums = np.add.reduceat(np.cross(off, off[ahead]), firsts, axis=0)
        return np.ascontiguousarray(sums / np.linalg.norm(sums, axis=1)[:, None])

    @cached_property
    def anchors(self) -> np.ndarray:
        """(f, 3) [m] of each face the corner that stands farthest out along its normal."""
        entries = np.repeat(np.arange(self.n_faces), np.diff(self.face_starts))
        corners = self.vertices[self.face_vertices]
        out = np.einsum("ij,ij->i", corners - self._middle, self.normals[entries])
        order = np.lexsort((-out, entries))
        return corners[order[self.face_starts[:-1]]]

    def offsets_about(self, origin: np.ndarray) -> np.ndarray:
        """(f,) [m] d in n.(x - origin) <= d for each face."""
        return np.einsum("ij,ij->i", self.normals, self.anchors - origin)

    @cached_property
    def half_spaces(self) -> np.ndarray:
        """(f, 4) rows (n, -d): the body is where rows[:, :3] x + rows[:, 3] <= 0."""
        return np.column_stack([self.normals, -self.offsets_about(np.zeros(3))])

    @cached_property
    def _middle(self) -> np.ndarray:
        return self.vertices.mean(axis=0)

    @cached_property
    def _moments(self) -> np.ndarray:
        return ring_moments(self.vertices, self.face_starts, self.face_vertices, self._middle)

    @property
    def volume(self) -> float:
        """[m^3]."""
        return float(self._moments[0])

    @cached_property
    def centroid(self) -> np.ndarray:
        """(3,) [m]."""
        return self._middle + self._moments[1:] / self._moments[0]

    @cached_property
    def face_widths(self) -> np.ndarray:
        """(f,) [m] the distance of each face's plane from the centroid."""
        return self.offsets_about(self.centroid)

    @cached_property
    def _twin(self) -> np.ndarray:
        """(e,) of each directed edge the entry of its reverse; `hull_faces` sees to it that each has one."""
        flat = self.face_vertices
        return twins(flat, flat[rings_of(self.face_starts).ahead])

    @cached_property
    def vertex_graph(self) -> tuple[np.ndarray, np.ndarray]:
        """(n + 1,) starts and (e,) neighbours of the vertices."""
        return vertex_graph(self.face_starts, self.face_vertices, len(self.vertices))

    @cached_property
    def face_graph(self) -> tuple[np.ndarray, np.ndarray]:
        """(f + 1,) starts and (e,) neighbours of the faces, over their edges in order."""
        entry_face = np.repeat(np.arange(self.n_faces), np.diff(self.face_starts))
        return self.face_starts, entry_face[self._twin]

    @cached_property
    def trivalent(self) -> TrivalentPolytope:
        """The body with each corner split into vertices of three faces."""
        return trivalent_form(self.face_starts, self.face_vertices, self._twin, len(self.vertices))

    @cached_property
    def packed(self) -> PackedBody:
        """The body as the kernels of `query` take it, with its map of directions."""
        rings, planes = (
            (self.face_starts, self.face_vertices),
            (self.normals, self.anchors, self.face_widths),
        )
        return packed(self.vertices, rings, self.centroid, planes, self.face_graph[1])

    @cached_property
    def packed_at(self) -> tuple[int, int, int, int]:
        """Where `packed` lies in memory (`kernels.polytope.bodies`), for as long as this body is held."""
        numbers, indices = self.packed
        return numbers.ctypes.data, len(numbers), indices.ctypes.data, len(indices)

    @cached_property
    def face_areas(self) -> np.ndarray:
        """(f, 4) area [m^2] and centroid [m] of each face."""
        return face_areas(self.packed)

    def prepared(self) -> Self:
        """Itself, with all that intersections need made ahead."""
        _ = (self.face_widths, self.vertex_graph, self.trivalent, self.face_areas, self.packed_at)
        _ = self.box
        return self


def packed(
    vertices: np.ndarray,
    rings: tuple[np.ndarray, np.ndarray],
    centroid: np.ndarray,
    planes: tuple[np.ndarray, np.ndarray, np.ndarray],
    neighbours: np.ndarray,
) -> PackedBody:
    """The arrays of a body with faces `rings` (starts, corners), planes (normals, a corner of each, distance
    from the centroid) and `neighbours`, the face over each edge, as the edges stand in `rings`.

    The layout is described in `kernels.polytope.body`."""
    normals, anchors, widths = planes
    size = np.linalg.norm(np.ptp(vertices, axis=0))
    f = len(normals)
    k = int(np.clip(np.ceil(np.sqrt(f / FACES_PER_CELL / 6.0)), 1, 128))
    round_from_body, body_from_round, pad = _rounding_map(vertices - centroid)
    cells, faces = exit_cells((vertices - centroid) @ round_from_body.T, *rings, k, pad)
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
    bound_cells(body, body_from_round)
    return body


def _rounding_map(corners: np.ndarray) -> tuple[np.ndarray, np.ndarray, float]:
    """(3, 3) to a frame in which the corners spread alike in all directions, back, and the cells' margin."""
    values, axes = np.linalg.eigh(corners.T @ corners / len(corners))
    spread = np.sqrt(np.maximum(values, values.max() * 1e-24))
    there = (axes / spread) @ axes.T
    back = (axes * spread) @ axes.T
    return there, back, 1e-9 + 1e-14 * float(spread.max() / spread.min())
