"""Files of single precision, far from the origin: what rounding may have moved is taken off the clearance."""

from __future__ import annotations

import struct

import numpy as np
import pytest

from clearance.formats.cloud.formats import cloud_from_bytes
from clearance.formats.mesh.mesh_file import mesh_file, mesh_from_bytes

FAR = np.array([431000.14, 10.0, 0.0])
OFF = float(np.linalg.norm(0.5 * np.spacing(np.array([431001.0, 11.0, 1.0], np.float32))))
"""[m] Half of 31.25 mm along x, and next to nothing along the others."""

CORNERS = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]]) + FAR
FACES = np.array([[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]])


def ply(kind: str, letter: str) -> bytes:
    head = "ply\nformat binary_little_endian 1.0\nelement vertex 4\n"
    head += "".join(f"property {kind} {axis}\n" for axis in "xyz")
    head += "element face 4\nproperty list uchar int vertex_indices\nend_header\n"
    rows = b"".join(struct.pack("<B3i", 3, *face) for face in FACES.tolist())
    return head.encode() + CORNERS.astype(f"<{letter}").tobytes() + rows


def pcd(size: int, form: str = "binary") -> bytes:
    head = f"VERSION 0.7\nFIELDS x y z\nSIZE {size} {size} {size}\nTYPE F F F\nCOUNT 1 1 1\n"
    head += f"WIDTH 4\nHEIGHT 1\nPOINTS 4\nDATA {form}\n"
    return head.encode() + CORNERS.astype(f"<f{size}").tobytes()


@pytest.mark.parametrize(
    ("data", "name"),
    [
        (mesh_file(CORNERS, FACES, "stl"), "far.stl"),
        (mesh_file(CORNERS, FACES, "glb"), "far.glb"),
        (ply("float", "f4"), "far.ply"),
    ],
)
def test_a_mesh_of_single_precision_far_away_has_a_shortfall_of_its_rounding(data, name):
    loaded = mesh_from_bytes(data, name)
    assert loaded.shape.shortfall == pytest.approx(OFF, rel=1e-4)
    assert any("single precision" in note for note in loaded.notes)
    moved = np.abs(loaded.shape.vertices[:, None] - CORNERS).max(axis=2).min(axis=1)
    assert (moved <= loaded.shape.shortfall).all() and moved.max() > 0.01
    millimetres = mesh_from_bytes(data, name, 0.001)
    assert millimetres.shape.shortfall == pytest.approx(0.001 * OFF, rel=1e-4)


def test_a_mesh_of_double_precision_or_near_the_origin_has_none():
    assert mesh_from_bytes(ply("double", "f8"), "far.ply").shape.shortfall == 0.0
    near = mesh_from_bytes(mesh_file(CORNERS - FAR + 100.0, FACES, "stl"), "near.stl")
    assert near.shape.shortfall == 0.0 and not any("single" in note for note in near.notes)


def test_a_scan_of_single_precision_far_away_has_larger_balls():
    loaded = cloud_from_bytes(pcd(4), "far.pcd", 0.005)
    assert loaded.shape.ball_radius == pytest.approx(0.005 + OFF, rel=1e-4)
    assert any("single precision" in note for note in loaded.notes)
    assert cloud_from_bytes(ply("float", "f4"), "far.ply", 0.005).shape.ball_radius > 0.02
    assert cloud_from_bytes(pcd(8), "far.pcd", 0.005).shape.ball_radius == 0.005
    small = cloud_from_bytes(pcd(4), "far.pcd", 0.005, in_millimetres=True).shape.ball_radius
    assert small == pytest.approx(0.005 + 0.001 * OFF, rel=1e-4)
