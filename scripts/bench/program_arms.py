"""Arms for the benchmark of robot programs, and forward and inverse kinematics of their own in long doubles.

They read the URDF again and share no code with the package. Not for: paths (`program_paths`).
"""

from __future__ import annotations

import sys
import xml.etree.ElementTree as ElementTree
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import NamedTuple

import numpy as np
import pybullet_data
from harness import ROOT, SHARED

LONG = np.longdouble

PYBULLET = Path(pybullet_data.getDataPath())
UR5 = "cmeel.prefix/share/example-robot-data/robots/ur_description/urdf/ur5_robot.urdf"


class ArmFile(NamedTuple):
    """An arm: its file, the link that holds the tool, and a posture far from singularities [rad, m]."""

    path: Path
    link: str
    posture: tuple[float, ...]


def arm_files(names: Sequence[str] = ()) -> dict[str, ArmFile]:
    """Those of some names, or all, that are on this machine: three of six axes, two of seven, one of those on a
    slide."""
    example = next((Path(p) / UR5 for p in sys.path if (Path(p) / UR5).is_file()), Path("none"))
    bent = (0.2, 0.5, -0.3, -1.4, 0.3, 1.0, 0.4)
    every = {
        "heron6": ArmFile(
            ROOT / "robots/heron6/heron6.urdf", "tool_tip", (-0.5, 0.1, 0.4, 0.1, 1.1, 0.2)
        ),
        "xarm6": ArmFile(PYBULLET / "xarm/xarm6_robot.urdf", "link6", (0.2, -0.4, -0.9, 0.3, 1.1, 0.2)),
        "ur5": ArmFile(example, "wrist_3_link", (0.2, -1.2, 1.5, -1.7, -1.4, 0.3)),
        "iiwa": ArmFile(PYBULLET / "kuka_iiwa/model.urdf", "lbr_iiwa_link_7", bent),
        "panda": ArmFile(
            PYBULLET / "franka_panda/panda.urdf", "panda_hand", (0.2, 0.3, -0.3, -1.8, 0.3, 2.0, 0.6)
        ),
        "fetch": ArmFile(
            SHARED / "robots/fetch_vamp/fetch.urdf", "wrist_roll_link",
            (0.2, 0.3, 0.4, 0.5, 1.2, 0.3, 1.0, 0.2),
        ),
    }  # fmt: skip
    chosen = names or every
    return {name: every[name] for name in chosen if every[name].path.is_file()}


@dataclass(frozen=True, eq=False)
class OwnJoint:
    """A moving joint: the fixed frame before it (4, 4), its axis (3,), whether it turns."""

    name: str
    before: np.ndarray
    axis: np.ndarray
    turns: bool


