"""The shapes of a URDF's links, those of the table of shapes and mesh files, in the link's frame.

Not for: which links and joints there are (`robot`).
"""

from __future__ import annotations

import math
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from clearance.formats.files.found_files import FoundFiles
from clearance.formats.mesh.triangles import UpAxis
from clearance.formats.mesh_store import MeshStore, Scale
from clearance.formats.plausibility import scale_notices
from clearance.formats.robot.request import RobotRequest
from clearance.formats.robot.shape_kinds import chosen_kind
from clearance.formats.robot.urdf.elements import dimensions_of, numbers, pose_of
from clearance.formats.text.notes import grouped, short
from clearance.geometry.polyhedron import Polyhedron
from clearance.geometry.shapes import SHAPES
from clearance.world.notice import Notice

if TYPE_CHECKING:
    from lxml.etree import _Element as Element


class ShapeReader:
    """Makes shapes from elements, and keeps what is to be reported of their files.

    Args:
        largest: [bytes] files above it are not read for a box alone.
    """

    def __init__(self, request: RobotRequest, meshes: MeshStore, largest: float = math.inf) -> None:
        self.request = request
        self.meshes = meshes
        self.largest = largest
        self._notes: list[tuple[str, str]] = []
        self._scales: dict[str, Scale] = {}
        self._found = FoundFiles(meshes.files, request.package_dirs)

    @property
    def other_axis(self) -> UpAxis:
        """The reading of COLLADA and GLB that is not asked for."""
        return "file" if self.request.collada_up_axis == "ros" else "ros"

    def kind(self, link: Element) -> str:
        """Which elements of a link are its shape."""
        has = frozenset(() if link.find("collision") is None else ("collision",))
        return chosen_kind(has, self.request.geometry)

    def shape(self, element: Element) -> tuple[Polyhedron, str]:
        """The shape of a collision or visual element in its link's frame, and what it was made from."""
        given = element.find("geometry")[0]
        if given.tag == "mesh":
            shape, origin = self._mesh(given)
        else:
            shape, origin = SHAPES[given.tag].maker(**dimensions_of(given)), given.tag
        moved = element.find("origin") is not None
        return (shape.transformed(pose_of(element)) if moved else shape), origin

    def box(self, element: Element, way: UpAxis) -> np.ndarray:
        """(2, 3) [m] the box round a collision or visual element in its link's frame.

        Args:
            way: which way is up in COLLADA and GLB.

        Raises:
            BadInput: it cannot be read, or is a larger file than asked for.
        """
        mesh = element.find("geometry/mesh")
        if mesh is None:
            return self.shape(element)[0].bounds
        path, scale = self.mesh_file(mesh)
        pose = pose_of(element)
        points = self.meshes.points(path, scale, way, self.largest) @ pose[:3, :3].T + pose[:3, 3]
        return np.array([points.min(axis=0), points.max(axis=0)])

    def mesh_file(self, mesh: Element) -> tuple[Path, Scale]:
        """Where a mesh element's file lies, and its scale."""
        path = self._found.mesh(mesh.get("filename"), self.request.path.parent)
        scale = tuple(np.broadcast_to(numbers(mesh, "scale", (1.0,)), 3).tolist())
        self._scales[short(self.meshes.files.shown(path))] = scale
        return path, scale

    def notes(self) -> list[str]:
        """What was mended in the files, a line for each kind of fault."""
        return [*grouped(self._notes), *self._found.notes()]

    def notices(self) -> list[Notice]:
        """Files that stand in for others, and scales that look like another unit."""
        return [*self._found.notices(), *scale_notices(list(self._scales.items()))]

    def _mesh(self, element: Element) -> tuple[Polyhedron, str]:
        path, scale = self.mesh_file(element)
        mesh = self.meshes.load(path, scale, self.request.collada_up_axis)
        shown = self.meshes.files.shown(path)
        self._notes += [(shown, note) for note in mesh.notes]
        return mesh.shape, shown
