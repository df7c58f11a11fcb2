"""Motion as a physics engine's controlled robot really makes it: the adapter of pybullet.

The robot's masses, inertias, joints, damping, limits and efforts come from its URDF, its shapes from
our own loader. Gravity is on, every moving joint is position-controlled towards the trajectory, and
each simulation step's state is stored. Not for: clearance (`measure`), computed from those states by
our own kinematics; what is suspect about the motion (`course`).
"""

from __future__ import annotations

import ctypes
import os
import sys
import tempfile
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np

from clearance.errors import NotFinite, NotSimulated
from clearance.extras import importing
from clearance.simulate.physics.course import HULLS, Pushes, notices_on_course
from clearance.simulate.physics.model import (
    notes_on_masses,
    notices_on_model,
    write_obj,
    write_physics_urdf,
)
from clearance.world.body import Obstacle
from clearance.world.cubic import positions_along
from clearance.world.joint_speeds import motion_limit
from clearance.world.kinematics import moving_positions
from clearance.world.mimics import followers
from clearance.world.motion import Motion
from clearance.world.placed_robot import PlacedRobot

STEPS_PER_SECOND = 240
SUBSTEPS = 16
"""Solver steps inside each step: the engine integrates joint damping explicitly; at 240 Hz alone a
Fetch's wrist (5 N m s/rad) diverges: tracking error 2.2 rad; 0.007 with 4, 0.005 with 16. They are
our own loop: with the engine's `numSubSteps` a motor pushes 16 times as hard as it may."""
SETTLE_TIME = 0.25  # [s] recorded at least after the trajectory's end: the robot arrives late
LONGEST_SETTLING = 10.0  # [s] after which a robot that has not arrived does not
ARRIVED = 1e-3  # [rad or m] from the last sample; ten times as much a second is rest
GRAVITY = (0.0, 0.0, -9.81)  # [m/s^2]
_UNLIMITED = 1e6  # [N] or [N m] where the URDF states no effort


def simulated_motion(
    placed: PlacedRobot,
    obstacles: Sequence[Obstacle] = (),
    contact_response: bool = False,
    settle_time: float = SETTLE_TIME,
    gravity_at: Callable[[np.ndarray], np.ndarray] | None = None,
) -> Motion:
    """The motion of the position-controlled robot at 240 Hz, starting at rest at the first sample.

    The states are those after each simulation step, the first one included. They go on for
    `settle_time` after the last sample and, unless that is 0, until the robot has arrived, for at most
    `LONGEST_SETTLING`. Asked positions between samples
    are linear, or on cubics where the trajectory has velocities. Where the trajectory is followed at
    another rate, the physics are those of the robot that is so fast; times are the trajectory's.

    Args:
        placed: its trajectory is what is asked; joints it does not name stay at their fixed
        value. obstacles: push back only if `contact_response`; then the links' shapes count as
        their convex
            hulls by the engine (obstacles stay as they are). The robot does not push itself.
        settle_time: [s] of the run at least after the last sample.
        gravity_at: (n, 3) [m/s^2] at (n,) times of the trajectory, as the base sees it; `GRAVITY` in
            the world if it is not given.

    Raises:
        BadInput: the engine cannot load the robot. NotFinite: the simulation diverged.
        Unavailable: pybullet cannot be imported.
    """
    n_least = len(_asked(placed, settle_time)[0])
    times, asked, rates = _asked(placed, LONGEST_SETTLING if settle_time else 0.0)
    with _world(placed, with_shapes=contact_response) as world:
        if contact_response:
            world.add(obstacles)
        world.start(asked[0])
        notes = (*notes_on_masses(placed), *world.notes_on_efforts())
        positions = np.empty_like(asked)
        positions[0] = asked[0]
        pulls = None if gravity_at is None else gravity_at(times)
        for i_step in range(1, len(times)):
            if pulls is not None:
                world.pull(pulls[i_step])
            positions[i_step] = world.step_towards(asked[i_step], rates[i_step])
            if i_step + 1 >= n_least and _has_arrived(positions[: i_step + 1], asked[i_step]):
                made = slice(i_step + 1)
                times, asked, positions = times[made], asked[made], positions[made]
                break
    _require_finite(times, positions)
    off = np.abs(positions - asked)
    notices = [*notices_on_model(placed), *world.pushes.notices(times)]
    notices += notices_on_course(placed, times, positions, off)
    if contact_response:
        notes = (*notes, HULLS)
    error = off.max(axis=1, initial=0.0)
    return Motion(placed, times, positions, error, notes, notices=tuple(notices))


