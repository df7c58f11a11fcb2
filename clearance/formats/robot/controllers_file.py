"""`ros2_controllers.yaml`, and its like of ROS 1, to how far controllers let joints off their path.

A tolerance of 0, or none, means that the controller does not look. Not for: what that does to a clearance.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass

from clearance.errors import BadDimension, BadInput, MissingKey, at
from clearance.formats.message.documents import Fields, told
from clearance.formats.message.parameter_values import mapping, number, parameters, require_keys
from clearance.world.motion_limits import PathTolerance
from clearance.world.names import checked_name

_DEPTH = 4
"""Namespaces that a controller may be in."""

_TOLERANCES = ("trajectory", "goal")

_OF_ALL = ("goal_time", "stopped_velocity_tolerance")
"""Constraints that are of no joint."""


@dataclass(frozen=True)
class Controller:
    """A controller that follows trajectories, and the tolerances of its joints."""

    name: str
    tolerances: dict[str, PathTolerance]


def parse_controllers(data: bytes) -> list[Controller]:
    """The controllers in a file that have joints.

    Raises:
        MissingKey: none has. BadInput: with the controller and the key.
    """
    found = list(_controllers(parameters(data)))
    if not found:
        raise MissingKey("no controller in it has 'joints' or 'constraints'")
    return found


def _controllers(given: Fields, depth: int = 0) -> Iterator[Controller]:
    for name, value in given.items():
        if not isinstance(value, Fields):
            continue
        body = value.get("ros__parameters", value)
        if not isinstance(body, Fields):
            continue
        with at(f"{name:.60}"):
            if "constraints" in body or isinstance(body.get("joints"), list):
                yield Controller(checked_name(name), _tolerances(body))
            elif depth < _DEPTH:
                yield from _controllers(body, depth + 1)


def _tolerances(body: Fields) -> dict[str, PathTolerance]:
    """Of each joint that the controller names."""
    joints = body.get("joints", [])
    if not isinstance(joints, list) or not all(isinstance(joint, str) for joint in joints):
        raise BadInput(f"{told(joints)} is given", where="joints", valid="a list of names")
    found = {checked_name(joint): PathTolerance() for joint in joints}
    with at("constraints"):
        for name, given in mapping(body.get("constraints", Fields())).items():
            if name in _OF_ALL:
                continue
            with at(f"{name:.60}"):
                found[checked_name(name)] = _tolerance(mapping(given))
    return found


def _tolerance(given: Fields) -> PathTolerance:
    require_keys(given, _TOLERANCES)
    return PathTolerance(*(_length(given, key) for key in _TOLERANCES))


def _length(given: Fields, key: str) -> float:
    value = number(given, key) if key in given else 0.0
    if value < 0.0:
        raise BadDimension(f"{value:g} is given", where=key, valid="0 or more")
    return value or math.inf
