"""The solids of one case's mesh files: each file is made once for each scale and up axis."""

from __future__ import annotations

import os
from pathlib import Path

from clearance.load.collada_file import UpAxis
from clearance.load.input_files import InputFiles
from clearance.load.mesh import LoadedMesh, mesh_from_bytes
from clearance.tolerance import TESSELLATION

Scale = tuple[float, float, float]


class MeshStore:
    """Loads meshes through `files` and keeps them.

    Args:
        files: reads the files and remembers their checksums.
    """

    def __init__(self, files: InputFiles) -> None:
        self.files = files
        self._loaded: dict[tuple[str, Scale, UpAxis, float], LoadedMesh] = {}

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
            BadInput: as `mesh.read_mesh`, with the path as it is shown.
        """
        key = (os.path.abspath(path), scale, up_axis, tolerance)
        if key not in self._loaded:
            data = self.files.read(path)
            shown = self.files.shown(path)
            self._loaded[key] = mesh_from_bytes(data, shown, scale, up_axis, tolerance)
        return self._loaded[key]
