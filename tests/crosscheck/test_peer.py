"""The cross-check agrees with what is right, and names every step that is wrong."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import clearance as cl
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
from tests.crosscheck.sliding import box, cross_check, pairs_of, rail_record
from tests.made_cases import at, ball, faces_of, flying

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
