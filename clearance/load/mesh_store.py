"""The solids of one case's mesh files: each file is made once for each scale and up axis."""

from __future__ import annotations

import os
from dataclasses import replace
from pathlib import Path

from clearance.load.collada_file import UpAxis
from clearance.load.input_files import InputFiles
from clearance.load.mesh import LoadedMesh, mesh_from_bytes
from clearance.load.plausibility import scale_notes

Scale = tuple[float, float, float]


class MeshStore:
    """Loads meshes through `files` and keeps them.

    Args:
        files: reads the files and remembers their checksums.
    """

    def __init__(self, files: InputFiles) -> None:
        self.files = files
        self._loaded: dict[tuple[str, Scale, UpAxis], LoadedMesh] = {}

    def load(self, path: Path, scale: Scale, up_axis: UpAxis = "file") -> LoadedMesh:
        """The solid in a mesh file; the same object for the same file, scale and up axis.

        Raises:
            BadInput: as `mesh.read_mesh`, with the path as it is shown.
        """
        key = (os.path.abspath(path), scale, up_axis)
        if key not in self._loaded:
            data = self.files.read(path)
            made = mesh_from_bytes(data, self.files.shown(path), scale, up_axis)
            self._loaded[key] = replace(made, notes=(*made.notes, *scale_notes(scale)))
        return self._loaded[key]
