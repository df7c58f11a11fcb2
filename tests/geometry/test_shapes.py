"""Shapes hold the true solid, proven in rationals, and stand out by no more than they say."""

from __future__ import annotations

from fractions import Fraction

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from clearance.errors import BadDimension
from clearance.geometry.shapes import box, capsule, cylinder, ellipsoid, pipe, sphere
from tests.examples import examples
from tests.geometry.exact_faces import (
    area_vector,
    corners,
    dot,
    is_flat_and_convex,
    minus,
    on_grid,
)

radii = st.floats(1e-3, 10.0)
tolerances = st.sampled_from([1e-1, 3e-2, 1e-2])  # of the radius: few faces, quick rationals


def exact(x: float) -> Fraction:
    return Fraction(float(x))


def is_sound(shape) -> bool:
    return shape.closed and shape.oriented and shape.manifold and shape.volume > 0.0


def lies_before(face, point, radius: Fraction) -> bool:
    """True if the face's plane is at least `radius` before the point, exactly."""
    *face, point, (radius, _, _) = on_grid([*face, point, (radius,) * 3])
    normal = area_vector(face)
    height = dot(normal, minus(face[0], point))
    return height >= 0 and height * height >= radius * radius * dot(normal, normal)


def test_a_box_is_exact():
    shape = box((0.1, 0.7, 1e-3))
    assert shape.n_faces == 6 and shape.excess == 0.0 and is_sound(shape)
    assert np.array_equal(shape.bounds[1] * 2, [0.1, 0.7, 1e-3])
    assert all(is_flat_and_convex(corners(shape, i)) for i in range(6))


@examples(25)
@given(radii, tolerances)
def test_a_sphere_lies_inside_its_faces(radius, share):
    shape = sphere(radius, share * radius)
    origin = (Fraction(0),) * 3
    limit = (exact(radius) + exact(shape.excess)) ** 2
    assert is_sound(shape) and 0.0 < shape.excess <= share * radius
    for i in range(shape.n_faces):
        face = corners(shape, i)
        assert is_flat_and_convex(face)
        assert lies_before(face, origin, exact(radius))
        assert all(dot(p, p) <= limit for p in face)


@pytest.mark.slow
@examples(15)
@given(radii, radii, radii, tolerances)
def test_an_ellipsoid_lies_inside_its_faces(a, b, c, share):
    """The farthest of it along a face's normal is sqrt(sum (radius * normal)^2) from its centre."""
    shape = ellipsoid((a, b, c), share * max(a, b, c))
    assert is_sound(shape) and 0.0 < shape.excess <= share * max(a, b, c) * (1 + 1e-12)
    for i in range(shape.n_faces):
        x, y, z = area_vector(face := corners(shape, i))
        farthest = (exact(a) * x) ** 2 + (exact(b) * y) ** 2 + (exact(c) * z) ** 2
        height = dot((x, y, z), face[0])
        assert height > 0 and height * height >= farthest
    stretch = np.array([a, b, c])
    beyond = np.linalg.norm(shape.vertices / stretch, axis=1).max() - 1.0
    assert beyond * stretch.max() <= shape.excess * (1 + 1e-9)


@examples(20)
@given(radii, st.floats(0.0, 50.0), tolerances)
def test_a_capsule_lies_inside_its_faces(radius, length, share):
    shape = capsule(radius, length, share * radius)
    half = exact(length) / 2
    limit = (exact(radius) + exact(shape.excess)) ** 2
    assert is_sound(shape) and shape.excess <= share * radius
    for i in range(shape.n_faces):
        face = corners(shape, i)
        assert is_flat_and_convex(face)
        for end in (half, -half):
            assert lies_before(face, (Fraction(0), Fraction(0), end), exact(radius))
        for x, y, z in face:
            assert x * x + y * y + max(abs(z) - half, Fraction(0)) ** 2 <= limit


@examples(40)
@given(radii, st.floats(1e-3, 50.0), st.integers(3, 90))
def test_a_cylinder_lies_inside_its_faces(radius, length, n):
    shape = cylinder(radius, length, sections=n)
    assert shape.n_faces == n + 2 and is_sound(shape)
    limit = (exact(radius) + exact(shape.excess)) ** 2
    for i in range(shape.n_faces):
        face = corners(shape, i)
        assert is_flat_and_convex(face)
        normal = area_vector(face)
        if normal[2] == 0:
            assert lies_before(face, (Fraction(0), Fraction(0), face[0][2]), exact(radius))
        else:
            assert abs(face[0][2]) == exact(length) / 2
        assert all(x * x + y * y <= limit for x, y, _ in face)


@examples(40)
@given(radii, st.floats(0.05, 0.999), st.integers(3, 90))
def test_a_pipe_loses_no_material(outer, share, n):
    inner = share * outer
    shape = pipe(inner_radius=inner, outer_radius=outer, length=1.5, sections=n)
    assert shape.n_faces == 4 * n and is_sound(shape)
    least_bore = (exact(inner) - exact(shape.excess)) if inner > shape.excess else Fraction(0)
    for i in range(shape.n_faces):
        face = corners(shape, i)
        normal = area_vector(face)
        assert is_flat_and_convex(face)
        axis_point = (Fraction(0), Fraction(0), face[0][2])
        if normal[2] != 0:
            assert abs(face[0][2]) == Fraction(3, 4)
        elif dot(normal, minus(face[0], axis_point)) > 0:
            assert lies_before(face, axis_point, exact(outer))
        else:
            assert all(x * x + y * y <= exact(inner) ** 2 for x, y, _ in face)
            height = dot(normal, minus(face[0], axis_point))
            assert height * height >= least_bore**2 * dot(normal, normal)


