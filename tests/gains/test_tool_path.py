"""A base that is moved while its tool goes the same way."""

from dataclasses import replace

import numpy as np
import pytest

import clearance as cl
from clearance.errors import UnknownLink
from clearance.gains.figures import figures_of
from clearance.gains.folder import save_gain
from clearance.gains.search import Search
from clearance.gains.sentences import lines_of
from clearance.gains.shift import base_shift
from clearance.gains.tool_path import tool_path_kept
from clearance.gains.turn import Turn
from clearance.world.kinematics import link_poses
from clearance.world.robot import Joint, JointKind
from clearance.world.tool import pose_errors, tool_of
from tests.gains.gantries import along_x, gantry, slot, standing
from tests.gains.making_gain import write_cell
from tests.made_cases import at, random_robot


def footed(x_range=(-np.inf, np.inf), rates=False):
    """A gantry whose foot is 30 mm from a wall in x, 50 are needed; it carries a block along x."""
    plain = gantry()
    foot = cl.Body("base", cl.box((0.2, 0.2, 0.2)))
    joints = (replace(plain.joints[0], lower=x_range[0], upper=x_range[1]), plain.joints[1])
    robot = cl.Robot(plain.name, plain.link_names, joints, (foot, *plain.bodies))
    placed = along_x(robot, start=-1.0, end=-0.5, y=1.0)
    if rates:
        asked = placed.given_trajectory
        speeds = np.gradient(asked.positions, asked.times, axis=0)
        placed = replace(placed, trajectory=replace(asked, velocities=speeds))
    wall = standing("wall", cl.box((0.1, 0.4, 0.4)), (0.18, 0.0, 0.0))
    return cl.Case("foot", (placed,), (wall,), cl.Limits(fail=0.05))


@pytest.mark.slow
@pytest.mark.parametrize("rates", [False, True])
def test_a_foot_steps_back_and_slides_make_up_for_it(rates):
    case = footed(rates=rates)
    found = cl.gain(case, "base", tool_path="kept")
    assert found.kept and found.change == pytest.approx([-0.02, 0.0, 0.0], abs=1e-6)
    assert found.lower_bound == pytest.approx(0.02, rel=1e-4)
    before, after = (one.robots[0].given_trajectory for one in (case, found.case))
    assert after.positions - before.positions == pytest.approx(
        np.tile([0.02, 0.0], (41, 1)), abs=1e-6
    )
    error = found.tool_path
    assert (
        error.link == "tool"
        and error.far <= 1e-9
        and error.far_between <= 2e-9
        and error.turn == 0.0
    )


def test_limits_of_slides_bind():
    found = cl.gain(
        footed(x_range=(-1.0, -0.49)), "base", tool_path="kept", within=(0.03, 0.0, 0.0)
    )
    assert (
        not found.kept
        and found.case.robots[0].given_trajectory.positions[:, 0].max() <= -0.49 + 2e-4
    )
    assert any("joint x is at its upper limit" in line for line in found.binding)


def test_what_the_tool_is_near_to_no_base_mends():
    post = standing("post", cl.box((0.1, 0.1, 1.0)), (-0.7, 1.12, 0.0))
    case = replace(footed(), obstacles=(post,))
    found = cl.gain(case, "base", tool_path="kept")
    assert (
        not found.kept and found.n_measured == 1 and "nothing of this change" in str(found.blocked)
    )


def test_joints_that_cannot_follow_are_said():
    with pytest.raises(cl.BadInput, match="cannot keep the path of 'tool'"):
        cl.gain(footed(), "base", tool_path="kept", within=(0.0, 0.0, 0.1))
    with pytest.raises(cl.BadInput, match="did you mean 'tool'"):
        cl.gain(footed(), "base", tool_path="kept", tool="tooth")


def arm():
    """Six joints that turn, two fat links, past a ball."""
    axes = np.eye(3)[[2, 1, 1, 0, 1, 0]]
    offsets = [(0, 0, 0.2), (0, 0, 0.1), (0, 0, 0.4), (0.3, 0, 0), (0.1, 0, 0), (0.1, 0, 0)]
    names = ("base", *(f"l{i}" for i in range(6)))
    joints = []
    for i, (axis, offset) in enumerate(zip(axes, offsets, strict=True)):
        turns = JointKind.REVOLUTE, names[i], names[i + 1], at(*offset), axis
        joints.append(Joint(f"j{i}", *turns, -3.0, 3.0))
    bodies = (cl.Body("l1", cl.box((0.1, 0.1, 0.4))), cl.Body("l5", cl.box((0.05, 0.05, 0.05))))
    robot = cl.Robot("arm", names, tuple(joints), bodies)
    times = np.linspace(0.0, 1.0, 21)
    ends = np.array([[0.0, 0.3, 0.4, 0.2, 0.6, 0.1], [0.6, 0.5, 0.2, -0.2, 0.8, 0.4]])
    positions = ends[0] + times[:, None] * (ends[1] - ends[0])
    placed = cl.PlacedRobot(robot, cl.Trajectory(times, tuple(j.name for j in joints), positions))
    ball = standing("ball", cl.PointCloud([[0.0, 0.0, 0.0]], 0.05), (0.1, 0.13, 0.45))
    return cl.Case("arm", (placed,), (ball,), cl.Limits(fail=0.03))


