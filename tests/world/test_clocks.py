"""Which bodies move by one clock."""

import numpy as np
import pytest

import clearance as cl
from clearance.errors import BadDimension
from clearance.world.carry import Carry
from clearance.world.case import Clock
from clearance.world.clocks import NO_CLOCK, clocks_of
from clearance.world.forest import owner_of
from clearance.world.mount import Mount
from clearance.world.rules import Rule
from clearance.world.timing import Window


def body(name: str) -> cl.Body:
    return cl.Body(name, cl.box([1, 1, 1]))


def robot(name: str, on: str | None = None, link: str = "base") -> cl.PlacedRobot:
    mount = None if on is None else Mount(on)
    return cl.PlacedRobot(cl.Robot(name, (link,), (), (body(link),)), mount=mount)


def case(*robots: cl.PlacedRobot, carries: tuple[Carry, ...] = ()) -> cl.Case:
    obstacles = tuple(cl.Obstacle(body(name)) for name in ("table", "part", "tray"))
    return cl.Case("cell", robots, obstacles, carries=carries, clock=Clock(np.inf))


def test_two_robots_on_one_standing_table_keep_their_own_clocks():
    clocks = clocks_of(case(robot("left", "table"), robot("right", "table")))
    assert clocks[False, 0] != clocks[False, 1]
    assert clocks[True, 0] == NO_CLOCK


def test_a_part_on_a_carried_tray_has_the_clock_of_what_carries_both():
    carries = (Carry("part", "tray", Window(0)), Carry("tray", "left/base", Window(0)))
    clocks = clocks_of(case(robot("left"), robot("right"), carries=carries))
    assert clocks[True, 1] == clocks[True, 2] == clocks[False, 0]
    assert clocks[True, 0] == NO_CLOCK


def test_a_link_may_have_a_stroke_in_its_name():
    assert owner_of(case(robot("arm", link="tool/base")), Mount("tool/base")) == (False, 0)


@pytest.mark.parametrize("level", [-0.001, np.nan, np.inf, "5 mm"])
def test_a_rule_has_levels_like_limits(level):
    with pytest.raises(BadDimension):
        Rule(("a", "b"), fail=level)
