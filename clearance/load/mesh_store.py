"""The solids of one case's mesh files: each is made once for each scale and up axis, and kept for later runs."""

from __future__ import annotations

import os
from pathlib import Path

from clearance.geometry.kept_shapes import kept, name_of
from clearance.load import mesh
from clearance.load.collada_file import UpAxis
from clearance.load.input_files import InputFiles
from clearance.load.mesh import LoadedMesh, mesh_from_bytes

Scale = tuple[float, float, float]

SMALL = 4096
"""Bytes below which a file is read in less time than what was made of it."""


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
            self._loaded[key] = _solid_of(data, self.files.shown(path), scale, up_axis)
        return self._loaded[key]


def _solid_of(data: bytes, shown: str, scale: Scale, up_axis: UpAxis) -> LoadedMesh:
    """As `mesh_from_bytes`, which depends on the name by its suffix alone where it refuses nothing."""

    def make() -> LoadedMesh:
        return mesh_from_bytes(data, shown, scale, up_axis)

    if len(data) < SMALL:
        return make()
    name = name_of(data, Path(shown).suffix.lower(), scale, up_axis)
    return kept(name, "solid", str(mesh.__file__), make)
