"""Shared regions against exact rationals, closed forms, scipy and manifold3d, and in touch."""

from __future__ import annotations

import itertools

import numpy as np
import pytest

from clearance.errors import BadDimension, EmptyMesh
from clearance.geometry.polytope import Polytope
from clearance.geometry.polytope_hull import NotSolid
from clearance.query import cutting, intersection
from clearance.query.intersection import intersect
from tests.oracle.polytope_volumes import shared_volume

CUBE = np.array(list(itertools.product([0.0, 1.0], repeat=3)))


def ball(n: int, seed: int, centre=(0.0, 0.0, 0.0)) -> Polytope:
    v = np.random.default_rng([n, seed]).normal(size=(n, 3))
    return Polytope(v / np.linalg.norm(v, axis=1)[:, None] + centre)


def cluster(m: int, n: int, seed: int = 0) -> list[Polytope]:
    rng = np.random.default_rng([m, n, seed])
    return [ball(n, i, rng.normal(size=3) * 0.1) for i in range(m)]


@pytest.mark.slow
@pytest.mark.parametrize("method", ["cut", "dual"])
@pytest.mark.parametrize(("m", "n"), [(2, 4), (2, 7), (3, 4), (3, 6), (5, 4)])
def test_volumes_are_the_exact_ones(m, n, method):
    for seed in range(3):
        points = np.random.default_rng([m, n, seed]).normal(size=(m, n, 3))
        bodies = [Polytope(p) for p in points]
        exact, found = float(shared_volume(*points)), intersect(bodies, method)
        assert found.volume == pytest.approx(exact, rel=1e-13, abs=0.0)
        assert (found.dimension == 3) == (exact > 0.0)


def test_sixty_four_identical_copies_are_the_body():
    body = ball(40, 1)
    found = intersect([body] * 64)
    assert found.volume == pytest.approx(body.volume, rel=1e-15)
    assert len(found.faces) == body.n_faces


def test_copies_shifted_by_1e_12():
    points = np.random.default_rng(8).normal(size=(8, 3))
    shifted = points + [1e-12, 0, 0]
    exact = float(shared_volume(points, shifted))
    found = intersect([Polytope(points), Polytope(shifted)])
    assert found.method == "cut"
    assert found.volume == pytest.approx(exact, rel=1e-14)


@pytest.mark.parametrize(("m", "n"), [(2, 200), (7, 30), (64, 12), (64, 50)])
def test_order_changes_nothing_beyond_1e_14(m, n):
    bodies = cluster(m, n)
    first = intersect(bodies).volume
    assert first > 0.0
    for seed in range(2):
        order = np.random.default_rng(seed).permutation(m)
        assert intersect([bodies[i] for i in order]).volume == pytest.approx(first, rel=1e-14)


@pytest.mark.slow
@pytest.mark.parametrize(("m", "n"), [(2, 4), (2, 50), (5, 300), (64, 50)])
def test_it_agrees_with_scipy_and_satisfies_every_half_space(m, n):
    from scipy.spatial import ConvexHull, HalfspaceIntersection

    bodies = cluster(m, n)
    found = intersect(bodies)
    rows = np.vstack([body.half_spaces for body in bodies])
    assert (found.vertices @ rows[:, :3].T + rows[:, 3]).max() < 1e-14
    peer = ConvexHull(HalfspaceIntersection(rows, found.common.point).intersections)
    assert found.volume == pytest.approx(peer.volume, rel=1e-12)


@pytest.mark.slow
def test_halves_change_nothing(monkeypatch):
    families = [
        cluster(m, n, seed)
        for m, n in ((2, 8), (2, 60), (2, 400), (5, 40), (24, 30))
        for seed in range(3)
    ]
    families += [
        [Polytope(CUBE), Polytope(CUBE * 0.5 + 0.3), Polytope(CUBE + 0.25)],
        [Polytope(CUBE)] * 4,
    ]
    families.append(
        [Polytope(CUBE * s - np.array(s) / 2) for s in ((1, 1, 9), (1, 9, 1), (9, 1, 1))]
    )
    families.append([ball(500, 1), Polytope((CUBE - 0.5) * [0.1, 0.1, 9.0]), ball(300, 2)])
    plain = [intersect(bodies) for bodies in families]
    monkeypatch.setattr(intersection, "HALVED_FROM", 0)
    for bodies, before in zip(families, plain, strict=True):
        found = intersect(bodies)
        assert found.volume == pytest.approx(before.volume, rel=1e-14)
        assert {tuple(row) for row in found.provenance} == {tuple(row) for row in before.provenance}
        assert len(found.vertices) == len(before.vertices)
        assert sorted(map(len, found.faces)) == sorted(map(len, before.faces))


