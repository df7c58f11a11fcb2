"""YAML and JSON dumps of stamped poses to a pose table: PoseStamped, PoseWithCovarianceStamped, Path, transforms
of one frame, as `ros2 topic echo` and `rostopic echo` write them.

Not for: what a document is (`message.documents`), nor tables (`tables`).
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from functools import partial
from typing import Any, NamedTuple

import numpy as np

from clearance.errors import BadMotion, BadShape, BadTime, MissingKey, at
from clearance.formats.message.documents import (
    MOST_JSON,
    Fields,
    described,
    json_documents,
    yaml_documents,
)
from clearance.formats.message.values import (
    NANO,
    frame_of,
    header_of,
    items,
    message,
    nanoseconds_in,
    numbers,
    require_fields,
    text,
)
from clearance.formats.motion.requests import (
    PoseRequest,
    PoseSamples,
    ReadSamples,
    samples_of,
)

MOST = 1_000_000
"""Poses in a file."""


class _StampedPose(NamedTuple):
    """A pose [m] at a time [ns], in a frame; `child` is the frame that a transform is of."""

    nanoseconds: int
    frame: str
    child: str
    position: list[float]
    quaternion: list[float]


def _read(documents_in: Callable[[bytes], list[Any]], request: PoseRequest) -> ReadSamples:
    """The poses in a file.

    Raises:
        BadInput: with the place in the file.
    """
    if request.length is not None:
        fault = "'units' is given, and messages are in metres"
        raise BadMotion(fault, valid="leave 'units' out of moves")
    with request.opened() as file:
        data = file.read(MOST_JSON + 1)
    stamped: list[_StampedPose] = []
    for i, document in enumerate(documents_in(data)):
        with at(f"message {i + 1}"):
            for one in _poses_in(document):
                if len(stamped) >= min(MOST, len(data)):
                    raise BadShape("aliases repeat more than the file holds")
                _refuse_standing(stamped, one)
                stamped.append(one)
    if not stamped:
        raise BadShape("there is no pose", valid=_NEEDED)
    return _samples_of(stamped)


read_yaml_poses = partial(_read, yaml_documents)
read_json_poses = partial(_read, json_documents)


def _poses_in(given: Any) -> Iterator[_StampedPose]:
    """The poses of a message."""
    if not isinstance(given, Fields):
        raise MissingKey(f"{described(given)} is not a message", valid=_NEEDED)
    if "poses" in given or "transforms" in given:
        key = "poses" if "poses" in given else "transforms"
        for i, one in enumerate(items(given, key)):
            with at(f"{key}[{i}]"):
                yield _pose(one)
    else:
        yield _pose(given)


def _pose(given: Any) -> _StampedPose:
    if not isinstance(given, Fields) or not {"header"} < set(given):
        raise MissingKey(f"{described(given)} has no header with a time", valid=_NEEDED)
    require_fields(given, "header", "pose", "transform", "child_frame_id", "twist")
    header = header_of(given)
    time = nanoseconds_in(header.get("stamp"))
    if time is None:
        raise BadTime(
            f"{described(header.get('stamp'))} is given",
            where="header.stamp",
            valid="{sec, nanosec} or {secs, nsecs}",
        )
    pose, keys = message(given, "pose"), ("position", "orientation")
    if "transform" in given:
        pose, keys = message(given, "transform"), ("translation", "rotation")
    elif "pose" in pose:
        require_fields(pose, "pose", "covariance")
        pose = message(pose, "pose")
    with at("pose" if "pose" in given else "transform"):
        require_fields(pose, *keys)
    for key in keys:
        if key not in pose:
            raise MissingKey(f"there is no {key!r}", valid=_NEEDED)
    return _StampedPose(
        time,
        frame_of(given),
        text(given, "child_frame_id", "").lstrip("/"),
        numbers(pose[keys[0]], "xyz", keys[0]),
        numbers(pose[keys[1]], "xyzw", keys[1]),
    )


def _refuse_standing(before: Sequence[_StampedPose], one: _StampedPose) -> None:
    """Nothing, if a pose can follow those before it.

    Raises:
        BadTime: it is not later. BadInput: it is of or in another frame.
    """
    if not before:
        return
    for what, was, now in (
        ("of", before[0].child, one.child),
        ("in", before[0].frame, one.frame),
    ):
        if was != now:
            raise BadMotion(
                f"poses {what} {was!r} and {now!r} are in one file",
                valid="those of one frame, in one frame",
            )
    if one.nanoseconds <= before[-1].nanoseconds:
        raise BadTime("its stamp is not after that of the pose before", where="header.stamp")


def _samples_of(stamped: Sequence[_StampedPose]) -> ReadSamples:
    first = stamped[0]
    times = np.array([(one.nanoseconds - first.nanoseconds) / NANO for one in stamped])
    positions = np.array([one.position for one in stamped])
    quaternions = np.array([one.quaternion for one in stamped])
    where = (
        f"in frame {first.frame!r}, taken for what the poses are seen from"
        if first.frame
        else "in no frame"
    )
    return samples_of(
        PoseSamples(times, positions, quaternions, first.frame, first.child, first.nanoseconds),
        (f"{len(stamped)} stamped poses {where}; their times count from the first at 0 s",),
    )


_NEEDED = "PoseStamped, Path or TransformStamped messages, each pose with header, position and orientation"
