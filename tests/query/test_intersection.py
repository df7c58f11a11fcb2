"""Common points and shared regions of convex bodies, thin, flat and touching ones too, against exact rationals."""

from __future__ import annotations

import itertools

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from clearance.errors import BadDimension, BadShape, EmptyMesh, NotFinite
from clearance.geometry.polytope import Polytope
from clearance.geometry.polytope_hull import NotSolid
from clearance.query import cutting, intersection, thin
from clearance.query.common_point import common_point, common_point_paper
from clearance.query.intersection import intersect
from tests.examples import first_fast
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
@pytest.mark.parametrize(
    ("room", "name", "value"), [(intersection, "HALVED_FROM", 0), (cutting, "ROWS_A_VERTEX", 1)]
)
def test_halves_and_growing_on_the_way_change_nothing(room, name, value, monkeypatch):
    families = [cluster(m, n) for m, n in ((2, 8), (2, 60), (2, 900), (9, 40), (24, 30))]
    families += [
        [Polytope(CUBE), Polytope(CUBE * 0.5 + 0.3), Polytope(CUBE + 0.25)],
        [Polytope(CUBE)] * 4,
        [Polytope(CUBE * s - np.array(s) / 2) for s in ((1, 1, 9), (1, 9, 1), (9, 1, 1))],
        [ball(500, 1), Polytope((CUBE - 0.5) * [0.1, 0.1, 9.0]), ball(300, 2)],
        [Polytope(CUBE), Polytope(2.9 * np.vstack([np.eye(3), -np.eye(3)]))],  # cuts one corner
    ]
    points = np.random.default_rng(8).normal(size=(90, 3))
    families.append([Polytope(points + k * np.array([1e-12, 2e-12, 0.0])) for k in range(4)])
    plain = [intersect(bodies) for bodies in families]
    monkeypatch.setattr(room, name, value)
    for bodies, before in zip(families, plain, strict=True):
        found = intersect(bodies)
        assert found.volume == pytest.approx(before.volume, rel=1e-14)
        assert {tuple(row) for row in found.provenance} == {tuple(row) for row in before.provenance}
        assert len(found.vertices) == len(before.vertices)
        assert sorted(map(len, found.faces)) == sorted(map(len, before.faces))


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


def certificate_is_right(bodies, proof) -> bool:
    """Weights times normals vanish, and weights times offsets do not exceed 0: nothing inside all."""
    rows = [bodies[k].half_spaces[f] for k, f in zip(proof.parts, proof.faces, strict=True)]
    total = proof.weights @ np.array(rows)
    return len(rows) <= 4 and np.abs(total[:3]).max() < 1e-12 and total[3] > -1e-12


def test_apart_bodies_have_a_certificate_and_two_a_separating_plane():
    for seed in range(30):
        rng = np.random.default_rng(seed)
        centre = rng.normal(size=3)
        a, b = (
            ball(25, seed),
            ball(25, seed + 50, centre / np.linalg.norm(centre) * rng.uniform(1.2, 2.5)),
        )
        met, paper = common_point([a, b]), common_point_paper(a, b)
        assert met.relation == paper.relation
        if met.relation == "apart":
            assert certificate_is_right([a, b], met.certificate)
            for normal in (met.certificate.normal, paper.certificate.normal):
                assert (a.vertices @ normal).max() < (b.vertices @ normal).min()
        else:
            for point in (met.point, paper.point):
                assert min(a.offsets_about(point).min(), b.offsets_about(point).min()) > 0.0


@pytest.mark.parametrize("shift", [(1, 0, 0), (1, 1, 0), (1, 1, 1), (1, 0.5, 0.25)])
def test_touching_is_neither_overlap_nor_apart(shift):
    a, b = Polytope(CUBE), Polytope(CUBE + shift)
    assert common_point([a, b]).relation == "touch"
    assert common_point_paper(a, b).relation == "touch"


def posed(angle: float, shift) -> np.ndarray:
    pose = np.eye(4)
    pose[:3, :3] = Rotation.from_rotvec([0.3 * angle, -angle, 0.5 * angle]).as_matrix()
    pose[:3, 3] = shift
    return pose


@pytest.mark.slow
@pytest.mark.parametrize("m", [2, 5])
def test_along_a_trajectory_a_warm_start_gives_the_same_answer_with_less_work(m):
    bodies = [ball(50, i) for i in range(m)]
    warm, work, seen = (), [0, 0], set()
    for step in range(60):
        poses = [posed(0.02 * i * step, [0.04 * step * (i == 1), 0.1 * i, 0.0]) for i in range(m)]
        cold = common_point(bodies, poses)
        met = common_point(bodies, poses, warm)
        moved = [
            Polytope(b.vertices @ p[:3, :3].T + p[:3, 3])
            for b, p in zip(bodies, poses, strict=True)
        ]
        assert met.relation == cold.relation == common_point(moved).relation
        if met.relation == "overlap":
            assert met.level == pytest.approx(cold.level, abs=1e-12)
            assert cold.level == pytest.approx(common_point(moved).level, abs=1e-12)
            assert min(b.offsets_about(met.point).min() for b in moved) > 0.0
        warm = met.warm
        work[0] += cold.n_faces
        work[1] += met.n_faces
        seen.add(met.relation)
    assert seen == {"overlap", "apart"}
    assert m > 2 or work[1] < 0.3 * work[0]


def test_bodies_without_a_common_point_to_ask_for_are_refused():
    with pytest.raises(EmptyMesh):
        common_point([])
    with pytest.raises(BadShape, match="item 1 is a ndarray"):
        common_point([Polytope(CUBE), CUBE])
    with pytest.raises(BadShape, match=r"poses have shape \(1, 4, 4\)"):
        common_point([Polytope(CUBE)] * 2, [np.eye(4)])
    with pytest.raises(NotFinite):
        common_point([Polytope(CUBE)], [np.full((4, 4), np.nan)])


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


def test_a_thin_region_near_too_many_planes_keeps_its_first_digits(monkeypatch):
    monkeypatch.setattr(thin, "MOST_PLANES", 0)
    exact, found = exact_and_found(turned(CUBE, 3), turned(CUBE + [1.0 - 1e-9, 0.3, 0.2], 3))
    assert found == pytest.approx(exact, rel=1e-4)


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
