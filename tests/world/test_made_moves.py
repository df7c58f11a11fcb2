"""A time has the name of the move that a program makes then."""

from __future__ import annotations

import numpy as np
import pytest

import clearance as cl
from clearance.world.made_moves import MadeMoves
from clearance.world.robot import Joint, JointKind
from clearance.world.timing import Timing
from clearance.world.trajectory import MoveSpan

SPANS = (MoveSpan("PTP 1", 0.0, 1.0), MoveSpan("LIN 2", 1.0, 1.0), MoveSpan("LIN 3", 1.0, 4.0))


def robot(name: str, timing: Timing, moves: tuple[MoveSpan, ...] = SPANS) -> cl.PlacedRobot:
    joint = Joint("axis", JointKind.REVOLUTE, "base", "arm", np.eye(4))
    body = cl.Body("arm", cl.box([1, 1, 1]))
    motion = cl.Trajectory(np.array([0.0, 4.0]), ("axis",), np.array([[0.0], [0.0]]), moves=moves)
    one = cl.Robot(name, ("base", "arm"), (joint,), (body,))
    return cl.PlacedRobot(one, trajectory=motion, timing=timing)


def made(*robots: cl.PlacedRobot) -> MadeMoves:
    return MadeMoves.of(cl.Case("cell", robots, (cl.Obstacle(cl.Body("post", cl.box([1, 1, 1]))),)))


@pytest.mark.parametrize(
    ("timing", "told"),
    [
        (Timing(), {-0.1: "", 0.0: "PTP 1", 1.0: "PTP 1", 1.1: "LIN 3", 4.0: "LIN 3", 4.1: ""}),
        (Timing(start=2.0, rate=2.0), {1.9: "", 2.5: "PTP 1", 2.6: "LIN 3", 4.0: "LIN 3", 4.1: ""}),
        (Timing(after="loop"), {4.0: "LIN 3", 4.5: "PTP 1", 7.0: "LIN 3", 12.5: "PTP 1"}),
    ],
)
def test_the_end_of_a_move_is_its_own_and_rounds_repeat(timing, told):
    moves = made(robot("one", timing))
    assert {time: moves.at(time) for time in told} == told
    codes, names = moves.codes(np.array([*told]))
    assert [names[code] if code >= 0 else "" for code in codes] == [*told.values()]


def test_each_robot_that_makes_a_move_is_named_and_one_without_a_program_is_not():
    moves = made(
        robot("left", Timing()), robot("right", Timing(start=3.0)), robot("still", Timing(), ())
    )
    assert made(robot("left", Timing()), robot("still", Timing(), ())).at(0.5) == "PTP 1"
    assert moves.at(0.5) == "left/PTP 1" and moves.at(3.5) == "left/LIN 3, right/PTP 1"
    assert (
        moves.over(0.5, 6.0) == "left/PTP 1 to right/LIN 3"
        and moves.over(5.0, 6.0) == "right/LIN 3"
    )


def test_rows_have_their_moves_at_every_depth_and_none_without_a_program():
    told = {"rows": [{"time": 0.5}, {"time": None}, {"a": {"start": 0.5, "end": 2.0}}], "end": 4.0}
    named = made(robot("one", Timing())).named(told)
    first, second, third = named["rows"]
    assert first == {"time": 0.5, "move": "PTP 1"} and second == {"time": None}
    assert third["a"]["moves"] == "PTP 1 to LIN 3" and "move" not in named
    assert MadeMoves().named(told) is told
