"""The bodies of one case's files of meshes and points: each is made once for each scale and up axis."""

from __future__ import annotations

import os
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from clearance.errors import BadSyntax
from clearance.formats.files.input_files import InputFiles
from clearance.formats.mesh.mesh_file import (
    LoadedMesh,
    mesh_from_bytes,
    triangles_from_bytes,
    vertices_from_bytes,
)
from clearance.formats.mesh.triangles import UpAxis, scaled_points
from clearance.tolerance import TESSELLATION

if TYPE_CHECKING:
    from clearance.formats.cloud.formats import LoadedCloud

Scale = tuple[float, float, float]


class MeshStore:
    """Loads meshes and clouds through `files` and keeps them.

    Args:
        files: reads the files and remembers their checksums.
    """

    def __init__(self, files: InputFiles) -> None:
        self.files = files
        self._loaded: dict[tuple[str, Scale, UpAxis, float], LoadedMesh] = {}
        self._points: dict[tuple[str, Scale, UpAxis, bool], np.ndarray] = {}
        self._clouds: dict[tuple[str, float, Scale, bool], LoadedCloud] = {}

    def load(
        self,
        path: Path,
        scale: Scale,
        up_axis: UpAxis = "file",
        tolerance: float = TESSELLATION,
    ) -> LoadedMesh:
        """The solid in a mesh file; the same object for the same file, scale, up axis and tolerance.

        Args:
            tolerance: [m] how far the facets of a CAD file may be off its surface.

        Raises:
            BadInput: as `mesh.mesh_file.read_mesh`, with the path as it is shown.
        """
        key = (os.path.abspath(path), scale, up_axis, tolerance)
        if key not in self._loaded:
            data = self.files.read(path)
            shown = self.files.shown(path)
            self._loaded[key] = mesh_from_bytes(data, shown, scale, up_axis, tolerance)
        return self._loaded[key]

    def points(
        self, path: Path, scale: Scale, up_axis: UpAxis, largest: float, *, loosely: bool = False
    ) -> np.ndarray:
        """(n, 3) [m] corners of the surface in a mesh file, all of its hull among them; no solid is made of it.

        Args:
            largest: [bytes] a larger file is refused, unless it is loaded.
            loosely: points that no face uses may be among them, which is faster.

        Raises:
            BadInput: as `load`, or too large; loosely, not where the faces alone are at fault.
        """
        file = os.path.abspath(path)
        if (loaded := self._loaded.get((file, scale, up_axis, TESSELLATION))) is not None:
            return loaded.shape.vertices
        key = (file, scale, up_axis, loosely)
        if key not in self._points:
            data, shown = self.files.read(path), self.files.shown(path)
            if len(data) > largest:
                raise BadSyntax(f"{len(data):,} bytes", where=shown, valid=f"up to {largest:,}")
            if loosely:
                points = vertices_from_bytes(data, shown, up_axis)
            else:
                points = triangles_from_bytes(data, shown, up_axis).vertices
            self._points[key], _ = scaled_points(points, scale)
        return self._points[key]

    def load_points(
        self, path: Path, radius: float, scale: Scale, *, in_millimetres: bool = False
    ) -> LoadedCloud:
        """The cloud in a file of points; the same object for the same file, radius, scale and unit.

        Raises:
            BadInput: as `cloud.formats.read_points`, with the path as it is shown.
        """
        key = (os.path.abspath(path), radius, scale, in_millimetres)
        if key not in self._clouds:
            from clearance.formats.cloud.formats import cloud_from_bytes

            data = self.files.read(path)
            self._clouds[key] = cloud_from_bytes(
                data, self.files.shown(path), radius, scale, in_millimetres=in_millimetres
            )
        return self._clouds[key]
