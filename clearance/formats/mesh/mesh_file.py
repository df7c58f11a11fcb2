"""Mesh files to solids, and the adapter of trimesh, which writes them.

Every format has a reader of our own beside this file, because the usual ones lose or bend something in
each (NOTES.md). Not for: primitive shapes (`geometry.shapes`).
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass
from os import PathLike
from pathlib import Path

import numpy as np

from clearance.errors import BadSyntax, at
from clearance.formats.files.input_files import read_bytes
from clearance.formats.known_formats import Kind, format_of, function_at, suffixes_read
from clearance.formats.mesh.placing import Z_FROM_Y_UP
from clearance.formats.mesh.triangles import (
    COUNTED,
    MeshRequest,
    Triangles,
    UpAxis,
    checked,
    n_without_area,
    on_rounding,
    scaled,
    without_copies,
)
from clearance.formats.text.notes import counted
from clearance.geometry.polyhedron import Polyhedron
from clearance.tolerance import TESSELLATION

_OF_OPEN = "open: a body inside is found only if the holes are small"
OPEN = f"the surface is {_OF_OPEN}"
"""The note on a mesh of which no part is closed; the same text for all, so that one line can name them all."""


@dataclass(frozen=True, eq=False)
class LoadedMesh:
    """A solid from a file.

    Attributes:
        shape: in metres, in the file's frame, scaled.
        n_triangles: as many as the file has, polygons counted as the triangles they are cut into.
        notes: what had to be mended or decided, one line each, without the file's name.
    """

    shape: Polyhedron
    n_triangles: int
    notes: tuple[str, ...]


def read_mesh(
    path: str | PathLike[str],
    scale: float | Sequence[float] = 1.0,
    up_axis: UpAxis = "file",
    tolerance: float = TESSELLATION,
) -> Polyhedron:
    """The solid in a mesh file (`.stl`, `.obj`, `.dae`, `.ply`, `.off`, `.glb`), CAD file (`.step`, `.stp`) or
    octomap (`.bt`, `.ot`).

    Args:
        scale: factor of all axes or of each; negative mirrors, and the faces stay counter-clockwise
            from outside.
        up_axis: which way is up in COLLADA and GLB: "file" as they say, "ros" as they lie.
        tolerance: [m] how far the facets of a CAD file may be off its surface. The solid's `shortfall` says how
            far they are at most; a case takes it off the clearance, `distance` of two solids does not.

    Raises:
        MissingFile, BadSyntax, EmptyMesh, NotFinite, BadPolygon, BadDimension: with the file's name.
    """
    path = Path(path)
    data = read_bytes(path, path.name)
    return mesh_from_bytes(data, path.name, scale, up_axis, tolerance).shape


def mesh_from_bytes(
    data: bytes,
    name: str,
    scale: float | Sequence[float] = 1.0,
    up_axis: UpAxis = "file",
    tolerance: float = TESSELLATION,
) -> LoadedMesh:
    """The solid in the content of a mesh file; `name` gives the format and stands in errors."""
    with at(name):
        return _solid(scaled(triangles_from_bytes(data, name, up_axis, tolerance), scale))


def triangles_from_bytes(
    data: bytes, name: str, up_axis: UpAxis = "file", tolerance: float = TESSELLATION
) -> Triangles:
    """The triangles of a mesh file as they are in it, before anything is mended."""
    known = format_of(Kind.MESH, name)
    if known is None:
        suffix, valid = Path(name).suffix.lower(), ", ".join(suffixes_read(Kind.MESH))
        if suffix in suffixes_read(Kind.CLOUD):
            valid += "; a scan is read as points: {file: …, radius: …}"
        raise BadSyntax(f"unknown mesh format {suffix!r}", valid=valid)
    return checked(function_at(known.read)(MeshRequest(data, up_axis, tolerance)))


def vertices_from_bytes(data: bytes, name: str, up_axis: UpAxis = "file") -> np.ndarray:
    """(n, 3) vertices of a mesh file, all that its triangles have and perhaps more.

    Raises:
        BadInput: as `read_mesh`, or nothing at all.
    """
    known = format_of(Kind.MESH, name)
    if known is not None and known.points:
        with suppress(ValueError):  # the reader says better what is wrong
            points: np.ndarray = function_at(known.points)(data)
            if len(points) and np.isfinite(points).all():
                return points
    return triangles_from_bytes(data, name, up_axis).vertices


def mesh_file(vertices: np.ndarray, triangles: np.ndarray, kind: str) -> bytes:
    """The content of a mesh file: vertices (n, 3) [m], triangles (m, 3), kind "stl" or "glb" (turned y up)."""
    import trimesh

    turned = vertices @ Z_FROM_Y_UP if kind == "glb" else vertices
    content = trimesh.Trimesh(turned, triangles, process=False).export(file_type=kind)
    assert isinstance(content, bytes)  # as both kinds are
    return content


def _solid(triangles: Triangles) -> LoadedMesh:
    single, off = without_copies(triangles), triangles.off
    off += triangles.rounded if triangles.rounded > COUNTED else 0.0
    given = Polyhedron.from_triangles(single.vertices, single.corners, excess=off, shortfall=off)
    shape = given.outward()
    notes = (*_on_triangles(triangles, single, shape), *_on_parts(given, shape))
    return LoadedMesh(shape, len(triangles.corners), notes)


def _on_triangles(triangles: Triangles, single: Triangles, shape: Polyhedron) -> Iterator[str]:
    """Notes on triangles, of which `single` are those without copies."""
    if triangles.off:
        yield (
            f"facets of a CAD file, up to {triangles.off * 1e3:.3g} mm off its surface, which is taken off the "
            "clearance; depths of contact are those of the facets"
        )
    yield from on_rounding(triangles.rounded, "is taken off the clearance")
    yield from triangles.notes
    n_copies = len(triangles.corners) - len(single.corners)
    if n_copies:
        copies = counted(n_copies, "exact copy of a face is", "exact copies of faces are")
        yield f"{copies} left out"
    n_flat = n_without_area(single)
    if n_flat:
        yield _on_flat(n_flat, shape)


def _on_flat(n_flat: int, shape: Polyhedron) -> str:
    n_faces = int(np.count_nonzero(~shape.normals.any(axis=1)))
    what = f"{counted(n_flat, 'triangle')} {'has' if n_flat == 1 else 'have'} no area"
    if not n_faces:
        covered = "is covered by its" if n_flat == 1 else "are covered by their"
        return f"{what} and {covered} neighbours"
    faces = counted(n_faces, "is kept as a face", "are kept as faces")
    return f"{what}; {faces}, because nothing else covers {'it' if n_faces == 1 else 'them'}"


def _on_parts(given: Polyhedron, shape: Polyhedron) -> Iterator[str]:
    """Notes on the parts of a surface, as they were given and as they are."""
    n_parts, n_turned = len(given.component_inside_out), int(given.component_inside_out.sum())
    if n_turned:
        which = "the closed surface" if n_parts == 1 else f"{n_turned} of its {n_parts} parts"
        yield f"{which} {'was inside out and is' if n_turned == 1 else 'were inside out and are'} turned round"
    n_parts, n_two_sided = len(shape.component_closed), int(shape.component_two_sided.sum())
    if n_two_sided:
        hold = "holds" if n_two_sided == 1 else "hold"
        all_hold = n_two_sided == n_parts
        which = "it holds" if all_hold else f"{n_two_sided} of its {n_parts} parts {hold}"
        yield f"{which} each face once for each side: what is wholly inside is not seen to be in contact"
    n_open = int((~shape.component_closed).sum())
    if n_open == n_parts:
        yield OPEN
    elif n_open:
        yield f"{n_open} of its {n_parts} parts {'is' if n_open == 1 else 'are'} {_OF_OPEN}"
