"""Smooth joint paths: tool poses to joint waypoints (inverse kinematics), waypoints to a CSV of samples.

Waypoints are rounded to 1e-4 and samples to 1e-6 [rad or m], far above what differs between machines, so
that the files are the same bytes everywhere. Not for: collision checks; those are what the scenes are for.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pybullet_data
import yourdfpy
from scipy.interpolate import CubicSpline
from scipy.spatial.transform import Rotation


@dataclass(frozen=True)
class ToolPose:
    """Where the tool frame shall be: position [m] and roll, pitch, yaw [rad] in the base frame."""

    xyz: tuple[float, float, float]
    rpy: tuple[float, float, float] = (0.0, 0.0, 0.0)


class Arm:
    """A serial arm of a URDF file, solved for poses of one of its links.

    Args:
        urdf: the file; meshes are not read.
        joints: the joints to move, in the order of the path's columns.
        tip: the link whose pose is asked for.
    """

    def __init__(self, urdf: Path, joints: Sequence[str], tip: str) -> None:
        self.joints, self.tip = tuple(joints), tip
        self._model = yourdfpy.URDF.load(str(urdf), load_meshes=False, build_scene_graph=True)
        self._specs = [self._model.joint_map[name] for name in joints]
        self._bounds = np.array([[spec.limit.lower, spec.limit.upper] for spec in self._specs]).T

    def tip_pose(self, positions: np.ndarray) -> np.ndarray:
        """(4, 4) base_from_tip [m] at the given (k,) joint positions."""
        rest = dict.fromkeys(self._model.actuated_joint_names, 0.0)
        self._model.update_cfg(rest | dict(zip(self.joints, positions, strict=True)))
        return self._model.get_transform(self.tip)

    def positions(self, target: ToolPose, start: np.ndarray) -> np.ndarray:
        """(k,) joint positions, inside the limits, that put the tip at `target`.

        Levenberg's iteration, damped in proportion to the error, at most 0.2 rad at a time. It
        ends within 1e-7 (the model ignores smaller changes), far below the 1e-4 it is rounded to, so that
        library versions do not show in the result.

        Raises:
            ValueError: no such positions were found.
        """
        found = np.clip(start, *self._bounds)
        for _ in range(100):
            error = self._error(target, self.tip_pose(found))
            if np.abs(error).max() < 1e-8:
                break
            jacobian, damping = self._jacobian(), 1e-2 * np.abs(error).max()
            step = jacobian.T @ np.linalg.solve(jacobian @ jacobian.T + damping * np.eye(6), error)
            found = np.clip(found + step * min(1.0, 0.2 / np.abs(step).max()), *self._bounds)
        if np.abs(error).max() > 1e-7:
            raise ValueError(
                f"{target} is out of reach of {self.tip}: off by {np.abs(error).max():.4g}"
            )
        return np.round(found, 4)

    def _error(self, target: ToolPose, pose: np.ndarray) -> np.ndarray:
        """(6,) from the pose to the target in the base frame: translation [m], rotation vector [rad]."""
        turn = Rotation.from_euler("xyz", target.rpy) * Rotation.from_matrix(pose[:3, :3]).inv()
        return np.concatenate([target.xyz - pose[:3, 3], turn.as_rotvec()])

    def _jacobian(self) -> np.ndarray:
        """(6, k) velocity of the tip a unit of joint speed, all joints turning, at the last `tip_pose`."""
        tip = self._model.get_transform(self.tip)[:3, 3]
        columns = []
        for spec in self._specs:
            frame = self._model.get_transform(spec.child)
            axis = frame[:3, :3] @ spec.axis
            columns.append(np.concatenate([np.cross(axis, tip - frame[:3, 3]), axis]))
        return np.array(columns).T


def solved(
    arm: Arm, start: Sequence[float], targets: Sequence[ToolPose | Sequence[float]]
) -> np.ndarray:
    """(n, k) joint waypoints: tool poses are solved one after another, joint positions are kept."""
    rows = [np.asarray(start, dtype=np.float64)]
    for target in targets:
        found = arm.positions(target, rows[-1]) if isinstance(target, ToolPose) else target
        rows.append(np.asarray(found, dtype=np.float64))
    return np.array(rows)


def smooth(waypoints: np.ndarray, n_steps: int) -> np.ndarray:
    """(n_steps, k) samples through all waypoints, at rest at both ends.

    A cubic spline over the distance between waypoints, run through with the minimum-jerk profile
    10 s^3 - 15 s^4 + 6 s^5 (Flash and Hogan 1985): position, speed and acceleration are continuous.
    """
    gaps = np.linalg.norm(np.diff(waypoints, axis=0), axis=1)
    knots = np.concatenate([[0.0], np.cumsum(np.sqrt(gaps))])
    s = np.linspace(0.0, 1.0, n_steps)
    profile = s**3 * (10.0 - 15.0 * s + 6.0 * s**2)
    return CubicSpline(knots / knots[-1], waypoints, bc_type="natural")(profile)


@dataclass(frozen=True, eq=False)
class JointTable:
    """Joint names, (n, k) positions and the time between samples [s]."""

    joints: tuple[str, ...]
    positions: np.ndarray
    step: float = 0.01

    def lines(self) -> list[str]:
        """`time` [s] and one column a joint, six decimals."""
        times = self.step * np.arange(len(self.positions))
        return _lines(["time", *self.joints], times, self.positions)


@dataclass(frozen=True, eq=False)
class PoseTable:
    """(n,) times [s], (n, 3) places [m] and (n, 4) quaternions x, y, z, w."""

    times: np.ndarray
    places: np.ndarray
    quaternions: np.ndarray

    def lines(self) -> list[str]:
        """`time` and the pose; six decimals, nine of the quaternion so that its length is 1."""
        header = ["time", "x", "y", "z", "qx", "qy", "qz", "qw"]
        turns = (",".join(_decimals(row, 9)) for row in self.quaternions)
        first, *rows = _lines(header, self.times, self.places)
        return [first, *(f"{row},{turn}" for row, turn in zip(rows, turns, strict=True))]


Table = JointTable | PoseTable


def write_table(path: Path, table: Table) -> None:
    """Writes a table's lines."""
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text("\n".join(table.lines()) + "\n", encoding="utf-8")


def stock(path: str) -> Path:
    """A file that pybullet_data brings."""
    return Path(pybullet_data.getDataPath()) / path


def repository() -> Path:
    """The folder that holds `robots` and `scenes`."""
    return Path(__file__).parents[2]


def _lines(header: Sequence[str], times: np.ndarray, rows: np.ndarray) -> list[str]:
    pairs = zip(times, rows, strict=True)
    return [",".join(header), *(",".join([f"{t:.3f}", *_decimals(row, 6)]) for t, row in pairs)]


def _decimals(row: Iterable[float], n: int) -> list[str]:
    """Numbers with `n` decimals, none of them -0."""
    return [f"{value:.{n}f}" for value in np.round(np.asarray(row), n) + 0.0]
