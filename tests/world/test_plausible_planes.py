"""Boxes that stand for planes end: whatever may get past the end is warned of."""

from dataclasses import replace

import numpy as np
import pytest

from clearance import box
from clearance.world.body import Body, Obstacle
from clearance.world.carry import Carry
from clearance.world.case import Case
from clearance.world.placed_robot import PlacedRobot
from clearance.world.plausibility import notices_of
from clearance.world.pose_table import PoseTable
from clearance.world.robot import Joint, JointKind, Robot
from clearance.world.rules import Allowance
from clearance.world.timing import Window
from tests.made_cases import at
from tests.world.test_plausibility import case_of

GROUND = Obstacle(Body("floor", box((40.0, 40.0, 20.0)), "box"), at(0.0, 0.0, -10.0))


def told_of_planes(case: Case) -> list[str]:
    return [notice.text for notice in notices_of(case) if notice.kind == "plane"]


@pytest.mark.parametrize(
    ("x", "depth", "warned"), [(0.0, 20.0, False), (25.0, 20.0, True), (19.5, 1.0, True)]
)
def test_a_robot_that_may_get_past_a_box_that_stands_for_a_plane_is_warned_of(x, depth, warned):
    floor = Obstacle(Body("floor", box((40.0, 40.0, depth)), "box"), at(0.0, 0.0, -0.5 * depth))
    placed = replace(case_of().robots[0], world_from_base=at(x, 0.0, 0.5))
    told = told_of_planes(Case("made", (placed,), (floor,)))
    assert len(told) == warned and all("robot 'arm' may get" in text for text in told)


def test_an_obstacle_that_moves_past_the_end_of_a_plane_is_warned_of():
    places = np.array([[0.0, 0.0, 1.0], [30.0, 0.0, 1.0]])
    moves = PoseTable(np.array([0.0, 1.0]), places, np.array([[0.0, 0.0, 0.0, 1.0]] * 2))
    cart = Obstacle(Body("cart", box((1.0, 1.0, 1.0)), "box"), moves=moves)
    (told,) = told_of_planes(replace(case_of(), obstacles=(GROUND, cart)))
    assert told.endswith("m from its middle: obstacle 'cart' may get 30.9 m from there")
    near = replace(cart, moves=replace(moves, positions=places / 2))
    assert told_of_planes(replace(case_of(), obstacles=(GROUND, near))) == []


def test_an_obstacle_that_only_circles_near_the_edge_of_a_plane_is_not_warned_of():
    """Its corners get 12.9 m from the middle of the plane, where a ball about all its places ends at 24.9 m."""
    places = np.array([[-12.0, 0.0, 1.0], [0.0, 12.0, 1.0], [12.0, 0.0, 1.0]])
    moves = PoseTable(np.arange(3.0), places, np.array([[0.0, 0.0, 0.0, 1.0]] * 3))
    cart = Obstacle(Body("cart", box((1.0, 1.0, 1.0)), "box"), moves=moves)
    assert told_of_planes(replace(case_of(), obstacles=(GROUND, cart))) == []
    turned = replace(GROUND, world_from_body=at(0.0, -8.0, -10.0))
    (told,) = told_of_planes(replace(case_of(), obstacles=(turned, cart)))
    assert "obstacle 'cart' may get 20.9 m from there" in told


def test_a_box_as_wide_as_a_plane_of_another_depth_is_a_box():
    """Readers of planes make them 20 m deep, and those of 0.2 made them 1 m deep."""
    far = replace(case_of().robots[0], world_from_base=at(25.0, 0.0, 0.5))
    hall = replace(GROUND, body=Body("floor", box((40.0, 40.0, 0.2)), "box"))
    told = [told_of_planes(Case("made", (far,), (one,))) for one in (GROUND, hall)]
    assert [len(one) for one in told] == [1, 0]


def test_nothing_gets_past_the_end_of_a_plane_that_it_is_not_measured_against():
    far = replace(case_of().robots[0], world_from_base=at(25.0, 0.0, 0.5))
    case, pair = Case("made", (far,), (GROUND,)), ("*", "floor")
    shapeless = replace(case, robots=(replace(far, exclude_links=("base", "upper")),))
    now_and_then = replace(case, allow=(Allowance(pair, Window(0.5)),))
    assert [len(told_of_planes(one)) for one in (case, now_and_then)] == [1, 1]
    always = replace(case, allow=(Allowance(pair),))
    assert [told_of_planes(one) for one in (shapeless, always)] == [[], []]


def test_a_part_that_a_hand_takes_past_the_end_of_a_plane_is_warned_of():
    """The arm reaches 0.76 m, a rod in its hand 3 m farther."""
    case = case_of(obstacle=box((0.1, 0.1, 3.0)))
    floor = replace(GROUND, world_from_body=at(-17.0, 0.0, -10.0))
    far = replace(case, obstacles=(*case.obstacles, floor))
    assert told_of_planes(far) == []
    (told,) = told_of_planes(replace(far, carries=(Carry("block", "upper", Window(0.5)),)))
    assert "robot 'arm' may get 20.8 m from there" in told


def test_another_robot_past_the_end_of_a_robots_own_floor_is_warned_of():
    floor = Body("world", box((40.0, 40.0, 20.0)), "plane")
    cell = Robot(
        "cell", ("world", "upper"), (Joint("j", JointKind.FIXED, "world", "upper", at(0.0, 0.0, 0.5)),),
        (floor, Body("upper", box((0.3, 0.3, 0.3)), "box")),
    )  # fmt: skip
    there = replace(case_of().robots[0], world_from_base=at(25.0, 0.0, 0.5))
    (told,) = told_of_planes(Case("made", (PlacedRobot(cell), there), ()))
    assert told.startswith("link 'cell/world' stands for a plane without end")
    assert told.endswith("m from its middle: robot 'arm' may get 25.8 m from there")
