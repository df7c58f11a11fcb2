"""Corners and edges of faces, four at a time: as one after another, to the bit, however many a face has."""

import math

import numpy as np
import pytest

import clearance as cl
from clearance.compile.declared import Floats2, Floats4
from clearance.compile.decorators import inline, kernel
from clearance.geometry.tree import surface_of
from clearance.kernels.arithmetic.lanes import WIDTH, lane
from clearance.kernels.arithmetic.vec3 import (
    Vec3,
    along,
    dot,
    inverse,
    rigid,
    row,
    sub,
    turn,
    turn_back,
)
from clearance.kernels.features.bounds import direction_between, direction_outward
from clearance.kernels.mesh.corners import corners_at, greatest_in, least_in
from clearance.kernels.mesh.surface import Surface
from tests.made_cases import at

pytestmark = pytest.mark.slow


@kernel
def corners_of_faces(surface: Surface, in_lanes: Floats2, extremes: Floats2) -> int:
    """Fills the corners of all faces as lanes give them, with the greatest and least of x in each register."""
    n = 0
    for face in range(len(surface.face_starts) - 1):
        end = surface.face_starts[face + 1]
        for c in range(surface.face_starts[face], end, WIDTH):
            x = corners_at(surface, c, end)
            for k in range(WIDTH):
                place = WIDTH * n + k
                in_lanes[place, 0] = lane(x.x, k)
                in_lanes[place, 1], in_lanes[place, 2] = lane(x.y, k), lane(x.z, k)
            extremes[n, 0], extremes[n, 1] = greatest_in(x.x), least_in(x.x)
            n += 1
    return n


@pytest.mark.parametrize("n_sides", [3, 4, 5, 8, 9])
def test_the_last_corner_fills_what_is_left_of_a_register(n_sides):
    surface = surface_of(cl.cylinder(0.3, 1.0, sections=n_sides))
    starts = surface.face_starts
    expected = [
        surface.vertices[surface.face_vertices[min(c + k, end - 1)]]
        for first, end in zip(starts[:-1], starts[1:], strict=True)
        for c in range(first, end, WIDTH)
        for k in range(WIDTH)
    ]
    found, extremes = np.empty((len(expected), 3)), np.empty((len(expected) // WIDTH, 2))
    assert corners_of_faces(surface, found, extremes) == len(extremes)
    assert (found == np.array(expected)).all()
    xs = found[:, 0].reshape(-1, WIDTH)
    assert (extremes == np.stack([xs.max(axis=1), xs.min(axis=1)], axis=1)).all()


@inline
def beside_edge_by_edge(surface, face, other, face_other, m):
    """(squared distance, where to) of what lies beyond the plane and one edge of a face."""
    first, last = other.face_starts[face_other], other.face_starts[face_other + 1]
    normal = row(surface.normals, face)
    v = turn_back(m, normal)
    least, most = math.inf, -math.inf
    for c in range(first, last):
        h = dot(v, row(other.vertices, other.face_vertices[c]))
        least, most = min(least, h), max(most, h)
    start = surface.face_starts[face]
    offset = dot(normal, sub(m.t, row(surface.vertices, surface.face_vertices[start])))
    height = max(0.0, least + offset) + min(0.0, most + offset)
    farthest, outward = 0.0, normal
    for e in range(start, surface.face_starts[face + 1]):
        u = row(surface.corner_normals, e)
        v = turn_back(m, u)
        least = math.inf
        for c in range(first, last):
            least = min(least, dot(v, row(other.vertices, other.face_vertices[c])))
        least += dot(u, sub(m.t, row(surface.vertices, surface.face_vertices[e])))
        if least > farthest:
            farthest, outward = least, u
    o = Vec3(farthest * outward.x, farthest * outward.y, farthest * outward.z)
    return height * height + farthest * farthest, along(o, height, normal)


@kernel
def directions_beside(a: Surface, b: Surface, pose: Floats2, found: Floats4) -> None:
    """Fills `direction_outward` of all face pairs, and beside it that of edges one after another."""
    m = rigid(pose)
    for i in range(len(a.face_starts) - 1):
        for j in range(len(b.face_starts) - 1):
            u = direction_outward(a, i, b, j, m, inverse(m)).u
            of_a, d = beside_edge_by_edge(a, i, b, j, m)
            of_b, e = beside_edge_by_edge(b, j, a, i, inverse(m))
            if of_b > of_a:
                d = turn(m, Vec3(-e.x, -e.y, -e.z))
            v = direction_between(Vec3(0.0, 0.0, 0.0), d, m).u
            for k in range(3):
                found[i, j, 0, k], found[i, j, 1, k] = u[k], v[k]


@pytest.mark.parametrize("n_sides", [3, 5, 9])
def test_edges_four_at_a_time_give_the_direction_that_one_after_another_give(n_sides):
    a, b = (
        surface_of(cl.cylinder(0.3, 1.0, sections=n_sides)),
        surface_of(cl.cylinder(0.2, 0.4, sections=4)),
    )
    turned = np.array([[0.36, 0.48, -0.8], [-0.8, 0.6, 0.0], [0.48, 0.64, 0.6]])
    found = np.empty((len(a.face_starts) - 1, len(b.face_starts) - 1, 2, 3))
    for x in (-0.6, 0.1, 0.7):
        directions_beside(a, b, at(x, -0.3, 0.9, turned), found)
        assert (found[:, :, 0] == found[:, :, 1]).all()
        assert np.allclose(np.linalg.norm(found, axis=3), 1.0, atol=1e-12)
