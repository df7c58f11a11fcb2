"""What a search leaves out holds no nearest points: nodes turned away, what planes separate, boxes side by side.

Bodies have few faces: rational arithmetic is asked for every pair of them.
"""

from __future__ import annotations

import itertools
import math

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

import clearance as cl
from clearance.geometry.polyhedron import Polyhedron
from clearance.geometry.shapes import cylinder, pipe
from clearance.geometry.tree import surface_of
from clearance.kernels.arithmetic.double_double import frames_of
from clearance.kernels.arithmetic.lanes import ALL, WIDTH, lane
from clearance.kernels.arithmetic.vec3 import Vec3, rigid
from clearance.kernels.features.bounds import direction_between, margin_of, rounding_slack
from clearance.kernels.features.face_pair import Hit
from clearance.kernels.features.posed_pair import PosedPair
from clearance.kernels.motion.boxes_along_path import ROUNDING, CarriedBoxes, steps_together
from clearance.kernels.search.displacement import Still
from clearance.kernels.search.node_pairs import (
    NodeGroup,
    bounds_of_group,
    turned_away,
    views_along,
)
from clearance.kernels.search.scratch import new_scratch
from clearance.kernels.search.separating_planes import separate
from tests import oracle
from tests.examples import examples
from tests.made_cases import (
    SOLIDS,
    at,
    ball,
    corners_moved,
    dented,
    faces_below,
    faces_of,
    torus,
)
from tests.strategies import rotations


