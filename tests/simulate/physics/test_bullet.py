"""Physics against what can be said on paper, and our kinematics against the engine's."""

from __future__ import annotations

import importlib.util
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from clearance.errors import BadInput, MissingFile
from clearance.formats.files.input_files import InputFiles
from clearance.formats.mesh_store import MeshStore
from clearance.formats.robot.request import RobotRequest, read_robot
from clearance.geometry.point_cloud import PointCloud
from clearance.geometry.shapes import box
from clearance.simulate.physics import bullet
from clearance.simulate.physics.bullet import STEPS_PER_SECOND, simulated_motion
from clearance.world.body import Body, Obstacle
from clearance.world.kinematics import link_poses
from clearance.world.placed_robot import PlacedRobot
from clearance.world.trajectory import Trajectory
from tests.made_cases import at

ENGINE_PRECISION = 1e-6
"""The engine is built in float32: 6e-8 a joint, about ten joints, poses to 2 m."""

CART = """<robot name="cart">
  <link name="ground"><inertial><mass value="1"/>
    <inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial></link>
  <link name="slider"><inertial><origin xyz="0.05 0 0"/><mass value="2"/>
    <inertia ixx="0.1" iyy="0.1" izz="0.1" ixy="0" ixz="0" iyz="0"/></inertial>
    <collision><geometry><box size="0.2 0.2 0.2"/></geometry></collision></link>
  <link name="follower"><inertial><mass value="0.5"/>
    <inertia ixx="0.1" iyy="0.1" izz="0.1" ixy="0" ixz="0" iyz="0"/></inertial></link>
  <joint name="rail" type="prismatic"><parent link="ground"/><child link="slider"/>
    <origin xyz="0.1 0.2 0.3" rpy="0.3 -0.2 0.5"/>
    <axis xyz="{axis}"/><limit lower="-2" upper="2" effort="{effort}" velocity="2"/></joint>
  <joint name="arm" type="revolute"><parent link="slider"/><child link="follower"/>
    <axis xyz="0 1 0"/><limit lower="-3" upper="3" effort="50" velocity="2"/>
    <mimic joint="rail" multiplier="-1.5" offset="0.25"/></joint>
</robot>"""


def cart(tmp_path: Path, effort: float = 500.0, axis: str = "1 0 0", **changes) -> PlacedRobot:
    path = tmp_path / "cart.urdf"
    path.write_text(CART.format(effort=effort, axis=axis))
    times = np.linspace(0.0, 1.0, 21)
    asked = 0.25 * (1.0 - np.cos(np.pi * times))  # to 0.5 m, at rest at both ends
    trajectory = Trajectory(times, ("rail",), asked[:, None])
    return replace(placed_robot(path, trajectory), **changes)


def placed_robot(path: Path, trajectory: Trajectory | None = None, packages=()) -> PlacedRobot:
    robot = read_robot(RobotRequest(path, packages), MeshStore(InputFiles(path.parent)))
    names = tuple(joint.name for joint in robot.moving_joints)
    still = Trajectory(np.array([0.0, 1.0]), names, np.zeros((2, len(names))))
    return PlacedRobot(robot, trajectory or still, urdf_path=str(path))


def about_y(angle: float) -> np.ndarray:
    """(3, 3)"""
    c, s = np.cos(angle), np.sin(angle)
    return np.array([[c, 0.0, s], [0.0, 1.0, 0.0], [-s, 0.0, c]])


TILTED = at(0.3, -0.4, 0.5, turned=about_y(0.7))


def rail_up(placed: PlacedRobot) -> PlacedRobot:
    """The cart on a base that has its rail point up."""
    joint = placed.robot.moving_joints[0].parent_from_joint[:3, :3]
    return replace(placed, world_from_base=at(turned=about_y(-np.pi / 2) @ joint.T))


def packaged_urdf(relative: str) -> Path:
    # found without importing: the import would start the engine's logging
    return Path(importlib.util.find_spec("pybullet_data").origin).parent / relative


def bullet_link_poses(placed: PlacedRobot, positions: np.ndarray) -> np.ndarray:
    """(n, n_links, 4, 4) [m] the pose of every link as the engine's own kinematics sees it."""
    with bullet._world(placed, with_shapes=False) as world:
        engine, body = world._engine, world._body
        index = {
            engine.getJointInfo(body, i)[12].decode(): i for i in range(engine.getNumJoints(body))
        }
        found = []
        for row in positions:
            world._place(row, np.zeros(len(row)))
            found.append(
                [pose_of(engine, body, index.get(name)) for name in placed.robot.link_names]
            )
    return np.array(found)


