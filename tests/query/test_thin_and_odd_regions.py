"""Regions of thin, flat, needle-like, huge and regular bodies against exact rationals and closed forms."""

from __future__ import annotations

import itertools

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from clearance.geometry.polytope import Polytope
from clearance.query import intersection
from clearance.query.common_point import MAX_PASSES, common_point
from clearance.query.intersection import intersect
from tests.examples import first_fast
from tests.oracle.polytope_volumes import shared_volume

CUBE = np.array(list(itertools.product([0.0, 1.0], repeat=3)))
OCTAHEDRON = np.vstack([np.eye(3), -np.eye(3)])


def turned(points: np.ndarray, seed: int) -> np.ndarray:
    return points @ Rotation.random(random_state=seed).as_matrix().T


def exact_and_found(a: np.ndarray, b: np.ndarray) -> tuple[float, float]:
    return float(shared_volume(a, b)), intersect([Polytope(a), Polytope(b)]).volume


@pytest.mark.slow
@pytest.mark.parametrize("overlap", [1e-12, 1e-9, 1e-6, 1e-3, 1.0])
@pytest.mark.parametrize(
    "shift", [(1.0, 0.3, 0.2), (1.0, 0.0, 0.0), (1.0, 1.0, 0.4), (1.0, 1.0, 1.0)]
)
def test_boxes_in_any_attitude_that_overlap_little(overlap, shift):
    moved = CUBE + np.array(shift) - overlap * (np.array(shift) == 1.0)
    exact, found = exact_and_found(turned(CUBE, 3), turned(moved, 3))
    if exact > 0.0 or overlap > 1e-10:
        assert found == pytest.approx(exact, rel=1e-13, abs=0.0)
    else:
        assert found == 0.0


@pytest.mark.slow
@pytest.mark.parametrize("overlap", [1e-12, 1e-9, 1e-6, 1e-3])
def test_mirrored_bodies_that_overlap_little(overlap):
    for seed in range(2):
        points = np.random.default_rng([7, seed]).normal(size=(7, 3))
        body = Polytope(points / np.linalg.norm(points, axis=1)[:, None])
        n, d = body.normals[seed], body.anchors[seed] @ body.normals[seed]
        mirrored = body.vertices - 2.0 * np.outer(body.vertices @ n - (d - overlap / 2.0), n)
        exact, found = exact_and_found(body.vertices, mirrored)
        assert exact > 0.0 and found == pytest.approx(exact, rel=1e-13, abs=0.0)


@pytest.mark.slow
@pytest.mark.parametrize("overlap", [1e-12, 1e-9, 1e-6])
def test_a_corner_just_through_a_face(overlap):
    for seed in range(3):
        a, b = turned(OCTAHEDRON, seed), turned(CUBE - [0.0, 0.4, 0.6], seed) + 0.0
        toward = Rotation.random(random_state=seed).as_matrix()[:, 0]
        exact, found = exact_and_found(a, b + toward * (1.0 - overlap))
        assert exact > 0.0 and found == pytest.approx(exact, rel=1e-13, abs=0.0)


@pytest.mark.parametrize(
    "scale", first_fast([(1e-6, 1, 1), (1, 1e-5, 1e-5), (1e6, 1e6, 1e6), (1, 40, 0.02)], 1)
)
def test_flat_needle_like_and_huge_bodies(scale):
    for seed in range(3):
        a, b = np.random.default_rng(seed).normal(size=(2, 5, 3)) * scale
        for shift in (0.0, 3e5):
            turn = seed if shift == 0.0 else None
            pair = [turned(p, turn) if turn is not None else p + shift for p in (a, b)]
            exact, found = exact_and_found(*pair)
            assert found == pytest.approx(exact, rel=1e-13, abs=0.0)


@pytest.mark.parametrize("method", ["cut", "dual"])
def test_regular_solids_share_regular_solids(method):
    cube, octahedron = 2.0 * CUBE - 1.0, OCTAHEDRON
    tetrahedron = np.array([[1.0, 1, 1], [1, -1, -1], [-1, 1, -1], [-1, -1, 1]])
    cases = (
        ([cube, 2.0 * octahedron], 20.0 / 3.0, 12, 14),  # cuboctahedron of edge sqrt 2
        ([cube, 1.5 * octahedron], 8.0 / 6.0 * 1.5**3 - 6.0 * 0.5**3 * 2.0 / 3.0, 24, 14),
        (
            [tetrahedron, -tetrahedron],
            4.0 / 3.0,
            6,
            8,
        ),  # stella octangula: the octahedron of its middle
        ([cube, tetrahedron], 8.0 / 3.0, 4, 4),
    )
    for bodies, volume, n_corners, n_faces in cases:
        for seed in range(3):
            found = intersect([Polytope(turned(points, seed)) for points in bodies], method)
            assert found.volume == pytest.approx(volume, rel=1e-14)
            assert (len(found.vertices), len(found.faces)) == (n_corners, n_faces)


@pytest.mark.parametrize(("m", "n"), [(3, 8), (8, 5), (16, 4), (64, 4), (64, 30)])
def test_many_bodies_both_ways(m, n):
    for seed in range(3):
        rng = np.random.default_rng([m, n, seed])
        bodies = [Polytope(rng.normal(size=(n, 3)) + rng.normal(size=3) * 0.1) for _ in range(m)]
        cut, dual = (intersect(bodies, method) for method in ("cut", "dual"))
        assert cut.relation == dual.relation and cut.volume >= 0.0
        assert cut.volume == pytest.approx(dual.volume, rel=1e-11, abs=0.0)
        assert cut.common.passes < MAX_PASSES and cut.common.n_faces < 16 * m
        if cut.relation == "overlap":
            assert 2 * (len(cut.vertices) + len(cut.faces) - 2) == sum(map(len, cut.faces))


def test_bytes_do_not_depend_on_the_number_of_threads(monkeypatch):
    monkeypatch.setattr(intersection, "HALVED_FROM", 100)
    rng = np.random.default_rng(2)
    bodies = [Polytope(rng.normal(size=(60, 3)) + 0.2 * rng.normal(size=3)) for _ in range(12)]
    one, two, three = (intersect(bodies, threads=n) for n in (1, 2, 3))
    assert one.volume == two.volume == three.volume > 0.0
    assert one.vertices.tobytes() == two.vertices.tobytes() == three.vertices.tobytes()
    assert one.provenance.tobytes() == two.provenance.tobytes()


@pytest.mark.parametrize("n", [4, 60, 900])
def test_the_deepest_point_is_that_of_the_linear_programme(n):
    from scipy.optimize import linprog

    for seed in range(3):
        rng = np.random.default_rng([n, seed])
        bodies = [Polytope(rng.normal(size=(n, 3)) + 0.3 * rng.normal(size=3)) for _ in range(3)]
        rows = np.vstack([np.column_stack([b.normals, b.face_widths]) for b in bodies])
        bounds = np.concatenate([b.normals @ b.centroid + b.face_widths for b in bodies])
        best = linprog([0, 0, 0, -1], A_ub=rows, b_ub=bounds, bounds=[(None, None)] * 4)
        met = common_point(bodies)
        if met.relation == "overlap":
            assert met.level == pytest.approx(best.x[3], rel=1e-7)
        else:
            assert best.x[3] < 1e-9
