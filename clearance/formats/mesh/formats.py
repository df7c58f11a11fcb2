"""The triangles in a mesh file, by the reader of its suffix: a new format is a file, a function and a row here.

A reader is imported when a file is of its format: a case has one or two of them. Not for: what is made of the
triangles (`mesh_file`).
"""

from __future__ import annotations

from collections.abc import Callable

from clearance.formats.mesh.placing import UpAxis
from clearance.formats.mesh.triangles import Triangles


def _stl(data: bytes, _: UpAxis, __: float) -> Triangles:
    from clearance.formats.mesh.stl_file import read_stl

    return read_stl(data)


def _obj(data: bytes, _: UpAxis, __: float) -> Triangles:
    from clearance.formats.mesh.obj_file import read_obj

    return read_obj(data)


def _collada(data: bytes, up_axis: UpAxis, _: float) -> Triangles:
    from clearance.formats.mesh.collada_file import read_collada

    return read_collada(data, up_axis)


def _ply(data: bytes, _: UpAxis, __: float) -> Triangles:
    from clearance.formats.mesh.ply_file import read_ply

    return read_ply(data)


def _off(data: bytes, _: UpAxis, __: float) -> Triangles:
    from clearance.formats.mesh.off_file import read_off

    return read_off(data)


def _glb(data: bytes, _: UpAxis, __: float) -> Triangles:
    from clearance.formats.mesh.gltf_file import read_glb

    return read_glb(data)


def _step(data: bytes, _: UpAxis, tolerance: float) -> Triangles:
    from clearance.formats.mesh.step_file import read_step

    return read_step(data, tolerance)


def _octree(data: bytes, _: UpAxis, __: float) -> Triangles:
    from clearance.formats.mesh.octree_file import read_octree

    return read_octree(data)


READERS: dict[str, Callable[[bytes, UpAxis, float], Triangles]] = {
    ".stl": _stl,
    ".obj": _obj,
    ".dae": _collada,
    ".ply": _ply,
    ".off": _off,
    ".glb": _glb,
    ".step": _step,
    ".stp": _step,
    ".bt": _octree,
    ".ot": _octree,
}
"""By suffix in small letters; each takes the content, the up axis and the tolerance [m] of facets."""

CAD = (".step", ".stp")
"""Formats of surfaces that become facets within a tolerance."""
