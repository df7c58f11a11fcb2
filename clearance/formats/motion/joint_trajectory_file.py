"""YAML and JSON dumps of ROS's trajectory messages to a trajectory, as `ros2 topic echo` and `rostopic echo` write
them, one document a message.

Not for: what a document is (`message.documents`), which message is meant (`joint_messages`), its points
(`joint_points`).
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from clearance.formats.message.documents import MOST_JSON, json_documents, yaml_documents
from clearance.formats.motion.joint_messages import chosen, messages_in
from clearance.formats.motion.joint_points import trajectory_of_message
from clearance.formats.motion.trajectory_request import ReadTrajectory, TrajectoryRequest


def read_yaml_trajectory(request: TrajectoryRequest) -> ReadTrajectory:
    """The trajectory in a YAML file.

    Raises:
        BadInput: with the line and the keys that lead to what is wrong.
    """
    return _read(request, yaml_documents)


def read_json_trajectory(request: TrajectoryRequest) -> ReadTrajectory:
    """The trajectory in a JSON file.

    Raises:
        BadInput: with the keys that lead to what is wrong.
    """
    return _read(request, json_documents)


def _read(request: TrajectoryRequest, documents_in: Callable[[bytes], list[Any]]) -> ReadTrajectory:
    request.choice.refuse_others({"which"}, "a trajectory message")
    with request.opened() as file:
        documents = documents_in(file.read(MOST_JSON + 1))
    message = chosen(messages_in(documents, request.n_bytes), request.choice.which)
    return trajectory_of_message(message, request.n_bytes, request.joints_needed)
