"""Moments at which a tool stays about where it is, and how tools move by joints."""

import numpy as np
import pytest

import clearance as cl
from clearance.errors import UnknownLink
from clearance.world.robot import Joint, JointKind, Mimic
from clearance.world.tool import apart, tool_of
from tests.gains.gantries import along_x, gantry, slot, standing


def posted(fail=0.04):
    """A block that passes a post 20 mm away at 0.5 s."""
    post = standing("post", cl.box((0.1, 0.1, 1.0)), (0.0, 0.12, 0.0))
    return cl.Case("post", (along_x(gantry()),), (post,), cl.Limits(fail=fail))


@pytest.mark.parametrize("time", [0.5, 0.4871])
def test_a_tool_that_may_move_far_enough_does_and_no_farther(time):
    found = cl.gain(posted(), keep_tool=[(time, 0.0201, 1e-3)])
    (move,) = found.tool_moves
    assert found.kept and found.after.passed and move.link == "tool"
    assert 0.0199 < move.far <= 0.0201 and move.turn == 0.0


def test_what_the_tool_keeps_from_is_said():
    found = cl.gain(posted(), keep_tool=[(0.49, 0.01, 1e-3)])
    assert not found.kept and found.tool_moves[0].far <= 0.011
    assert any("tool tool has no more to give at 0.490 s" in line for line in found.binding)


@pytest.mark.parametrize("far, turn, n", [(0.0199, 1e-6, 1), (0.01, 0.05, 1), (0.02001, 1e-6, 2)])
def test_a_tolerance_that_holds_the_violation_is_said_at_once(far, turn, n):
    found = cl.gain(posted(), keep_tool=[(0.5, far, turn)])
    assert found.kept == (n == 2) and (found.n_measured == 1) == (n == 1)
    assert n == 2 or "that moment is to be kept" in str(found.blocked)


@pytest.mark.slow
def test_a_tool_that_is_kept_elsewhere_costs_more():
    free = cl.gain(posted())
    kept = cl.gain(posted(), keep_tool=[(0.35, 0.001, 1e-3)])
    assert kept.kept and kept.tool_moves[0].far <= 0.001
    assert kept.size >= free.size * (1.0 - 1e-6)


def chain():
    """Joints of all sorts, one that follows, out of plane."""
    rng = np.random.default_rng(5)

    def placed():
        pose = np.eye(4)
        pose[:3, :3] = np.linalg.qr(rng.normal(size=(3, 3)))[0]
        pose[:3, :3] *= np.sign(np.linalg.det(pose[:3, :3]))
        pose[:3, 3] = rng.normal(size=3)
        return pose

    axes = np.eye(3)
    joints = (
        Joint("a", JointKind.REVOLUTE, "base", "l1", placed(), axes[2]),
        Joint("b", JointKind.PRISMATIC, "l1", "l2", placed(), axes[0]),
        Joint("c", JointKind.CONTINUOUS, "l2", "l3", placed(), axes[1]),
        Joint("d", JointKind.REVOLUTE, "l3", "l4", placed(), axes[0], mimic=Mimic("a", -0.5, 0.2)),
        Joint("e", JointKind.FIXED, "l4", "l5", placed()),
    )
    names = ("base", "l1", "l2", "l3", "l4", "l5")
    robot = cl.Robot("chain", names, joints, (cl.Body("l5", cl.box((0.1, 0.1, 0.1))),))
    at = rng.normal(size=(3, 3))
    return cl.PlacedRobot(robot, cl.Trajectory(np.arange(3.0), ("c", "a", "b"), at))


def test_rates_of_a_tool_are_those_of_differences():
    placed = chain()
    tool, at = tool_of(placed, "l5"), placed.given_trajectory.positions
    rates = tool.poses_and_rates(at)[1]
    for column in range(3):
        step = np.eye(3)[column] * 1e-6
        found = apart(tool.poses(at + step), tool.poses(at - step)) / 2e-6
        assert rates[:, :, column] == pytest.approx(found, abs=1e-8)


def test_how_poses_lie_apart_at_any_angle():
    axis = np.array([2.0, -1.0, 2.0]) / 3.0
    cross = np.cross(np.eye(3), axis)
    for angle in (0.0, 1e-9, 0.3, 3.0):
        turned = np.eye(4)
        turned[:3, :3] += np.sin(angle) * cross + (1 - np.cos(angle)) * cross @ cross
        found = apart(turned[None], np.eye(4)[None])[0]
        assert found == pytest.approx(np.append(np.zeros(3), angle * axis), abs=1e-9)


def test_the_usual_tool_is_the_first_that_all_joints_move():
    assert tool_of(chain(), None).name == "l3"


@pytest.mark.parametrize(
    "fault, told, how",
    [
        (UnknownLink, "did you mean 'tool'", {"keep_tool": [(0.5, 0.01, 0.1)], "tool": "tol"}),
        (cl.BadInput, "no joint of the path", {"keep_tool": [(0.5, 0.01, 0.1)], "tool": "base"}),
        (cl.BadInput, "at which its path is not", {"keep_tool": [(1.5, 0.01, 0.1)]}),
        (cl.BadInput, "0.001 mm", {"keep_tool": [(0.5, 0.0, 0.1)]}),
    ],
)
def test_what_is_no_pose_to_keep(fault, told, how):
    with pytest.raises(fault, match=told):
        cl.gain(slot(), **how)
