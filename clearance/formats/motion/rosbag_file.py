"""Bags of ROS to a trajectory: ROS 1 (`.bag`), folders of rosbag2 (sqlite3, mcap), and their single files.

The one adapter of rosbags. Topics of trajectories, and of goals that hold one, hold what was planned, those of
JointState what the robot did. Not for: the points of a message (`joint_points`), nor states put together
(`joint_states`).
"""

from __future__ import annotations

import sys
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import replace
from itertools import islice
from pathlib import Path
from textwrap import dedent
from typing import TYPE_CHECKING, Any

import numpy as np

from clearance.errors import BadMotion, BadShape, BadSyntax, ClearanceError, nearest_name
from clearance.extras import importing
from clearance.formats.message.documents import Fields
from clearance.formats.message.values import NANO
from clearance.formats.motion.joint_messages import chosen, messages_in
from clearance.formats.motion.joint_points import trajectory_of_message
from clearance.formats.motion.joint_states import JointState, trajectory_of_states
from clearance.formats.motion.requests import ReadTrajectory
from clearance.formats.schema.timed import Choice
from clearance.world.notice import listed

if TYPE_CHECKING:
    from rosbags.highlevel import AnyReader

_COMMANDS = "trajectory_msgs/msg/JointTrajectory"

_PLANNED = (
    _COMMANDS,
    "moveit_msgs/msg/RobotTrajectory",
    "moveit_msgs/msg/DisplayTrajectory",
    "control_msgs/msg/FollowJointTrajectoryActionGoal",
    "control_msgs/msg/FollowJointTrajectoryGoal",
    "moveit_msgs/msg/ExecuteTrajectoryActionGoal",
    "moveit_msgs/msg/MoveGroupActionResult",
    "control_msgs/action/FollowJointTrajectory_SendGoal_Event",
    "moveit_msgs/action/ExecuteTrajectory_SendGoal_Event",
)
"""Kinds of messages that hold what was planned. Goals are topics in ROS 1; in ROS 2 they are recorded as events of
the service `_action/send_goal`, where its introspection is on."""

_PLANS = frozenset(one for one in _PLANNED if one.startswith("moveit") and "Execute" not in one)
"""Those that no robot follows as they are received."""

_STATES = "sensor_msgs/msg/JointState"
MOST_MESSAGES = 1_000_000
"""Of one topic; some 70 s."""

FIRST_MESSAGES = 10_000
"""Of a topic that is not chosen, some 0.7 s; drivers that tell of different joints take turns, or begin later."""


def read_bag(
    path: Path,
    choice: Choice,
    turns: Mapping[str, bool],
    wrapping: frozenset[str] | None = None,
) -> ReadTrajectory:
    """The trajectory of the topic that is meant.

    Args:
        turns: names the joints that the robot can move; empty if the robot is not known.
        wrapping: joints that a recording may have reduced by whole turns; None if they are not known.

    Raises:
        BadInput: with the topic. Unavailable: rosbags is not installed.
    """
    with importing("ros", "reading a bag"):
        import rosbags.highlevel  # noqa: F401  # asked before the file is looked at
    with _as_ours(), _opened(path) as reader:
        topic, kind = _topic(reader, choice.topic)
        if kind == _STATES:
            choice.refuse_others({"topic", "gaps"}, "recorded joint states")
            read = trajectory_of_states(_states(reader, topic), turns, choice.gaps, wrapping)
            return _with_others(read, reader, topic, turns)
        choice.refuse_others({"topic", "which"}, "messages in a bag")
        plain = ((time, _plain(one)) for time, one in _messages(reader, topic))
        goals = [*_goals_once(plain)]
        message = chosen(messages_in([one for _, one in goals], sys.maxsize), choice.which)
        whole = message.around[0][1] if message.around else message.trajectory
        received = 0 if kind in _PLANS else next(time for time, one in goals if one is whole)
        read = trajectory_of_message(message, sys.maxsize, received=received)
        return _with_others(read, reader, topic, turns, (_COMMANDS,))


@contextmanager
def _as_ours() -> Iterator[None]:
    """Whatever a reader that is not ours dies of, the bag brought it."""
    try:
        yield
    except ClearanceError:
        raise
    except Exception as error:
        reason = str(error).strip() or "it is damaged"
        raise BadSyntax(f"not a bag that can be read: {reason}") from None


@contextmanager
def _opened(path: Path) -> Iterator[AnyReader]:
    from rosbags.highlevel import AnyReader
    from rosbags.typesys import Stores, get_types_from_msg, get_typestore

    known = get_typestore(Stores.LATEST)
    for kind, fields in DEFINITIONS.items():
        known.register(get_types_from_msg(dedent(fields), kind))
    with AnyReader([path], default_typestore=known) as reader:
        yield reader


