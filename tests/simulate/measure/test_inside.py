"""A robot inside a solid with a fault is in contact or suspect, never quietly clear; sheets make no noise.

At any positions boxes that are looked at first leave out no pair in doubt that the whole question finds.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import clearance as cl
from clearance.geometry.point_cloud import PointCloud
from clearance.geometry.polyhedron import Polyhedron
from clearance.query.inside import doubt_of
from clearance.simulate.measure import inside
from clearance.simulate.measure.sections import section_plan
from clearance.world.case import Case
from clearance.world.forest import forest_of
from clearance.world.notice import Severity
from clearance.world.pairs import Pair, measured_pairs
from clearance.world.pose_table import PoseTable
from tests.made_cases import arm, at, ball, faces_of, flying, torus
from tests.query.test_almost_closed import halves, two_sided

BALL = ball(2.0, 2)
LINK = cl.box((0.05, 0.05, 0.05))


def moved(shape: Polyhedron, positions: np.ndarray, outer: Polyhedron, **options) -> cl.Run:
    steps = np.zeros((len(positions), 6))
    steps[:, :3] = positions
    return cl.check(flying("inside", shape, [(outer, np.eye(4))], steps), **options)


WAY = np.linspace((-0.3, 0.1, 0.0), (0.3, 0.1, 0.2), 30)


@pytest.mark.parametrize("need", ["steps", "pairs", "limit", "minimum"])
@pytest.mark.parametrize("fault", ["twice", "missing", "turned"])
def test_a_robot_wholly_inside_is_in_contact_whatever_is_asked(fault: str, need: str) -> None:
    faces = faces_of(BALL)
    faces = {
        "twice": [*faces, faces[9]],
        "missing": faces[1:],
        "turned": [faces[0][::-1], *faces[1:]],
    }[fault]
    outer = Polyhedron(BALL.vertices, faces)
    run = moved(LINK, WAY, outer, need=need)
    assert run.status == "contact" and not run.passed and run.worst["clearance"] == 0.0
    assert run.record.notices == ()
    assert moved(outer, WAY, LINK, need=need).status == "contact"


@pytest.mark.parametrize("at_once", [inside.AT_ONCE, 8])
def test_where_the_hole_decides_the_pair_is_suspect_by_name_and_first_step(
    at_once: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(inside, "AT_ONCE", at_once)
    there = np.array([5.0, 0.0, 0.0])
    outer = Polyhedron(BALL.vertices + there, faces_of(BALL)[1:])
    middle = BALL.face(0).mean(axis=0)
    run = moved(LINK, np.linspace(3.0, 1.0, 21)[:, None] * middle + there, outer)
    (notice,) = run.record.notices
    assert (notice.severity, notice.kind) == (Severity.SUSPECT, "inside")
    assert notice.text.startswith(
        "link l6 may be inside obstacle o0, or round it, at 0.200 s (step 20)"
    )
    quiet = moved(LINK, np.linspace(3.0, 1.5, 21)[:, None] * middle + there, outer)
    assert quiet.record.notices == ()


def test_larger_holes_make_it_suspect_and_sheets_do_not() -> None:
    faces = faces_of(BALL)
    (notice,) = moved(LINK, WAY, Polyhedron(BALL.vertices, faces[12:])).record.notices
    assert "step 0" in notice.text
    for shape in (Polyhedron(BALL.vertices, faces[100:]), Polyhedron(BALL.vertices, faces[:100])):
        assert moved(LINK, WAY, shape).record.notices == ()


def test_steps_in_contact_are_not_in_doubt() -> None:
    """A link that reaches through the surface itself is in contact there, which is known."""
    outer = Polyhedron(BALL.vertices, faces_of(BALL)[1:])
    rod = cl.box((0.05, 0.05, 5.0))
    case = flying("through", rod, [(outer, at())], np.zeros((3, 6)))
    run = cl.check(case)
    assert run.status == "contact"
    assert inside.notices(section_plan(run.record.timeline)) == ()


CRACKED = {
    "halves apart": halves(BALL, 1.0),
    "two-sided": two_sided(BALL),
}


@pytest.mark.parametrize("need", ["steps", "minimum"])
@pytest.mark.parametrize("kind", CRACKED)
def test_a_solid_with_cracks_or_two_sides_is_suspect_round_a_robot_and_inside_one(
    kind: str, need: str
) -> None:
    run = moved(LINK, WAY, CRACKED[kind], need=need)
    assert run.status == "suspect" and not run.passed
    assert [(notice.severity, notice.kind) for notice in run.record.notices] == [
        (Severity.SUSPECT, "inside")
    ]
    assert moved(CRACKED[kind], WAY, LINK).status == "suspect"
    assert moved(LINK, WAY + [9.0, 0.0, 0.0], CRACKED[kind]).record.notices == ()


def test_a_robot_that_is_inside_only_on_its_way_through_coarse_steps_is_suspect() -> None:
    """Steps so long that it is never in the wall: outside in the bounds' corners first and last."""
    way = np.linspace((-1.9, -1.9, -1.9), (1.9, 1.9, 1.9), 7)
    run = moved(LINK, way, CRACKED["halves apart"])
    assert run.record.notices and "step 2" in run.record.notices[0].text


def test_a_bowl_round_a_robot_is_quiet_and_walls_far_away_are_a_matter_of_units() -> None:
    """The wall of the tube is 15 times the robot's reach away."""
    turns = np.linspace(0.0, 2.0 * np.pi, 32, endpoint=False)
    ring = np.stack([np.cos(turns), np.sin(turns)], axis=1)
    ends = np.concatenate([np.insert(0.8 * ring, 2, z, axis=1) for z in (-2.4, 2.4)])
    tube = Polyhedron(ends, [[i, (i + 1) % 32, 32 + (i + 1) % 32, 32 + i] for i in range(32)])
    bowl = Polyhedron(BALL.vertices, faces_of(BALL)[:100])
    deep = np.linspace((0.0, 0.0, 0.0), (0.0, 0.0, -1.6), 9)
    assert moved(LINK, deep, bowl).record.notices == ()
    assert [one.kind for one in moved(LINK, 0.0 * deep, tube).record.notices] == ["units"]


ROUND = ball(0.6, 2)
FACES = faces_of(ROUND)
TINY, ROD = cl.box((0.06, 0.05, 0.04)), cl.box((0.02, 0.02, 0.5))
N = 150


def with_faces(faces: list) -> Polyhedron:
    return Polyhedron(ROUND.vertices, faces)


def faces_alone() -> Polyhedron:
    """The ball, each face with corners of its own."""
    centres = ROUND.centres[:, None]
    corners = centres + 0.9999 * (ROUND.vertices[np.array(FACES)] - centres)
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
TWO_SIDED = two_sided(ROUND)
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
    "one face missing": lambda: flown(TINY, (ONE_HOLE, at(*-ROUND.face(0).mean(axis=0)))),
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


@pytest.mark.slow
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
