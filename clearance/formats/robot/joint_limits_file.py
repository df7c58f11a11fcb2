"""MoveIt's `joint_limits.yaml` to limits of a robot's joints: positions, velocities, accelerations.

As in MoveIt, a limit counts where its `has_…` is true. Not for: what is beyond them (`world.joint_speeds`).
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass

from clearance.errors import BadDimension, BadInput, MissingKey, at
from clearance.formats.message.documents import Fields
from clearance.formats.message.parameter_values import (
    mapping,
    number,
    parameters,
    require_keys,
    truth,
)
from clearance.world.motion_limits import NO_LIMIT, MotionLimit
from clearance.world.names import checked_name

_WRAPPED_IN = ("robot_description_planning", "ros__parameters")

_USED = {
    "has_position_limits": ("min_position", "max_position"),
    "has_velocity_limits": ("max_velocity",),
    "has_acceleration_limits": ("max_acceleration",),
}
_UNUSED = (
    "has_jerk_limits", "max_jerk", "has_effort_limits", "max_effort", "has_deceleration_limits",
    "max_deceleration", "min_velocity", "min_acceleration", "angle_wraparound", "has_soft_limits", "k_position",
    "k_velocity", "soft_lower_limit", "soft_upper_limit",
)  # fmt: skip

_KEYS = (*_USED, *(key for keys in _USED.values() for key in keys), *_UNUSED)


@dataclass(frozen=True)
class FileLimits:
    """What a file says of one joint.

    Attributes:
        lower, upper: [rad] or [m]; infinite where it says nothing.
        unused: keys that are there and say nothing here.
    """

    lower: float = -math.inf
    upper: float = math.inf
    motion: MotionLimit = NO_LIMIT
    unused: tuple[str, ...] = ()


def parse_joint_limits(data: bytes) -> dict[str, FileLimits]:
    """Limits by joint.

    Raises:
        BadInput: with the joint and the key.
    """
    found = list(_blocks(parameters(data)))
    if not found:
        raise MissingKey("'joint_limits' is missing", valid="MoveIt's file of that name")
    if len(found) > 1:
        raise BadInput(f"there are {len(found)} mappings 'joint_limits'", valid="one")
    limits = {}
    for name, given in mapping(found[0]).items():
        with at(f"joint_limits.{name:.60}"):
            limits[checked_name(name)] = _limits(mapping(given))
    return limits


def _blocks(given: Fields, depth: int = 0) -> Iterator[object]:
    """The values of `joint_limits`, at the top or in what ROS wraps parameters in: nodes, and their parameters."""
    if "joint_limits" in given:
        yield given["joint_limits"]
        return
    for key, value in given.items():
        if isinstance(value, Fields) and depth < 4 and (depth == 0 or key in _WRAPPED_IN):
            yield from _blocks(value, depth + 1)


def _limits(given: Fields) -> FileLimits:
    require_keys(given, _KEYS)
    unused = [key for key in _UNUSED if key in given]
    values: dict[str, float] = {}
    for has, keys in _USED.items():
        if not truth(given, has):
            unused += [key for key in keys if key in given]
            continue
        for key in keys:
            if key not in given:
                raise MissingKey(f"{has} is true, but {key!r} is missing")
            values[key] = number(given, key)
    lower, upper = values.get("min_position", -math.inf), values.get("max_position", math.inf)
    if lower > upper:
        raise BadInput(f"min_position {lower:g} is above max_position {upper:g}")
    for key in ("max_velocity", "max_acceleration"):
        if values.get(key, 1.0) <= 0.0:
            raise BadDimension(f"{key} is {values[key]:g}", valid="above 0")
    motion = MotionLimit(
        values.get("max_velocity", math.inf), values.get("max_acceleration", math.inf)
    )
    return FileLimits(lower, upper, motion, tuple(unused))
