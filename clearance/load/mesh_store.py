"""The bodies of one case's files of meshes and points: each file is made once for each scale and up axis."""

from __future__ import annotations

import os
from pathlib import Path

from clearance.load.cloud import LoadedCloud, cloud_from_bytes
from clearance.load.collada_file import UpAxis
from clearance.load.input_files import InputFiles
from clearance.load.mesh import LoadedMesh, mesh_from_bytes

Scale = tuple[float, float, float]


class MeshStore:
    """Loads meshes and clouds through `files` and keeps them.

    Args:
        files: reads the files and remembers their checksums.
    """

    def __init__(self, files: InputFiles) -> None:
        self.files = files
        self._loaded: dict[tuple[str, Scale, UpAxis], LoadedMesh] = {}
        self._clouds: dict[tuple[str, float, Scale, bool], LoadedCloud] = {}

    def load(self, path: Path, scale: Scale, up_axis: UpAxis = "file") -> LoadedMesh:
        """The solid in a mesh file; the same object for the same file, scale and up axis.

        Raises:
            BadInput: as `mesh.read_mesh`, with the path as it is shown.
        """
        key = (os.path.abspath(path), scale, up_axis)
        if key not in self._loaded:
            data = self.files.read(path)
            self._loaded[key] = mesh_from_bytes(data, self.files.shown(path), scale, up_axis)
        return self._loaded[key]

    def load_points(
        self, path: Path, radius: float, scale: Scale, *, in_millimetres: bool = False
    ) -> LoadedCloud:
        """The cloud in a file of points; the same object for the same file, radius, scale and unit.

        Raises:
            BadInput: as `cloud.read_points`, with the path as it is shown.
        """
        key = (os.path.abspath(path), radius, scale, in_millimetres)
        if key not in self._clouds:
            data = self.files.read(path)
            self._clouds[key] = cloud_from_bytes(
                data, self.files.shown(path), radius, scale, in_millimetres=in_millimetres
            )
        return self._clouds[key]
