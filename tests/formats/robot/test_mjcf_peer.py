"""Poses, meshes and distances of MJCF models as MuJoCo has them."""

import mujoco
import numpy as np
import pytest

from clearance.geometry.pose import pose_from_rpy
from clearance.query.distance import distance
from clearance.world.kinematics import link_poses
from clearance.world.placed_robot import PlacedRobot
from tests.formats.making_mjcf import JOINTED, load_mjcf, mjcf, write_mjcf

pytestmark = pytest.mark.peer


def names_of(model) -> list[str]:
    return [model.body(i).name or f"body{i}" for i in range(model.nbody)]


def as_quaternion(yaw_pitch_roll) -> np.ndarray:
    """(4,) the scalar first, as MuJoCo has it."""
    quaternion = np.empty(4)
    mujoco.mju_mat2Quat(quaternion, pose_from_rpy([0, 0, 0], yaw_pitch_roll[::-1])[:3, :3].ravel())
    return quaternion


def random_state(model, robot, rng) -> tuple[np.ndarray, np.ndarray]:
    """Positions of all moving joints of the robot, and the qpos that says the same."""
    columns, qpos = [], np.zeros(model.nq)
    for i in range(model.njnt):
        at, kind = model.jnt_qposadr[i], model.jnt_type[i]
        if kind == mujoco.mjtJoint.mjJNT_FREE:
            place, turn = rng.normal(size=3), rng.uniform(-3, 3, 3)
            qpos[at : at + 7] = [*place, *as_quaternion(turn)]
            columns += [*place, *turn]
        elif kind == mujoco.mjtJoint.mjJNT_BALL:
            turn = rng.uniform(-3, 3, 3)
            qpos[at : at + 4] = as_quaternion(turn)
            columns += [*turn]
        else:
            qpos[at] = rng.uniform(-2, 2)
            columns.append(qpos[at])
    assert len(columns) == len(robot.moving_joints)
    return np.array([columns]), qpos


def farthest_apart(folder, text: str, n: int = 50) -> float:
    robot = load_mjcf(folder, text)
    model = mujoco.MjModel.from_xml_path(str(write_mjcf(folder, text)))
    data, rng, worst = mujoco.MjData(model), np.random.default_rng(7), 0.0
    for _ in range(n):
        positions, data.qpos[:] = random_state(model, robot, rng)
        mujoco.mj_kinematics(model, data)
        poses = link_poses(PlacedRobot(robot), positions)[0]
        for i, name in enumerate(names_of(model)):
            ours = poses[robot.link_names.index(name)]
            worst = max(
                worst,
                float(np.abs(ours[:3, 3] - data.xpos[i]).max()),
                float(np.abs(ours[:3, :3] - data.xmat[i].reshape(3, 3)).max()),
            )
    return worst


def test_bodies_are_where_mujoco_has_them(tmp_path):
    assert farthest_apart(tmp_path, JOINTED) < 1e-12


MESHES = mjcf(
    '<body name="b" pos="0 0 1"><joint/><geom type="mesh" mesh="a" pos="1 2 3" euler="30 0 10"/>'
    '<geom type="mesh" mesh="second" quat="0 1 1 0"/><geom type="mesh" mesh="inline" pos="0 0 9"/></body>',
    '<default><mesh scale="0.5 2 -0.25"/></default>',
    '<asset><mesh file="a.stl" refpos="0.1 0.2 0.3" refquat="0.9 0.1 0.2 0.3"/>'
    '<mesh name="second" file="a.stl" scale="1 1 1"/>'
    '<mesh name="inline" vertex="0 0 0 1 0 0 0 1 0 0.1 0.2 1"/></asset>',
)


def test_meshes_are_where_mujoco_has_them_to_its_single_precision(tmp_path):
    (body,) = load_mjcf(tmp_path, MESHES).bodies
    model = mujoco.MjModel.from_xml_path(str(tmp_path / "toy.xml"))
    theirs = []
    for i in range(model.ngeom):
        start, mesh = model.mesh_vertadr[model.geom_dataid[i]], model.geom_dataid[i]
        points = model.mesh_vert[start : start + model.mesh_vertnum[mesh]].astype(float)
        turn = np.empty(9)
        mujoco.mju_quat2Mat(turn, model.geom_quat[i])
        theirs.append(points @ turn.reshape(3, 3).T + model.geom_pos[i])
    apart = np.linalg.norm(body.shape.vertices[:, None] - np.concatenate(theirs)[None], axis=2)
    assert len(body.shape.vertices) == 12
    assert apart.min(axis=1).max() < 1e-6 and apart.min(axis=0).max() < 1e-6
    assert body.shape.closed and body.shape.volume > 0


PAIRS = mjcf(
    '<body name="a" pos="0.1 0.2 0.3" euler="10 20 30"><joint/><geom {}/></body>'
    '<body name="b" pos="1.5 1.2 0.9" euler="50 10 0"><joint/><geom {}/></body>'
)
BOX = 'type="box" size="0.1 0.2 0.3"'
ROUND = (
    'type="sphere" size="0.2"', 'type="capsule" size="0.1 0.4"', 'type="cylinder" size="0.2 0.3"',
    'type="capsule" fromto="0 0 0 0.3 0.2 0.1" size="0.1"',
)  # fmt: skip


@pytest.mark.parametrize(
    ("first", "second"),
    [(BOX, BOX), *((BOX, one) for one in ROUND), (ROUND[0], ROUND[1]), (ROUND[1], ROUND[3])],
)
def test_distances_are_mujocos_within_the_facets(tmp_path, first, second):
    robot = load_mjcf(tmp_path, PAIRS.format(first, second))
    model = mujoco.MjModel.from_xml_path(str(tmp_path / "toy.xml"))
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    exact = mujoco.mj_geomDistance(model, data, 0, 1, 10.0, None)
    a, b = (robot.bodies[i].shape.transformed(pose) for i, pose in enumerate(
        link_poses(PlacedRobot(robot), np.zeros((1, 2)))[0][1:]))  # fmt: skip
    ours = distance(a, b).distance
    assert ours <= exact + 1e-6 and ours >= exact - a.excess - b.excess - 1e-6
