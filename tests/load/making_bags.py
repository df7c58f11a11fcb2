"""Small bags in each container, written by rosbags itself."""

from pathlib import Path

import numpy as np
from rosbags.rosbag1 import Writer as Writer1
from rosbags.rosbag2 import StoragePlugin
from rosbags.rosbag2 import Writer as Writer2
from rosbags.typesys import Stores, get_types_from_msg, get_typestore

CONTAINERS = ("bag", "rosbag2 sqlite3", "rosbag2 mcap", "mcap")
JOINTS = ("shoulder", "lift")

_ROBOT = "moveit_msgs/msg/RobotTrajectory"
_DISPLAY = "moveit_msgs/msg/DisplayTrajectory"

NEW, OLD = get_typestore(Stores.ROS2_JAZZY), get_typestore(Stores.ROS1_NOETIC)


def planned(*rows):
    """A JointTrajectory of points 1.1 s apart."""

    def make(types, header):
        point = types["trajectory_msgs/msg/JointTrajectoryPoint"]
        duration = types["builtin_interfaces/msg/Duration"]
        none = np.empty(0)
        points = [
            point(np.array(row), np.array([0.0, 0.5]), none, none, duration(i, i * 10**8))
            for i, row in enumerate(rows)
        ]
        return types["trajectory_msgs/msg/JointTrajectory"](header(0), [*JOINTS], points)

    return "trajectory_msgs/msg/JointTrajectory", make


for name, text in (
    (
        _ROBOT,
        "trajectory_msgs/JointTrajectory joint_trajectory\n"
        "trajectory_msgs/MultiDOFJointTrajectory multi_dof_joint_trajectory\n",
    ),
    (_DISPLAY, "string model_id\nmoveit_msgs/RobotTrajectory[] trajectory\n"),
):
    NEW.register(get_types_from_msg(text, name))


def displayed(*trajectories):
    """A DisplayTrajectory; MoveIt's has a start state as well."""

    def make(types, header):
        other = types["trajectory_msgs/msg/MultiDOFJointTrajectory"](header(0), [], [])
        made = [types[_ROBOT](one(types, header), other) for _, one in trajectories]
        return types[_DISPLAY]("arm", made)

    return _DISPLAY, make


def state(seconds, positions, names=JOINTS):
    """A JointState that is stamped some seconds after others."""

    def make(types, header):
        none = np.empty(0)
        kind = types["sensor_msgs/msg/JointState"]
        return kind(header(100 + seconds), [*names], np.array(positions), none, none)

    return "sensor_msgs/msg/JointState", make


def write_bag(folder: Path, container: str, topics) -> Path:
    """The bag's path; messages are recorded a second apart."""
    folder.mkdir(exist_ok=True)
    store = OLD if container == "bag" else NEW
    types = store.types

    def header(seconds):
        stamp = types["builtin_interfaces/msg/Time"](seconds, 0)
        made = types["std_msgs/msg/Header"]
        return made(0, stamp, "") if container == "bag" else made(stamp, "")

    path = folder / ("run.bag" if container == "bag" else "run")
    plugin = StoragePlugin.MCAP if "mcap" in container else StoragePlugin.SQLITE3
    writer = (
        Writer1(path) if container == "bag" else Writer2(path, version=9, storage_plugin=plugin)
    )
    write = store.serialize_ros1 if container == "bag" else store.serialize_cdr
    with writer:
        for topic, messages in topics.items():
            kind = messages[0][0]
            connection = writer.add_connection(topic, kind, typestore=store)
            for i, (_, make) in enumerate(messages):
                writer.write(connection, (1 + i) * 10**9, bytes(write(make(types, header), kind)))
    return next(path.glob("*.mcap")) if container == "mcap" else path
