"""The geoms of an MJCF model as solids in their body's frame: primitives of the table of shapes, and mesh files.

A mesh is read by our own reader, with the numbers and faces of its file, and moved to where MuJoCo says. Not for:
which geoms are measured (`robot`, `scene.mjcf`).
"""

from __future__ import annotations

import os
from collections.abc import Iterable
from pathlib import Path, PurePosixPath

import numpy as np

from clearance.errors import BadRobot, BadSyntax, MissingFile, at
from clearance.formats.files.place import here
from clearance.formats.mesh_store import MeshStore
from clearance.formats.robot.mjcf.document import MjcfDocument
from clearance.formats.robot.mjcf.mujoco_adapter import MjcfGeom, MjcfMesh, MjcfModel, MjcfSpec
from clearance.formats.robot.shape_kinds import plane_from_box
from clearance.formats.text.notes import grouped
from clearance.geometry.polyhedron import Polyhedron
from clearance.geometry.polytope_hull import hull_faces
from clearance.geometry.pose import inverse
from clearance.geometry.shapes import SHAPES
from clearance.world.extents import PLANE_SIZE

_UNREAD = {
    "hfield": "its surface is a grid of heights",
    "sdf": "its surface is a function",
}
"""What MuJoCo has besides, and why it is refused."""


def primitive(geom: MjcfGeom) -> tuple[str, dict[str, float | list[float]]]:
    """The name in the table of shapes, and the dimensions, of a geom that is no mesh.

    Raises:
        BadInput: a kind that is not read, and why.
    """
    a, b, _ = geom.size.tolist()
    if geom.kind == "box":
        return "box", {"size": (2.0 * geom.size).tolist()}
    if geom.kind == "plane":
        return "box", {"size": list(PLANE_SIZE)}
    if geom.kind == "ellipsoid":
        return "ellipsoid", {"radii": geom.size.tolist()}
    if geom.kind == "sphere":
        return "sphere", {"radius": a}
    if geom.kind in ("capsule", "cylinder"):
        return geom.kind, {"radius": a, "length": 2.0 * b}
    raise BadRobot(
        f"geom {geom.name!r}: a {geom.kind} is not read: {_UNREAD.get(geom.kind, 'it is unknown')}",
        valid="box, sphere, capsule, cylinder, ellipsoid or mesh",
    )


def body_from_shape(geom: MjcfGeom) -> np.ndarray:
    """(4, 4) [m] the pose in its body of what `primitive` or the mesh makes."""
    return geom.pose @ plane_from_box() if geom.kind == "plane" else geom.pose


