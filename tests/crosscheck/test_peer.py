"""The cross-check agrees with what is right, and names every step that is wrong."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import clearance as cl
from clearance.crosscheck import compare, peer_run
from clearance.crosscheck.exact import placed, triangles_sq
from clearance.crosscheck.fcl_adapter import PeerBody
from clearance.crosscheck.peer_run import (
    PeerRun,
)
from clearance.crosscheck.triangles import is_inside, triangle_soup, winding_number
from clearance.geometry.point_cloud import PointCloud
from clearance.geometry.polyhedron import Polyhedron
from clearance.query.distance import distance
from clearance.tolerance import CROSS_CHECK
from clearance.world.case import Omission
from clearance.world.placed_robot import PlacedRobot
from tests import oracle
from tests.crosscheck.sliding import box, cross_check, pairs_of, rail_record
from tests.made_cases import at, ball, dented, faces_of, flying
from tests.query.test_clouds import GRID, KINDS, answer, scan, solid_of
from tests.strategies import FAMILIES, rotations

pytestmark = pytest.mark.peer

NEAR_AND_FAR = {"near": (box(0.2, 0.2, 0.2), (1, 0, 0)), "far": (box(0.2, 0.2, 0.2), (-3, 0, 0))}


def passing(clearances: list[float], **changes):
    """A unit-free pass: link of 0.2 m from x = 0 towards the near box at x = 1, whose face is at
    0.9.
    """
    positions = [0.0, 0.3, 0.6, 0.7999]
    rows = [
        (given, "near", (x + 0.1, 0.05, 0.0), (0.9, 0.05, 0.0))
        for x, given in zip(positions, clearances, strict=True)
    ]
    return rail_record(box(0.2, 0.2, 0.2), NEAR_AND_FAR, positions, rows, **changes)


TRUE = [0.8, 0.5, 0.2, 0.0001]


def test_right_answers_agree():
    reported = []
    check = cross_check(passing(TRUE), progress=lambda done, total: reported.append((done, total)))
    assert check.agrees and check.n_steps == 4
    assert check.greatest_difference < 1e-12 and check.worst_witness_error < 1e-12
    assert reported == [(4, 4)]
    diagonal = np.linalg.norm([1.1 + 3.1, 0.2, 0.2])
    assert check.tolerance == pytest.approx(CROSS_CHECK * diagonal, rel=1e-12)
    assert check.peer.startswith("python-fcl")


@pytest.mark.parametrize("error", [1e-7, -1e-7, 0.1])
def test_a_wrong_clearance_is_listed_with_both_answers(error):
    check = cross_check(passing([0.8, 0.5 + error, 0.2, 0.0001]))
    assert not check.agrees and check.worst_step == 1
    assert check.greatest_difference == pytest.approx(abs(error), rel=1e-4)
    (row,) = check.disagreements
    assert (row.step, row.clearance) == (1, 0.5 + error)
    assert row.peer_clearance == pytest.approx(0.5, abs=1e-12)
    assert (row.link, row.obstacle, row.peer_link, row.peer_obstacle) == (
        "slider", "near", "slider", "near",
    )  # fmt: skip


def test_a_nan_is_a_disagreement():
    check = cross_check(passing([0.8, np.nan, 0.2, 0.0001]))
    assert [row.step for row in check.disagreements] == [1]


def test_a_witness_off_its_body_is_listed_though_the_distance_is_right():
    record = passing(TRUE)
    height = np.array([0.0, 0.15, 0.0, 0.0])
    lifted = record.rows.with_columns({"link_z": height, "obstacle_z": height})
    check = cross_check(replace(record, table=lifted))
    assert check.greatest_difference < 1e-12
    assert check.worst_witness_error == pytest.approx(0.05, abs=1e-12)
    assert [row.step for row in check.disagreements] == [1]
    assert "witness" in check.disagreements[0].reason


def test_unmeasured_pairs_take_no_part():
    rows = [(3.0 - 0.2, "far", (-0.1, 0, 0), (-2.9, 0, 0))]
    omitted = (Omission("slider", "near", "allowed"),)
    assert cross_check(rail_record(box(0.2, 0.2, 0.2), NEAR_AND_FAR, [0.0], rows, omitted)).agrees
    record = rail_record(box(0.2, 0.2, 0.2), NEAR_AND_FAR, [0.0], rows)
    assert cross_check(record).disagreements[0].peer_obstacle == "near"


def test_contact_agrees_only_if_both_say_it():
    positions, point = [0.0, 0.95], (0.9, 0.0, 0.0)
    first = (0.8, "near", (0.1, 0, 0), point)
    touching = rail_record(
        box(0.2, 0.2, 0.2), NEAR_AND_FAR, positions, [first, (0.0, "near", point, point)]
    )
    assert cross_check(touching).agrees
    missed = rail_record(
        box(0.2, 0.2, 0.2), NEAR_AND_FAR, positions,
        [first, (0.01, "near", point, (0.91, 0, 0))],
    )  # fmt: skip
    (row,) = cross_check(missed).disagreements
    assert row.peer_clearance == 0.0 and row.reason == "the peer says contact"
    invented = rail_record(
        box(0.2, 0.2, 0.2), NEAR_AND_FAR, [0.0, 0.5], [first, (0.0, "near", point, point)]
    )
    (row,) = cross_check(invented).disagreements
    assert row.peer_clearance == pytest.approx(0.3) and "peer does not" in row.reason


@pytest.mark.parametrize(("link", "obstacle"), [((0.2,) * 3, (2.0,) * 3), ((2.0,) * 3, (0.2,) * 3)])
def test_containment_is_contact_for_the_peer_too(link, obstacle):
    """Field, fault 3: FCL alone says +0.9 m for a box in the middle of a larger one."""
    rows = [(0.0, "solid", (0.0, 0.0, 0.0), (0.0, 0.0, 0.0))]
    record = rail_record(box(*link), {"solid": (box(*obstacle), (0, 0, 0))}, [0.0], rows)
    assert cross_check(record).agrees


def test_one_of_two_parts_inside_is_contact():
    small = box(0.2, 0.2, 0.2)
    two = Polyhedron(
        np.vstack([small.vertices, small.vertices + np.array([5.0, 0, 0])]),
        [*small.face_vertices.reshape(-1, 4), *(small.face_vertices.reshape(-1, 4) + 8)],
    )
    rows = [(0.0, "solid", (5.0, 0.0, 0.0), (5.0, 0.0, 0.0))]
    record = rail_record(two, {"solid": (box(2, 2, 2), (5, 0, 0))}, [0.0], rows)
    assert cross_check(record).agrees


def test_an_open_body_has_no_inside():
    lidless = box(2.0, 2.0, 2.0)
    open_box = Polyhedron(lidless.vertices, lidless.face_vertices.reshape(-1, 4)[:5])
    rows = [(0.9, "open", (0.0, 0.0, -0.1), (0.0, 0.0, -1.0))]
    record = rail_record(box(0.2, 0.2, 0.2), {"open": (open_box, (0, 0, 0))}, [0.0], rows)
    assert cross_check(record).agrees


def test_a_triangle_without_area_does_not_make_a_contact():
    """Field, fault 4: FCL answers 0 for a mesh that holds a triangle without area."""
    plain = box(0.2, 0.2, 0.2)
    faces = [*plain.face_vertices.reshape(-1, 4).tolist(), [0, 8, 1]]
    vertices = np.vstack([plain.vertices, plain.vertices[:2].mean(axis=0)])
    rows = [(0.8, "near", (0.1, 0, 0), (0.9, 0, 0))]
    assert cross_check(rail_record(Polyhedron(vertices, faces), NEAR_AND_FAR, [0.0], rows)).agrees


def two_robots(**changes) -> cl.Case:
    positions = np.zeros((12, 6))
    positions[:, 0] = np.linspace(0.0, 0.5, 12)
    obstacles = [(cl.box((0.3, 0.3, 0.3)), at(1.2)), (cl.box((0.1, 0.1, 0.1)), at(0.0, 1.0))]
    case = flying("two", cl.box((0.2, 0.2, 0.2)), obstacles, positions)
    (one,) = case.robots
    second = replace(one.robot, name="second")
    other = PlacedRobot(second, one.trajectory, at(0.0, -0.9, 0.2), **changes)
    return replace(case, robots=(one, other))


def test_a_wrong_clearance_of_either_robot_is_found() -> None:
    run = cl.check(two_robots())
    wrong = run.record.rows.with_columns({"clearance": run.record.clearances + 1e-6})
    check = cross_check(replace(run.record, table=wrong))
    assert len(check.disagreements) == 12
    assert {row.peer_link for row in check.disagreements} <= {"flying/l6", "second/l6"}


def test_inside_is_what_a_box_says():
    rng = np.random.default_rng(7)
    points = rng.uniform(-2, 2, size=(500, 3))
    expected = (np.abs(points) < [0.5, 1.0, 1.5]).all(axis=1)
    soup = triangle_soup(box(1.0, 2.0, 3.0))
    assert expected.any() and np.array_equal(is_inside(soup, points), expected)
    numbers = winding_number(soup.corners, points)
    assert np.allclose(numbers, np.round(numbers), atol=1e-12)


def test_before_a_hole_the_peer_says_inside_where_the_package_says_contact():
    """By the faces alone, which are there on three quarters of all sides, or are not."""
    whole = ball(1.0, 2)
    outer = Polyhedron(whole.vertices, faces_of(whole)[2:])
    points = whole.centres[:2].mean(axis=0) + np.random.default_rng(5).normal(
        scale=0.1, size=(200, 3)
    )
    found = is_inside(triangle_soup(outer), points)
    ours = [distance(outer, PointCloud([point], 1e-9)).inside == "yes" for point in points]
    assert 20 < found.sum() < 180 and found.tolist() == ours


def test_skipping_changes_no_answer():
    """All pairs asked at every step give what the sorted, bounded search gives, with far fewer
    queries.
    """
    rng = np.random.default_rng(11)
    obstacles = {
        f"o{i}": (box(*rng.uniform(0.1, 0.5, 3)), tuple(rng.uniform(-3, 3, 3))) for i in range(12)
    }
    positions = np.cumsum(rng.uniform(-0.2, 0.25, 60)).tolist()
    rows = [(0.0, "o0", (0, 0, 0), (0, 0, 0))] * 60
    record = rail_record(box(0.3, 0.2, 0.1), obstacles, positions, rows)
    run = PeerRun(record, pairs_of(record))
    answers = run.measure()
    poses = run.poses(0, 60)
    for step in range(60):
        run.pairs[0].link.peer.place(poses[0, step])
        every = [pair.link.peer.distance(pair.other.peer) for pair in run.pairs]
        assert answers.clearances[step] == min(every)
    assert answers.n_queries < 60 * 12 / 2


@pytest.mark.parametrize("name", sorted(FAMILIES))
def test_triangles_are_as_far_apart_as_the_oracle_says(name: str) -> None:
    for p, q in zip(*FAMILIES[name](np.random.default_rng(5), 6), strict=True):
        given = [placed(np.asarray(x, dtype=float)[:3], np.eye(4)) for x in (p, q)]
        assert triangles_sq(*given) == oracle.polygon_distance_sq(p[:3], q[:3])


def test_the_triangles_that_fcl_names_are_as_near_as_it_says() -> None:
    random = np.random.default_rng(6)
    a, b = triangle_soup(dented(random, 2)), triangle_soup(ball(0.4, 2))
    one, two = PeerBody(a), PeerBody(b)
    for turn in rotations(random, 20):
        pose = at(*random.normal(scale=2.0, size=3), turned=turn)
        one.place(np.eye(4)), two.place(pose)
        i, j = one.nearest_triangles(two)
        exact = triangles_sq(placed(a.corners[i], np.eye(4)), placed(b.corners[j], pose))
        assert float(oracle.root(exact)) == pytest.approx(one.distance(two), abs=1e-12)


NEEDLE = Polyhedron(np.array([(0, 0, 0), (1, 0, 0), (0.5, 1e-9, 0)], dtype=float), [(0, 1, 2)])


def past_a_ball(shape: Polyhedron = NEEDLE):
    positions = np.zeros((4, 6))
    positions[:, 2] = [0.5, 0.3, 0.2, 0.4]
    return cl.check(flying("passing", shape, [(ball(0.1, 1), at(0.5))], positions))


@pytest.mark.parametrize("error", [1e-3, -1e-3])
def test_a_wrong_answer_of_the_peer_is_settled_and_counted(error: float, monkeypatch) -> None:
    """FCL with an error put into its answers: too far, our faces refute it; too near, those it names."""
    measured = peer_run.PeerRun.measure

    def wrong(self, progress=None):
        answers = measured(self, progress)
        return replace(answers, clearances=answers.clearances + [0.0, error, 0.0, 2.0 * error])

    monkeypatch.setattr(peer_run.PeerRun, "measure", wrong)
    found = cross_check(past_a_ball().record)
    assert found.agrees and found.n_settled == 2
    assert found.greatest_settled == pytest.approx(2e-3, rel=1e-6) == found.greatest_difference


@pytest.mark.parametrize("error", [1e-3, -1e-3])
def test_a_wrong_answer_of_ours_is_never_settled(error: float) -> None:
    run = past_a_ball(ball(0.2, 1))
    wrong = run.record.clearances + [0.0, error, 0.0, 0.0]
    record = replace(run.record, table=run.record.rows.with_columns({"clearance": wrong}))
    found = cross_check(record)
    assert [row.step for row in found.disagreements] == [1] and found.n_settled == 0


def test_a_nearer_pair_that_we_passed_over_is_never_settled() -> None:
    """Our answer is that of two faces that are there, our points are on them, and another pair is nearer."""
    positions = np.zeros((2, 6))
    case = flying(
        "two", ball(0.2, 1), [(ball(0.1, 1), at(1.0)), (ball(0.1, 1), at(0.0, 0.0, 0.8))], positions
    )
    far = cl.check(replace(case, obstacles=case.obstacles[:1]))
    found = cross_check(replace(far.record, case=case))
    assert len(found.disagreements) == 2 and found.n_settled == 0


def needle(random: np.random.Generator, width: float) -> Polyhedron:
    corners = np.array(
        [(0, 0, 0), (1, 0, 0), (random.uniform(0.2, 0.8), width, 0), (0.5, 0, width)]
    )
    return Polyhedron(
        corners @ rotations(random, 1)[0].T, [(0, 2, 1), (0, 1, 3), (1, 2, 3), (2, 0, 3)]
    )


def test_points_on_needles_are_on_them() -> None:
    """In float64 their heights are off by 4e-9 m at some poses; no step disagrees for that."""
    random = np.random.default_rng(0)
    in_floats = []
    for _ in range(40):
        width = 10.0 ** random.uniform(-10, -8)
        link, obstacle = needle(random, width), needle(random, width)
        positions = np.concatenate(
            [random.normal(scale=0.7, size=(3, 3)), random.uniform(-3, 3, (3, 3))], axis=1
        )
        case = flying("needles", link, [(obstacle, np.eye(4))], positions)
        record = cl.check(case, certify=False).record
        found = cross_check(record)
        assert found.agrees and found.worst_witness_error <= found.tolerance
        in_floats.append(
            compare._Witnesses(peer_run.PeerRun(record, pairs_of(record))).errors().max()
            > found.tolerance
        )
    assert sum(in_floats) >= 1


def test_it_gives_up_where_nothing_is_settled(monkeypatch) -> None:
    asked = []
    monkeypatch.setattr(compare, "GIVE_UP", 2)
    monkeypatch.setattr(compare._Witnesses, "refute", lambda *args: asked.append(args) or False)
    run = past_a_ball(ball(0.2, 1))
    rows = run.record.rows
    off = {name: rows.numbers(name) + 1e-3 for name in ("clearance", "link_z")}
    found = cross_check(replace(run.record, table=rows.with_columns(off)))
    assert len(found.disagreements) == 4 and len(asked) <= 2


def record_of(given, near):
    """A record of one step: the solid on a rail, a cloud beside it, and what was found of them."""
    cloud = PointCloud(given.points / GRID, given.radius / GRID)
    row = (near.distance, "cloud", near.point_b, near.point_a)
    return rail_record(solid_of(given.boxes), {"cloud": (cloud, (0, 0, 0))}, [0.0], [row])


@pytest.mark.parametrize("n", [1, 7, 60, 400])
@pytest.mark.parametrize("kind", KINDS)
def test_right_answers_agree_and_wrong_ones_do_not(n, kind):
    """The other way round as well: a distance where a point is inside, contact where none is."""
    for seed in range(2):
        given = scan(np.random.default_rng(seed), n, kind)
        true, near = answer(given, np.eye(4))
        record = record_of(given, near)
        check = cross_check(record)
        assert check.agrees and check.n_settled == 0, (seed, check)
        assert near.distance == pytest.approx(true, abs=1e-12)
        for wrong in (near.distance + 1e-6, max(0.0, near.distance - 1e-6)):
            if abs(wrong - true) >= 1e-6:
                rows = record.rows.with_columns({"clearance": np.array([wrong])})
                assert not cross_check(replace(record, table=rows)).agrees, (seed, wrong)


def test_a_point_wholly_inside_that_is_called_apart_is_a_disagreement():
    """FCL alone says 246 mm for a point in the middle of a box of 0.5 m, and is asked what is inside besides."""
    cloud = PointCloud([[0.002, -1.03, 0.345], [0.0, 0.0, 0.0]], 0.004)
    row = (0.246, "cloud", (0.0, 0.0, -0.25), (0.0, 0.0, -0.004))
    record = rail_record(box(0.5, 0.5, 0.5), {"cloud": (cloud, (0, 0, 0))}, [0.0], [row])
    (found,) = cross_check(record).disagreements
    assert (found.peer_clearance, found.reason) == (0.0, "the peer says contact")