def is_turned_away(a, b, pose_a, pose_b, i, j):
    """If the node i of a is left out from j of b where both are apart, and j from i."""
    frames = frames_of(rigid(pose_a), rigid(pose_b))
    still = Still(rounding_slack(a, a.roots[0], b, b.roots[0], frames))
    views = views_along(
        direction_between(Vec3(0.0, 0.0, 0.0), Vec3(0.0, 0.0, 1.0), frames.m), frames.m
    )
    for group, k in ((NodeGroup(False, i // WIDTH, j), i), (NodeGroup(True, j // WIDTH, i), j)):
        bounds = bounds_of_group(a, b, views, group, ALL, still, np.inf)
        away = turned_away(a, b, views, group, ALL, bounds, still)
        yield lane(bounds, k % WIDTH) > 0.0 and away >> k % WIDTH & 1


def crossing(random):
    """Two dented balls in one surface that cut each other; what is near may be inside the other one."""
    one, two = dented(random, 0), dented(random, 0)
    return Polyhedron.merged([one, two.transformed(at(*random.normal(scale=0.4, size=3)))])


def fan(random):
    """Faces round one corner, some two fans of them, pinched."""
    n = int(random.integers(3, 8))
    turn = np.sort(random.uniform(0.0, 2.0 * np.pi, n))
    rim = np.stack([np.cos(turn), np.sin(turn), random.uniform(-1.5, 1.5, n)], axis=1)
    vertices = np.concatenate([[[0.0, 0.0, 0.0]], rim, -rim * random.uniform(0.5, 2.0, (n, 1))])
    faces = [(0, 1 + k, 1 + (k + 1) % n) for k in range(n)]
    if random.random() < 0.5:
        faces += [(0, 1 + n + (k + 1) % n, 1 + n + k) for k in range(n)]
    return Polyhedron(vertices, faces)


def half(random):
    shape = dented(random, 0)
    return Polyhedron(shape.vertices, faces_of(shape)[: shape.n_faces // 2])


def twice(random):
    shape = dented(random, 0)
    return Polyhedron(shape.vertices, faces_of(shape) + [face[::-1] for face in faces_of(shape)])


def copied(random):
    """Some faces twice, some of these the other way round."""
    shape = dented(random, 0)
    again = [face for face in faces_of(shape) if random.random() < 0.4]
    return Polyhedron(
        shape.vertices, faces_of(shape) + [face[:: random.choice([-1, 1])] for face in again]
    )


def thin_shell(random):
    shape = dented(random, 0)
    return Polyhedron.merged([shape, corners_moved(shape, 0.97 * shape.vertices).flipped()])


def some_turned_round(random):
    shape = dented(random, 0)
    turned = random.random(shape.n_faces) < 0.1
    faces = [
        face[::-1] if round_ else face for face, round_ in zip(faces_of(shape), turned, strict=True)
    ]
    return Polyhedron(shape.vertices, faces)


def dented_ring(random):
    shape = torus(1.0, 0.3, 6, 4)
    return corners_moved(
        shape, shape.vertices + random.normal(scale=0.08, size=shape.vertices.shape)
    )


def squeezed(random, height):
    shape = dented(random, 0)
    return corners_moved(shape, shape.vertices * (1.0, height, 1.0))


KINDS = {
    "ball": lambda random: ball(1.0, 0),
    "dented": lambda random: dented(random, 0),
    "ring": lambda random: torus(1.0, 0.3, 6, 4),
    "dented ring": dented_ring,
    "inside out": lambda random: dented(random, 0).flipped(),
    "some turned round": some_turned_round,
    "half": half,
    "crossing": crossing,
    "fan": fan,
    "twice": twice,
    "copied": copied,
    "thin shell": thin_shell,
    "needles": lambda random: squeezed(random, 1e-5),
    "flat": lambda random: squeezed(random, 0.0),
    "box": lambda random: cl.box((1.0, 0.6, 0.3)),
    "pipe": lambda random: cl.pipe(inner_radius=0.4, outer_radius=0.5, length=1.0, sections=6),
}


def owners_of_the_nearest(a, b, pose_a, pose_b):
    """The faces of least index that hold the nearest points; None where the bodies touch."""
    sq, attained = oracle.nearest_faces(
        a.vertices, faces_of(a), b.vertices, faces_of(b), pose_a, pose_b
    )
    return None if sq == 0 else (min(f for f, _ in attained), min(g for _, g in attained))


def nodes_over(surface, face):
    """The nodes of the tree that a face lies below."""
    return [node for node, below in enumerate(faces_below(surface)) if face in below]


def anywhere(random, reach):
    turned = rotations(random, 1)[0]
    return at(*(reach * random.normal(size=3)), turned)


@pytest.mark.slow
@examples(20)
@example(0, "dented", "fan", 2.0, 0.0)
@example(1, "crossing", "twice", 1.0, 4e-7)
@example(2, "copied", "thin shell", 2.0, 0.0)
@given(
    st.integers(0, 2**32 - 1), st.sampled_from(sorted(KINDS)), st.sampled_from(sorted(KINDS)),
    st.sampled_from([0.5, 1.0, 2.0, 10.0]), st.sampled_from([0.0, 4e-7]),
)  # fmt: skip
def test_what_holds_the_nearest_points_is_not_turned_away(seed, kind_a, kind_b, reach, off):
    random = np.random.default_rng(seed)
    a, b = KINDS[kind_a](random), KINDS[kind_b](random)
    pose_a, pose_b = anywhere(random, 0.0), anywhere(random, reach)
    pose_b[:3, :3] += off / 3.0 * random.uniform(-1.0, 1.0, size=(3, 3))
    owners = owners_of_the_nearest(a, b, pose_a, pose_b)
    if owners is None:
        return
    one, two = surface_of(a), surface_of(b)
    for i, j in itertools.product(*(map(nodes_over, (one, two), owners))):
        assert not any(is_turned_away(one, two, pose_a, pose_b, i, j))


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


N_STEPS = 40


def way(rng: np.random.Generator, pace: float, turn: float) -> np.ndarray:
    """(n, 4, 4) a body that wanders and turns."""
    poses = np.tile(np.eye(4), (N_STEPS, 1, 1))
    turns = np.cumsum(turn * rng.standard_normal((N_STEPS, 3)), axis=0)
    poses[:, :3, :3] = Rotation.from_rotvec(turns).as_matrix()
    poses[:, :3, 3] = 3.0 * rng.standard_normal(3) + np.cumsum(
        pace * rng.standard_normal((N_STEPS, 3)), axis=0
    )
    return poses


def gaps_along_axes(bounds: np.ndarray, other: np.ndarray, m: np.ndarray) -> np.ndarray:
    """(n,) [m] how far a box that is seen by `m` (n, 4, 4) is from the first along that one's axes."""
    half, half_of_other = (bounds[1] - bounds[0]) / 2, (other[1] - other[0]) / 2
    away = m[:, :3, :3] @ other.mean(axis=0) + m[:, :3, 3] - bounds.mean(axis=0)
    return (np.abs(away) - half - np.abs(m[:, :3, :3]) @ half_of_other).max(axis=1)


def gaps_of_balls(bounds: np.ndarray, poses: np.ndarray) -> np.ndarray:
    """(n,) [m] how far the balls round two boxes (2, 2, 3) are from each other, at poses (n, 2, 4, 4)."""
    middles = [poses[:, i, :3, :3] @ bounds[i].mean(axis=0) + poses[:, i, :3, 3] for i in (0, 1)]
    radii = np.linalg.norm(bounds[:, 1] - bounds[:, 0], axis=1) / 2
    return np.linalg.norm(middles[0] - middles[1], axis=1) - radii.sum()


def gaps_along_centres(bounds: np.ndarray, poses: np.ndarray) -> np.ndarray:
    """(n,) [m] how far two boxes are from each other along the line of their middles."""
    middles = [poses[:, i, :3, :3] @ bounds[i].mean(axis=0) + poses[:, i, :3, 3] for i in (0, 1)]
    away = middles[1] - middles[0]
    length = np.linalg.norm(away, axis=1)
    along = away / length[:, None]
    seen = [np.einsum("nij,ni->nj", poses[:, i, :3, :3], along) for i in (0, 1)]
    reach = [np.abs(seen[i]) @ (bounds[i, 1] - bounds[i, 0]) / 2 for i in (0, 1)]
    return length - reach[0] - reach[1]


PACES = st.sampled_from([0.0, 1e-4, 0.01, 0.1, 0.5, 2.0])


@settings(max_examples=200)
@given(st.integers(0, 10**6), PACES, PACES, st.sampled_from([0.1, 1.0, 10.0]), st.booleans())
def test_where_boxes_are_omitted_they_are_beside_each_other_and_else_never(
    seed: int, pace: float, turn: float, slow: float, stands: bool
) -> None:
    rng = np.random.default_rng(seed)
    bounds = np.sort(rng.normal(0.0, 1.0, (2, 2, 3)), axis=1) * rng.lognormal(0.0, 1.0, (2, 1, 3))
    poses = np.stack([way(rng, pace, turn), way(rng, pace * slow, turn * slow)], axis=1)
    links = np.array([0, -1 if stands else 1])
    standing = np.stack([np.eye(4), poses[0, 1]])
    if stands:
        poses[:, 1] = poses[0, 1]
    spans = np.empty((1, 2), dtype=np.int64)
    boxes = CarriedBoxes(bounds, links, standing)
    steps_together(boxes, np.array([[0, 1]]), np.ascontiguousarray(poses[:, : 2 - stands]), spans)
    seen = np.linalg.inv(poses[:, 0]) @ poses[:, 1]
    apart = np.max(
        [
            gaps_along_axes(bounds[0], bounds[1], seen),
            gaps_along_axes(bounds[1], bounds[0], np.linalg.inv(seen)),
            gaps_along_centres(bounds, poses),
            gaps_of_balls(bounds, poses),
        ],
        axis=0,
    )
    first, end = spans[0]
    omitted = np.ones(N_STEPS, dtype=bool)
    omitted[first:end] = False
    assert (apart[omitted] > 0.0).all()
    largest = np.abs(poses[:, :, :3, 3]).sum() + np.abs(bounds).sum()
    if first < end:
        assert apart[[first, end - 1]].max() <= 2.0 * ROUNDING * largest


@pytest.mark.parametrize("far", [1.0, -1.0])
def test_a_box_that_flies_by_is_met_only_where_it_is_near(far: float) -> None:
    poses = np.tile(np.eye(4), (21, 1, 1, 1))
    poses[:, 0, 0, 3] = np.linspace(-5.0, 5.0, 21)
    cube = np.array([[-0.5] * 3, [0.5] * 3])
    beside = np.eye(4)
    beside[1, 3] = 1.1 * far
    standing = np.stack([np.eye(4), np.eye(4), beside])
    boxes = CarriedBoxes(np.stack([cube] * 3), np.array([0, -1, -1]), standing)
    spans = np.empty((3, 2), dtype=np.int64)
    steps_together(boxes, np.array([[0, 1], [1, 0], [0, 2]]), poses, spans)
    assert spans.tolist() == [[8, 13], [8, 13], [0, 0]]
