"""A search within a limit: what it finds is nearest, and what it proves of bodies that are farther is true."""

import numpy as np
import pytest

import clearance as cl
from clearance.geometry.shapes import cylinder
from clearance.geometry.tree import surface_of
from clearance.kernels.arithmetic.double_double import frames_of
from clearance.kernels.arithmetic.vec3 import rigid
from clearance.kernels.features.posed_pair import PosedPair
from clearance.kernels.search.body_pair import NO_FACE, TO_THE_END, PairQuestion, search
from clearance.kernels.search.front import POOL, PairFront, no_fronts
from clearance.kernels.search.scratch import new_scratch
from tests.examples import first_fast
from tests.made_cases import SOLIDS, at
from tests.strategies import rotations


def searches(a, b, poses, limits, wanted, seeds, moved, out):
    """Fills `out` (n, 2) [m]: the distance found, or infinity, and the bound proven.

    All are of one pair that goes on from its front, b at `poses` (n, 4, 4) in the frame of a, which it has `moved`
    (n,) [m] to from the one before. Seeds (n, 2) of -2 stand for those that the last search gave back.
    """
    fronts, scratch = no_fronts(1, POOL), new_scratch()
    face_a, face_b = NO_FACE, NO_FACE
    way = 0.0
    for i in range(len(poses)):
        way += moved[i]
        if seeds[i, 0] != -2:
            face_a, face_b = seeds[i, 0], seeds[i, 1]
        asked = PairQuestion(limits[i], wanted[i], face_a, face_b, True, TO_THE_END, False)
        frames = frames_of(rigid(np.eye(4)), rigid(poses[i]))
        bodies = PosedPair(a, 0, b, 0, frames)
        found = search(bodies, asked, PairFront(fronts, 0, way), scratch)
        out[i, 0] = np.sqrt(found.hit.gap_sq) if found.hit.face_a != 2**62 else np.inf
        out[i, 1] = found.lower_bound
        face_a, face_b = found.face_a, found.face_b


SHAPES = {
    **SOLIDS,
    "pipe": lambda random: cylinder(0.5, 2.0),
}


def wandering(random: np.random.Generator, n: int) -> tuple[np.ndarray, np.ndarray]:
    """Poses (n, 4, 4) of a body that goes past another, in strides of all sizes; no less than each stride [m]."""
    place, turned = random.normal(size=3), rotations(random, 1)[0]
    place *= random.uniform(2.0, 5.0) / np.linalg.norm(place)
    poses, moved = [at(*place, turned=turned)], [0.0]
    for _ in range(n - 1):
        stride = random.choice([0.0, 1e-9, 1e-3, 0.05, 0.3])
        step = stride * random.normal(size=3)
        place = place + step
        poses.append(at(*place, turned=turned))
        moved.append(float(np.linalg.norm(step)) * (1.0 + 1e-9))
    return np.array(poses), np.array(moved)


@pytest.mark.parametrize("kind_b", first_fast(["dented", "box"], 1))
@pytest.mark.parametrize("kind_a", SHAPES)
def test_what_a_search_within_a_limit_says_is_true(kind_a, kind_b):
    random = np.random.default_rng([len(kind_a), len(kind_b), ord(kind_a[0]), ord(kind_b[0])])
    for _ in range(6):
        a, b = SHAPES[kind_a](random), SHAPES[kind_b](random)
        poses, moved = wandering(random, 40)
        truth = np.array([cl.distance(a, b, pose_b=pose).distance for pose in poses])
        limits = truth * random.choice(
            [0.3, 0.9, 0.999, 1.0 - 1e-5, 1.0 + 1e-12, 1.01, 2.0], len(poses)
        )
        wanted = limits * random.choice([0.5, 0.99, 1.0], len(poses))
        seeds = random.integers(-1, [a.n_faces, b.n_faces], (len(poses), 2))
        seeds[(seeds < 0).any(axis=1)] = NO_FACE
        seeds[random.random(len(poses)) < 0.6] = -2
        out = np.empty((len(poses), 2))
        searches(surface_of(a), surface_of(b), poses, limits, wanted, seeds, moved, out)
        free = truth > 0.0
        (found, proven), truth, limits, wanted = (
            out[free].T,
            truth[free],
            limits[free],
            wanted[free],
        )
        assert (proven <= truth).all()
        assert (found[wanted >= truth] == truth[wanted >= truth]).all()
        assert np.isinf(found[wanted < truth * (1.0 - 1e-12)]).all()
        assert (proven >= np.minimum(limits, truth) - 1e-7).all()