def pose_of(engine, body: int, i_link: int | None) -> np.ndarray:
    """The pose of a link, or of the base."""
    if i_link is not None:
        xyz, quat = engine.getLinkState(body, i_link, computeForwardKinematics=True)[4:6]
    else:
        world_from_inertial = engine.getBasePositionAndOrientation(body)
        inertial_from_base = engine.invertTransform(*engine.getDynamicsInfo(body, -1)[3:5])
        xyz, quat = engine.multiplyTransforms(*world_from_inertial, *inertial_from_base)
    pose = np.eye(4)
    pose[:3, :3] = np.reshape(engine.getMatrixFromQuaternion(quat), (3, 3))
    pose[:3, 3] = xyz
    return pose


def assert_same_kinematics(placed: PlacedRobot) -> None:
    placed = replace(placed, world_from_base=TILTED)
    rng = np.random.default_rng(5)
    joints = placed.robot.moving_joints
    low = [max(joint.lower, -3.0) for joint in joints]
    high = [min(joint.upper, 3.0) for joint in joints]
    positions = rng.uniform(low, high, size=(25, len(joints)))
    ours, engine = link_poses(placed, positions), bullet_link_poses(placed, positions)
    assert ours.shape == engine.shape
    assert np.abs(ours - engine).max() < ENGINE_PRECISION


@pytest.mark.slow
def test_our_kinematics_are_the_engines_on_a_robot_it_brings():
    urdf = packaged_urdf("franka_panda/panda.urdf")
    assert_same_kinematics(placed_robot(urdf, packages=(packaged_urdf(""),)))


def test_our_kinematics_are_the_engines_with_mimic_offset_and_odd_axes(tmp_path):
    assert_same_kinematics(cart(tmp_path, axis="1 2 -2"))


def test_a_strong_robot_follows_and_every_simulation_step_is_kept(tmp_path):
    motion = simulated_motion(cart(tmp_path), settle_time=0.25)
    assert np.allclose(np.diff(motion.times), 1 / STEPS_PER_SECOND)
    assert motion.n_steps == 1 + 300 and motion.times[-1] == pytest.approx(1.25)
    assert motion.tracking_error[0] == 0.0 and 0.0 < motion.tracking_error.max() < 0.02
    assert motion.positions[-1, 0] == pytest.approx(0.5, abs=1e-3)
    given = motion.placed.trajectory
    asked = np.interp(motion.times, given.times, given.positions[:, 0])
    assert np.allclose(motion.tracking_error, np.abs(motion.positions[:, 0] - asked), atol=1e-15)


def test_a_weak_robot_lags_as_newton_says(tmp_path):
    """A slider of 2 kg that may push with 0.5 N gains no more than 0.25 m/s each second."""
    upright = cart(tmp_path, effort=0.5)
    level = np.linalg.inv(link_poses(upright, np.zeros((1, 1)))[0, 1])
    level[:3, 3] = 0.0  # turns the rail into the horizontal, so that gravity does no work
    motion = simulated_motion(replace(upright, world_from_base=level))
    bound = 0.5 * (0.5 / 2.0) * motion.times**2  # the follower's mass only makes it slower
    assert (motion.positions[:, 0] <= bound + 1e-3).all()
    assert motion.tracking_error.max() > 0.2


def test_gravity_pulls_a_robot_that_cannot_hold_itself(tmp_path):
    """A rail that points up and a motor of almost no force: free fall from rest, s = g t^2 / 2."""
    weak = rail_up(cart(tmp_path, effort=1e-6))
    still = Trajectory(np.array([0.0, 0.5]), ("rail",), np.zeros((2, 1)))
    motion = simulated_motion(replace(weak, trajectory=still), settle_time=0.0)
    fallen = -0.5 * 9.81 * motion.times**2
    assert np.allclose(motion.positions[:, 0], fallen, atol=0.02 * abs(fallen[-1]))
    assert motion.positions[-1, 0] < -1.1


def test_what_is_assumed_is_said(tmp_path):
    assert simulated_motion(cart(tmp_path)).notes == ()
    placed = cart(tmp_path, effort=0.0)
    (note,) = simulated_motion(placed).notes
    assert "effort" in note and "rail" in note
    text = CART.format(effort=5, axis="1 0 0")
    path = Path(placed.urdf_path)
    path.write_text(text[: text.index("<inertial><origin")] + text[text.index("<collision>") :])
    (note,) = simulated_motion(placed_robot(path)).notes
    assert "slider" in note and "mass" in note


def test_a_robot_that_the_engine_cannot_read_is_refused_in_one_line(tmp_path):
    placed = cart(tmp_path)
    Path(placed.urdf_path).write_text("<robot name='empty'/>")
    with pytest.raises(BadInput) as caught:
        simulated_motion(placed)
    assert "cannot load" in str(caught.value)
    Path(placed.urdf_path).unlink()
    with pytest.raises(MissingFile):
        simulated_motion(placed)


