"""What makes cutting quick changes no answer: the inner ball, bounds of cells, rows closed up, whole faces."""

from __future__ import annotations

import numpy as np
import pytest

from clearance.geometry.polytope import Polytope
from clearance.kernels.polytope.exits import cell_of, is_in_ball
from clearance.query.intersection import intersect

SHAPES = [(1, 1, 1), (1, 1, 1e-3), (1, 1e-6, 1e-6), (1e6, 1, 1e-5)]


def cluster(m: int, n: int, seed: int, spread: float = 0.2) -> list[Polytope]:
    rng = np.random.default_rng([m, n, seed])
    points = rng.normal(size=(m, n, 3))
    points /= np.linalg.norm(points, axis=2)[..., None]
    return [Polytope(p * rng.uniform(0.8, 1.2, 3) + rng.normal(size=3) * spread) for p in points]


@pytest.mark.slow
@pytest.mark.parametrize("n", [4, 9, 300])
@pytest.mark.parametrize("shape", SHAPES)
def test_ball_and_cells_call_nothing_inside_that_is_not(shape, n):
    """But for what the corners of so slender a body stand out of its own planes, relatively (`polytope.exits`)."""
    rng = np.random.default_rng(n)
    turn = np.linalg.qr(rng.normal(size=(3, 3)))[0]
    body = Polytope(rng.normal(size=(n, 3)) * shape @ turn)
    packed = body.packed
    gauges = (body.normals / body.face_widths[:, None]).T
    standing_out = max(0.0, ((body.vertices - body.centroid) @ gauges).max() - 1.0)
    on_surface = rng.normal(size=(2000, 3)) * shape @ turn
    on_surface /= (on_surface @ gauges).max(axis=1)[:, None]
    for x in on_surface:
        assert not is_in_ball(packed, *(x * (1.0 - 1e-9)))
        assert cell_of(packed, *x)[1] >= 1.0 - 1e-13 - standing_out
    resolved = max(shape) / min(shape) < 1e8  # else its round frame is lost to rounding
    if n == 300 and resolved:
        assert any(is_in_ball(packed, *(0.9 * x)) for x in on_surface)


def test_a_moved_body_is_the_hull_of_the_moved_corners():
    rng = np.random.default_rng(5)
    pose = np.eye(4)
    pose[:3, :3] = np.linalg.qr(rng.normal(size=(3, 3)))[0]
    pose[:3, :3] *= np.linalg.det(pose[:3, :3])
    pose[:3, 3] = rng.normal(size=3)
    body, other = cluster(2, 60, 4)
    moved = body.moved(pose)
    again = Polytope(body.vertices @ pose[:3, :3].T + pose[:3, 3])
    assert moved.volume == pytest.approx(again.volume, rel=1e-14)
    assert moved.n_faces == again.n_faces
    there = other.moved(pose)
    assert intersect([moved, there]).volume == pytest.approx(
        intersect([body, other]).volume, rel=1e-13
    )