@dataclass(frozen=True, eq=False)
class OwnArm:
    """The joints from a robot's root to its tool, in long doubles.

    Attributes:
        end: (4, 4) the tool in the frame of the last joint [m].
    """

    joints: tuple[OwnJoint, ...]
    end: np.ndarray

    @classmethod
    def read(cls, path: Path, link: str, tool: np.ndarray) -> OwnArm:
        """That of a URDF, with a tool (4, 4) on a link."""
        above = {
            one.find("child").get("link"): one
            for one in ElementTree.parse(path).getroot().findall("joint")
        }
        chain = []
        while link in above:
            chain.append(above[link])
            link = above[link].find("parent").get("link")
        joints, before = [], np.eye(4, dtype=LONG)
        for one in reversed(chain):
            before = before @ _origin(one.find("origin"))
            if one.get("type") != "fixed":
                axis = one.find("axis")
                along = _numbers("1 0 0" if axis is None else axis.get("xyz"))
                turns = one.get("type") != "prismatic"
                joints.append(OwnJoint(one.get("name"), before, along / _size(along), turns))
                before = np.eye(4, dtype=LONG)
        return cls(tuple(joints), before @ tool)

    def poses(self, positions: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """(n, 3, 3) rotation and (n, 3) origin [m] of the tool at positions (n, k)."""
        turn = np.tile(np.eye(3, dtype=LONG), (len(positions), 1, 1))
        origin = np.zeros((len(positions), 3), dtype=LONG)
        for i, joint in enumerate(self.joints):
            origin = origin + turn @ joint.before[:3, 3]
            turn = turn @ joint.before[:3, :3]
            if joint.turns:
                turn = turn @ turned(joint.axis * positions[:, i, None])
            else:
                origin = origin + (turn @ joint.axis) * positions[:, i, None]
        return turn @ self.end[:3, :3], origin + turn @ self.end[:3, 3]

    def rates(self, positions: np.ndarray) -> np.ndarray:
        """(n, 6, k) central differences of the pose: right to some 1e-12, which Newton's steps may be."""
        step, columns = LONG(1e-6), []
        turn, _ = self.poses(positions)
        for i in range(len(self.joints)):
            moved = step * np.eye(len(self.joints), dtype=LONG)[i]
            (turn_b, at_b), (turn_a, at_a) = (
                self.poses(positions + moved),
                self.poses(positions - moved),
            )
            spin = (turn_b - turn_a) @ np.swapaxes(turn, 1, 2)
            columns.append(np.hstack([at_b - at_a, _skew_part(spin)]) / (2 * step))
        return np.stack(columns, axis=2).astype(float)

    def solved(self, wanted: Poses, near: np.ndarray) -> np.ndarray:
        """(m, n, k) the joints that hold the tool at poses (m, n), found from joints near them.

        The Jacobian is that in the middle of each n. What it leaves free stays as in `near`.
        """
        m, n, k = near.shape
        inverse = np.linalg.pinv(self.rates(near[:, n // 2])).astype(LONG)
        found = near.astype(LONG)
        for _ in range(12):
            turn, origin = self.poses(found.reshape(-1, k))
            off = np.hstack(
                [
                    wanted.origin.reshape(-1, 3) - origin,
                    _skew_part(wanted.turn.reshape(-1, 3, 3) @ np.swapaxes(turn, 1, 2)),
                ]
            )
            found = found + np.einsum("mki,mni->mnk", inverse, off.reshape(m, n, 6))
            if np.abs(off).max() < 1e-12:  # what this step leaves is a hundredth
                return found
        raise ArithmeticError(f"the oracle's joints are off by {np.abs(off).max():.1e}")


class Poses(NamedTuple):
    """Rotations (..., 3, 3) and origins (..., 3) [m]."""

    turn: np.ndarray
    origin: np.ndarray


def turned(vectors: np.ndarray) -> np.ndarray:
    """(n, 3, 3) the rotations by vectors (n, 3) [rad], by Rodrigues."""
    vectors = np.asarray(vectors, dtype=LONG)
    angle = np.sqrt((vectors**2).sum(axis=1))[:, None, None]
    axis = vectors / np.where(angle[:, 0] == 0, LONG(1), angle[:, 0])
    cross = np.zeros((len(vectors), 3, 3), dtype=LONG)
    for i, j, column, sign in ((0, 1, 2, -1), (0, 2, 1, 1), (1, 2, 0, -1)):
        cross[:, i, j], cross[:, j, i] = sign * axis[:, column], -sign * axis[:, column]
    versine = 2 * np.sin(angle / 2) ** 2
    return np.eye(3, dtype=LONG) + np.sin(angle) * cross + versine * (cross @ cross)


def _skew_part(matrices: np.ndarray) -> np.ndarray:
    """(n, 3) half the skew parts."""
    pairs = [((k + 2) % 3, (k + 1) % 3) for k in range(3)]
    return np.stack([matrices[:, i, j] - matrices[:, j, i] for i, j in pairs], axis=1) / 2


def _numbers(text: str | None) -> np.ndarray:
    return np.array([LONG(float(one)) for one in (text or "0 0 0").split()])


def _size(vector: np.ndarray) -> np.longdouble:
    return np.sqrt((np.asarray(vector, dtype=LONG) ** 2).sum())


def _origin(element: ElementTree.Element | None) -> np.ndarray:
    pose = np.eye(4, dtype=LONG)
    if element is not None:
        roll, pitch, yaw = np.eye(3, dtype=LONG) * _numbers(element.get("rpy"))[:, None]
        pose[:3, :3] = turned(yaw[None])[0] @ turned(pitch[None])[0] @ turned(roll[None])[0]
        pose[:3, 3] = _numbers(element.get("xyz"))
    return pose
