"""Files of single precision, far from the origin: what rounding may have moved is taken off the clearance."""

from __future__ import annotations

import numpy as np
import pytest

from clearance.formats.cloud.formats import cloud_from_bytes
from clearance.formats.mesh.mesh_file import mesh_file, mesh_from_bytes
from tests.formats.making_clouds import pcd
from tests.formats.making_meshes import binary_ply

FAR = np.array([431000.14, 10.0, 0.0])
OFF = float(np.linalg.norm(0.5 * np.spacing(np.array([431001.0, 11.0, 1.0], np.float32))))
"""[m] Half of 31.25 mm along x, and next to nothing along the others."""

CORNERS = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]]) + FAR
FACES = np.array([[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]])
FAR_PLY = binary_ply(FACES, points=CORNERS, number="f4")


def far_pcd(size: int) -> bytes:
    fields = [(name, "F", size, 1) for name in "xyz"]
    return pcd(CORNERS, fields=fields)


@pytest.mark.parametrize(
    ("data", "name"),
    [
        (mesh_file(CORNERS, FACES, "stl"), "far.stl"),
        (mesh_file(CORNERS, FACES, "glb"), "far.glb"),
        (FAR_PLY, "far.ply"),
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
    assert mesh_from_bytes(binary_ply(FACES, points=CORNERS), "far.ply").shape.shortfall == 0.0
    near = mesh_from_bytes(mesh_file(CORNERS - FAR + 100.0, FACES, "stl"), "near.stl")
    assert near.shape.shortfall == 0.0 and not any("single" in note for note in near.notes)


def test_a_scan_of_single_precision_far_away_has_larger_balls():
    loaded = cloud_from_bytes(far_pcd(4), "far.pcd", 0.005)
    assert loaded.shape.ball_radius == pytest.approx(0.005 + OFF, rel=1e-4)
    assert any("single precision" in note for note in loaded.notes)
    assert cloud_from_bytes(FAR_PLY, "far.ply", 0.005).shape.ball_radius > 0.02
    assert cloud_from_bytes(far_pcd(8), "far.pcd", 0.005).shape.ball_radius == 0.005
    small = cloud_from_bytes(far_pcd(4), "far.pcd", 0.005, in_millimetres=True).shape.ball_radius
    assert small == pytest.approx(0.005 + 0.001 * OFF, rel=1e-4)
