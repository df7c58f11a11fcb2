"""Bags of ROS to a trajectory: ROS 1 (`.bag`), folders of rosbag2 (sqlite3, mcap), and their single files.

The one door of rosbags. Topics of JointTrajectory, RobotTrajectory and DisplayTrajectory hold what was planned,
those of JointState what the robot did. Not for: the points of a message (`joint_points`).
"""

from __future__ import annotations

import sys
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from clearance.errors import BadInput, BadShape, BadSyntax, BadTime, ClearanceError, nearest_name
from clearance.extras import importing
from clearance.load.joint_messages import chosen, messages_in
from clearance.load.joint_points import trajectory_of_message
from clearance.load.message_documents import Fields
from clearance.load.trajectory_request import Choice, ReadTrajectory
from clearance.world.names import checked_name
from clearance.world.notice import listed
from clearance.world.trajectory import Trajectory

if TYPE_CHECKING:
    from rosbags.highlevel import AnyReader

SUFFIXES = (".bag", ".mcap", ".db3")
_PLANNED = (
    "trajectory_msgs/msg/JointTrajectory",
    "moveit_msgs/msg/RobotTrajectory",
    "moveit_msgs/msg/DisplayTrajectory",
)
_STATES = "sensor_msgs/msg/JointState"
MOST_MESSAGES = 1_000_000
"""Of one topic; some 70 s."""


class _State(NamedTuple):
    nanoseconds: int
    names: tuple[str, ...]
    positions: list[float]


def is_bag(path: Path) -> bool:
    """Whether a path is that of a bag: a folder, or a file by its suffix."""
    return path.suffix.lower() in SUFFIXES or path.is_dir()


def files_of(path: Path) -> list[Path]:
    """The files of a bag."""
    if not path.is_dir():
        return [path]
    return sorted(one for one in path.iterdir() if one.is_file() and not one.name.startswith("."))


def read_bag(path: Path, choice: Choice, turns: Mapping[str, bool]) -> ReadTrajectory:
    """The trajectory of the topic that is meant.

    Args:
        turns: names the joints that the robot can move; empty where it is not known.

    Raises:
        BadInput: with the topic. Unavailable: rosbags is not installed.
    """
    with importing("ros", "reading a bag"):
        import rosbags.highlevel  # noqa: F401  # asked before the file is looked at
    with _as_ours(), _opened(path) as reader:
        topic, kind = _topic(reader, choice.topic)
        if kind == _STATES:
            choice.refuse_others({"topic"}, "recorded joint states")
            return _of_states(_states(reader, topic), turns)
        choice.refuse_others({"topic", "which"}, "messages in a bag")
        planned = messages_in([_plain(one) for _, one in _messages(reader, topic)], sys.maxsize)
        return trajectory_of_message(chosen(planned, choice.which), sys.maxsize)


@contextmanager
def _as_ours() -> Iterator[None]:
    """Whatever a reader that is not ours dies of, the bag brought it."""
    try:
        yield
    except ClearanceError:
        raise
    except Exception as error:
        raise BadSyntax(f"not a bag that can be read: {error or type(error).__name__}") from None


@contextmanager
def _opened(path: Path) -> Iterator[AnyReader]:
    from rosbags.highlevel import AnyReader
    from rosbags.typesys import Stores, get_typestore

    with AnyReader([path], default_typestore=get_typestore(Stores.LATEST)) as reader:
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
            raise BadInput(
                f"the bag has no trajectories or joint states of topic {wanted!r:.60}",
                valid=nearest_name(wanted, kinds),
            )
        return wanted, kinds[wanted]
    if not kinds:
        others = listed(sorted({one.msgtype for one in reader.connections}), 8)
        raise BadInput(
            f"the bag has no trajectories and no joint states{f', but {others}' if others else ''}",
            valid=f"topics of {', '.join((*_PLANNED, _STATES))}",
        )
    if len(kinds) > 1:
        shown = listed(
            [f"{topic} ({kind.rpartition('/')[2]})" for topic, kind in kinds.items()], 12
        )
        raise BadInput(
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


def _states(reader: AnyReader, topic: str) -> list[_State]:
    states = []
    for recorded, message in _messages(reader, topic):
        stamp = message.header.stamp
        stamped = stamp.sec * 10**9 + stamp.nanosec
        names = tuple(checked_name(name) for name in message.name)
        states.append(_State(stamped or recorded, names, message.position.tolist()))
    return states


def _of_states(states: list[_State], turns: Mapping[str, bool]) -> ReadTrajectory:
    """What the robot did, from the first state on; in seconds from it."""
    first = states[0]
    kept = [name for name in first.names if name in turns or not turns]
    if not kept:
        raise BadInput(
            f"none of the joints {listed([*first.names], 8)} can be moved",
            valid=f"the robot moves {listed([*turns], 8)}",
        )
    rows = []
    for i, state in enumerate(states):
        where = f"message {i + 1}"
        if set(state.names) != set(first.names) or len(state.names) != len(state.positions):
            raise BadShape(
                f"{len(state.positions)} positions of {listed([*state.names], 4)}",
                where=where,
                valid=f"those of the first message: {listed([*first.names], 4)}",
            )
        if i and state.nanoseconds <= states[i - 1].nanoseconds:
            raise BadTime("its time is not after that of the one before", where=where)
        by_name = dict(zip(state.names, state.positions, strict=True))
        rows.append([by_name[name] for name in kept])
    times = np.array([(state.nanoseconds - first.nanoseconds) / 10**9 for state in states])
    notes = ["recorded joint states: joints move linearly between them, from the first at 0 s"]
    left = [name for name in first.names if name not in kept]
    if left:
        notes.append(f"joints that cannot be set are left out: {listed(left, 8)}")
    return ReadTrajectory(Trajectory(times, tuple(kept), np.array(rows)), tuple(notes))
