"""A solid as flat convex polygons: the one type in which all geometry is measured.

Faces are stored flat (`face_starts`, `face_vertices`), counter-clockwise as seen from outside where the
surface is consistently oriented. A `Polyhedron` that exists is valid: finite, with at least one face, every
index in range, every face flat and convex. Everything else is computed on first use, and then cached.
"""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any, Self

import numpy as np

from clearance.errors import BadDimension, BadShape, EmptyMesh, NotFinite
from clearance.geometry.coplanar import merge_coplanar
from clearance.geometry.edges import fans_of, rings_of
from clearance.geometry.faces import (
    check_flat_and_convex,
    check_indices,
    checked_vertices,
    flat_faces,
)
from clearance.geometry.nesting import inside_out_components, solids
from clearance.geometry.planes import Planes, planes_of
from clearance.geometry.pose import validated_pose
from clearance.geometry.topology import Topology, component_volumes, topology_of


def require_polyhedron(given: object, where: str) -> Polyhedron:
    """The argument, if it is a `Polyhedron`.

    Raises:
        BadShape: it is not.
    """
    if not isinstance(given, Polyhedron):
        raise BadShape(f"a {type(given).__name__} is no Polyhedron", where=where, valid=_REMEDIES)
    return given


_REMEDIES = (
    "cl.Polyhedron(vertices, faces), cl.box and its like, or Polyhedron.from_trimesh make one"
)