class MjcfShapes:
    """Makes solids of geoms, and keeps what is to be reported of mesh files.

    Args:
        folder: of the model's file.
    """

    def __init__(
        self, spec: MjcfSpec, folder: Path, package_dirs: Iterable[Path], meshes: MeshStore
    ) -> None:
        self.spec, self.folder, self.meshes = spec, folder, meshes
        self.package_dirs = tuple(package_dirs)
        self._made: dict[str, tuple[Polyhedron, str]] = {}
        self._notes: list[tuple[str, str]] = []
        self.outside: dict[str, None] = {}

    def shape(self, geom: MjcfGeom) -> tuple[Polyhedron, str]:
        """The solid of a geom in its body's frame, and what it was made from.

        Raises:
            BadInput: a kind that is not read, or dimensions or a mesh that make no solid.
        """
        if geom.kind == "mesh":
            shape, origin = self.mesh(geom.mesh)
        else:
            kind, dimensions = primitive(geom)
            with at(f"geom {geom.name!r}"):
                shape, origin = SHAPES[kind].maker(**dimensions), kind
        return shape.transformed(body_from_shape(geom)), origin

    def mesh(self, name: str) -> tuple[Polyhedron, str]:
        """A mesh by its name in the model, scaled and moved as it says, and what it was made from."""
        if name not in self._made:
            with at(f"mesh {name!r}"):
                self._made[name] = self._mesh(self.spec.meshes[name])
        return self._made[name]

    def notes(self) -> list[str]:
        """What was mended in the files, a line for each kind of fault, and files from elsewhere."""
        outside = [f"files outside the model's folder: {', '.join(self.outside)}"]
        return [*grouped(self._notes), *(outside if self.outside else [])]

    def file_of(self, given: str) -> Path:
        """The file that a mesh names.

        Raises:
            MissingFile: it is not there. BadSyntax: a scheme, as of a package.
        """
        if "://" in given:
            raise BadSyntax(f"file={given!r:.100}", valid="a path; nothing is fetched")
        given = given.replace("\\", "/")
        if self.spec.strippath:
            given = PurePosixPath(given).name
        below = (self.spec.meshdir or "").replace("\\", "/")
        for folder in (self.folder / below, *self.package_dirs):
            path = here(folder / given)
            if os.path.isfile(path):
                self._note_outside(path)
                return path
        raise MissingFile(
            f"there is no mesh {given!r} in {below or 'the folder of the model'}",
            valid="the file there, or its folder in robot.package_dirs",
        )

    def _note_outside(self, path: Path) -> None:
        inside = (self.folder, *self.package_dirs)
        place = Path(os.path.abspath(path))
        if not any(place.is_relative_to(os.path.abspath(folder)) for folder in inside):
            self.outside[self.meshes.files.shown(path)] = None

    def _mesh(self, mesh: MjcfMesh) -> tuple[Polyhedron, str]:
        still = mesh.lies_as_in_its_file
        if not mesh.file:
            return _placed(_inline(mesh), mesh), "mesh"
        path = self.file_of(mesh.file)
        scale = tuple(mesh.scale.tolist()) if still else (1.0, 1.0, 1.0)
        loaded = self.meshes.load(path, (scale[0], scale[1], scale[2]), "ros")
        shown = self.meshes.files.shown(path)
        self._notes += [(shown, note) for note in loaded.notes]
        return (loaded.shape if still else _placed(loaded.shape, mesh)), shown


def compiled(
    document: MjcfDocument, package_dirs: Iterable[Path], meshes: MeshStore
) -> tuple[MjcfModel, MjcfShapes]:
    """The model as MuJoCo compiles it, and what makes its shapes."""
    spec = MjcfSpec(document.root)
    shapes = MjcfShapes(spec, document.folder, package_dirs, meshes)
    fitted = {name: triangles_of(shapes.mesh(name)[0]) for name in sorted(spec.fitted)}
    for shown in document.outside:
        shapes.outside[shown] = None
    return spec.model(fitted), shapes


def triangles_of(shape: Polyhedron) -> tuple[np.ndarray, np.ndarray]:
    """Vertices and triangles of a surface, its faces cut as fans."""
    starts, flat = shape.face_starts.tolist(), shape.face_vertices.tolist()
    fans = [
        (flat[start], flat[i], flat[i + 1])
        for start, end in zip(starts, starts[1:], strict=False)
        for i in range(start + 1, end - 1)
    ]
    return shape.vertices, np.array(fans, dtype=np.int64)


def _placed(shape: Polyhedron, mesh: MjcfMesh) -> Polyhedron:
    """A shape in the mesh's own frame, moved back, turned back and then scaled along the axes."""
    pose = np.eye(4)
    pose[:3, :3], pose[:3, 3] = mesh.turned, mesh.moved
    moved = shape.transformed(inverse(pose))
    return moved if np.array_equal(mesh.scale, np.ones(3)) else moved.scaled(mesh.scale.tolist())


def _inline(mesh: MjcfMesh) -> Polyhedron:
    """The surface that stands in the document; the hull where only points do."""
    if len(mesh.corners):
        return Polyhedron.from_triangles(mesh.points, mesh.corners).outward()
    vertices, starts, flat = hull_faces(mesh.points)
    return Polyhedron(
        vertices, [flat[i:k].tolist() for i, k in zip(starts, starts[1:], strict=False)]
    )
