"""Which bodies are measured against which: allowed pairs, and parts in hand."""

from dataclasses import replace

import numpy as np
import pytest

import clearance as cl
from clearance.geometry.shapes import box
from clearance.world.body import Body
from clearance.world.carry import Carry
from clearance.world.collision_matrix import ADJACENT, CollisionMatrix
from clearance.world.robot import Joint, JointKind, Robot
from clearance.world.self_pairs import RIGID, self_pairs
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


SHAPE = box((0.1, 0.1, 0.1))


def tree(links: str, solid: str, **joints: str) -> Robot:
    """A robot of one-letter links; joints as `ab="revolute"`, parents before children."""
    return Robot(
        "tree",
        tuple(links),
        tuple(Joint(name, JointKind(kind), *name, np.eye(4)) for name, kind in joints.items()),
        tuple(Body(name, SHAPE) for name in solid),
    )


def excuses(robot, *arguments, **options):
    pairs = self_pairs(robot, *arguments, **options)
    return {pair.link_a + pair.link_b: pair.excused for pair in pairs}


def test_neighbours_through_links_without_geometry_have_one_joint_that_moves_between_them():
    bolted = tree("abcd", "ad", ab="fixed", bc="revolute", cd="fixed")
    assert excuses(bolted) == {"ad": ADJACENT}
    two_joints = tree("abcd", "acd", ab="revolute", bc="revolute", cd="revolute")
    assert excuses(two_joints) == {"ac": None, "ad": None, "cd": ADJACENT}


def test_links_on_two_joints_of_one_link_are_measured_whether_that_has_a_shape_or_not():
    for solid in ("acd", "abcd"):
        fork = excuses(tree("abcd", solid, ab="revolute", bc="revolute", bd="prismatic"))
        assert fork["cd"] is None and fork["ac"] is None
    assert excuses(tree("abc", "bc", ab="revolute", ac="revolute")) == {"bc": None}


def test_links_that_stand_about_a_bare_world_are_measured():
    walled = tree("wabc", "abc", wa="fixed", wb="fixed", bc="prismatic")
    assert excuses(walled) == {"ab": RIGID, "ac": None, "bc": ADJACENT}
    assert excuses(tree("wab", "ab", wa="fixed", wb="prismatic")) == {"ab": None}


def test_of_links_joined_by_fixed_joints_only_those_that_the_moving_joint_joins_are_adjacent():
    robot = tree("abcd", "abcd", ab="fixed", bc="revolute", cd="fixed")
    assert excuses(robot) == {
        "ab": RIGID, "ac": None, "ad": None, "bc": ADJACENT, "bd": None, "cd": RIGID,
    }  # fmt: skip


def test_a_joint_of_several_degrees_of_freedom_is_one_joint():
    chain = tree("abcd", "ad", ab="prismatic", bc="prismatic", cd="continuous")
    assert excuses(chain) == {"ad": None}
    joints = tuple(replace(joint, part_of=("planar", "base")) for joint in chain.joints)
    assert excuses(replace(chain, joints=joints)) == {"ad": ADJACENT}


def test_with_a_file_only_what_it_says_is_excused_and_never_is_not():
    robot = tree("abc", "abc", ab="revolute", bc="revolute")
    matrix = CollisionMatrix(disabled=(("c", "a", "Never"), ("b", "c", "User")))
    assert excuses(robot, matrix) == {"ab": None, "ac": None, "bc": "User"}
    assert excuses(robot, matrix, trust_never=True) == {"ab": None, "ac": "Never", "bc": "User"}


def test_what_the_robots_own_file_says_counts_where_no_srdf_speaks_and_then_nothing_else():
    plain = tree("abcd", "abcd", ab="revolute", bc="revolute", cd="fixed")
    own = CollisionMatrix(disabled=(("d", "a", "its author"), ("c", "d", "its author")))
    robot = replace(plain, own_matrix=own)
    assert excuses(robot) == {
        "ab": None, "ac": None, "ad": "its author", "bc": None, "bd": None, "cd": RIGID,
    }  # fmt: skip
    assert excuses(robot, CollisionMatrix())["ad"] is None
