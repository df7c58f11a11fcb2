"""Small valid files of shapes and drawings, cubes for the most part. Not for: damaging them (`campaign`)."""

from __future__ import annotations

import logging
import re
import tempfile
from pathlib import Path

import ezdxf

from tests.formats import making_glb, making_meshes
from tests.formats.making import CUBE
from tests.formats.making_meshes import NODE, QUADS, primitive


def obj() -> bytes:
    """The last of its faces counts from its own line, and names a point of a texture."""
    return f"# cube\no c\n{making_meshes.obj(QUADS[:5])}f -7/1 -3 -1 -5\n".encode()


def collada() -> bytes:
    """A cube in millimetres, placed by a node of the library and by one that turns and scales it."""
    corners = " ".join(str(i) for quad in QUADS for i in quad)
    faces = primitive("polylist", 6, f"<vcount>4 4 4 4 4 4</vcount><p>{corners}</p>")
    turned = "<rotate>0 0 1 90</rotate><scale>1 2 3</scale>"
    return making_meshes.collada(
        '<unit meter="0.001"/><up_axis>Y_UP</up_axis>',
        " ".join(map(str, CUBE.ravel().tolist())),
        faces,
        f'<node>{turned}<instance_node url="#n"/>{NODE}</node>',
        f'<library_nodes><node id="n">{NODE}</node></library_nodes>',
    )


def glb() -> bytes:
    """Two cubes, one scaled, one moved and turned."""
    document, binary = making_glb.cube_document()
    document["scenes"] = [{"nodes": [0, 1]}]
    document["nodes"] = [
        {"mesh": 0, "scale": [1, 2, 3]},
        {"mesh": 0, "translation": [9, 0, 0], "rotation": [0, 0, 0, 1]},
    ]
    return making_glb.glb(document, binary)


def dxf() -> bytes:
    """Written by ezdxf, so that it has all the tables that a drawing needs."""
    logging.getLogger("ezdxf").setLevel(logging.ERROR)  # R12 has no units, which it would tell
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