@pytest.mark.slow
@pytest.mark.parametrize("radius", [1e-3, 0.5])
def test_the_default_tolerance_is_a_tenth_of_a_millimetre(radius):
    for shape in (
        sphere(radius), cylinder(radius, 1.0), capsule(radius, 1.0),
        pipe(inner_radius=0.5 * radius, outer_radius=radius, length=1.0),
    ):  # fmt: skip
        assert 0.0 < shape.excess <= 1e-4


PATH = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [1, 1.5, 0.7], [0, 1.5, 1.5]])


def centre_distance(points: np.ndarray, path: np.ndarray, bend: float) -> np.ndarray:
    """(n,) distances from a centre line of straight pieces and arcs."""
    directions = np.diff(path, axis=0)
    directions /= np.linalg.norm(directions, axis=1)[:, None]
    turns = np.arccos(np.einsum("ij,ij->i", directions[:-1], directions[1:]))
    cut = np.concatenate([[0], bend * np.tan(turns / 2), [0]])
    best = np.full(len(points), np.inf)
    for i, d in enumerate(directions):
        start, end = path[i] + cut[i] * d, path[i + 1] - cut[i + 1] * d
        along = np.clip((points - start) @ d, 0.0, np.linalg.norm(end - start))
        best = np.minimum(best, np.linalg.norm(points - start - along[:, None] * d, axis=1))
    for i, turn in enumerate(turns):
        a, b = directions[i], directions[i + 1]
        inward = b - (b @ a) * a
        inward /= np.linalg.norm(inward)
        centre = path[i + 1] - cut[i + 1] * a + bend * inward
        offset = points - centre
        x, y = offset @ a, -(offset @ inward)
        angle = np.arctan2(x, y)
        z = offset @ np.cross(a, inward)
        on_arc = np.hypot(np.hypot(x, y) - bend, z)
        best = np.where((angle >= 0) & (angle <= turn), np.minimum(best, on_arc), best)
    return best


@pytest.mark.parametrize("tolerance", [2e-3, 1e-3])
@pytest.mark.parametrize("inner", [0.0, 0.05])
def test_a_bent_pipe_stands_out_everywhere_by_no_more_than_it_says(inner, tolerance):
    shape = pipe(
        path=PATH, bend_radius=0.2, inner_radius=inner, outer_radius=0.06, tolerance=tolerance
    )
    assert is_sound(shape) and shape.excess <= tolerance
    a, b, c = (shape.vertices[shape.triangles()[:, i]] for i in range(3))
    weights = np.random.default_rng(1).dirichlet((1, 1, 1), size=4)
    corners_too = [[1, 0, 0], [0, 1, 0], [0, 0, 1], [0.5, 0.5, 0], [0, 0.5, 0.5], [0.5, 0, 0.5]]
    for u, v, w in [*weights, *corners_too]:
        points = u * a + v * b + w * c
        inside_ends = (points[:, 0] > 1e-9) | (np.abs(points[:, 1]) > 0.2)
        last = PATH[-1] - PATH[-2]
        inside_ends &= (points - PATH[-1]) @ last < -1e-9
        distance = centre_distance(points[inside_ends], PATH, 0.2)
        outer = distance > 0.055
        assert outer.any() and (distance[outer] >= 0.06 - 1e-15).all()
        assert (distance[outer] <= 0.06 + shape.excess).all()
        assert (distance[~outer] <= 0.05 + 1e-15).all()
        assert (distance[~outer] >= 0.05 - shape.excess).all()


BENT = {"path": [[0, 0, 0], [1, 0, 0], [1, 1, 0]], "inner_radius": 0.05, "outer_radius": 0.06}


@pytest.mark.parametrize(
    ("make", "field"),
    [
        (lambda: box((1, 2)), "size"),
        (lambda: box(3), "size"),
        (lambda: sphere(0), "radius"),
        (lambda: sphere(float("nan")), "radius"),
        (lambda: sphere("wide"), "radius"),
        (lambda: sphere(1, 1e-9), "tolerance"),
        (lambda: cylinder(1, 0), "length"),
        (lambda: cylinder(1, float("inf")), "length"),
        (lambda: cylinder(1, 1, sections=2), "sections"),
        (lambda: cylinder(1, 1, sections=7.5), "sections"),
        (lambda: cylinder(1, 1, tolerance=1e-12), "tolerance"),
        (lambda: capsule(1, -1), "length"),
        (lambda: pipe(inner_radius=-1, outer_radius=1, length=1), "inner_radius"),
        (lambda: pipe(inner_radius=1, outer_radius=1, length=1), "inner_radius"),
        (lambda: pipe(inner_radius=0.5, outer_radius=1), "length"),
        (
            lambda: pipe(inner_radius=0.5, outer_radius=1, length=1, path=[[0, 0, 0], [1, 0, 0]]),
            "path",
        ),
        (lambda: pipe(**BENT), "bend_radius"),
        (lambda: pipe(**BENT, bend_radius=0.06), "bend_radius"),
        (lambda: pipe(**BENT, bend_radius=1.1), "path"),
        (lambda: pipe(**{**BENT, "path": [[0, 0, 0], [0, 0, 0]]}), "path"),
        (
            lambda: pipe(**{**BENT, "path": [[0, 0, 0], [1, 0, 0], [0, 0, 0]]}, bend_radius=0.1),
            "path",
        ),
        (lambda: pipe(**{**BENT, "path": [[0, 0, 0]]}), "path"),
        (lambda: pipe(**{**BENT, "path": [[0, 0, 0], [1, np.nan, 0]]}), "path"),
    ],
)
def test_dimensions_that_no_solid_has_are_refused(make, field):
    with pytest.raises(BadDimension) as caught:
        make()
    assert field in str(caught.value)
