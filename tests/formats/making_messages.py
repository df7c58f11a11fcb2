"""Dumps of trajectory messages as ROS's own commands write them, by hand."""

import json

ROS2 = """header:
  stamp:
    sec: 12
    nanosec: 500
  frame_id: base
joint_names:
- shoulder
- lift
points:
- positions:
  - 0.1
  - 0.0
  velocities:
  - 0.0
  - -1e-3
  accelerations: []
  effort: []
  time_from_start:
    sec: 0
    nanosec: 0
- positions:
  - 0.30000000000000004
  - 0.05
  velocities:
  - 0.5
  - .25
  accelerations: []
  effort: []
  time_from_start:
    sec: 1
    nanosec: 100000000
---
"""
"""`ros2 topic echo` of a JointTrajectory."""

ROS1 = """header:
  seq: 0
  stamp:
    secs: 0
    nsecs:         0
  frame_id: ''
joint_names: [shoulder, lift]
points:
  -
    positions: [0.1, 0.0]
    velocities: [0.0, -0.001]
    accelerations: []
    effort: []
    time_from_start:
      secs: 0
      nsecs:         0
  -
    positions: [0.30000000000000004, 0.05]
    velocities: [0.5, 0.25]
    accelerations: []
    effort: []
    time_from_start:
      secs: 1
      nsecs: 100000000
---
"""
"""`rostopic echo` of the same."""

POINTS = [
    {
        "positions": [0.1, 0.0],
        "velocities": [0.0, -0.001],
        "time_from_start": {"sec": 0, "nanosec": 0},
    },
    {"positions": [0.30000000000000004, 0.05], "velocities": [0.5, 0.25], "time_from_start": 1.1},
]
JOINTS = ["shoulder", "lift"]
MESSAGE = {"joint_names": JOINTS, "points": POINTS}
"""The same as plain data."""


def dumped(message: object) -> str:
    """As JSON, which is YAML too."""
    return json.dumps(message)


def with_points(*points: object, **fields: object) -> dict[str, object]:
    return {**MESSAGE, "points": list(points), **fields}


def robot_trajectory(message: object = MESSAGE, n_other: int = 0) -> dict[str, object]:
    other = {"joint_names": ["base"] if n_other else [], "points": [{"transforms": []}] * n_other}
    return {"joint_trajectory": message, "multi_dof_joint_trajectory": other}


def display_trajectory(*trajectories: object) -> dict[str, object]:
    start = {"joint_state": {"name": JOINTS, "position": [0.1, 0.0]}}
    return {"model_id": "arm", "trajectory": list(trajectories), "trajectory_start": start}
