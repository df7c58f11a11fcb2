"""Small meshes written to text and bytes by no writer of the package: OBJ, PLY, OFF and COLLADA."""

from __future__ import annotations

import struct

import numpy as np

from tests.formats.making import CUBE

QUADS = [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]]
"""The faces of the cube of `making`, counter-clockwise from outside."""

WEDGE = "0 0 0 1 0 0 0 2 0 0 0 3"
WEDGE_TRIANGLES = "0 2 1 0 1 3 0 3 2 1 2 3"
SHARED = '<input semantic="VERTEX" source="#v" offset="0"/>'
NODE = '<instance_geometry url="#g"/>'


def _rows(rows) -> list[str]:
    return [" ".join(map(repr, row)) for row in np.asarray(rows).tolist()]


def obj(faces=QUADS) -> str:
    """The cube, each face a line of its own from the ninth on."""
    lines = [f"v {row}" for row in _rows(CUBE)]
    return "\n".join([*lines, *(f"f {' '.join(str(i + 1) for i in face)}" for face in faces), ""])


def _ply_header(
    kind, n_points, n_faces, *, coordinates="double", element="face", more="", newline="\n"
):
    lines = ["ply", f"format {kind} 1.0", "comment made by a test", f"element vertex {n_points}"]
    lines += [f"property {coordinates} {axis}" for axis in "xyz"] + [more] * bool(more)
    lines += [f"element {element} {n_faces}", "property list uchar int vertex_indices"]
    return newline.join([*lines, "end_header", ""]).encode()


def text_ply(faces=QUADS, points=CUBE, newline="\n", **kwargs) -> bytes:
    rows = _rows(np.asarray(points, dtype=float))
    rows += [" ".join(map(str, [len(face), *face])) for face in faces]
    head = _ply_header("ascii", len(points), len(faces), newline=newline, **kwargs)
    return head + newline.join([*rows, ""]).encode()


def binary_ply(faces=QUADS, order="<", points=CUBE, number="f8", **kwargs) -> bytes:
    kind = {"<": "binary_little_endian", ">": "binary_big_endian"}[order]
    coordinates = {"f8": "double", "f4": "float"}[number]
    body = np.asarray(points).astype(order + number).tobytes()
    body += b"".join(struct.pack(f"{order}B{len(f)}i", len(f), *f) for f in faces)
    return _ply_header(kind, len(points), len(faces), coordinates=coordinates, **kwargs) + body


def off(faces=QUADS, points=CUBE, head="OFF\n", colour="") -> bytes:
    rows = _rows(np.asarray(points, dtype=float))
    rows += [" ".join(map(str, [len(face), *face])) + colour for face in faces]
    return (f"{head}{len(points)} {len(faces)} 0\n" + "\n".join([*rows, ""])).encode()


def primitive(kind: str, count: int, inside: str, inputs: str = SHARED) -> str:
    """Faces of a mesh of COLLADA."""
    return f'<{kind} count="{count}">{inputs}{inside}</{kind}>'


def collada(asset="", vertices=WEDGE, primitives=None, nodes=f"<node>{NODE}</node>", more=""):
    """A COLLADA document of one geometry `g`, a wedge of four triangles unless it is said otherwise."""
    primitives = primitives or primitive("triangles", 4, f"<p>{WEDGE_TRIANGLES}</p>")
    n = len(vertices.split())
    return f"""<?xml version="1.0"?>
<COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1">
<asset>{asset}</asset>{more}
<library_geometries><geometry id="g"><mesh>
<source id="p"><float_array id="pa" count="{n}">{vertices}</float_array><technique_common>
<accessor source="#pa" count="{n // 3}" stride="3"><param name="X" type="float"/>
<param name="Y" type="float"/><param name="Z" type="float"/></accessor></technique_common></source>
<vertices id="v"><input semantic="POSITION" source="#p"/></vertices>{primitives}
</mesh></geometry></library_geometries>
<library_visual_scenes><visual_scene id="s">{nodes}</visual_scene></library_visual_scenes>
<scene><instance_visual_scene url="#s"/></scene></COLLADA>""".encode()
