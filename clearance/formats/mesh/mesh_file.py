"""Mesh files to solids, and the adapter of trimesh, which writes them.

Every format has a reader of our own beside this file, because the usual ones lose or bend something in
each (NOTES.md). Not for: primitive shapes (`geometry.shapes`).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from os import PathLike
from pathlib import Path

import numpy as np

from clearance.errors import BadSyntax, at
from clearance.formats.files.input_files import read_bytes
from clearance.formats.known_formats import Kind, format_of, function_at, suffixes_read
from clearance.formats.mesh.placing import Z_FROM_Y_UP
from clearance.formats.mesh.triangles import (
    MeshRequest,
    Triangles,
    UpAxis,
    checked,
    n_without_area,
    scaled,
    without_copies,
)
from clearance.geometry.polyhedron import Polyhedron
from clearance.tolerance import TESSELLATION

OPEN = "the surface is open: it has no inside"
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
        up_axis: what becomes of a COLLADA file's `<up_axis>`: "file" obeys it, "ros" ignores it.
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


def mesh_file(vertices: np.ndarray, triangles: np.ndarray, kind: str) -> bytes:
    """The content of a mesh file: vertices (n, 3) [m], triangles (m, 3), kind "stl" or "glb" (turned y up)."""
    import trimesh

    turned = vertices @ Z_FROM_Y_UP if kind == "glb" else vertices
    content = trimesh.Trimesh(turned, triangles, process=False).export(file_type=kind)
    assert isinstance(content, bytes)  # as both kinds are
    return content


def _solid(triangles: Triangles) -> LoadedMesh:
    single, n_copies = without_copies(triangles)
    off = triangles.off
    given = Polyhedron.from_triangles(single.vertices, single.corners, excess=off, shortfall=off)
    shape = given.outward()
    notes = [
        *_notes_on_facets(off),
        *triangles.notes,
        *_notes_on_copies(n_copies),
        *_notes_on_flat(n_without_area(single), shape),
        *_notes_on_turned(given),
        *_notes_on_sides(shape.component_two_sided),
        *_notes_on_open(shape.component_closed),
    ]
    return LoadedMesh(shape, len(triangles.corners), tuple(notes))


def _notes_on_facets(off: float) -> list[str]:
    if not off:
        return []
    return [
        f"facets of a CAD file, up to {off * 1e3:.3g} mm off its surface, which is taken off the clearance; "
        "depths of contact are those of the facets"
    ]


def _notes_on_copies(n_copies: int) -> list[str]:
    if not n_copies:
        return []
    return [
        f"{_counted(n_copies, 'exact copy of a face is', 'exact copies of faces are')} left out"
    ]


def _notes_on_turned(given: Polyhedron) -> list[str]:
    n_parts, n_turned = len(given.component_inside_out), int(given.component_inside_out.sum())
    if not n_turned:
        return []
    which = "the closed surface" if n_parts == 1 else f"{n_turned} of its {n_parts} parts"
    were = "was" if n_turned == 1 else "were"
    return [f"{which} {were} inside out and {'is' if n_turned == 1 else 'are'} turned round"]


def _notes_on_sides(two_sided: np.ndarray) -> list[str]:
    n_parts, n_two_sided = len(two_sided), int(np.count_nonzero(two_sided))
    if not n_two_sided:
        return []
    hold = "holds" if n_two_sided == 1 else "hold"
    which = "it holds" if n_two_sided == n_parts else f"{n_two_sided} of its {n_parts} parts {hold}"
    return [
        f"{which} each face once for each side: what is wholly inside is not seen to be in contact"
    ]


def _notes_on_open(closed: np.ndarray) -> list[str]:
    n_parts, n_open = len(closed), int(np.count_nonzero(~closed))
    if not n_open:
        return []
    if n_open == n_parts:
        return [OPEN]
    return [
        f"{n_open} of its {n_parts} parts {'is open: it has' if n_open == 1 else 'are open: they have'} no inside"
    ]


def _notes_on_flat(n_flat: int, shape: Polyhedron) -> list[str]:
    if not n_flat:
        return []
    n_faces = int(np.count_nonzero(~shape.normals.any(axis=1)))
    what = f"{_counted(n_flat, 'triangle', 'triangles')} {'has' if n_flat == 1 else 'have'} no area"
    if not n_faces:
        covered = "is covered by its" if n_flat == 1 else "are covered by their"
        return [f"{what} and {covered} neighbours"]
    faces = "1 is kept as a face" if n_faces == 1 else f"{n_faces} are kept as faces"
    return [f"{what}; {faces}, because nothing else covers {'it' if n_faces == 1 else 'them'}"]


def _counted(n: int, one: str, many: str) -> str:
    return f"{n} {one if n == 1 else many}"
