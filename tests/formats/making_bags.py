"""Small bags in each container, written by rosbags itself."""

import sqlite3
from pathlib import Path
from textwrap import dedent

import numpy as np
from rosbags.rosbag1 import Writer as Writer1
from rosbags.rosbag2 import StoragePlugin
from rosbags.rosbag2 import Writer as Writer2
from rosbags.typesys import Stores, get_types_from_msg, get_typestore

from clearance.formats.motion.rosbag_file import DEFINITIONS

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


for name, text in DEFINITIONS.items():
    NEW.register(get_types_from_msg(dedent(text), name))


GOAL_ID = "actionlib_msgs/msg/GoalID"
ACTION_GOAL = "control_msgs/msg/FollowJointTrajectoryActionGoal"
EVENT = "control_msgs/action/FollowJointTrajectory_SendGoal_Event"

for name, text in (
    (
        "control_msgs/msg/FollowJointTrajectoryGoal",
        "trajectory_msgs/JointTrajectory trajectory\nduration goal_time_tolerance\n",
    ),
    (
        ACTION_GOAL,
        "Header header\nactionlib_msgs/GoalID goal_id\ncontrol_msgs/FollowJointTrajectoryGoal goal\n",
    ),
):
    OLD.register(get_types_from_msg(text, name))

_ACTION = {
    EVENT: "uint8 event_type\n"
    "control_msgs/action/FollowJointTrajectory_SendGoal_Request[<=1] request\n",
    "control_msgs/action/FollowJointTrajectory_SendGoal_Request": "uint8[16] goal_id\n"
    "control_msgs/action/FollowJointTrajectory_Goal goal\n",
    "control_msgs/action/FollowJointTrajectory_Goal": "trajectory_msgs/JointTrajectory trajectory\n",
}
for name, text in _ACTION.items():
    NEW.register(get_types_from_msg(text, name))


def goal(trajectory):
    """The goal of an action as ROS 1 sends it on a topic."""

    def make(types, header):
        inner = types["control_msgs/msg/FollowJointTrajectoryGoal"]
        duration = types["builtin_interfaces/msg/Duration"]
        stamp = types["builtin_interfaces/msg/Time"](0, 0)
        held = inner(trajectory[1](types, header), duration(0, 0))
        return types[ACTION_GOAL](header(0), types[GOAL_ID](stamp, "g"), held)

    return ACTION_GOAL, make


def goal_event(number, trajectory=None):
    """An event of the service by which ROS 2 sends a goal; a response, which holds none, without a trajectory."""

    def make(types, header):
        requests = []
        if trajectory is not None:
            inner = types["control_msgs/action/FollowJointTrajectory_Goal"]
            request = types["control_msgs/action/FollowJointTrajectory_SendGoal_Request"]
            of = np.full(16, number, dtype=np.uint8)
            requests = [request(of, inner(trajectory[1](types, header)))]
        return types[EVENT](1, requests)

    return EVENT, make


def displayed(*trajectories):
    """A DisplayTrajectory, with the state that it starts from."""

    def make(types, header):
        other = types["trajectory_msgs/msg/MultiDOFJointTrajectory"](header(0), [], [])
        made = [types[_ROBOT](one(types, header), other) for _, one in trajectories]
        return types[_DISPLAY]("arm", made, _start(types, header))

    return _DISPLAY, make


def _start(types, header):
    none = np.empty(0)
    joints = types["sensor_msgs/msg/JointState"](header(0), [*JOINTS], np.zeros(2), none, none)
    others = types["sensor_msgs/msg/MultiDOFJointState"](header(0), [], [], [], [])
    return types["moveit_msgs/msg/RobotState"](joints, others, [], False)


def state(seconds, positions, names=JOINTS, velocities=()):
    """A JointState that is stamped some seconds after others; not at all where they are None."""

    def make(types, header):
        none, moving = np.empty(0), np.array(velocities, dtype=float)
        kind = types["sensor_msgs/msg/JointState"]
        at = 0 if seconds is None else 100 + seconds
        return kind(header(at), [*names], np.array(positions), moving, none)

    return "sensor_msgs/msg/JointState", make


def write_bag(folder: Path, container: str, topics) -> Path:
    """The bag's path; messages are recorded a second apart."""
    folder.mkdir(exist_ok=True)
    store = OLD if container == "bag" else NEW
    types = store.types

    def header(seconds):
        nanoseconds = round(seconds * 1e9)
        stamp = types["builtin_interfaces/msg/Time"](*divmod(nanoseconds, 10**9))
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
            connection = writer.add_connection(
                topic, kind, typestore=store, **_own_definition(kind)
            )
            for i, (_, make) in enumerate(messages):
                writer.write(connection, (1 + i) * 10**9, bytes(write(make(types, header), kind)))
    return next(path.glob("*.mcap")) if container == "mcap" else path


def _own_definition(kind: str) -> dict[str, str]:
    """The definition of an event of an action, which rosbags cannot write by itself."""
    if kind != EVENT:
        return {}
    of_path, _ = NEW.generate_msgdef("trajectory_msgs/msg/JointTrajectory", ros_version=2)
    nested = [f"MSG: {name}\n{text}" for name, text in _ACTION.items()][1:]
    path = f"MSG: trajectory_msgs/JointTrajectory\n{of_path}"
    text = f"{'=' * 80}\n".join([_ACTION[EVENT], *nested, path])
    return {"msgdef": text, "rihs01": NEW.hash_rihs01(EVENT)}


def without_definitions(bag: Path) -> Path:
    """The rosbag2 in sqlite3 as it was before Iron, when it brought no definitions of its messages."""
    with sqlite3.connect(next(bag.glob("*.db3"))) as database:
        database.execute("DROP TABLE message_definitions")
        database.execute("UPDATE schema SET schema_version = 3")
    database.close()
    return bag
