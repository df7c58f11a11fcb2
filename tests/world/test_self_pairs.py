"""Pairs of one robot's links: what is rigid, what is adjacent, and what a file excuses."""

import itertools
from dataclasses import replace

import numpy as np

from clearance.geometry.shapes import box
from clearance.world.body import Body
from clearance.world.collision_matrix import ADJACENT, CollisionMatrix
from clearance.world.robot import Joint, JointKind, Robot
from clearance.world.self_pairs import EXCLUDED, RIGID, self_pairs

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


def test_every_pair_is_there_once_in_the_robots_order():
    robot = tree("abcd", "abcd", ab="revolute", bc="revolute", cd="prismatic")
    found = [(pair.link_a, pair.link_b) for pair in self_pairs(robot)]
    assert found == list(itertools.combinations("abcd", 2))


def test_neighbours_are_adjacent():
    robot = tree("abcd", "abcd", ab="revolute", bc="revolute", bd="prismatic")
    assert excuses(robot) == {
        "ab": ADJACENT, "ac": None, "ad": None, "bc": ADJACENT, "bd": ADJACENT, "cd": None,
    }  # fmt: skip


def test_neighbours_through_links_without_geometry_are_adjacent():
    chain = tree("abcd", "acd", ab="revolute", bc="revolute", cd="revolute")
    assert excuses(chain) == {"ac": ADJACENT, "ad": None, "cd": ADJACENT}
    fork = tree("abcd", "acd", ab="revolute", bc="revolute", bd="revolute")
    assert excuses(fork) == {"ac": ADJACENT, "ad": ADJACENT, "cd": ADJACENT}
    bare_root = tree("abc", "bc", ab="revolute", ac="revolute")
    assert excuses(bare_root) == {"bc": ADJACENT}


def test_links_joined_by_fixed_joints_are_one_body():
    robot = tree("abcd", "abcd", ab="fixed", bc="revolute", cd="fixed")
    assert excuses(robot) == {
        "ab": RIGID, "ac": ADJACENT, "ad": ADJACENT, "bc": ADJACENT, "bd": ADJACENT, "cd": RIGID,
    }  # fmt: skip


def test_with_a_file_only_what_it_says_is_excused_and_never_is_not():
    robot = tree("abc", "abc", ab="revolute", bc="revolute")
    matrix = CollisionMatrix(disabled=(("c", "a", "Never"), ("b", "c", "User")))
    assert excuses(robot, matrix) == {"ab": None, "ac": None, "bc": "User"}
    assert excuses(robot, matrix, trust_never=True) == {"ab": None, "ac": "Never", "bc": "User"}


def test_what_the_robots_own_file_excludes_counts_where_no_srdf_speaks():
    plain = tree("abcd", "abcd", ab="revolute", bc="revolute", cd="fixed")
    robot = replace(plain, excluded=(("d", "a"), ("a", "b"), ("c", "d")))
    assert excuses(robot) == {
        "ab": ADJACENT, "ac": None, "ad": EXCLUDED, "bc": ADJACENT, "bd": ADJACENT, "cd": RIGID,
    }  # fmt: skip
    assert excuses(robot, CollisionMatrix())["ad"] is None
