"""Small valid files of shapes and drawings, cubes for the most part. Not for: damaging them (`campaign`)."""

from __future__ import annotations

import json
import logging
import re
import struct
import tempfile
from pathlib import Path

import numpy as np

CUBE = np.array([[x, y, z] for x in (0.0, 1.0) for y in (0.0, 1.0) for z in (0.0, 1.0)])
QUADS = [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]]
TRIANGLES = np.array([[q[0], q[i], q[i + 1]] for q in QUADS for i in (1, 2)])


def binary_stl() -> bytes:
    facets = [struct.pack("<12fH", 0, 0, 0, *CUBE[t].ravel(), 0) for t in TRIANGLES]
    return bytes(80) + struct.pack("<I", len(facets)) + b"".join(facets)


def text_stl() -> bytes:
    lines = ["solid cube"]
    for triangle in CUBE[TRIANGLES].tolist():
        lines += ["facet normal 0 0 0", "outer loop"]
        lines += ["vertex " + " ".join(map(str, point)) for point in triangle]
        lines += ["endloop", "endfacet"]
    return "\n".join([*lines, "endsolid cube", ""]).encode()


def _rows(rows: np.ndarray | list, before: str = "", one: int = 0) -> str:
    return "".join(
        before + " ".join(str(value + one) for value in list(row)) + "\n" for row in rows
    )


def obj() -> bytes:
    return (
        "# cube\no c\n"
        + _rows(CUBE.tolist(), "v ")
        + _rows(QUADS[:5], "f ", 1)
        + "f -7/1 -3 -1 -5\n"
    ).encode()


def _faces() -> str:
    return _rows([[len(quad), *quad] for quad in QUADS])


def off() -> bytes:
    return ("OFF\n8 6 0\n" + _rows(CUBE.tolist()) + _faces()).encode()


def _ply_head(kind: str) -> str:
    lines = [
        "ply",
        f"format {kind} 1.0",
        "element vertex 8",
        *(f"property double {x}" for x in "xyz"),
    ]
    return "\n".join(
        [*lines, "element face 6", "property list uchar int vertex_indices", "end_header", ""]
    )


def ply_text() -> bytes:
    return (_ply_head("ascii") + _rows(CUBE.tolist()) + _faces()).encode()


def ply_binary() -> bytes:
    faces = b"".join(struct.pack("<B4i", 4, *quad) for quad in QUADS)
    return _ply_head("binary_little_endian").encode() + CUBE.astype("<f8").tobytes() + faces


def collada() -> bytes:
    polygons = " ".join(str(i) for quad in QUADS for i in quad)
    return f"""<?xml version="1.0"?><COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1">
<asset><unit meter="0.001"/><up_axis>Y_UP</up_axis></asset><library_geometries><geometry id="g"><mesh>
<source id="p">
<float_array id="pa" count="24">{" ".join(map(str, CUBE.ravel().tolist()))}</float_array><technique_common>
<accessor source="#pa" count="8" stride="3"><param name="X" type="float"/><param name="Y" type="float"/>
<param name="Z" type="float"/></accessor></technique_common></source><vertices id="v">
<input semantic="POSITION" source="#p"/></vertices><polylist count="6">
<input semantic="VERTEX" source="#v" offset="0"/>
<vcount>4 4 4 4 4 4</vcount><p>{polygons}</p></polylist></mesh></geometry></library_geometries><library_nodes>
<node id="n"><instance_geometry url="#g"/></node></library_nodes><library_visual_scenes><visual_scene id="s"><node>
<rotate>0 0 1 90</rotate><scale>1 2 3</scale><instance_node url="#n"/><instance_geometry url="#g"/></node>
</visual_scene></library_visual_scenes><scene><instance_visual_scene url="#s"/></scene></COLLADA>""".encode()


def glb() -> bytes:
    points, indices = CUBE.astype("<f4").tobytes(), TRIANGLES.astype("<u2").tobytes()
    document = {
        "asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0, 1]}],
        "nodes": [{"mesh": 0, "scale": [1, 2, 3]},
                  {"mesh": 0, "translation": [9, 0, 0], "rotation": [0, 0, 0, 1]}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1, "mode": 4}]}],
        "accessors": [{"bufferView": 0, "componentType": 5126, "count": 8, "type": "VEC3"},
                      {"bufferView": 1, "componentType": 5123, "count": 36, "type": "SCALAR"}],
        "bufferViews": [{"buffer": 0, "byteLength": 96}, {"buffer": 0, "byteOffset": 96, "byteLength": 72}],
        "buffers": [{"byteLength": 168}],
    }  # fmt: skip
    text = json.dumps(document).encode()
    text += b" " * (-len(text) % 4)
    chunks = (
        struct.pack("<I4s", len(text), b"JSON")
        + text
        + struct.pack("<I4s", 168, b"BIN\0")
        + points
        + indices
    )
    return struct.pack("<4sII", b"glTF", 2, 12 + len(chunks)) + chunks


def step() -> bytes:
    from tests.formats.making_step import cylinder_step

    return cylinder_step().encode()


def dxf() -> bytes:
    """Written by ezdxf, so that it has all the tables that a drawing needs."""
    import ezdxf

    logging.getLogger("ezdxf").setLevel(
        logging.ERROR
    )  # R12 has no units, which it would tell each time
    drawing = ezdxf.new("R12")
    space = drawing.modelspace()
    space.add_line((0, 0), (2, 0))
    space.add_arc((2, 1), 1, -90, 90)
    space.add_polyline2d([(2, 2, 0), (0, 2, 0.5), (0, 0, 0)], format="xyb")
    space.add_circle((5, 5), 2)
    with tempfile.TemporaryDirectory() as folder:
        drawing.saveas(Path(folder) / "d.dxf")
        return _WHEN.sub(b"0.0", (Path(folder) / "d.dxf").read_bytes())


_WHEN = re.compile(rb"24\d{5}\.\d+|20\d\d-[-\d]+T[:.\d]+\+00:00")
"""A day with its time: of Julian days, and as text."""
