"""Arms and moves for tests of programs: six and seven axes, one on a rail."""

from __future__ import annotations

from collections.abc import Sequence
from functools import lru_cache
from pathlib import Path

import numpy as np
import pybullet_data
from scipy.spatial.transform import Rotation

import clearance as cl
from clearance.programs.arm import Arm
from clearance.programs.motion import ProgramMotion, motion_of
from clearance.programs.moves import Move, Program
from tests.made_cases import at

ROBOTS = Path(__file__).parents[2] / "robots"
FILES = {
    "heron6": ROBOTS / "heron6" / "heron6.urdf",
    "panda": Path(pybullet_data.getDataPath()) / "franka_panda" / "panda.urdf",
    "iiwa": Path(pybullet_data.getDataPath()) / "kuka_iiwa" / "model.urdf",
}
START = (-0.5, 0.1, 0.4, 0.1, 1.1, 0.2)
"""Joints of heron6 [rad], far from singularities."""

TOOLS = {"iiwa": "lbr_iiwa_link_7", "heron6": "tool_tip", "panda": "panda_hand"}


@lru_cache
def arm(name: str) -> Arm:
    """An arm with a tool that is off its flange."""
    return Arm(cl.load_robot(FILES[name]), TOOLS[name], at(0.02, -0.01, 0.1))


def first_pose(name: str = "heron6", start: Sequence[float] = START) -> np.ndarray:
    """(4, 4) `root_from_tool` [m] at some joints."""
    return arm(name).poses(np.array([start]))[0]


def motion(
    moves: Sequence[Move],
    name: str = "heron6",
    start: Sequence[float] = START,
    robot: cl.Robot | None = None,
    **more,
) -> ProgramMotion:
    """The motion of moves from some joints.

    Args:
        robot: another one with the arm. more: of the program; of `start` the joints beside the arm.
    """
    one = arm(name)
    joints = {joint.name: float(value) for joint, value in zip(one.joints, start, strict=True)}
    joints |= more.pop("beside", {})
    program = Program(one.link, one.link_from_tool, tuple(moves), joints, **more)
    return motion_of(robot or one.robot, program)


def shifted(pose: np.ndarray, way=(0.0, 0.0, 0.0), by=(0.0, 0.0, 0.0)) -> np.ndarray:
    """(4, 4) a pose that is moved, and turned where it is."""
    found = pose.copy()
    found[:3, 3] += way
    found[:3, :3] = turned(by) @ pose[:3, :3]
    return found


def posture(one: Arm, draw: np.random.Generator) -> np.ndarray:
    """(k,) joints within the middle of their ranges, far from singularities."""
    low, high = np.clip(one.chain.ranges, -2.0, 2.0).T
    while True:
        found = low + (high - low) * draw.uniform(0.25, 0.75, len(low))
        _, rates = one.tool.poses_and_rates(found[None])
        if np.linalg.svd(rates[0], compute_uv=False)[-1] > 0.12:
            return np.asarray(found)


def turned(vector: np.ndarray) -> np.ndarray:
    """(3, 3) the rotation by a vector [rad]."""
    return np.asarray(Rotation.from_rotvec(vector).as_matrix())
