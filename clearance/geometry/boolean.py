"""Closed meshes that share a region, or grow together: the adapter of manifold3d.

manifold3d works on closed surfaces with two faces an edge, in float64, and answers with such a surface
again. Input that it cannot take is refused in one line. Not for: convex bodies, which `query.intersection` cuts
exactly.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from clearance.errors import BadPolygon
from clearance.extras import importing, is_installed


@dataclass(frozen=True, eq=False)
class ClosedMesh:
    """A closed surface of triangles, outward, perhaps empty.

    Attributes:
        vertices: (n, 3) [m]. triangles: (m, 3) indices.
    """

    vertices: np.ndarray
    triangles: np.ndarray

    @classmethod
    def empty(cls) -> ClosedMesh:
        """The surface of nothing."""
        return cls(np.zeros((0, 3)), np.zeros((0, 3), dtype=np.int64))

    @property
    def is_empty(self) -> bool:
        """True if there is no triangle."""
        return len(self.triangles) == 0

    @cached_property
    def _corners(self) -> np.ndarray:
        """(m, 3, 3) corners about the middle of the box, so that far origins cost no digits."""
        return self.vertices[self.triangles] - self._middle

    @cached_property
    def _middle(self) -> np.ndarray:
        if self.is_empty:
            return np.zeros(3)
        return 0.5 * (self.vertices.min(axis=0) + self.vertices.max(axis=0))

    @cached_property
    def _shares(self) -> np.ndarray:
        """(m,) [m^3] the signed volume of each triangle's tetrahedron with the middle."""
        a, b, c = np.moveaxis(self._corners, 1, 0)
        return np.einsum("ij,ij->i", a, np.cross(b, c)) / 6.0

    @property
    def volume(self) -> float:
        """[m^3] 0 or more: rounding below nothing is nothing."""
        return max(0.0, float(self._shares.sum()))

    @property
    def centroid(self) -> np.ndarray:
        """(3,) [m] of the region; of its corners where it has no volume."""
        total = self._shares.sum()
        if not total > 0.0:
            return self.vertices.mean(axis=0) if len(self.vertices) else np.full(3, np.nan)
        moment = np.einsum("i,ij->j", self._shares, self._corners.sum(axis=1)) / 4.0
        return self._middle + moment / total


def available() -> bool:
    """True if manifold3d is installed."""
    return is_installed("manifold3d")


def solid(vertices: np.ndarray, triangles: np.ndarray) -> Any:
    """manifold3d's solid of a closed, outward surface; vertices (n, 3) [m], triangles (m, 3).

    Raises:
        Unavailable: manifold3d is not installed. BadPolygon: the surface is none that it can take.
    """
    manifold = _library()
    mesh = manifold.Mesh64(  # copies, because it takes no read-only arrays
        vert_properties=np.array(vertices, dtype=np.float64, order="C"),
        tri_verts=np.array(triangles, dtype=np.uint64, order="C"),
    )
    made = manifold.Manifold(mesh)
    if made.status() != manifold.Error.NoError:
        raise BadPolygon(
            f"the surface bounds no solid ({str(made.status()).split('.')[-1]})",
            valid="a closed, outward surface with two faces at every edge",
        )
    return made


def evaluated(one: Any) -> Any:
    """The same solid, evaluated now: else its parts are evaluated in every boolean with it."""
    one.num_tri()
    return one


def block(box: np.ndarray) -> Any:
    """The solid of an axis-parallel box (2, 3) [m]."""
    made = _library().Manifold.cube(tuple((box[1] - box[0]).tolist()))
    return made.translate(tuple(box[0].tolist()))


def union(solids: Sequence[Any]) -> Any:
    """The union of the solids."""
    manifold = _library()
    return manifold.Manifold.batch_boolean(list(solids), manifold.OpType.Add)


def moved(one: Any, pose: np.ndarray) -> Any:
    """The solid after a rigid motion (4, 4) [m]."""
    return one.transform(np.array(pose[:3], dtype=np.float64, order="C"))


def mesh_of(one: Any) -> ClosedMesh:
    """The surface of a solid."""
    mesh = one.to_mesh64()
    vertices = np.array(mesh.vert_properties, dtype=np.float64)[:, :3]
    return ClosedMesh(vertices, np.array(mesh.tri_verts, dtype=np.int64).reshape(-1, 3))


def _library() -> Any:
    with importing("contact", "a Boolean of solids"):
        import manifold3d
    return manifold3d