def test_a_cloud_of_points_is_nothing_to_bump_into(tmp_path):
    scan = Obstacle(Body("scan", PointCloud([[0.5, 0.0, 0.0]], 0.01)))
    placed = cart(tmp_path)
    simulated_motion(placed, [scan])  # measured, not pushed against
    with pytest.raises(BadInput, match="contact_response: obstacle 'scan' is a cloud of points"):
        simulated_motion(placed, [scan], contact_response=True)


WRIST = """<robot name="wrist" {space}>
  <link name="base"/>
  <link name="upper"><inertial><origin xyz="0.1 0.05 0.02" rpy="0.4 -0.3 0.7"/><mass value="6"/>
    <inertia ixx="0.4" iyy="0.5" izz="0.3" ixy="0.05" ixz="-0.04" iyz="0.03"/></inertial>
    <collision><geometry><box size="0.4 0.1 0.1"/></geometry></collision></link>
  <link name="lower">{lower}
    <collision><geometry><box size="0.3 0.08 0.08"/></geometry></collision></link>
  <joint name="shoulder" type="revolute"><parent link="base"/><child link="upper"/>
    <origin xyz="0 0 1"/><axis xyz="0 1 0"/><dynamics damping="{damping}" friction="{friction}"/>
    <limit lower="-3" upper="3" effort="60" velocity="90"/></joint>
  <joint name="elbow" type="revolute"><parent link="upper"/><child link="lower"/>
    <origin xyz="0.4 0 0" rpy="0.2 0.1 0"/><axis xyz="0 0 1"/>
    <limit lower="-3" upper="3" effort="4" velocity="90"/></joint>
</robot>"""
LOWER = """<inertial><origin xyz="0.1 0 0" rpy="0 0.5 0.2"/><mass value="2"/>
    <inertia ixx="0.02" iyy="{iyy}" izz="0.05" ixy="0.004" ixz="0" iyz="0.006"/></inertial>"""
USUAL = LOWER.format(iyy=0.05)
FRAME = """<inertial><mass value="0"/>
    <inertia ixx="0" iyy="0" izz="0" ixy="0" ixz="0" iyz="0"/></inertial>"""


def wrist(tmp_path: Path, lower=USUAL, damping=0.0, friction=0.0, space="") -> PlacedRobot:
    path = tmp_path / "wrist.urdf"
    path.write_text(WRIST.format(lower=lower, damping=damping, friction=friction, space=space))
    asked = Trajectory(
        np.array([0.0, 0.4]), ("shoulder", "elbow"), np.array([[0.0, 0.0], [0.6, 1.2]])
    )
    return placed_robot(path, asked)


def engines_own_motion(placed: PlacedRobot, n_steps: int) -> np.ndarray:
    """(n, 2) [rad] the whole URDF in an engine of its own, with the inertias of the file."""
    engine, trajectory = bullet._connect(), placed.given_trajectory
    flags = engine.URDF_USE_INERTIA_FROM_FILE
    body = engine.loadURDF(placed.urdf_path, useFixedBase=True, flags=flags)
    engine.setTimeStep(1.0 / (STEPS_PER_SECOND * bullet.SUBSTEPS))
    engine.setGravity(0.0, 0.0, -9.81)
    found, last = [np.zeros(2)], np.zeros(2)
    for joint in range(2):
        engine.changeDynamics(body, joint, linearDamping=0.0, angularDamping=0.0)
        engine.setJointMotorControl2(body, joint, engine.VELOCITY_CONTROL, force=0.0)
    for step in range(1, n_steps):
        asked = np.array([
            np.interp(step / STEPS_PER_SECOND, trajectory.times, column)
            for column in trajectory.positions.T
        ])  # fmt: skip
        for joint, effort in enumerate((60.0, 4.0)):
            rate = (asked - last)[joint] * STEPS_PER_SECOND
            engine.setJointMotorControl2(
                body, joint, engine.POSITION_CONTROL, asked[joint], rate, effort
            )
        last = asked
        for _ in range(bullet.SUBSTEPS):
            engine.stepSimulation()
        found.append(np.array([engine.getJointState(body, joint)[0] for joint in range(2)]))
    engine.disconnect()
    return np.array(found)


@pytest.mark.parametrize(("damping", "contact_response"), [(0.0, True), (8.0, False)])
def test_inertias_and_damping_are_those_of_the_urdf(tmp_path, damping, contact_response):
    placed = wrist(tmp_path, damping=damping)
    motion = simulated_motion(placed, contact_response=contact_response)
    wanted = engines_own_motion(placed, motion.n_steps)
    assert motion.positions == pytest.approx(wanted, abs=1e-9)
    assert motion.tracking_error.max() > 0.05
    assert not motion.notices or "friction" not in motion.notices[0].text