def _topic(reader: AnyReader, wanted: str | None) -> tuple[str, str]:
    """Name and kind of message of the topic that is meant."""
    kinds = {
        one.topic: one.msgtype
        for one in sorted(reader.connections, key=lambda one: one.topic)
        if one.msgtype in (*_PLANNED, _STATES) and one.msgcount
    }
    if wanted is not None:
        if wanted not in kinds:
            raise BadMotion(
                f"the bag has no trajectories or joint states of topic {wanted!r:.60}",
                valid=nearest_name(wanted, kinds),
            )
        return wanted, kinds[wanted]
    if not kinds:
        others = listed(sorted({one.msgtype for one in reader.connections}), 8)
        raise BadMotion(
            f"the bag has no trajectories and no joint states{f', but {others}' if others else ''}",
            valid=f"topics of {', '.join((*_PLANNED[:4], _STATES))}, or the like",
        )
    if len(kinds) > 1:
        shown = listed(
            [f"{topic} ({kind.rpartition('/')[2]})" for topic, kind in kinds.items()], 12
        )
        raise BadMotion(
            f"the bag has several topics: {shown}",
            valid=f"trajectory: {{file: …, topic: {next(iter(kinds))}}} takes the first",
        )
    return next(iter(kinds.items()))


def _messages(reader: AnyReader, topic: str) -> Iterator[tuple[int, Any]]:
    """When each was recorded [ns], and the message."""
    connections = [one for one in reader.connections if one.topic == topic]
    for i, (connection, time, raw) in enumerate(reader.messages(connections)):
        if i >= MOST_MESSAGES:
            raise BadShape(f"more than {MOST_MESSAGES:,} messages of {topic}")
        yield time, reader.deserialize(raw, connection.msgtype)


def _plain(value: Any) -> Any:
    """A message as mappings, lists, text and numbers."""
    if isinstance(value, np.ndarray):
        return value.tolist()
    if isinstance(value, list):
        return [_plain(one) for one in value]
    names = getattr(value, "__dataclass_fields__", None)
    if names is None:
        return value
    return Fields(
        {name: _plain(getattr(value, name)) for name in names if not name.startswith("__")}
    )


def _states(reader: AnyReader, topic: str) -> list[JointState]:
    states = []
    for recorded, message in _messages(reader, topic):
        stamp = message.header.stamp
        stamped = stamp.sec * NANO + stamp.nanosec
        positions, names = message.position.tolist(), tuple(message.name)
        moving = len(message.velocity) > 0
        states.append(JointState(stamped or recorded, names, positions, moving, stamped != 0))
    return states


def _with_others(
    read: ReadTrajectory,
    reader: AnyReader,
    topic: str,
    turns: Collection[str],
    kinds: Sequence[str] = (_STATES, _COMMANDS),
) -> ReadTrajectory:
    """What was read of a topic, with joints that other topics of some kinds tell of and it does not."""
    trajectory, known = read.trajectory, {*read.trajectory.joint_names}
    unread = [*trajectory.unread]
    topics = {one.topic for one in reader.connections if one.msgtype in kinds}
    for other in sorted(topics - {topic}):
        names = dict.fromkeys(name for name in _names_in(reader, other) if name not in known)
        if lacking := [name for name in names if name in turns or not turns]:
            unread.append(f"{listed(lacking, 4)} of topic {other}")
    return read._replace(trajectory=replace(trajectory, unread=tuple(unread)))


def _names_in(reader: AnyReader, topic: str) -> Iterator[str]:
    """The joints that the first messages of a topic tell of."""
    for _, message in islice(_messages(reader, topic), FIRST_MESSAGES):
        yield from message.joint_names if hasattr(message, "joint_names") else message.name


def _goals_once(messages: Iterable[tuple[int, Any]]) -> Iterator[tuple[int, Any]]:
    """The messages; of the events of one goal, which client and server both tell of, the first."""
    seen: set[str] = set()
    for time, message in messages:
        if isinstance(message, Fields) and isinstance(message.get("request"), list):
            goals = {str(one.get("goal_id")) for one in message["request"]}
            if goals <= seen:
                continue
            seen |= goals
        yield time, message


DEFINITIONS: dict[str, str] = {
    "object_recognition_msgs/msg/ObjectType": "string key\nstring db",
    "moveit_msgs/msg/CollisionObject": """
        std_msgs/Header header
        geometry_msgs/Pose pose
        string id
        object_recognition_msgs/ObjectType type
        shape_msgs/SolidPrimitive[] primitives
        geometry_msgs/Pose[] primitive_poses
        shape_msgs/Mesh[] meshes
        geometry_msgs/Pose[] mesh_poses
        shape_msgs/Plane[] planes
        geometry_msgs/Pose[] plane_poses
        string[] subframe_names
        geometry_msgs/Pose[] subframe_poses
        byte operation""",
    "moveit_msgs/msg/AttachedCollisionObject": """
        string link_name
        moveit_msgs/CollisionObject object
        string[] touch_links
        trajectory_msgs/JointTrajectory detach_posture
        float64 weight""",
    "moveit_msgs/msg/RobotState": """
        sensor_msgs/JointState joint_state
        sensor_msgs/MultiDOFJointState multi_dof_joint_state
        moveit_msgs/AttachedCollisionObject[] attached_collision_objects
        bool is_diff""",
    "moveit_msgs/msg/RobotTrajectory": """
        trajectory_msgs/JointTrajectory joint_trajectory
        trajectory_msgs/MultiDOFJointTrajectory multi_dof_joint_trajectory""",
    "moveit_msgs/msg/DisplayTrajectory": """
        string model_id
        moveit_msgs/RobotTrajectory[] trajectory
        moveit_msgs/RobotState trajectory_start""",
}
"""By kind of message: its fields, one a line."""
