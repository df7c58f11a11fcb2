"""The deepest common point, the paper's GJK, certificates and hill climbing."""

from __future__ import annotations

import itertools

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from clearance.errors import BadShape, EmptyMesh, NotFinite
from clearance.geometry.polytope import Polytope
from clearance.query.common_point import common_point, common_point_paper

CUBE = np.array(list(itertools.product([0.0, 1.0], repeat=3)))


def ball(n: int, seed: int, centre=(0.0, 0.0, 0.0)) -> Polytope:
    v = np.random.default_rng([n, seed]).normal(size=(n, 3))
    return Polytope(v / np.linalg.norm(v, axis=1)[:, None] + centre)


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


def turned(angle: float, shift) -> np.ndarray:
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
        poses = [turned(0.02 * i * step, [0.04 * step * (i == 1), 0.1 * i, 0.0]) for i in range(m)]
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


def test_refusals():
    with pytest.raises(EmptyMesh):
        common_point([])
    with pytest.raises(BadShape, match="item 1 is a ndarray"):
        common_point([Polytope(CUBE), CUBE])
    with pytest.raises(BadShape, match=r"poses have shape \(1, 4, 4\)"):
        common_point([Polytope(CUBE)] * 2, [np.eye(4)])
    with pytest.raises(NotFinite):
        common_point([Polytope(CUBE)], [np.full((4, 4), np.nan)])
