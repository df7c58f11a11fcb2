"""How many pairs of a robot's links are measured, and why not the others: the same words in every answer."""

from dataclasses import replace

import numpy as np
import pytest

import clearance as cl
from clearance.world.collision_matrix import CollisionMatrix
from clearance.world.robot import Joint, JointKind
from clearance.world.rules import Allowance
from clearance.world.timing import Window
from tests.made_cases import at


def snake(n_links, *, fixed=(), name="snake"):
    """Cubes 0.3 m apart in a row, a to …, each on a joint about the one before."""
    links = tuple("abcdefgh"[:n_links])
    kinds = [JointKind.FIXED if link in fixed else JointKind.REVOLUTE for link in links[1:]]
    joints = tuple(
        Joint(f"j{b}", kind, a, b, at(0.3, 0.0, 0.0), np.array([0.0, 0.0, 1.0]))
        for a, b, kind in zip(links, links[1:], kinds, strict=False)
    )
    bodies = tuple(cl.Body(link, cl.box((0.1, 0.1, 0.1))) for link in links)
    return cl.Robot(name, links, joints, bodies)


def run_of(robot, *robots, allow=(), matrix=None, exclude_links=()):
    placed = [
        cl.PlacedRobot(
            one,
            cl.Trajectory(
                np.array([0.0, 1.0]), ("jb",), np.array([[0.0], [0.1]])
            ),
            at(0.0, 5.0 * i, 0.0),
            self_clearance=cl.SelfClearance(matrix),
            exclude_links=exclude_links,
        )
        for i, one in enumerate((robot, *robots))
    ]  # fmt: skip
    return cl.check(cl.Case("row", tuple(placed), (), allow=allow), certify=False)


def matrix(*disabled):
    return CollisionMatrix(disabled=disabled)


def told(run):
    return list(run.verdict.self_clearance)


def test_every_answer_says_how_many_pairs_are_measured_and_why_not_the_others():
    run = run_of(snake(5))
    line = "self-clearance: 6 of 10 pairs measured, 4 neighbours"
    assert told(run) == [line] and run.verdict.scope[0] == line
    (answer,) = run.summary["self_clearance"]
    assert answer == {
        "robot": "snake", "n_pairs": 10, "n_measured": 6, "n_not_always": 0,
        "left_out": {"neighbours": 4}, "text": line,
    }  # fmt: skip


@pytest.mark.parametrize(
    ("robot", "options", "says"),
    [
        (snake(2 + 1), {}, "1 of 3 pairs measured, 2 neighbours"),
        (snake(4, fixed="c"), {}, "3 of 6 pairs measured, 2 neighbours, 1 joined by fixed joints"),
        (snake(4), {"allow": (("a", "d"),)}, "2 of 6 pairs measured, 3 neighbours, 1 allowed"),
        (snake(4), {"exclude_links": ("d",)}, "1 of 6 pairs measured, 2 neighbours, 3 of links that are excluded"),
        (
            snake(4),
            {"matrix": matrix(("a", "b", "Adjacent"), ("d", "a", "User"), ("b", "d", "Never"))},
            "4 of 6 pairs measured, 1 by the SRDF (Adjacent), 1 by the SRDF (User)",
        ),
        (
            replace(snake(4), own_matrix=matrix(("a", "b", "Adjacent"), ("d", "a", "a filter"))),
            {},
            "4 of 6 pairs measured, 1 neighbour, 1 by a filter",
        ),
        (
            snake(4),
            {"allow": (Allowance(("a", "d"), Window(0.0, 0.5)),)},
            "3 of 6 pairs measured (1 of them not always), 3 neighbours",
        ),
    ],
)  # fmt: skip
def test_each_reason_is_counted(robot, options, says):
    assert told(run_of(robot, **options)) == [f"self-clearance: {says}"]
