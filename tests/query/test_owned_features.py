"""What a face owns, and that leaving out face pairs whose nearest features are others' own changes no bit."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from clearance import Polyhedron
from clearance.geometry.shapes import box, cylinder, pipe, sphere
from clearance.geometry.tree import surface_of
from clearance.kernels.mesh.surface import ANYTHING, LISTED
from clearance.kernels.search.pair_query import AFRESH, FRONT_CAPACITY, nearest_at_poses, track_pair
from clearance.kernels.search.scratch import new_scratch
from tests.examples import examples, first_fast
from tests.made_cases import prism, torus
from tests.strategies import rotations

BODIES = {
    "box": box((1.0, 0.7, 0.4)),
    "many-sided caps": prism(0.3, 1.0, 40),
    "eight-sided caps": prism(0.3, 1.0, LISTED),
    "cylinder": cylinder(radius=0.3, length=1.0, tolerance=0.001),
    "ball": sphere(0.4, tolerance=0.01),
    "ring": torus(0.5, 0.12, 40, 14),
    "pipe": pipe(inner_radius=0.2, outer_radius=0.25, length=0.6, tolerance=0.002),
}


def in_triangles(shape: Polyhedron) -> Polyhedron:
    faces = np.split(shape.face_vertices, shape.face_starts[1:-1])
    return Polyhedron(
        shape.vertices, [(f[0], f[i], f[i + 1]) for f in faces for i in range(1, len(f) - 1)]
    )


def answers(a, b, poses, *, afresh):
    """(distance, bound, points, faces) at all poses, as one array of bits; how many face pairs were measured."""
    tracked = track_pair(a, b, FRONT_CAPACITY, new_scratch())
    n = len(poses)
    numbers, points, counts = (
        np.empty((n, 2)),
        np.empty((n, 2, 3)),
        np.empty((n, 5), dtype=np.int64),
    )
    assert (
        nearest_at_poses(
            tracked,
            np.eye(4)[None],
            poses,
            AFRESH if afresh else 0,
            numbers,
            points,
            counts,
        )
        == -1
    )
    return b"".join(x.tobytes() for x in (numbers, points, counts[:, :2].copy())), int(
        counts[:, 3].sum()
    )


def around(random, n, least, most):
    """Poses at a distance, turned at random or upright (parallel faces), each with three a little farther on."""
    poses = np.tile(np.eye(4), (n, 4, 1, 1))
    poses[: n // 2, :, :3, :3] = rotations(random, n // 2)[:, None]
    away = random.normal(size=(n, 3))
    away[n // 4 :: 3, :2] = 0.0
    away *= random.uniform(least, most, (n, 1)) / np.linalg.norm(away, axis=1, keepdims=True)
    poses[..., :3, 3] = away[:, None]
    poses[:, 1:, :3, 3] += random.normal(scale=1e-3, size=(n, 3, 3)).cumsum(axis=1)
    return poses.reshape(-1, 4, 4)


@pytest.mark.parametrize("name", first_fast(BODIES, 3))
@pytest.mark.parametrize("cut", [False, True], ids=["polygons", "triangles"])
@examples(6)
@given(seed=st.integers(0, 2**32 - 1), other=st.sampled_from(sorted(BODIES)))
def test_nothing_changes_but_the_work(name, cut, seed, other):
    shapes = [BODIES[name], BODIES[other]]
    a, b = (surface_of(in_triangles(shape) if cut else shape) for shape in shapes)
    whole_a, whole_b = (s._replace(owns=np.full_like(s.owns, ANYTHING)) for s in (a, b))
    random = np.random.default_rng(seed)
    poses = around(random, 12, 0.2, 1.0 + random.uniform(0.0, 30.0))
    expected, _ = answers(whole_a, whole_b, poses, afresh=True)
    for afresh in (True, False):
        found, n_faces = answers(a, b, poses, afresh=afresh)
        found_by_all, n_all = answers(whole_a, whole_b, poses, afresh=afresh)
        assert found == found_by_all == expected
        assert n_faces <= n_all