@dataclass(frozen=True, eq=False, init=False)
class Polyhedron:
    """A surface of flat convex polygons in its own body frame.

    Args:
        vertices: (n, 3) [m].
        faces: for each face the indices of its three or more vertices in order, as any sequence of
            sequences or as an (m, k) array.
        excess: [m] how far the surface may stand outside the shape it stands for (0: it is the shape).
        shortfall: [m] how far that shape may stand outside the surface: a case subtracts it from the clearance.

    Raises:
        EmptyMesh: no faces. NotFinite: NaN or infinity. BadShape: not (n, 3). BadDimension: `excess` or
            `shortfall` below 0.
        BadPolygon: fewer than three vertices, an index out of range or twice in a row, a face that is
            clearly warped or not convex (`tolerance.FLATNESS`).
    """

    vertices: np.ndarray
    face_starts: np.ndarray
    face_vertices: np.ndarray
    excess: float
    shortfall: float

    def __init__(
        self,
        vertices: np.ndarray,
        faces: Sequence[Sequence[int]] | np.ndarray,
        excess: float = 0.0,
        shortfall: float = 0.0,
    ) -> None:
        points = checked_vertices(vertices)
        starts, flat = flat_faces(faces)
        check_indices(len(points), starts, flat)
        check_flat_and_convex(points, starts, flat)
        self._fill(points, starts, flat, excess, shortfall)

    def __repr__(self) -> str:
        return f"<Polyhedron: vertices {len(self.vertices)}, polygons {len(self.face_starts) - 1}>"

    def _fill(
        self,
        vertices: np.ndarray,
        starts: np.ndarray,
        flat: np.ndarray,
        excess: float,
        shortfall: float,
    ) -> None:
        for bound, given in (("excess", excess), ("shortfall", shortfall)):
            if not 0.0 <= given < np.inf:
                raise BadDimension(f"{bound} is {given}", valid="0 or more [m]")
            object.__setattr__(self, bound, float(given))
        for name, value, kind in (
            ("vertices", vertices, np.float64),
            ("face_starts", starts, np.int64),
            ("face_vertices", flat, np.int64),
        ):
            array = np.ascontiguousarray(value, dtype=kind)
            array.setflags(write=False)
            object.__setattr__(self, name, array)

    def __setstate__(self, state: dict[str, Any]) -> None:
        """A copy from another process, whose arrays come back as writable."""
        self.__dict__.update(state)
        for array in (self.vertices, self.face_starts, self.face_vertices):
            array.setflags(write=False)

    @classmethod
    def _of_valid(
        cls,
        vertices: np.ndarray,
        starts: np.ndarray,
        flat: np.ndarray,
        excess: float = 0.0,
        shortfall: float = 0.0,
    ) -> Self:
        """The polyhedron of flat faces that are known to be valid."""
        made = cls.__new__(cls)
        made._fill(vertices, starts, flat, excess, shortfall)
        return made

    @classmethod
    def from_triangles(
        cls,
        vertices: np.ndarray,
        triangles: np.ndarray,
        excess: float = 0.0,
        shortfall: float = 0.0,
    ) -> Self:
        """The surface of triangles, with coplanar neighbours merged exactly into convex polygons.

        Equal vertices become one; zero-area triangles that a proper face covers are dropped, others stay
        (`coplanar.merge_coplanar` also counts them).

        Args:
            vertices: (n, 3) [m]. triangles: (m, 3) indices.

        Raises:
            EmptyMesh, NotFinite, BadShape, BadPolygon: as for the constructor; repeated indices are allowed.
        """
        points = checked_vertices(vertices)
        starts, flat = flat_faces(triangles)
        check_indices(len(points), starts, flat, allow_repeated=True)
        merged = merge_coplanar(points, flat.reshape(-1, 3))
        return cls._of_valid(
            merged.vertices, merged.face_starts, merged.face_vertices, excess, shortfall
        )

    @classmethod
    def from_trimesh(cls, mesh: Any) -> Self:
        """The surface of a `trimesh.Trimesh`, or of anything with `vertices` (n, 3) [m] and `faces` (m, 3).

        Raises:
            EmptyMesh: no such attributes or no faces. BadDimension: it says another unit than metres. BadShape: a
                round primitive, whose facets lie inside it; otherwise as `from_triangles`.
        """
        kind = type(mesh).__name__
        if not hasattr(mesh, "vertices") or not hasattr(mesh, "faces"):
            raise EmptyMesh(f"a {kind} has no vertices and faces", valid="a trimesh.Trimesh")
        units = getattr(mesh, "units", None)
        if units not in (None, "m", "meter", "meters"):
            raise BadDimension(
                f"the mesh has units {units!r:.40}", valid='metres: mesh.convert_units("meters")'
            )
        if hasattr(getattr(mesh, "primitive", None), "radius"):
            raise BadShape(
                f"the facets of a {kind} of trimesh lie inside it", valid=f"cl.{kind.lower()}"
            )
        return cls.from_triangles(np.asarray(mesh.vertices), np.asarray(mesh.faces))

    @property
    def ball_radius(self) -> float:
        """[m] of the balls about the points of a cloud; 0: of a surface there are none."""
        return 0.0

    @property
    def n_faces(self) -> int:
        """Number of polygons."""
        return len(self.face_starts) - 1

    @property
    def n_triangles(self) -> int:
        """Number of triangles that the polygons would be cut into."""
        return len(self.face_vertices) - 2 * self.n_faces

    def face(self, i_face: int) -> np.ndarray:
        """The (k, 3) corners [m] of one face, in order."""
        return self.vertices[
            self.face_vertices[self.face_starts[i_face] : self.face_starts[i_face + 1]]
        ]

    def triangles(self) -> np.ndarray:
        """(n_triangles, 3) vertex indices: each face cut from its first vertex, faces in order."""
        return self.face_vertices[self._fans[0]]

    @property
    def triangle_faces(self) -> np.ndarray:
        """(n_triangles,) the face that each of `triangles()` is cut from."""
        return self._fans[1]

    @cached_property
    def _fans(self) -> tuple[np.ndarray, np.ndarray]:
        return fans_of(self.face_starts)

    @cached_property
    def bounds(self) -> np.ndarray:
        """(2, 3) [m] the least and greatest coordinates of the faces in the body frame."""
        used = self.vertices[self.face_vertices]
        return np.array([used.min(axis=0), used.max(axis=0)])

    @property
    def box_corners(self) -> np.ndarray:
        """(8, 3) [m] the corners of `bounds`."""
        return np.array([*itertools.product(*self.bounds.T)])

    @cached_property
    def _planes(self) -> Planes:
        return planes_of(self.vertices, self.face_starts, self.face_vertices)

    @property
    def normals(self) -> np.ndarray:
        """(m, 3) unit normals, outward where the surface is closed and outward oriented; zero without area."""
        return self._planes.normals

    @property
    def centres(self) -> np.ndarray:
        """(m, 3) [m] the mean of each face's corners."""
        return self._planes.centres

    @property
    def radii(self) -> np.ndarray:
        """(m,) [m] from each face's centre to its farthest corner."""
        return self._planes.radii

    @cached_property
    def _topology(self) -> Topology:
        return topology_of(self.vertices, self.face_starts, self.face_vertices)

    @property
    def closed(self) -> bool:
        """True if every edge is shared by two faces, or by an even number of them."""
        return self._topology.closed

    @property
    def oriented(self) -> bool:
        """True if faces that share an edge run along it in opposite directions."""
        return self._topology.oriented

    @property
    def manifold(self) -> bool:
        """True if no edge belongs to more than two faces."""
        return self._topology.manifold

    @property
    def face_component(self) -> np.ndarray:
        """(m,) the connected component that each face is in; components share no edge."""
        return self._topology.face_component

    @property
    def component_closed(self) -> np.ndarray:
        """(k,) True for the components that are closed and consistently oriented: they have an inside."""
        return self._topology.component_closed

    @property
    def component_two_sided(self) -> np.ndarray:
        """(k,) True for closed components that have each face once for each side: nothing is inside them."""
        return self._topology.component_two_sided

    @cached_property
    def volume(self) -> float | None:
        """[m^3] the enclosed volume, less cavities; None unless the surface is closed and oriented.

        What several components enclose counts for each of them; `cl.contact` counts it once.
        """
        if not self.closed or not self.oriented:
            return None
        component = self.face_component[self.triangle_faces]
        volumes = component_volumes(
            self.vertices, self.triangles(), component, len(self.component_closed)
        )
        return float(volumes.sum())

    def solids(self) -> list[np.ndarray]:
        """The triangles (k, 3) of the solids whose union a closed body is; one but where components overlap."""
        component = self.face_component[self.triangle_faces]
        return solids(self.vertices, self.triangles(), component, len(self.component_closed))

    @cached_property
    def component_inside_out(self) -> np.ndarray:
        """(k,) True for the closed components that are inside out; cavities and two-sided ones are not."""
        component = self.face_component[self.triangle_faces]
        encloses = self.component_closed & ~self.component_two_sided
        return inside_out_components(self.vertices, self.triangles(), component, encloses)

    def outward(self) -> Polyhedron:
        """The surface with closed components that are inside out turned round, as they nest (`nesting`)."""
        wrong = self.component_inside_out
        return self._with_reversed(wrong[self.face_component]) if wrong.any() else self

    def flipped(self) -> Polyhedron:
        """The surface with inside and outside exchanged."""
        return self._with_reversed(np.ones(self.n_faces, dtype=bool))

    def _with_reversed(self, faces: np.ndarray) -> Polyhedron:
        """The surface with the faces where (m,) `faces` is True reversed."""
        ring = rings_of(self.face_starts)
        entries = np.arange(len(self.face_vertices))
        mirrored = self.face_starts[ring.face] + self.face_starts[ring.face + 1] - 1 - entries
        flat = self.face_vertices[np.where(faces[ring.face], mirrored, entries)]
        return self._of_valid(self.vertices, self.face_starts, flat, self.excess, self.shortfall)

    def transformed(self, pose: np.ndarray) -> Polyhedron:
        """The surface moved by a (4, 4) rigid motion [m], each coordinate to a few roundings.

        Raises:
            BadPose: not a rigid motion.
        """
        pose = validated_pose(pose)
        vertices = self.vertices @ pose[:3, :3].T + pose[:3, 3]
        return self._of_valid(
            vertices, self.face_starts, self.face_vertices, self.excess, self.shortfall
        )

    def scaled(self, factor: float | Sequence[float]) -> Polyhedron:
        """The surface with its coordinates times one factor, or times three; a mirrored one stays outward.

        Raises:
            BadDimension: a factor that is zero or not finite, or is not one or three numbers.
        """
        factors = np.asarray(factor, dtype=np.float64)
        if (
            factors.shape not in ((), (1,), (3,))
            or not np.isfinite(factors).all()
            or not factors.all()
        ):
            raise BadDimension(
                f"scale is {factor!r:.60}", valid="one or three numbers other than 0"
            )
        factors = np.broadcast_to(factors, 3)
        vertices = self.vertices * factors
        if not np.isfinite(vertices).all():
            raise NotFinite(f"scale {factors.tolist()} is too large", valid="finite coordinates")
        grown = (
            np.nextafter(bound * np.abs(factors).max(), np.inf) if bound else 0.0
            for bound in (self.excess, self.shortfall)
        )
        made = self._of_valid(vertices, self.face_starts, self.face_vertices, *grown)
        return made.flipped() if np.prod(np.sign(factors)) < 0.0 else made

    @staticmethod
    def merged(parts: Sequence[Polyhedron]) -> Polyhedron:
        """All faces of several surfaces as one; the greatest excess and shortfall of them are its own.

        Raises:
            EmptyMesh: no parts.
        """
        if not parts:
            raise EmptyMesh("there are no surfaces to join", valid="at least one")
        shifts = np.cumsum([0] + [len(part.vertices) for part in parts])
        corners = np.cumsum([0] + [len(part.face_vertices) for part in parts])
        starts = [
            part.face_starts[:-1] + shift for part, shift in zip(parts, corners, strict=False)
        ]
        return Polyhedron._of_valid(
            np.concatenate([part.vertices for part in parts]),
            np.concatenate([*starts, corners[-1:]]),
            np.concatenate(
                [part.face_vertices + shift for part, shift in zip(parts, shifts, strict=False)]
            ),
            max(part.excess for part in parts),
            max(part.shortfall for part in parts),
        )
