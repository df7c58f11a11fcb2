"""How fast a joint may move and accelerate, and how far a controller lets it off its path."""

from __future__ import annotations

import math
from dataclasses import dataclass

from clearance.errors import BadDimension


@dataclass(frozen=True)
class MotionLimit:
    """The greatest speed [rad/s or m/s] and acceleration [rad/s² or m/s²] of a joint, either way.

    Raises:
        BadDimension: a limit that is not above 0.
    """

    velocity: float = math.inf
    acceleration: float = math.inf

    def __post_init__(self) -> None:
        _check_above_0(velocity=self.velocity, acceleration=self.acceleration)


@dataclass(frozen=True)
class PathTolerance:
    """How far a joint may be off its path, and off its goal, before its controller stops [rad or m].

    Attributes:
        trajectory, goal: infinite where the controller does not check.

    Raises:
        BadDimension: one that is not above 0.
    """

    trajectory: float = math.inf
    goal: float = math.inf

    def __post_init__(self) -> None:
        _check_above_0(trajectory=self.trajectory, goal=self.goal)


def _check_above_0(**numbers: float) -> None:
    for name, number in numbers.items():
        if not number > 0.0:
            raise BadDimension(f"{name} {number:g} is given", valid="above 0")


NO_LIMIT = MotionLimit()