def test_growing_on_the_way_forgets_no_vertex(monkeypatch):
    families = [cluster(m, n) for m, n in ((2, 60), (2, 900), (9, 40))]
    points = np.random.default_rng(8).normal(size=(90, 3))
    families.append(
        [Polytope(points + shift * np.array([1e-12, 2e-12, 0.0])) for shift in range(4)]
    )
    families.append(
        [Polytope(CUBE), Polytope(2.9 * np.vstack([np.eye(3), -np.eye(3)]))]
    )  # cuts one corner
    plain = [intersect(bodies) for bodies in families]
    monkeypatch.setattr(cutting, "ROWS_A_VERTEX", 1)
    for bodies, before in zip(families, plain, strict=True):
        found = intersect(bodies)
        assert found.volume == pytest.approx(before.volume, rel=1e-14)
        assert {tuple(row) for row in found.provenance} == {tuple(row) for row in before.provenance}


def test_no_plane_is_missed_where_rounding_makes_a_false_top():
    rng = np.random.default_rng(1)
    rng.normal(size=(100, 3))
    v = rng.normal(size=(2, 1000, 3))
    pair = v / np.linalg.norm(v, axis=2)[:, :, None]
    centre = np.array([0.5, 0.3, 0.1])
    bodies = [Polytope(pair[0]), Polytope(pair[1] + centre)]
    rows = np.vstack([body.half_spaces for body in bodies])
    corners = intersect(bodies).vertices
    assert (corners @ rows[:, :3].T + rows[:, 3]).max() < 1e-14


def test_each_face_lies_in_the_plane_it_is_said_to_come_from():
    bodies = cluster(4, 60)
    found = intersect(bodies)
    assert set(found.provenance[:, 0]) <= {0, 1, 2, 3} and len(found.faces) == len(found.provenance)
    for ring, (part, face) in zip(found.faces, found.provenance, strict=True):
        off = bodies[part].offsets_about(found.vertices[ring].mean(axis=0))[face]
        assert abs(off) < 1e-14
    assert found.polytope().volume == pytest.approx(found.volume, rel=1e-13)
    edges = sum(len(ring) for ring in found.faces)
    assert len(found.vertices) - edges // 2 + len(found.faces) == 2


TOUCHING = [
    ((1, 0, 0), 2, 4), ((1, 0.5, 0.25), 2, 4), ((1, 1, 0), 1, 2), ((1, 0.5, 1), 1, 2), ((1, 1, 1), 0, 1),
]  # fmt: skip


@pytest.mark.parametrize(("shift", "dimension", "n"), TOUCHING)
@pytest.mark.parametrize("scale", [1e-6, 1.0, 1e6])
def test_touching_has_volume_exactly_0_and_a_shape(shift, dimension, n, scale):
    a, b = Polytope(CUBE * scale), Polytope((CUBE + shift) * scale)
    found = intersect([a, b])
    assert (found.relation, found.volume, found.dimension) == ("touch", 0.0, dimension)
    assert len(found.vertices) == n
    low, high = np.maximum([0, 0, 0], shift), np.minimum([1, 1, 1], np.add(shift, 1))
    assert np.abs(found.vertices.min(axis=0) / scale - low).max() < 1e-14
    assert np.abs(found.vertices.max(axis=0) / scale - high).max() < 1e-14


def test_an_edge_crosses_an_edge_in_a_point():
    roof = np.array([[-1, 0, 0], [1, 0, 0], [0, -1, -1], [0, 1, -1]], dtype=float)
    keel = np.array([[0, -1, 0], [0, 1, 0], [-1, 0, 1], [1, 0, 1]], dtype=float)
    found = intersect([Polytope(roof), Polytope(keel)])
    assert (found.relation, found.volume, found.dimension) == ("touch", 0.0, 0)
    assert np.abs(found.vertices).max() < 1e-14


def test_apart_is_an_answer_and_containment_the_inner_body():
    found = intersect([Polytope(CUBE), Polytope(CUBE + 2.0)])
    assert (
        found.empty and found.volume == 0.0 and found.dimension == -1 and len(found.vertices) == 0
    )
    with pytest.raises(NotSolid):
        found.polytope()
    assert intersect([Polytope(CUBE), Polytope(CUBE * 4 - 1)]).volume == 1.0


def test_refusals():
    for call, error in (
        (lambda: intersect([]), EmptyMesh),
        (lambda: intersect([Polytope(CUBE)], "best"), BadDimension),
        (lambda: intersect([Polytope(CUBE)], threads=0), BadDimension),
    ):
        with pytest.raises(error):
            call()
