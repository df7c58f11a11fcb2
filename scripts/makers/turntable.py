"""Scene `turntable_cell`: an arm on a linear axis looks at two towers that turn past it on a turntable.

Axis, turntable and arm have tables of their own, with sample times of their own. Metres, radians, seconds.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from scripts.makers.paths import Arm, JointTable, Table, ToolPose, stock
from scripts.makers.program import Program, ease, placed

JOINTS = tuple(f"lbr_iiwa_joint_{i}" for i in range(1, 8))
HOME = (1.57, 0.1, 0.0, -1.9, 0.0, 1.14, 0.0)
END = 9.0

CARRIAGE_TOP, PLATE_TOP = 0.19, 0.5
TABLE = np.array([0.0, 0.70, PLATE_TOP])
TOWERS = (-0.2, -1.92)
"""Where on the plate they stand: angles at a radius of `RADIUS`."""
RADIUS, HEIGHT = 0.24, 0.2

DOWN = (np.pi, 0.0, -np.pi / 2)


def tables() -> dict[str, Table]:
    """All tables of the scene."""
    return {
        "axis.csv": _of(("travel",), travel, 0.05),
        "turntable.csv": _of(("turn",), turn, 0.08),
        "arm.csv": JointTable(JOINTS, arm().positions[:, :-1], 0.03),
    }


def travel(t: float) -> float:
    """Where the carriage is: along with the first tower, back, and along with the second."""
    forth, back, again = ease((t - 0.2) / 4.0), ease((t - 3.6) / 2.0), ease((t - 5.4) / 3.4)
    return -0.25 + 0.40 * float(forth) - 0.35 * float(back) + 0.45 * float(again)


def turn(t: float) -> float:
    """How far the plate has turned, at rest at both ends."""
    return -2.5 + 1.9 * float(ease(t / 4.6)) + 1.9 * float(ease((t - 4.8) / 4.0))


def arm() -> Program:
    """Over the first tower, with it, over to the second, with that, and home."""
    tool = Arm(stock("kuka_iiwa/model.urdf"), JOINTS, "lbr_iiwa_link_7")
    program = Program(tool, placed(0.0, 0.0, CARRIAGE_TOP), HOME, 0.0, 0.03)
    looks = [(1.5, 0, 0.14), (2.1, 0, 0.075), (2.7, 0, 0.07), (3.3, 0, 0.075), (3.9, 0, 0.14)]
    looks += [(5.4, 1, 0.14), (6.0, 1, 0.075), (6.6, 1, 0.065), (7.2, 1, 0.07), (7.8, 1, 0.14)]
    targets = [over(TOWERS[which], t, away) for t, which, away in looks]
    program.follow([t for t, _, _ in looks], targets)
    program.move(END, HOME)
    return program


def over(tower: float, t: float, away: float) -> ToolPose:
    """The flange looking down at a tower's top at a time, as the carriage sees the world."""
    angle = tower + turn(t)
    top = TABLE + [RADIUS * np.cos(angle), RADIUS * np.sin(angle), HEIGHT]
    place = top + [-travel(t), 0.0, away]
    return ToolPose(tuple(place), DOWN)


def _of(joints: tuple[str, ...], law: Callable[[float], float], step: float) -> JointTable:
    times = np.arange(0.0, END + 1e-9, step)
    return JointTable(joints, np.array([[law(t)] for t in times]), step)
