"""Scene `door_and_arm`: an arm reaches through a hatch, whose door swings open and shut, over a line of parts.

Metres, radians, seconds.
"""

from __future__ import annotations

import numpy as np

from scripts.makers.paths import Arm, JointTable, PoseTable, Table, ToolPose, repository
from scripts.makers.program import Program, ease, placed

JOINTS = tuple(f"joint_{i}" for i in range(1, 7))
HOME = (-0.9, -0.75, 0.85, 0.0, -0.1, 0.0)
END = 12.0

HINGE = np.array([0.70, 0.32, 0.80])
WIDTH = 0.60
OPENED = np.radians(115.0)

APART = 0.8
"""From one part on the line to the next; it takes 2 s."""


def tables() -> dict[str, Table]:
    """All tables of the scene."""
    return {
        "arm.csv": JointTable(JOINTS, arm().positions[:, :-1], 0.04),
        "door.csv": door(),
        "parts.csv": parts(),
    }


def arm() -> Program:
    """Waits for the door, reaches through the hatch, dips between two parts, withdraws."""
    tool = Arm(repository() / "robots" / "heron6" / "heron6.urdf", JOINTS, "tool_tip")
    program = Program(tool, placed(0.0, 0.0, 0.0), HOME, 0.0, 0.04)
    level, dipped = (0.0, 0.15, 0.0), (0.0, 0.55, 0.0)
    program.wait(1.2)
    program.move(4.0, ToolPose((0.52, -0.08, 0.80), level), ToolPose((0.80, 0.0, 0.78), level))
    program.move(5.2, ToolPose((0.98, 0.0, 0.70), dipped))
    program.line(5.8, ToolPose((1.00, 0.0, 0.55), dipped))
    program.wait(6.4)
    program.line(7.0, ToolPose((0.98, 0.0, 0.70), dipped))
    program.move(8.2, ToolPose((0.78, 0.0, 0.78), level))
    program.move(10.4, ToolPose((0.52, -0.08, 0.80), level), HOME)
    return program


def door() -> PoseTable:
    """Of the middle of the door: about its hinge towards the arm, open, and shut again."""
    times = np.arange(0.0, END + 1e-9, 0.05)
    angles = OPENED * (ease((times - 0.2) / 2.4) - ease((times - 8.6) / 3.0))
    middle = (
        0.5 * WIDTH * np.column_stack([-np.sin(angles), -np.cos(angles), np.zeros_like(angles)])
    )
    turns = np.zeros((len(times), 4))
    turns[:, 2], turns[:, 3] = -np.sin(angles / 2.0), np.cos(angles / 2.0)
    return PoseTable(times, HINGE + middle, turns)


def parts() -> PoseTable:
    """Of a part that goes on by the distance between two, so that it ends where the next one began."""
    ends = np.array([[0.0, -0.5 * APART, 0.0], [0.0, 0.5 * APART, 0.0]])
    return PoseTable(np.array([0.0, 2.0]), ends, np.tile([0.0, 0.0, 0.0, 1.0], (2, 1)))