@pytest.mark.parametrize("turn", [None, Turn("z"), Turn("y", (0.4, 0.0, 0.3))])
def test_the_rows_are_those_of_differences(turn):
    way = tool_path_kept(base_shift(arm(), 0, turn=turn), None)
    rng = np.random.default_rng(1)
    x = 0.01 * rng.normal(size=way.size_of_x)
    search, step = Search(way, 0.1), 1e-6 * rng.normal(size=len(x))
    states = [search.state_at(x + side * step) for side in (-1.0, 0.0, 1.0)]
    near = [one.near[0] for one in states]
    low, here, high = (dict(zip(one.steps.tolist(), one.clearances, strict=True)) for one in near)
    foretold = dict(zip(here, way.gradient(near[1]) @ step, strict=True))
    common = low.keys() & here.keys() & high.keys()
    assert len(common) > 10
    for number in common:
        assert (high[number] - low[number]) / 2.0 == pytest.approx(foretold[number], abs=2e-11)


def test_an_arm_leans_away_and_its_tool_stays():
    case = arm()
    found = cl.gain(case, "base", tool_path="kept")
    assert found.kept and not found.before.passed and found.after.passed
    error = found.tool_path
    assert error.link == "l5" and error.far <= 1e-8 and error.turn <= 1e-8
    assert error.far < error.far_between < 0.002
    moments = np.linspace(0.0, 1.0, 333)
    at = []
    for one in (case, found.case):
        placed = one.robots[0]
        joints = np.stack(
            [
                np.interp(moments, placed.given_trajectory.times, q)
                for q in placed.given_trajectory.positions.T
            ],
            1,
        )
        at.append(link_poses(placed, joints)[:, -1, :3, 3])
    assert np.linalg.norm(at[1] - at[0], axis=1).max() <= error.far_between


FOOT = """\
robot: {urdf: robots/foot.urdf}
trajectory: foot.csv
scene:
  obstacles:
  - {name: wall, box: {size: [0.1, 0.4, 0.4]}, pose: {xyz: [0.18, 0.0, 0.0]}}
limits: {fail: 0.05}
"""


@pytest.mark.slow
def test_base_and_path_are_written(tmp_path):
    path = write_cell(tmp_path, FOOT)
    urdf = (tmp_path / "robots" / "one.urdf").read_text()
    foot = '<link name="base"><collision><geometry><box size="0.2 0.2 0.2"/></geometry></collision></link>'
    (tmp_path / "robots" / "foot.urdf").write_text(urdf.replace('<link name="base"/>', foot))
    (tmp_path / "foot.csv").write_text("time,x,y\n0,-1,1\n1,-0.5,1\n")
    found = cl.gain(path, "base", tool_path="kept")
    out = save_gain(found, tmp_path / "out")
    assert found.kept and cl.check(out / "case.yaml").passed
    assert "goes the same way" in (out / "gain.html").read_text()
    assert (out / "trajectory.csv").is_file()


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
    (line,) = [
        line for _, line in lines_of(found) if line.startswith(f"tool at {time:.3f} s is moved")
    ]
    told = {"link": "tool", "time": time, "far": move.far, "turn": 0.0}
    assert figures_of(found)["tool"] == [told | {"most_far": 0.0201, "most_turn": 1e-3}]
    assert "mm of 20.1 and turned 0 deg of 0.0572958" in line


@pytest.mark.slow
def test_what_the_tool_keeps_from_is_said():
    found = cl.gain(posted(), keep_tool=[(0.49, 0.01, 1e-3)])
    assert not found.kept and found.tool_moves[0].far <= 0.011
    assert any("tool tool has no more to give at 0.490 s" in line for line in found.binding)


@pytest.mark.parametrize("far, turn, n", [(0.0199, 1e-6, 1), (0.01, 0.05, 1), (0.02001, 1e-6, 2)])
def test_a_tolerance_that_holds_the_violation_is_said_at_once(far, turn, n):
    found = cl.gain(posted(), keep_tool=[(0.5, far, turn)])
    assert found.kept == (n == 2) and (found.n_measured == 1) == (n == 1)
    assert n == 2 or "that moment is to be kept" in str(found.blocked)


def chain(seed):
    """Joints of all sorts, some that follow, and the link behind the last that does not."""
    rng = np.random.default_rng(seed)
    robot = random_robot(rng, 6, mimics=0.4)
    own = [one for one in robot.joints if one.kind is not JointKind.FIXED and one.mimic is None]
    names = tuple(one.name for one in own[::-1])
    at = rng.normal(size=(3, len(names)))
    return cl.PlacedRobot(robot, cl.Trajectory(np.arange(3.0), names, at)), own[-1].child


@pytest.mark.parametrize("seed", range(3))
def test_the_usual_tool_is_what_all_joints_move_and_its_rates_are_those_of_differences(seed):
    placed, last = chain(seed)
    assert tool_of(placed, None).name == last
    tool, at = tool_of(placed, "l6"), placed.given_trajectory.positions
    rates = tool.poses_and_rates(at)[1]
    for column, step in enumerate(1e-6 * np.eye(at.shape[1])):
        found = pose_errors(tool.poses(at + step), tool.poses(at - step)) / 2e-6
        assert rates[:, :, column] == pytest.approx(found, abs=1e-8)


def test_how_poses_lie_apart_at_any_angle():
    axis = np.array([2.0, -1.0, 2.0]) / 3.0
    cross = np.cross(np.eye(3), axis)
    for angle in (0.0, 1e-9, 0.3, 3.0):
        turned = np.eye(3) + np.sin(angle) * cross + (1 - np.cos(angle)) * cross @ cross
        found = pose_errors(at(turned=turned)[None], np.eye(4)[None])[0]
        assert found == pytest.approx(np.append(np.zeros(3), angle * axis), abs=1e-9)


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
