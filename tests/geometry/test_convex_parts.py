"""Convex parts hold the body from outside and from inside, and say what they are."""

import numpy as np
import pytest

import clearance as cl
from clearance.geometry import boolean, decompose
from clearance.geometry.convex_parts import convex_parts, hull_drawn_in
from clearance.geometry.envelope import envelope
from tests.made_cases import l_prism

L_VOLUME = 4.0  # a 2 x 1 foot and a 1 x 2 stem, 1 thick


def inside(parts, points):
    return np.array(
        [((points @ p.normals.T + p.half_spaces[:, 3]).max(axis=1) <= 1e-9) for p in parts]
    )


def in_the_l(points):
    x, y, z = points.T
    return (x > 0) & (y > 0) & (z > 0) & (z < 1) & (((x < 2) & (y < 1)) | ((x < 1) & (y < 3)))


def needs(module):
    return pytest.mark.skipif(not module.available(), reason=f"{module.__name__}: not installed")


def test_a_convex_body_is_its_own_part():
    parts = convex_parts(cl.box((1.0, 2.0, 3.0)))
    assert parts.convex and parts.tight and parts.closed and parts.note == ""
    assert parts.outer == parts.inner and parts.outer[0].volume == pytest.approx(6.0, rel=1e-15)


@pytest.mark.slow
def test_facets_are_drawn_in_by_what_they_stand_out():
    parts = convex_parts(cl.sphere(0.1))
    assert parts.convex and parts.tight and parts.inner != parts.outer
    reach = np.linalg.norm(parts.inner[0].vertices, axis=1)
    assert reach.max() <= 0.1 and reach.min() > 0.0997
    assert "facets" in parts.note


@needs(boolean)
@needs(decompose)
@pytest.mark.cold
def test_parts_of_an_l_hold_it_and_lie_in_it():
    body = l_prism()
    assert body.volume == L_VOLUME
    parts = convex_parts(body)
    assert len(parts.outer) > 1 and "CoACD" in parts.note and "more volume" in parts.note
    points = np.random.default_rng(1).uniform(-0.1, 3.1, (4000, 3))
    truly = in_the_l(points)
    assert inside(parts.outer, points).any(axis=0)[truly].all()
    assert not inside(parts.inner, points).any(axis=0)[~truly].any()
    assert sum(p.volume for p in parts.inner) > 0.5 * L_VOLUME
    assert convex_parts(body) is parts  # kept


@needs(boolean)
@needs(decompose)
@pytest.mark.cold
def test_a_decomposition_that_dies_is_reported_and_costs_nothing_else(monkeypatch, tmp_path):
    script = tmp_path / "dies.py"
    script.write_text("import os, signal\nos.kill(os.getpid(), signal.SIGKILL)\n")
    monkeypatch.setattr(decompose, "_PROCESS", script)
    parts = convex_parts(l_prism())
    assert len(parts.outer) == 1 and "CoACD came to no end" in parts.note


def test_an_open_surface_has_no_parts():
    whole = cl.box((1.0, 1.0, 1.0))
    opened = cl.Polyhedron(
        whole.vertices, [whole.face_vertices[4 * i : 4 * i + 4] for i in range(5)]
    )
    parts = convex_parts(opened)
    assert not parts.closed and parts.inner == () and "not closed" in parts.note


def test_a_double_wall_holds_nothing():
    corners = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]])
    wall = cl.Polyhedron.from_triangles(
        corners, np.array([[0, 1, 2], [0, 2, 1], [0, 1, 3], [0, 3, 1]])
    )
    assert "holds no volume" in convex_parts(wall).note


@pytest.mark.parametrize("dent", [0.01, 0.00005])
def test_a_dented_hull_is_drawn_in_below_its_dent(dent):
    """A dent of less than a facet may stand out is left to the hull, which is told."""
    body = cl.box((1.0, 1.0, 1.0))
    points = np.concatenate([body.vertices, [[0.5 - dent, 0.0, 0.0]]])
    right = np.flatnonzero((body.normals == [1.0, 0.0, 0.0]).all(axis=1))[0]
    triangles = body.triangles()[body.triangle_faces != right]
    ring = body.face_vertices[4 * right : 4 * right + 4]
    fan = [(ring[i], ring[(i + 1) % 4], 8) for i in range(4)]
    surface = points[np.concatenate([triangles, fan])]
    (inner,) = hull_drawn_in(surface, only_convex=False)
    assert hull_drawn_in(surface, only_convex=True) == ()
    assert inner.vertices.max() <= 0.5 - dent and inner.volume > 0.94**3
    parts = convex_parts(
        cl.Polyhedron.from_triangles(points, np.concatenate([triangles, fan])), rough=True
    )
    said = "its hull stands for it, its dents are at most 0.05 mm deep"
    assert (parts.note == said) == parts.tight == (dent < 0.001)


@pytest.mark.parametrize("seed", range(2))
def test_an_envelope_holds_its_points(seed):
    points = np.random.default_rng(seed).normal(size=(300, 3)) * [1.0, 0.3, 0.01] + [
        10.0,
        0.0,
        -5.0,
    ]
    rows = envelope(points).half_spaces
    assert (points @ rows[:, :3].T + rows[:, 3]).max() <= 1e-11
