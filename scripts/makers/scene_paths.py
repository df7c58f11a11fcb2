"""The motion of each scene: waypoints as an engineer would teach them. Metres and radians."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from scripts.makers import door, handover, palletising, turntable, welding
from scripts.makers.paths import (
    Arm,
    JointTable,
    Table,
    ToolPose,
    repository,
    smooth,
    solved,
    stock,
)

GANTRY = ("slide_x", "slide_y", "slide_z", "yaw", "pitch", "roll")
HERON = tuple(f"joint_{i}" for i in range(1, 7))
IIWA = tuple(f"lbr_iiwa_joint_{i}" for i in range(1, 8))
PANDA = tuple(f"panda_joint{i}" for i in range(1, 8))
FORWARD = (0.0, np.pi / 2, 0.0)
"""Roll, pitch, yaw of a tool whose z axis points along x of the base."""
UPRIGHT = (np.pi, -np.pi / 2, 0.0)
"""The same, turned about its z axis so that its x axis points up."""


def box_box() -> JointTable:
    """The box tumbles round the fixed one: faces, edges and corners take turns at being nearest."""
    waypoints = [
        (-0.80, 0.34, 0.45, 0.0, 0.0, 0.0),
        (-0.35, 0.37, 0.50, 0.5, 0.2, 0.3),
        (0.00, 0.365, 0.66, 1.1, 0.4, 0.8),
        (0.34, 0.17, 0.76, 1.7, 0.5, 1.4),
        (0.20, -0.10, 0.85, 2.2, 0.1, 1.9),
        (-0.15, -0.33, 0.66, 2.6, -0.3, 2.2),
        (-0.60, -0.45, 0.45, 3.0, 0.0, 2.6),
    ]
    return JointTable(GANTRY, smooth(np.array(waypoints), 301), 0.02)


def box_pipe() -> JointTable:
    """The box goes through the bore, turning and swaying, round the end, and back along the outside."""
    waypoints = [
        (-0.90, 0.00, 0.50, 0.0, 0.0, 0.0),
        (-0.50, 0.02, 0.50, 0.0, 0.0, 0.3),
        (-0.15, 0.07, 0.52, 0.1, 0.0, 0.9),
        (0.15, 0.03, 0.46, 0.0, 0.15, 1.5),
        (0.55, 0.00, 0.50, -0.2, 0.0, 1.9),
        (0.78, 0.14, 0.55, 0.6, 0.1, 2.2),
        (0.50, 0.335, 0.62, 1.3, 0.2, 2.4),
        (0.00, 0.32, 0.58, 2.0, 0.1, 2.6),
        (-0.60, 0.42, 0.50, 2.6, 0.0, 3.0),
    ]
    return JointTable(GANTRY, smooth(np.array(waypoints), 361), 0.02)


def iiwa_pipe_rack() -> JointTable:
    """In between two risers to look at the pipes behind, out, and in again through the next, lower gap."""
    arm = Arm(stock("kuka_iiwa/model.urdf"), IIWA, "lbr_iiwa_link_7")
    home = (0.0, 0.2, 0.0, -1.9, 0.0, 0.53, 0.0)
    targets = [
        ToolPose((0.52, -0.14, 0.55), FORWARD),
        ToolPose((0.66, -0.14, 0.55), FORWARD),
        ToolPose((0.82, -0.155, 0.50), (0.0, 1.57, -0.18)),
        ToolPose((0.64, -0.13, 0.53), FORWARD),
        ToolPose((0.52, 0.04, 0.45), FORWARD),
        ToolPose((0.51, 0.20, 0.38), FORWARD),
        ToolPose((0.60, 0.21, 0.34), FORWARD),
        ToolPose((0.72, 0.209, 0.34), FORWARD),
        ToolPose((0.58, 0.20, 0.36), FORWARD),
        ToolPose((0.52, 0.10, 0.50), FORWARD),
        home,
    ]
    return JointTable(IIWA, smooth(solved(arm, home, targets), 401), 0.02)


def panda_shelf() -> JointTable:
    """Into the middle bay, against a carton that it pushes, and out again past the cans."""
    arm = Arm(stock("franka_panda/panda.urdf"), PANDA, "panda_grasptarget")
    home = (0.0, -0.9, 0.0, -2.4, 0.0, 3.05, 0.785)
    targets = [
        ToolPose((0.55, -0.02, 0.66), UPRIGHT),
        ToolPose((0.64, 0.05, 0.63), UPRIGHT),
        ToolPose((0.71, 0.10, 0.61), UPRIGHT),
        ToolPose((0.750, 0.10, 0.605), UPRIGHT),
        ToolPose((0.762, 0.105, 0.605), UPRIGHT),
        ToolPose((0.70, 0.09, 0.62), UPRIGHT),
        ToolPose((0.69, -0.12, 0.63), UPRIGHT),
        ToolPose((0.57, -0.14, 0.66), UPRIGHT),
        home,
    ]
    return JointTable(PANDA, smooth(solved(arm, home, targets), 321), 0.02)


def hot_cell() -> JointTable:
    """Through the port, round a bent pipe to the trough, up to look at the vessel, and back out."""
    arm = Arm(repository() / "robots" / "heron6" / "heron6.urdf", HERON, "tool_tip")
    home = (0.0, -0.75, 0.85, 0.0, -0.1, 0.0)
    targets = [
        ToolPose((0.62, 0.00, 0.75), (0.0, 0.0, 0.0)),
        ToolPose((0.80, 0.00, 0.75), (0.0, 0.1, 0.0)),
        ToolPose((0.95, 0.04, 0.73), (0.0, 0.3, 0.1)),
        ToolPose((1.04, 0.09, 0.675), (0.0, 0.5, 0.1)),
        ToolPose((0.97, 0.00, 0.76), (0.4, 0.1, 0.0)),
        ToolPose((0.98, -0.12, 0.84), (0.8, -0.2, -0.2)),
        ToolPose((0.82, -0.02, 0.76), (0.4, 0.0, 0.0)),
        ToolPose((0.62, 0.00, 0.75), (0.0, 0.0, 0.0)),
        home,
    ]
    return JointTable(HERON, smooth(solved(arm, home, targets), 401), 0.02)


def _alone(path: Callable[[], JointTable]) -> Callable[[], dict[str, Table]]:
    """The tables of a scene with one robot among standing things."""
    return lambda: {"trajectory.csv": path()}


TABLES: dict[str, Callable[[], dict[str, Table]]] = {
    **{
        path.__name__: _alone(path)
        for path in (box_box, box_pipe, iiwa_pipe_rack, panda_shelf, hot_cell)
    },
    "dual_arm_handover": handover.tables,
    "turntable_cell": turntable.tables,
    "door_and_arm": door.tables,
    "welding_cell": welding.tables,
}
"""Scene name to the function that makes its tables, by file name."""

PROGRAMS: dict[str, Callable[[], dict[str, str]]] = {
    "welding_cell": welding.programs,
    "palletising_cell": palletising.programs,
}
"""The same of the programs of robots, as texts."""
