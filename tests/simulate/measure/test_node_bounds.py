"""Every bound that prunes is at most the truth, by exact rationals, degenerate input included."""

from __future__ import annotations

import math
from dataclasses import replace
from fractions import Fraction
from typing import NamedTuple

import numpy as np
import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from clearance.compile.declared import Floats, Floats2
from clearance.compile.decorators import inline, kernel
from clearance.geometry.polyhedron import Polyhedron
from clearance.geometry.tree import join, surface_of
from clearance.kernels.arithmetic.double_double import frames_of
from clearance.kernels.arithmetic.lanes import ALL, WIDTH, lane
from clearance.kernels.arithmetic.vec3 import Vec3, rigid
from clearance.kernels.features.bounds import (
    direction_between,
    displacement,
    lower_bound_boxes,
    lower_bound_boxes_along_direction,
    lower_bound_faces_across,
    lower_bound_faces_along_direction,
    rounding_slack,
)
from clearance.kernels.mesh.surface import Surface, box_of, group_of
from clearance.kernels.motion.body_boxes import new_body_boxes
from clearance.kernels.motion.kinematics import Links
from clearance.kernels.motion.placed import new_placed_bodies, put_all
from clearance.kernels.motion.world import World, box_bound
from clearance.kernels.search.displacement import Still
from clearance.kernels.search.node_pairs import NodeGroup, bounds_of_group, views_along
from clearance.simulate.measure.layout import PairsInMotion
from clearance.simulate.measure.measure import measure
from clearance.simulate.measure.resources import Resources
from clearance.world.case import Limits
from clearance.world.motion import kinematic_motion
from clearance.world.pairs import measured_pairs
from tests import oracle
from tests.examples import examples
from tests.made_cases import faces_below, flying
from tests.oracle.rationals import posed
from tests.strategies import rotations


