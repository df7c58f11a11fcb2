"""The kinematics of heron6: frames, axes and limits.

At zero the upper arm stands and the forearm points along x.
"""

from __future__ import annotations

from scripts.makers.urdf import JointSpec

JOINTS = (
    JointSpec(
        "joint_1",
        "revolute",
        "base_link",
        "shoulder",
        (0, 0, 0.245),
        (0, 0, 1),
        (-2.97, 2.97),
        250,
        1.8,
    ),
    JointSpec(
        "joint_2",
        "revolute",
        "shoulder",
        "upper_arm",
        (0, 0, 0.2),
        (0, 1, 0),
        (-1.75, 2.1),
        250,
        1.6,
    ),
    JointSpec(
        "joint_3",
        "revolute",
        "upper_arm",
        "forearm",
        (0, 0, 0.44),
        (0, 1, 0),
        (-2.6, 1.3),
        180,
        1.8,
    ),
    JointSpec(
        "joint_4", "revolute", "forearm", "wrist_roll", (0.3, 0, 0), (1, 0, 0), (-3.1, 3.1), 60, 2.6
    ),
    JointSpec(
        "joint_5",
        "revolute",
        "wrist_roll",
        "wrist_pitch",
        (0.22, 0, 0),
        (0, 1, 0),
        (-2.0, 2.0),
        60,
        2.6,
    ),
    JointSpec(
        "joint_6",
        "revolute",
        "wrist_pitch",
        "gripper",
        (0.088, 0, 0),
        (1, 0, 0),
        (-6.1, 6.1),
        30,
        3.4,
    ),
    JointSpec(
        "finger_joint",
        "prismatic",
        "gripper",
        "finger_left",
        (0.06, 0, 0),
        (0, 1, 0),
        (0.0, 0.04),
        60,
        0.15,
    ),
    JointSpec(
        "finger_joint_mirrored",
        "prismatic",
        "gripper",
        "finger_right",
        (0.06, 0, 0),
        (0, -1, 0),
        (0.0, 0.04),
        60,
        0.15,
        mimic="finger_joint",
    ),
    JointSpec("tool_joint", "fixed", "gripper", "tool_tip", (0.15, 0, 0)),
)