@pytest.mark.parametrize("lower", ["", FRAME])
def test_a_link_without_mass_moves_and_is_told(tmp_path, lower):
    motion = simulated_motion(wrist(tmp_path, lower=lower))
    assert motion.positions[-1] == pytest.approx([0.6, 1.2], abs=1e-2)
    assert motion.notes == (
        "simulated motion: the URDF gives no mass to lower; taken as weightless",
    )


def test_a_mass_without_inertia_is_one_point(tmp_path):
    point = '<inertial><origin xyz="0.2 0 0"/><mass value="2"/></inertial>'
    (note,) = simulated_motion(wrist(tmp_path, lower=point)).notes
    assert note == "simulated motion: the URDF gives no inertia to lower; taken as one point"


def test_friction_that_the_engine_does_not_know_is_a_warning(tmp_path):
    (notice,) = simulated_motion(
        wrist(tmp_path, friction=0.5, space='xmlns="http://www.ros.org"')
    ).notices
    assert notice.severity == "warning" and notice.kind == "simulated"
    assert "friction" in notice.text and "'shoulder' 0.5 of 60 N m" in notice.text


def test_an_inertia_that_no_body_has_is_made_possible_and_is_a_warning(tmp_path):
    """The engine would take it as none: its greatest moment may not exceed the two others together."""
    placed = wrist(tmp_path, lower=LOWER.format(iyy=0.2))
    notice = simulated_motion(placed).notices[0]
    assert notice.severity == "warning" and "'lower'" in notice.text
    with bullet._world(placed, with_shapes=False) as world:
        moments = sorted(world._engine.getDynamicsInfo(world._body, 1)[2])
    given = np.array([[0.02, 0.004, 0.0], [0.004, 0.2, 0.006], [0.0, 0.006, 0.05]])
    added = np.diff(sorted(np.linalg.eigvalsh(given)))
    assert np.diff(moments) == pytest.approx(added, rel=1e-5)
    assert moments[2] == pytest.approx(moments[0] + moments[1], rel=1e-4)


@pytest.mark.parametrize("value", ["much", "nan"])
def test_an_inertia_that_is_no_number_is_refused_by_name(tmp_path, value):
    placed = wrist(tmp_path, lower=LOWER.format(iyy=0.05))
    path = Path(placed.urdf_path)
    path.write_text(path.read_text().replace('izz="0.05"', f'izz="{value}"'))
    with pytest.raises(BadInput, match=f"link 'lower': izz is '{value}'"):
        simulated_motion(placed)


def test_a_robot_that_arrives_late_is_simulated_until_it_rests(tmp_path):
    placed = cart(tmp_path, effort=60.0)
    quick = Trajectory(np.array([0.0, 0.2]), ("rail",), np.array([[0.0], [0.5]]))
    motion = simulated_motion(replace(placed, trajectory=quick, world_from_base=TILTED))
    assert motion.positions[-1, 0] == pytest.approx(0.5, abs=1e-3)
    assert 0.45 + 1e-6 < motion.times[-1] < 10.2


def test_a_robot_that_does_not_arrive_is_suspect(tmp_path):
    motion = simulated_motion(cart(tmp_path, effort=1e-3))
    assert motion.times[-1] == pytest.approx(11.0)
    (notice,) = motion.notices
    assert notice.severity == "suspect" and notice.kind == "simulated"
    assert "joint 'rail' leaves the trajectory by up to" in notice.text
    assert "from its last sample 10 s after it" in notice.text


@pytest.mark.slow
def test_a_robot_that_an_obstacle_stops_is_suspect(tmp_path):
    """A wall whose face is 0.2 m before the slider's pushes back only where that is told."""
    placed = cart(tmp_path, effort=50.0)
    there = link_poses(placed, np.zeros((1, 1)))[0, 1] @ at(0.4)
    wall = (Obstacle(Body("wall", box((0.2, 1.0, 1.0))), there),)
    through = simulated_motion(placed, wall)
    assert through.positions[-1, 0] == pytest.approx(0.5, abs=5e-3)
    assert np.array_equal(through.positions, simulated_motion(placed).positions)
    stopped = simulated_motion(placed, wall, contact_response=True)
    assert stopped.positions[:, 0].max() < 0.22 and stopped.tracking_error[-1] > 0.25
    pushed, course = stopped.notices
    assert pushed.severity == course.severity == "suspect"
    assert "obstacles push the simulated robot: 'slider' and " in pushed.text
    assert bullet.HULLS in stopped.notes


def test_joints_are_no_faster_than_they_may_be(tmp_path):
    placed = cart(tmp_path)  # 2 m/s
    quick = Trajectory(np.array([0.0, 0.1]), ("rail",), np.array([[0.0], [0.5]]))
    motion = simulated_motion(replace(placed, trajectory=quick))
    assert np.abs(np.diff(motion.positions[:, 0])).max() * STEPS_PER_SECOND < 2.0 + 1e-6
