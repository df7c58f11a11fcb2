"""Pairs in doubt at any positions: boxes that are looked at first leave out none that the whole question finds."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import clearance as cl
from clearance.geometry.point_cloud import PointCloud
from clearance.geometry.polyhedron import Polyhedron
from clearance.query.inside import doubt_of
from clearance.world.case import Case
from clearance.world.forest import forest_of
from clearance.world.pairs import Pair, measured_pairs
from clearance.world.pose_table import PoseTable
from tests.made_cases import arm, at, ball, faces_of, flying, torus

BALL = ball(0.6, 2)
FACES = faces_of(BALL)
TINY, ROD = cl.box((0.06, 0.05, 0.04)), cl.box((0.02, 0.02, 0.5))
N = 150


def with_faces(faces: list) -> Polyhedron:
    return Polyhedron(BALL.vertices, faces)


def faces_alone() -> Polyhedron:
    """The ball, each face with corners of its own."""
    centres = BALL.centres[:, None]
    corners = centres + 0.9999 * (BALL.vertices[np.array(FACES)] - centres)
    return Polyhedron(corners.reshape(-1, 3), np.arange(3 * len(FACES)).reshape(-1, 3).tolist())


def pierced_cube() -> Polyhedron:
    """A cube of triangles that lacks one in its top, whose middle is at the origin."""
    import trimesh

    mesh = trimesh.creation.box((1.0, 1.0, 1.0)).subdivide().subdivide()
    middles = mesh.triangles.mean(axis=1)
    hole = int(np.argmax(middles[:, 2] - 0.1 * np.abs(middles[:, :2]).sum(axis=1)))
    faces = np.delete(mesh.faces, hole, axis=0)
    return Polyhedron(mesh.vertices - middles[hole], faces.tolist())


ONE_HOLE, LID_OFF = with_faces(FACES[1:]), with_faces(FACES[12:])
TWO_SIDED = with_faces([*FACES, *(face[::-1] for face in FACES)])
POINTS = PointCloud(np.random.default_rng(2).uniform(-0.1, 0.1, (30, 3)), 0.005)


def flown(shape: Polyhedron, *obstacles: tuple[Polyhedron, np.ndarray]) -> Case:
    return flying("doubtful", shape, list(obstacles), np.zeros((2, 6)))


def with_an_obstacle_that_moves(case: Case) -> Case:
    """The first obstacle is moved by a table, which a configuration does not give."""
    first, *rest = case.obstacles
    begin = first.world_from_body[:3, 3]
    table = PoseTable(np.array([0.0, 1.0]), np.stack([begin, begin + 0.3]), np.eye(4)[[3, 3]])
    moved = replace(first, world_from_body=np.eye(4), moves=table)
    return replace(case, obstacles=(moved, *rest))


def bent(shape: Polyhedron, *obstacles: tuple[Polyhedron, np.ndarray]) -> Case:
    return arm("bent", [TINY, shape, TINY], list(obstacles), np.zeros((2, 3)))


CASES = {
    "one face missing": lambda: flown(TINY, (ONE_HOLE, at(*-BALL.face(0).mean(axis=0)))),
    "rod in the mouth of a hole": lambda: flown(ROD, (pierced_cube(), at(0.0, 0.0, -0.25))),
    "link that lacks faces": lambda: flown(LID_OFF, (TINY, at(0.2)), (ROD, at(-0.4))),
    "lid off, two sides, and whole": lambda: flown(
        TINY, (LID_OFF, at(0.3)), (TWO_SIDED, at(-0.5)), (cl.box((0.1, 0.1, 0.1)), at(0.0, 0.5))
    ),
    "each face alone": lambda: flown(TINY, (faces_alone(), at(0.1, 0.1))),
    "cloud in a ball that lacks faces": lambda: flown(LID_OFF, (POINTS, at(0.2))),
    "arm with a two-sided link": lambda: bent(
        TWO_SIDED, (TINY, at(0.4, 0.1)), (TINY, at(-0.2, 0.3, 0.1)), (LID_OFF, at(0.9))
    ),
    "nothing open": lambda: flown(TINY, (torus(0.4, 0.1, 12, 8), at(0.1))),
}


def in_doubt(case: Case, pair: Pair, positions: np.ndarray) -> np.ndarray:
    """(n,) whether a pair is in doubt and not in contact, each pair at each pose on its own."""
    one, other = (body.shape_in(case) for body in pair)
    doubt = doubt_of(one, other)
    if doubt is None:
        return np.zeros(len(positions), dtype=bool)
    link_poses = forest_of(case).poses(positions)
    of_one, of_other = (body.poses_in(case, link_poses) for body in pair)
    found = doubt.at(of_one, of_other)
    for k in np.flatnonzero(found):
        found[k] = not cl.distance(one, other, pose_a=of_one[k], pose_b=of_other[k]).contact
    return found


@pytest.mark.parametrize("kind", CASES)
def test_boxes_leave_out_no_pair_in_doubt(kind: str) -> None:
    case = CASES[kind]()
    rng = np.random.default_rng(list(CASES).index(kind))
    checker, (pairs, _) = cl.Checker(case, accept=["inside"]), measured_pairs(case)
    scales = rng.choice([0.01, 0.1, 1.0], (N, 1))
    asked = scales * rng.uniform(-1.0, 1.0, (N, len(checker.joint_names)))
    truth = np.stack([in_doubt(case, pair, asked) for pair in pairs])
    for row, undecided in zip(asked, truth.T, strict=True):
        found = checker.distance(row).undecided
        assert found == tuple(checker.pairs[i] for i in np.flatnonzero(undecided))
    assert np.array_equal(checker.distances(asked).undecided, truth.any(axis=0))
    assert truth.any() == (kind != "nothing open") and not truth.all()


def test_an_obstacle_that_moves_is_in_doubt_where_its_table_begins() -> None:
    case = flown(TINY, (LID_OFF, at(0.3)), (TWO_SIDED, at(-0.5)))
    asked = np.random.default_rng(8).uniform(-0.9, 0.9, (N, 6))
    with pytest.warns(UserWarning, match="give time="):
        moving = cl.Checker(with_an_obstacle_that_moves(case), accept=["inside"])
    standing = cl.Checker(case, accept=["inside"])
    found = [checker.distances(asked).undecided for checker in (moving, standing)]
    assert found[0].any() and np.array_equal(*found)