@inline
def bounds_of_nodes(a, b, pose_a, pose_b, direction, boxes, in_sight, alike, faces):
    """Fills the bounds of all node pairs and face pairs, with the slacks that the search takes off.

    `alike` takes how far the bounds of boxes in lanes are from those of one after another.
    """
    frames = frames_of(rigid(pose_a), rigid(pose_b))
    slack = rounding_slack(a, a.roots[0], b, b.roots[0], frames)
    p = Vec3(0.0, 0.0, 0.0)
    sight = direction_between(p, Vec3(direction[0], direction[1], direction[2]), frames.m)
    for i in range(len(a.children)):
        for j in range(len(b.children)):
            p, q = box_of(a, i), box_of(b, j)
            boxes[i, j] = lower_bound_boxes(p, q, frames.m, slack)
            in_sight[i, j] = lower_bound_boxes_along_direction(p, q, sight) - slack
            alike[i, j] = boxes[i, j]
            alike[i, j] -= lane(
                lower_bound_boxes(group_of(a, i // WIDTH), q, frames.m, slack), i % WIDTH
            )
    for i in range(len(a.normals)):
        for j in range(len(b.normals)):
            faces[i, j] = lower_bound_faces_along_direction(a, i, b, j, sight) - slack
            faces[i, j] = max(faces[i, j], lower_bound_faces_across(a, i, b, j, frames.m) - slack)


@inline
def bounds_of_groups(a, b, pose_a, pose_b, direction, cut, groups_of_a, groups_of_b):
    """Fills what the search takes as the bound of each node pair, with the group of the one and the other side."""
    frames = frames_of(rigid(pose_a), rigid(pose_b))
    still = Still(rounding_slack(a, a.roots[0], b, b.roots[0], frames))
    along = direction_between(
        Vec3(0.0, 0.0, 0.0), Vec3(direction[0], direction[1], direction[2]), frames.m
    )
    views = views_along(along, frames.m)
    for i in range(len(a.children)):
        for j in range(len(b.children)):
            of_a = bounds_of_group(a, b, views, NodeGroup(False, i // WIDTH, j), ALL, still, cut)
            of_b = bounds_of_group(a, b, views, NodeGroup(True, j // WIDTH, i), ALL, still, cut)
            groups_of_a[i, j], groups_of_b[i, j] = lane(of_a, i % WIDTH), lane(of_b, j % WIDTH)


class Bounds(NamedTuple):
    """What `bounds_of_nodes` and `bounds_of_groups` fill."""

    boxes: Floats2
    in_sight: Floats2
    alike: Floats2
    faces: Floats2
    of_a: Floats2
    of_b: Floats2


def fill_bounds(
    a: Surface, b: Surface, pose_a: Floats2, pose_b: Floats2, direction: Floats, cut: float, found: Bounds
) -> None:  # fmt: skip
    """All bounds of two surfaces."""
    bounds_of_nodes(
        a, b, pose_a, pose_b, direction, found.boxes, found.in_sight, found.alike, found.faces
    )
    bounds_of_groups(a, b, pose_a, pose_b, direction, cut, found.of_a, found.of_b)


compiled_bounds = kernel(fill_bounds)


def new_bounds(a: Surface, b: Surface) -> Bounds:
    """Room for all bounds of two surfaces."""
    of_nodes = np.empty((5, len(a.children), len(b.children)))
    return Bounds(*of_nodes[:3], np.empty((len(a.normals), len(b.normals))), *of_nodes[3:])


def body_bound_of(surface, world, enough):
    """What a sweep knows of a pair by the boxes of its bodies."""
    placed = new_placed_bodies(0, 2)
    put_all(world, np.empty(0), placed)
    return box_bound(surface, world, 0, placed, new_body_boxes(2), enough)


def triangles(random, n, kind):
    """A surface of n triangles that share no corner: of any shape, needles, points and lines, or far away."""
    corners = random.normal(size=(n, 1, 3)) + 0.4 * random.normal(size=(n, 3, 3))
    if kind == "needles":
        corners[:, 2] = corners[:, 1] + 1e-9 * random.normal(size=(n, 3))
    if kind == "no area":
        corners[:, 2] = corners[:, 1]
        corners[::2, 1] = corners[::2, 0]
        corners[::2, 2] = corners[::2, 0]
    if kind == "flat":
        corners[..., 2] = 0.25
    if kind == "lattice":
        corners = np.round(corners * 2.0) / 2.0
    if kind == "far":
        corners += 1e5
    if kind == "tiny":
        corners *= 1e-8
    return Polyhedron(corners.reshape(-1, 3), np.arange(3 * n).reshape(n, 3))


NO_LINKS = Links(
    *(np.empty(0, dtype=np.int64) for _ in range(2)), np.empty((0, 3)), np.empty((0, 4, 4)),
    np.empty(0, dtype=np.int64), np.empty(0), np.empty(0),
)  # fmt: skip


def standing_world(poses):
    """Two solids that stand, and their pair."""
    bodies = np.arange(2)
    return World(bodies, np.array([-1, -1]), bodies, poses, np.array([[0, 1]]), NO_LINKS)


KINDS = ("any", "needles", "no area", "flat", "lattice", "far", "tiny")


def pose(random, reach, turned):
    placed = np.eye(4)
    if turned:
        placed[:3, :3] = rotations(random, 1)[0]
    away = reach * random.normal(size=3)
    placed[:3, 3] = away if turned else np.round(away * 4) / 4
    return placed


def exact_distances_sq(a, b, pose_a, pose_b):
    """Fractions, a row a face of a."""
    ours, theirs = (posed(shape.vertices, at) for shape, at in ((a, pose_a), (b, pose_b)))
    return [
        [
            oracle.polygon_distance_sq(ours[3 * i : 3 * i + 3], theirs[3 * j : 3 * j + 3])
            for j in range(b.n_faces)
        ]
        for i in range(a.n_faces)
    ]


def is_at_most(bound, distance_sq):
    """bound <= root of the fraction, decided exactly; what is negative or nothing bounds anything."""
    if math.isnan(bound):
        return False
    return bound <= 0.0 or (math.isfinite(bound) and Fraction(float(bound)) ** 2 <= distance_sq)


@pytest.mark.slow
@examples(25)
@example(0, "far", "needles", 1e5, True)
@example(1, "no area", "no area", 1.0, False)
@given(
    st.integers(0, 2**32 - 1), st.sampled_from(KINDS), st.sampled_from(KINDS),
    st.sampled_from([0.0, 1e-7, 1.0, 4.0, 1e5]), st.booleans(),
)  # fmt: skip
def test_no_bound_of_a_node_or_face_is_above_the_exact_distance(
    seed, kind_a, kind_b, reach, turned
):
    """Compiled: there `Lanes` are in one register."""
    random = np.random.default_rng(seed)
    a, b = triangles(random, 3, kind_a), triangles(random, 3, kind_b)
    pose_a, pose_b = pose(random, reach, turned), pose(random, reach, turned)
    one, two = surface_of(a), surface_of(b)
    found = new_bounds(one, two)
    direction = random.normal(size=3) if turned else np.eye(3)[random.integers(3)]
    compiled_bounds(one, two, pose_a, pose_b, direction, random.choice([0.0, 1.0, np.inf]), found)
    truth = exact_distances_sq(a, b, pose_a, pose_b)
    for i, below_a in enumerate(faces_below(one)):
        for j, below_b in enumerate(faces_below(two)):
            if not (below_a and below_b):  # a lane without a node
                continue
            least_sq = min(truth[f][g] for f in below_a for g in below_b)
            assert is_at_most(found.boxes[i, j], least_sq)
            assert is_at_most(found.in_sight[i, j], least_sq)
            assert is_at_most(found.of_a[i, j], least_sq)
            assert is_at_most(found.of_b[i, j], least_sq)
            assert found.alike[i, j] == 0.0
    for f in range(3):
        for g in range(3):
            assert is_at_most(found.faces[f, g], truth[f][g])


@examples(50)
@example(0, "far", "needles", 1e5, 0.0)
@example(1, "tiny", "far", 1e-7, 4e-7)
@given(
    st.integers(0, 2**32 - 1), st.sampled_from(KINDS), st.sampled_from(KINDS),
    st.sampled_from([0.0, 1e-7, 1.0, 4.0, 1e5]), st.sampled_from([0.0, 1e-12, 4e-7]),
)  # fmt: skip
def test_no_bound_of_two_bodies_is_above_the_exact_distance(seed, kind_a, kind_b, reach, off):
    """By their balls and by their boxes, also where a rotation is `off` from orthonormal."""
    random = np.random.default_rng(seed)
    a, b = triangles(random, 3, kind_a), triangles(random, 3, kind_b)
    poses = np.array([pose(random, reach, True), pose(random, reach, True)])
    poses[:, :3, :3] += off / 3.0 * random.uniform(-1.0, 1.0, size=(2, 3, 3))
    surface, world = join([a, b]), standing_world(poses)
    truth = min(map(min, exact_distances_sq(a, b, *poses)))
    by_balls, by_boxes = (body_bound_of(surface, world, enough) for enough in (-np.inf, np.inf))
    assert is_at_most(by_balls, truth)
    assert is_at_most(by_boxes, truth)
    assert by_boxes >= by_balls


def test_edges_that_cross_are_told_apart_across_both():
    """Two upright triangles, point on point but for their edges that cross: no plane of either parts them."""
    a = Polyhedron([[-1, 0, 0], [1, 0, 0], [0, 0.1, -1]], [(0, 1, 2)])
    b = Polyhedron([[0, -1, 0.01], [0, 1, 0.01], [0.1, 0, 1]], [(0, 1, 2)])
    one, two = surface_of(a), surface_of(b)
    found = new_bounds(one, two)
    fill_bounds(one, two, np.eye(4), np.eye(4), np.array([1.0, 0, 0]), np.inf, found)
    assert found.faces[0, 0] == pytest.approx(0.01, abs=1e-12)


@examples(40)
@given(
    st.integers(0, 2**32 - 1),
    st.sampled_from(KINDS),
    st.sampled_from([0.0, 1e-9, 1e-3, 1.0, 1e4]),
    st.booleans(),
)
def test_no_corner_moves_farther_than_its_bound(seed, kind, reach, turned):
    """The displacement is convex over the faces, so the corners decide; poses are taken number by number."""
    random = np.random.default_rng(seed)
    shape = triangles(random, 4, kind)
    before = pose(random, 1.0, True)
    after = before.copy() if not turned else pose(random, 1.0, True)
    after[:3, 3] = before[:3, 3] + reach * random.normal(size=3)
    surface = surface_of(shape)
    bound = displacement(surface, surface.roots[0], before, after)
    for start, end in zip(posed(shape.vertices, before), posed(shape.vertices, after), strict=True):
        moved_sq = sum((x - y) ** 2 for x, y in zip(start, end, strict=True))
        assert moved_sq <= Fraction(bound) ** 2


@examples(10)
@given(
    st.integers(0, 2**32 - 1), st.sampled_from(KINDS[:5]), st.sampled_from(KINDS[:5]),
    st.sampled_from([0.0, 1e-3, 0.1, 3.0]), st.sampled_from(["minimum", "limit"]),
)  # fmt: skip
def test_no_bound_carried_from_step_to_step_is_above_the_exact_distance(
    seed, kind_a, kind_b, stride, need
):
    random = np.random.default_rng(seed)
    link, obstacles = triangles(random, 2, kind_a), [triangles(random, 2, kind_b) for _ in range(2)]
    standing = [pose(random, 3.0, True) for _ in obstacles]
    walk = np.cumsum(stride * random.normal(size=(6, 6)), axis=0)
    case = replace(
        flying("walk", link, list(zip(obstacles, standing, strict=True)), walk),
        limits=Limits(0.0, float(random.choice([0.01, 1.0, 3.0]))),
    )
    motion = kinematic_motion(case.robots[0])
    found = measure(PairsInMotion(case, [motion], measured_pairs(case)[0]), need, Resources(jobs=1))
    truth = [
        min(
            min(map(min, exact_distances_sq(link, shape, moved[-1], at)))
            for shape, at in zip(obstacles, standing, strict=True)
        )
        for moved in motion.poses()
    ]
    for step, least_sq in enumerate(truth):
        if found.pair[step] < 0:
            assert is_at_most(found.lower_bound[step], least_sq)
        else:  # the pose is rounded to a rotation, which moves what is as far away as this by as much
            assert found.lower_bound[step] <= oracle.root(least_sq) + Fraction(1e-15) * 100
            assert found.clearance[step] == pytest.approx(float(oracle.root(least_sq)), abs=1e-13)
    assert (found.pair >= 0).any()
