"""A scan on the page and in the live viewer: points are drawn in the colour of what stands, and told as balls."""

from dataclasses import replace

import numpy as np
import pytest

import clearance as cl
from clearance.formats.mesh.mesh_file import mesh_from_bytes
from clearance.report.glb import glb_of
from clearance.report.picture import png_of
from clearance.report.still import MOST_POINTS, as_solids, still_of
from tests.made_cases import flying


def scanned() -> cl.Case:
    """A small box that goes past a wall of points, and a block beside it that is nearest."""
    u, v = np.meshgrid(np.linspace(-1.0, 1.0, 60), np.linspace(-1.0, 1.0, 60))
    wall = np.stack([u, np.full_like(u, 0.8), v], axis=-1).reshape(-1, 3)
    way = np.linspace([-0.5, 0, 0, 0, 0, 0], [0.5, 0, 0, 0, 0, 0], 5)
    case = flying("scanned", cl.box([0.1, 0.1, 0.1]), [(cl.box([0.1, 0.1, 0.1]), below())], way)
    scan = cl.Obstacle(cl.Body("scan", cl.PointCloud(wall, 0.02)))
    return replace(case, obstacles=(*case.obstacles, scan))


def below() -> np.ndarray:
    pose = np.eye(4)
    pose[2, 3] = -0.3
    return pose


@pytest.mark.slow
def test_stills_show_points_as_solids():
    """In a picture and in a model; of many points some."""
    run = cl.check(scanned())
    record, replay = run.record, run.session.replay()
    still = still_of(replay)
    sizes = sorted(len(triangles) for _, triangles in still.shapes)
    assert sizes[-1] == 8 * 3600
    assert png_of(record, replay, run.verdict).startswith(b"\x89PNG")
    shape = mesh_from_bytes(glb_of(record, replay, record.worst), "moment.glb")
    assert shape.n_triangles > 8 * 3600
    points = (
        np.random.default_rng(1).uniform(-1.0, 1.0, (2 * MOST_POINTS + 1, 3)).astype(np.float32)
    )
    vertices, triangles = as_solids(points, np.empty((0, 3), dtype=np.int32))
    assert len(triangles) == 8 * (len(points) // 3 + 1)
    assert np.abs(vertices[:6] - points[0]).max() == pytest.approx(0.002, rel=1e-3)
    solid = cl.Polyhedron.from_triangles(vertices[:6], triangles[:8])
    assert solid.closed and solid.volume > 0.0
