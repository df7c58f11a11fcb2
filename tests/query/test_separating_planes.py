"""Two planes separate bodies by no more than their distance; only faces touching them are as near as they say."""

import math

import numpy as np
import pytest

import clearance as cl
from clearance.geometry.polyhedron import Polyhedron
from clearance.geometry.shapes import cylinder, pipe
from clearance.geometry.tree import surface_of
from clearance.kernels.arithmetic.double_double import frames_of
from clearance.kernels.arithmetic.vec3 import Vec3, rigid
from clearance.kernels.features.bounds import margin_of, rounding_slack
from clearance.kernels.features.face_pair import Hit
from clearance.kernels.features.posed_pair import PosedPair
from clearance.kernels.search.scratch import new_scratch
from clearance.kernels.search.separating_planes import separate
from tests import oracle
from tests.made_cases import SOLIDS, at, ball, faces_of
from tests.strategies import rotations


def separate_all(a, b, poses, points, limits, out, waiting):
    """Fills `out` (n, 3): what the planes prove [m], of all and of what does not wait, and the margin.

    b is at `poses` (n, 4, 4) in the frame of a; the search begins at `points` (n, 2, 3) in the frame of a.
    `waiting` (n, 144, 2) becomes the faces of the leaves that wait, or -1.
    """
    scratch = new_scratch()
    root_a, root_b = a.roots[0], b.roots[0]
    for i in range(len(poses)):
        frames = frames_of(rigid(np.eye(4)), rigid(poses[i]))
        slack = rounding_slack(a, root_a, b, root_b, frames)
        p = Vec3(points[i, 0, 0], points[i, 0, 1], points[i, 0, 2])
        q = Vec3(points[i, 1, 0], points[i, 1, 1], points[i, 1, 2])
        begin = Hit(np.inf, 2**62, 2**62, p, q)
        roots = PosedPair(a, root_a, b, root_b, frames)
        found = separate(roots, begin, limits[i], slack, scratch)
        out[i, 0], out[i, 1], out[i, 2] = found.lower_bound, found.beyond, margin_of(slack)
        for k in range(found.n_waiting):
            waiting[i, k, 0] = a.children[~scratch.nodes[k, 0], 0]
            waiting[i, k, 1] = b.children[scratch.nodes[k, 1], 0]


SHAPES = {
    **SOLIDS,
    "cylinder": lambda random: cylinder(0.5, 2.0, sections=32),
    "pipe": lambda random: pipe(inner_radius=0.4, outer_radius=0.5, length=1.5, sections=32),
    "sheet": lambda random: half_of(ball(1.0, 2)),
}


def half_of(shape: Polyhedron) -> Polyhedron:
    """The faces of a shape above its middle: an open surface."""
    above = [face for face in faces_of(shape) if shape.vertices[face][:, 2].mean() > 0.0]
    return Polyhedron(shape.vertices, above)


@pytest.mark.slow
@pytest.mark.parametrize("kind_b", SHAPES)
@pytest.mark.parametrize("kind_a", ["dented"])
def test_planes_promise_no_more_than_the_distance(kind_a: str, kind_b: str) -> None:
    random = np.random.default_rng([*map(ord, kind_a + kind_b)])
    a, b = SHAPES[kind_a](random), SHAPES[kind_b](random)
    n = 25
    places = random.normal(size=(n, 3))
    places *= (
        random.choice([1.2, 1.8, 2.2, 2.5, 4.0], (n, 1)) / np.linalg.norm(places, axis=1)[:, None]
    )
    poses = np.array(
        [at(*place, turned=turn) for place, turn in zip(places, rotations(random, n), strict=True)]
    )
    truths = [cl.distance(a, b, pose_b=pose) for pose in poses]
    points = np.array([[random.normal(size=3) * 0.1, pose[:3, 3]] for pose in poses])
    limits = np.array(
        [random.choice([math.inf, 0.5 * near.distance, 0.99 * near.distance]) for near in truths]
    )
    out, waiting = np.empty((n, 3)), np.full((n, 144, 2), -1)
    separate_all(surface_of(a), surface_of(b), poses, points, limits, out, waiting)
    for i, near in enumerate(truths):
        floor, beyond, margin = out[i]
        if i < 2:
            exact = oracle.polyhedron_distance_sq(
                a.vertices, faces_of(a), b.vertices, faces_of(b), None, poses[i]
            )
            assert floor <= float(oracle.root(exact)) or near.contact
        if near.contact:
            assert floor <= 0.0
            continue
        assert floor <= near.distance
        assert floor > limits[i] or waiting[i, 0, 0] >= 0 or floor == -math.inf
        if waiting[i, 0, 0] >= 0 and beyond > near.distance + margin:
            assert [near.face_a, near.face_b] in waiting[i].tolist()
