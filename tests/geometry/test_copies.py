"""Meshes that hold faces more than once are searched as if they did not; what is inside stays inside."""

from __future__ import annotations

import numpy as np
import pytest

from clearance import distance
from clearance.geometry.polyhedron import Polyhedron
from clearance.geometry.tree import surface_of
from tests.made_cases import at, ball, faces_below, faces_of, with_copies
from tests.strategies import rotations

BALL = ball(1.0, 3)
TINY = ball(0.05, 1)


@pytest.mark.slow
@pytest.mark.parametrize("turned_round", [False, True])
@pytest.mark.parametrize("every", [1, 3])
def test_a_face_and_its_copies_have_one_leaf_and_the_same_answer(
    every: int, turned_round: bool
) -> None:
    doubled = with_copies(BALL, list(range(0, BALL.n_faces, every)), turned_round=turned_round)
    assert sorted(faces_below(surface_of(doubled))[surface_of(doubled).roots[0]]) == list(
        range(BALL.n_faces)
    )
    assert (surface_of(doubled).cones == surface_of(BALL).cones).all()
    random = np.random.default_rng(5)
    for turn in rotations(random, 10):
        pose = at(*(1.5 * random.normal(size=3)), turned=turn)
        one, two = distance(BALL, TINY, pose_b=pose), distance(doubled, TINY, pose_b=pose)
        if one.contact:
            continue
        assert (one.distance, one.face_a, one.face_b) == (two.distance, two.face_a, two.face_b)
        assert one.tally == two.tally


def test_a_face_that_another_one_shares_two_corners_with_is_no_copy() -> None:
    corners = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0.5, 0.5, 1)]
    fans = Polyhedron(
        np.array(corners, dtype=float), [(0, 1, 4), (0, 1, 2, 3), (0, 1, 2), (1, 0, 4), (0, 1, 4)]
    )
    leaves = faces_below(surface_of(fans))[surface_of(fans).roots[0]]
    assert sorted(leaves) == [0, 1, 2]


@pytest.mark.slow
@pytest.mark.parametrize(
    ("faces", "turned_round", "holds"),
    [
        (range(BALL.n_faces), False, True),  # winds twice
        (range(BALL.n_faces), True, False),  # not at all
        (range(0, BALL.n_faces, 3), False, True),  # closed but for the copies, which count once
    ],
)
def test_copies_count_in_what_is_inside(faces: range, turned_round: bool, holds: bool) -> None:
    doubled = with_copies(BALL, list(faces), turned_round=turned_round)
    assert distance(doubled, TINY, pose_b=at(0.3, 0.2, 0.1)).contact == holds
    assert doubled.component_two_sided.tolist() == [turned_round]


def test_only_the_parts_that_hold_nothing_are_two_sided() -> None:
    both = with_copies(TINY, list(range(TINY.n_faces)), turned_round=True)
    sheet = Polyhedron(np.array([(3.0, 0, 0), (4, 0, 0), (3, 1, 0)]), [(0, 1, 2), (0, 2, 1)])
    bowl = Polyhedron(BALL.vertices, faces_of(BALL)[:40])
    bowl = with_copies(bowl, list(range(40)), turned_round=True)
    open_too = with_copies(ball(9.0, 1), [0, 1], turned_round=True)
    parts = Polyhedron.merged([BALL, both, sheet, open_too, bowl.transformed(at(20.0, 0.0, 0.0))])
    assert parts.component_two_sided.tolist()[:4] == [False, True, False, False]
    assert parts.component_two_sided[4:].all()


def test_a_cavity_that_is_there_twice_is_still_wound_round() -> None:
    """Once outward and twice inward: not zero, as without a tree."""
    hollow = Polyhedron.merged([ball(2.0, 2), BALL.flipped(), BALL.flipped()])
    assert distance(hollow, TINY).contact
    assert not distance(Polyhedron.merged([ball(2.0, 2), BALL.flipped()]), TINY).contact