def _has_arrived(positions: np.ndarray, asked: np.ndarray) -> bool:
    """True if every joint is where it is asked to be, and rests."""
    off = np.abs(positions[-1] - asked).max(initial=0.0)
    rate = np.abs(positions[-1] - positions[-2]).max(initial=0.0) * STEPS_PER_SECOND
    return bool(off <= ARRIVED and rate <= 10.0 * ARRIVED)


def _asked(placed: PlacedRobot, settle_time: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """(n,) times [s] of the trajectory, (n, k) positions and (n, k) rates asked for at each simulation step."""
    trajectory, rate = placed.given_trajectory, placed.timing.rate
    start, end = trajectory.times[0], trajectory.times[-1]
    n_steps = int(np.ceil(((end - start) / rate + settle_time) * STEPS_PER_SECOND - 1e-9)) + 1
    times = start + rate * (np.arange(n_steps) / STEPS_PER_SECOND)
    asked = moving_positions(placed, trajectory.joint_names, positions_along(trajectory, times))
    rates = np.diff(asked, axis=0, prepend=asked[:1]) * STEPS_PER_SECOND
    return times, asked, rates


def _require_finite(times: np.ndarray, positions: np.ndarray) -> None:
    bad = ~np.isfinite(positions).all(axis=1)
    if bad.any():
        raise NotFinite(
            f"the physics simulation diverged at {times[np.argmax(bad)]:g} s",
            valid="check the masses and inertias in the URDF, or use kinematic motion",
        )


class _World:
    """One robot on its base in one engine."""

    def __init__(self, engine: Any, body: int, placed: PlacedRobot, folder: Path) -> None:
        self._engine, self._body, self._folder = engine, body, folder
        joints = [engine.getJointInfo(body, i) for i in range(engine.getNumJoints(body))]
        index = {joint[1].decode(): joint[0] for joint in joints}
        moving = placed.robot.moving_joints
        self._indices = [index[joint.name] for joint in moving]
        efforts = [joints[i][10] for i in self._indices]
        self._without_effort = [
            joint.name for joint, effort in zip(moving, efforts, strict=True) if effort <= 0.0
        ]
        self._speeds = [motion_limit(placed, joint).velocity for joint in moving]
        root, names = placed.robot.link_names[0], {joint[0]: joint[12].decode() for joint in joints}
        self.pushes = Pushes({-1: root, **names})
        self._efforts = [effort if effort > 0.0 else _UNLIMITED for effort in efforts]
        columns = {joint.name: i for i, joint in enumerate(moving)}
        self._followers = [  # engine index, column of the master, factor and offset along all masters
            (index[joint.name], columns[master], factor, offset)
            for joint, master, factor, offset in followers(placed.robot)
            if joint.mimic is not None
        ]

    def notes_on_efforts(self) -> list[str]:
        """What was assumed about the joints' efforts."""
        if not self._without_effort:
            return []
        names = ", ".join(self._without_effort)
        return [
            f"simulated motion: the URDF limits no effort of {names}; they are taken as unlimited"
        ]

    def add(self, obstacles: Sequence[Obstacle]) -> None:
        """Puts the obstacles in as fixed bodies with all their concavities."""
        for i_obstacle, obstacle in enumerate(obstacles):
            if obstacle.body.is_cloud:
                raise NotSimulated(
                    f"obstacle {obstacle.name!r} is a cloud of points, which no simulated body can bump into",
                    where="contact_response",
                    valid="false, or kinematic motion; a cloud is measured all the same",
                )
            path = write_obj(obstacle.body.shape, self._folder / f"obstacle_{i_obstacle}.obj")
            shape = self._engine.createCollisionShape(
                self._engine.GEOM_MESH,
                fileName=str(path),
                flags=self._engine.GEOM_FORCE_CONCAVE_TRIMESH,
            )
            xyz, quat = _position_and_quaternion(obstacle.world_from_body)
            fixed = self._engine.createMultiBody(0.0, shape, basePosition=xyz, baseOrientation=quat)
            self.pushes.obstacles[fixed] = obstacle.name

    def start(self, positions: np.ndarray) -> None:
        """Puts the robot at rest at (k,) positions, under gravity, its motors ready."""
        engine = self._engine
        engine.setTimeStep(1.0 / (STEPS_PER_SECOND * SUBSTEPS))
        engine.setGravity(*GRAVITY)
        for i_link in range(-1, engine.getNumJoints(self._body)):  # no drag that no URDF asked for
            engine.changeDynamics(self._body, i_link, linearDamping=0.0, angularDamping=0.0)
        for i_joint in range(engine.getNumJoints(self._body)):
            engine.setJointMotorControl2(
                self._body, i_joint, controlMode=engine.VELOCITY_CONTROL, force=0.0
            )
        self._place(positions, np.zeros(len(positions)))

    def pull(self, gravity: np.ndarray) -> None:
        """Sets the gravity (3,) [m/s^2] of the steps to come."""
        self._engine.setGravity(*gravity.tolist())

    def step_towards(self, asked: np.ndarray, rates: np.ndarray) -> np.ndarray:
        """The (k,) positions after one simulation step with the motors set to what is asked."""
        for index, position, rate, effort, speed in zip(
            self._indices, asked, rates, self._efforts, self._speeds, strict=True
        ):
            limit = {"maxVelocity": speed} if np.isfinite(speed) else {}
            self._engine.setJointMotorControl2(
                self._body,
                index,
                controlMode=self._engine.POSITION_CONTROL,
                targetPosition=float(position),
                targetVelocity=float(rate),
                force=effort,
                **limit,
            )
        for _ in range(SUBSTEPS):
            self._engine.stepSimulation()
            if self.pushes.obstacles:
                self.pushes.add(self._engine.getContactPoints(bodyA=self._body))
        self.pushes.n_steps += 1
        states = self._engine.getJointStates(self._body, self._indices) if self._indices else ()
        positions = np.array([state[0] for state in states])
        self._place_followers(positions, np.array([state[1] for state in states]))
        return positions

    def _place(self, positions: np.ndarray, rates: np.ndarray) -> None:
        for index, position, rate in zip(self._indices, positions, rates, strict=True):
            self._engine.resetJointState(self._body, index, float(position), float(rate))
        self._place_followers(positions, rates)

    def _place_followers(self, positions: np.ndarray, rates: np.ndarray) -> None:
        for index, column, factor, offset in self._followers:
            position, rate = factor * positions[column] + offset, factor * rates[column]
            self._engine.resetJointState(self._body, index, float(position), float(rate))


@contextmanager
def _world(placed: PlacedRobot, with_shapes: bool) -> Iterator[_World]:
    with tempfile.TemporaryDirectory(prefix="clearance_physics_") as temporary:
        folder = Path(temporary)
        urdf = write_physics_urdf(placed, folder, with_shapes)
        with _silence():
            engine = _connect()
        try:
            with _silence():
                body = _load(engine, urdf, placed)
            yield _World(engine, body, placed, folder)
        finally:
            engine.disconnect()


def _load(engine: Any, urdf: Path, placed: PlacedRobot) -> int:
    xyz, quat = _position_and_quaternion(placed.world_from_base)
    try:
        return engine.loadURDF(
            str(urdf),
            basePosition=xyz,
            baseOrientation=quat,
            useFixedBase=True,
            flags=engine.URDF_USE_INERTIA_FROM_FILE,  # else made of the shapes, which are not there
        )
    except engine.error as error:
        raise NotSimulated(
            f"the physics engine cannot load the robot {placed.robot.name!r} ({error})",
            where=placed.urdf_path,
            valid="use kinematic motion",
        ) from None


def _connect() -> Any:
    with importing("simulate", "simulated motion"):
        import pybullet
        from pybullet_utils.bullet_client import BulletClient
    return BulletClient(connection_mode=pybullet.DIRECT)


@contextmanager
def _silence() -> Iterator[None]:
    """Keeps what the engine's C code prints off stdout and stderr; Python's own output is flushed
    first.
    """
    flush = ctypes.CDLL(None).fflush if os.name == "posix" else (lambda _: 0)
    for stream in (sys.stdout, sys.stderr):
        stream.flush()
    flush(None)
    saved = os.dup(1), os.dup(2)
    with open(os.devnull, "wb") as nowhere:
        os.dup2(nowhere.fileno(), 1)
        os.dup2(nowhere.fileno(), 2)
    try:
        yield
    finally:
        flush(None)
        for copy, target in zip(saved, (1, 2), strict=True):
            os.dup2(copy, target)
            os.close(copy)


def _position_and_quaternion(pose: np.ndarray) -> tuple[list[float], list[float]]:
    from scipy.spatial.transform import Rotation

    return pose[:3, 3].tolist(), Rotation.from_matrix(pose[:3, :3]).as_quat().tolist()
