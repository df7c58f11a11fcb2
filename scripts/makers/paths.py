"""Smooth joint paths: tool poses to joint waypoints (inverse kinematics), waypoints to a CSV of samples.

Waypoints are rounded to 1e-4 and samples to 1e-6 [rad or m], far above what differs between machines, so
that the files are the same bytes everywhere. Not for: collision checks; those are what the scenes are for.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import yourdfpy
from scipy.interpolate import CubicSpline
from scipy.optimize import least_squares
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
        limits = [self._model.joint_map[name].limit for name in joints]
        self._bounds = np.array([[limit.lower, limit.upper] for limit in limits]).T

    def tip_pose(self, positions: np.ndarray) -> np.ndarray:
        """(4, 4) base_from_tip [m] at the given (k,) joint positions."""
        rest = dict.fromkeys(self._model.actuated_joint_names, 0.0)
        self._model.update_cfg(rest | dict(zip(self.joints, positions, strict=True)))
        return self._model.get_transform(self.tip)

    def positions(self, target: ToolPose, start: np.ndarray) -> np.ndarray:
        """(k,) joint positions, inside the limits and near `start`, that put the tip at `target`.

        Raises:
            ValueError: no such positions within 0.1 mm and 0.1 mrad.
        """
        rotation = Rotation.from_euler("xyz", target.rpy)

        def misfit(positions: np.ndarray, pull: float) -> np.ndarray:
            pose = self.tip_pose(positions)
            turn = (rotation.inv() * Rotation.from_matrix(pose[:3, :3])).as_rotvec()
            return np.concatenate([pose[:3, 3] - target.xyz, 0.3 * turn, pull * (positions - start)])

        found = np.clip(start, self._bounds[0] + 1e-6, self._bounds[1] - 1e-6)
        for pull in (1e-2, 1e-4):
            found = least_squares(misfit, found, bounds=self._bounds, args=(pull,), xtol=1e-13).x
        found = np.round(found, 4)
        error = np.abs(misfit(found, 0.0)[:6]).max()
        if error > 3e-4:
            raise ValueError(f"{target} is out of reach of {self.tip}: off by {error:.4g}")
        return found


def solved(arm: Arm, start: Sequence[float], targets: Sequence[ToolPose | Sequence[float]]) -> np.ndarray:
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


def write_trajectory(path: Path, joints: Sequence[str], positions: np.ndarray, step: float) -> None:
    """Writes `time` [s] and one column a joint, six decimals."""
    lines = [",".join(["time", *joints])]
    for i, row in enumerate(positions):
        lines.append(",".join([f"{i * step:.3f}", *(f"{value + 0.0:.6f}" for value in np.round(row, 6) + 0.0)]))
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text("\n".join(lines) + "\n", encoding="utf-8")
