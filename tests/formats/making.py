"""Tiny meshes, robots, scenes and cases written to a folder, so that every test has its own files."""

from __future__ import annotations

import struct
from itertools import pairwise
from pathlib import Path

import numpy as np

CUBE = np.array(
    [[x, y, z] for x in (-0.5, 0.5) for y in (-0.5, 0.5) for z in (-0.5, 0.5)], dtype=np.float64
)
"""Corners of the unit cube: index 4x + 2y + z."""

CUBE_TRIANGLES = np.array(
    [
        [0, 1, 3], [0, 3, 2], [4, 6, 7], [4, 7, 5], [0, 4, 5], [0, 5, 1],
        [2, 3, 7], [2, 7, 6], [0, 2, 6], [0, 6, 4], [1, 5, 7], [1, 7, 3],
    ]
)  # fmt: skip
"""Counter-clockwise from outside."""


def binary_stl(corners: np.ndarray, header: bytes = b"made by a test") -> bytes:
    """A binary STL file of (m, 3, 3) triangle corners."""
    facets = b"".join(
        struct.pack("<12fH", 0, 0, 0, *np.asarray(triangle).ravel(), 0) for triangle in corners
    )
    return header.ljust(80, b"\0") + struct.pack("<I", len(corners)) + facets


def text_stl(corners: np.ndarray) -> bytes:
    """A text STL file of (m, 3, 3) triangle corners."""
    lines = ["solid made by a vertex test"]
    for triangle in corners:
        lines += ["facet normal 0 0 0", " outer loop"]
        lines += [f"  vertex {x!r} {y!r} {z!r}" for x, y, z in np.asarray(triangle).tolist()]
        lines += [" endloop", "endfacet"]
    return "\n".join([*lines, "endsolid made by a vertex test", ""]).encode()


def cube_stl() -> bytes:
    """The unit cube as binary STL."""
    return binary_stl(CUBE[CUBE_TRIANGLES])


def signed_volume(shape) -> float:
    """[m^3] of a Polyhedron, positive when its faces are counter-clockwise from outside."""
    total = 0.0
    for i in range(shape.n_faces):
        corners = shape.face(i)
        for b, c in pairwise(corners[1:]):
            total += np.dot(corners[0], np.cross(b, c)) / 6
    return float(total)


ARM = """<?xml version="1.0"?>
<robot name="arm">
  <link name="base"><collision><geometry><box size="0.2 0.2 0.2"/></geometry></collision></link>
  <link name="upper"><collision><origin xyz="0 0 0.5"/><geometry><mesh
  filename="upper.stl"/></geometry></collision></link> <link name="tip"/>
  <joint name="shoulder" type="revolute">
    <parent link="base"/><child link="upper"/><origin xyz="0 0 0.1" rpy="0 0 0"/>
    <axis xyz="0 0 2"/><limit lower="-1" upper="1" effort="1" velocity="1"/>
  </joint>
  <joint name="flange" type="fixed"><parent link="upper"/><child link="tip"/></joint>
</robot>
"""

CASE = """name: small
robot: {urdf: arm.urdf}
scene:
  obstacles:
  - name: post
    pose: {xyz: [1.2, 0, 0]}
    box: {size: [0.1, 0.1, 1]}
trajectory: {file: path.csv}
limits: {fail: 0.005, warn: 0.02}
"""

PATH = "time,shoulder\n0,0\n0.5,0.25\n1,0.5\n"


def write_case(
    folder: Path, case: str = CASE, urdf: str = ARM, trajectory: str = PATH, **files: bytes | str
) -> Path:
    """A whole case in `folder`; further `files` by name, a double underscore standing for the dot."""
    contents = {
        "case.yaml": case,
        "arm.urdf": urdf,
        "path.csv": trajectory,
        "upper.stl": cube_stl(),
    }
    contents |= {name.replace("__", "."): content for name, content in files.items()}
    for name, content in contents.items():
        data = content.encode() if isinstance(content, str) else content
        (folder / name).write_bytes(data)
    return folder / "case.yaml"
