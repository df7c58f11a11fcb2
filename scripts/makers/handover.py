"""Scene `dual_arm_handover`: a bar goes from a fixture to a left hand, a right hand, a tray that drives on.

The bar is square and lies along y all the time; the left hand has it about one end and the right about the other,
on the other pair of its faces. Metres, radians, seconds.
"""

from __future__ import annotations

import numpy as np
from scipy.spatial.transform import Rotation

from scripts.makers.paths import Arm, JointTable, PoseTable, Table, ToolPose, stock
from scripts.makers.program import Program, ease, placed

JOINTS = tuple(f"panda_joint{i}" for i in range(1, 8))
HOME = (0.0, -0.785, 0.0, -2.356, 0.0, 1.571, -0.785)
STEP = 0.04
OPEN, SHUT = 0.035, 0.0101
"""Shut fingers are 0.1 mm from the bar, which is 20 mm thick."""

LEFT, RIGHT = placed(-0.55, 0.0, 0.0), placed(0.55, 0.0, 0.0, np.pi)
FIXTURE = np.array([-0.10, 0.28, 0.09])
MEETING = np.array([0.0, 0.0, 0.42])
TRAY = np.array([0.12, -0.40, 0.145])
"""Where the middle of the bar is."""

HOLD = {"left": np.array([0.0, 0.06, 0.0]), "right": np.array([0.0, -0.06, 0.0])}
"""From the middle of the bar to where a hand has it."""

TILT = np.pi / 4


def tables() -> dict[str, Table]:
    """All tables of the scene."""
    return {
        "left.csv": JointTable((*JOINTS, "panda_finger_joint1"), left().positions, STEP),
        "right.csv": JointTable((*JOINTS, "panda_finger_joint1"), right().positions, STEP),
        "tray.csv": tray(),
    }


def left() -> Program:
    """Takes the bar up, holds it in the middle until the right hand has it, goes home."""
    program = Program(_arm(), LEFT, HOME, OPEN, STEP)
    down, tilted = _Hand("left", 0.0), _Hand("left", TILT)
    program.move(1.6, down(FIXTURE, away=0.10))
    program.line(2.4, down(FIXTURE))
    program.grip(3.0, SHUT)
    program.line(3.8, down(FIXTURE, away=0.12))
    program.move(6.0, tilted(MEETING))
    program.wait(7.6)
    program.grip(8.2, OPEN)
    program.line(9.0, tilted(MEETING, away=0.12))
    program.move(11.0, HOME)
    return program


def right() -> Program:
    """Comes to the middle, takes the bar over, puts it on the tray, goes home."""
    program = Program(_arm(), RIGHT, HOME, OPEN, STEP)
    down, tilted = _Hand("right", 0.0), _Hand("right", TILT)
    program.wait(4.0)
    program.move(6.0, tilted(MEETING, away=0.12))
    program.line(6.8, tilted(MEETING))
    program.grip(7.4, SHUT)
    program.wait(8.8)
    program.move(11.0, down(TRAY, away=0.12))
    program.line(12.0, down(TRAY))
    program.grip(12.6, OPEN)
    program.line(13.4, down(TRAY, away=0.12))
    program.move(15.2, HOME)
    return program


def tray() -> PoseTable:
    """Drives in along x, stands while the bar is put down, drives on."""
    times = np.arange(0.0, 15.21, 0.16)
    x = TRAY[0] + 0.75 * (ease((times - 6.0) / 4.0) - 1.0 + ease((times - 13.2) / 2.0))
    places = np.column_stack([x, np.full_like(x, TRAY[1]), np.full_like(x, TRAY[2] - 0.0193)])
    return PoseTable(times, places, np.tile([0.0, 0.0, 0.0, 1.0], (len(x), 1)))


def _arm() -> Arm:
    return Arm(stock("franka_panda/panda.urdf"), JOINTS, "panda_grasptarget")


class _Hand:
    """Poses of a hand that has the bar, leaning towards the other arm by an angle, or is `away` from there."""

    def __init__(self, side: str, tilt: float) -> None:
        to = 1.0 if side == "left" else -1.0
        z = np.array([to * np.sin(tilt), 0.0, -np.cos(tilt)])
        y = np.array([to * np.cos(tilt), 0.0, np.sin(tilt)])
        self._turn = Rotation.from_matrix(np.column_stack([np.cross(y, z), y, z]))
        self._z, self._hold = z, HOLD[side]

    def __call__(self, bar: np.ndarray, away: float = 0.0) -> ToolPose:
        place = bar + self._hold - away * self._z
        return ToolPose(tuple(place), tuple(self._turn.as_euler("xyz")))
