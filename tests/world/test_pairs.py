"""Which bodies are measured against which: allowed pairs, and parts in hand."""

from dataclasses import replace

import numpy as np
import pytest

import clearance as cl
from clearance.world.carry import Carry
from clearance.world.robot import Joint, JointKind
from clearance.world.timing import Window

CUBE = cl.box((0.1, 0.1, 0.1))


def standing(name: str, x: float) -> cl.Obstacle:
    pose = np.eye(4)
    pose[0, 3] = x
    return cl.Obstacle(cl.Body(name, CUBE), pose)


def sliding() -> cl.Case:
    """A link that slides along x between a post and a wall, beside a part."""
    slide = Joint("slide", JointKind.PRISMATIC, "base", "tip", np.eye(4))
    robot = cl.Robot("r", ("base", "tip"), (slide,), (cl.Body("tip", CUBE),))
    path = cl.Trajectory([0.0, 1.0], ("slide",), [[0.0], [0.2]])
    obstacles = standing("part", 0.5), standing("post", 2.0), standing("wall", -2.0)
    return cl.Case("c", (cl.PlacedRobot(robot, path),), obstacles)


def measured(case: cl.Case) -> set[tuple[str, str]]:
    minima = cl.check(case, need="pairs").pair_minima
    return {(one.link, one.obstacle) for one in minima}


@pytest.mark.parametrize(
    ("between", "left"),
    [
        (("tip", "p*"), {"wall"}),
        (("*", "wall"), {"part", "post"}),
        (("p*", "tip"), {"part", "post", "wall"}),
    ],
)
def test_an_allowed_pair_names_the_link_first(between, left):
    case = replace(sliding(), allow=(between,))
    assert measured(case) == {("tip", name) for name in left}


@pytest.mark.parametrize(
    ("touch", "left"), [((), {"post", "wall"}), (("wall",), {"post"}), (("*",), set())]
)
def test_a_part_in_hand_is_measured_against_all_that_it_may_not_touch(touch, left):
    case = replace(sliding(), carries=(Carry("part", "tip", Window(0.0), touch),))
    found = measured(case)
    assert {next(n for n in pair if n != "part") for pair in found if "part" in pair} == left
    assert {("tip", "post"), ("tip", "wall")} <= found
