"""The depth of two convex bodies: against fractions, closed forms, and what a way out must do."""

import numpy as np
import pytest

import clearance as cl
from clearance.query.penetration import ConvexCorners, depths_at_most, penetration
from tests.oracle.depths import squared_depth


def lattice_body(random, n, reach):
    while True:
        points = random.integers(-reach, reach + 1, (n, 3))
        try:
            return points, cl.Polytope(points.astype(float))
        except cl.ClearanceError:
            continue


def test_depth_is_that_of_fractions():
    random = np.random.default_rng(7)
    n_deep = 0
    for _ in range(40):
        p, a = lattice_body(random, 6, 4)
        q, b = lattice_body(random, 6, 4)
        exact = (
            float(squared_depth([tuple(map(int, r)) for r in p], [tuple(map(int, r)) for r in q]))
            ** 0.5
        )
        found = penetration(a, b)
        assert found.depth == pytest.approx(exact, rel=1e-14, abs=1e-14)
        assert found.at_least == pytest.approx(exact, rel=1e-14, abs=1e-14)
        n_deep += exact > 0.0
    assert n_deep > 20


def test_depth_of_many_corners_is_that_of_all_normals():
    random = np.random.default_rng(3)
    for n in (20, 60):
        a = cl.Polytope(random.normal(size=(n, 3)) * [1.0, 0.5, 0.2])
        b = cl.Polytope(random.normal(size=(n, 3)) + [0.4, 0.1, 0.0])
        found = penetration(a, b)
        assert found.depth == pytest.approx(by_all_normals(a, b), rel=1e-13)
        assert 0.0 <= found.depth - found.at_least <= 1e-13


def by_all_normals(a, b):
    crossed = np.cross(edges(a)[:, None], edges(b)[None]).reshape(-1, 3)
    lengths = np.linalg.norm(crossed, axis=1)
    crossed = crossed[lengths > 1e-9] / lengths[lengths > 1e-9, None]
    normals = np.concatenate([b.normals, -a.normals, crossed, -crossed])
    return ((normals @ b.vertices.T).max(axis=1) - (normals @ a.vertices.T).min(axis=1)).min()


def edges(body):
    rings = np.split(body.face_vertices, body.face_starts[1:-1])
    pairs = {tuple(sorted(two)) for r in rings for two in zip(r, np.roll(r, -1), strict=True)}
    return np.array([body.vertices[j] - body.vertices[i] for i, j in sorted(pairs)])


def ball(n, random, centre=(0.0, 0.0, 0.0), radius=1.0):
    points = random.normal(size=(n, 3))
    return cl.Polytope(radius * points / np.linalg.norm(points, axis=1)[:, None] + centre)


def test_balls_of_many_corners_part_by_the_sum_of_their_radii():
    random = np.random.default_rng(5)
    found = penetration(ball(3000, random), ball(3000, random, (1.2, 0.5, 0.0), 0.6))
    assert found.depth == pytest.approx(1.6 - 1.3, abs=4e-3)
    assert found.depth < 0.3 and found.depth - found.at_least < 1e-13
    assert found.rounds < 20
    assert found.direction @ [-12 / 13, -5 / 13, 0.0] > 0.99


@pytest.mark.parametrize("deep", [1.0, 1e-3, 1e-9, 1e-12])
def test_a_box_pushed_into_a_box_by_d_is_d_deep(deep):
    a = cl.Polytope.from_polyhedron(cl.box((4.0, 4.0, 4.0)))
    b = cl.Polytope(a.vertices + [4.0 - deep, 0.25, -0.5])
    found = penetration(a, b)
    assert found.depth == pytest.approx(deep, abs=1e-15)
    assert found.direction.tolist() == [-1.0, 0.0, 0.0]


def test_touching_and_apart_are_0_deep():
    a = cl.Polytope.from_polyhedron(cl.box((1.0, 1.0, 1.0)))
    for shift in ([1.0, 0.0, 0.0], [1.0, 1.0, 1.0], [3.0, 2.0, 0.0]):
        found = penetration(cl.Polytope(a.vertices + shift), a)
        assert (found.depth, found.at_least) == (0.0, 0.0)


def test_needles_and_sheets_have_their_depth():
    needle = cl.Polytope.from_polyhedron(cl.box((1e-6, 1e-6, 2.0)))
    sheet = cl.Polytope.from_polyhedron(cl.box((2.0, 2.0, 1e-7)))
    assert penetration(needle, sheet).depth == pytest.approx(1.0 + 5e-7 - 1e-6 * 0.45, rel=2e-6)
    assert penetration(needle, needle).depth == pytest.approx(1e-6, rel=1e-9)


def test_bounds_by_26_directions_are_never_below_the_depth():
    random = np.random.default_rng(9)
    hulls = [cl.Polytope(random.normal(size=(12, 3)) + random.normal(size=3)) for _ in range(10)]
    bodies = [ConvexCorners(hull.vertices, hull.normals) for hull in hulls]
    bounds = depths_at_most(bodies[:5], bodies[5:])
    depths = np.array([[penetration(a, b).depth for b in bodies[5:]] for a in bodies[:5]])
    assert (bounds >= depths * (1.0 - 1e-12)).all()
    assert (depths > 0.1).sum() > 5 and (bounds == 0.0).any()
    cubes = [cl.Polytope(cl.box((1.0, 1.0, 1.0)).vertices + [x, 0.0, 0.0]) for x in (0.0, 0.75)]
    placed = [ConvexCorners(cube.vertices, cube.normals) for cube in cubes]
    assert depths_at_most(placed, placed).tolist() == [[1.0, 0.25], [0.25, 1.0]]
    assert depths_at_most([], bodies).shape == (0, 10)
