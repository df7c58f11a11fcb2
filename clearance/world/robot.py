"""A robot as its kinematic tree: what moves with what. Not for: URDF (room `formats`), poses (`kinematics`)."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from enum import StrEnum
from functools import cached_property

import numpy as np

from clearance.errors import UnknownJoint, nearest_name
from clearance.world.body import Body
from clearance.world.collision_matrix import CollisionMatrix
from clearance.world.field_types import require_types
from clearance.world.notice import Notice

WORLD_LINK = "world"
"""A root link of this name is the surroundings of the robot in its own file: floor and walls."""


class JointKind(StrEnum):
    """How a joint's child moves in its parent."""

    FIXED = "fixed"
    REVOLUTE = "revolute"
    CONTINUOUS = "continuous"
    PRISMATIC = "prismatic"


@dataclass(frozen=True)
class Mimic:
    """A joint that follows another: position = multiplier * master + offset."""

    joint: str
    multiplier: float = 1.0
    offset: float = 0.0


@dataclass(frozen=True, eq=False)
class Joint:
    """A connection of two links.

    Attributes:
        parent, child: link names.
        parent_from_joint: (4, 4) pose of the child frame at position 0 [m].
        axis: (3,) unit vector in the joint frame.
        lower, upper: limits [rad] or [m]; infinite where there are none.
        part_of: kind and name of the joint of several degrees of freedom that it is a part of.
        velocity: the greatest that the robot's own file gives [rad/s] or [m/s]; infinite where it gives none.
    """

    name: str
    kind: JointKind
    parent: str
    child: str
    parent_from_joint: np.ndarray
    axis: np.ndarray = field(default_factory=lambda: np.array([1.0, 0.0, 0.0]))
    lower: float = -np.inf
    upper: float = np.inf
    mimic: Mimic | None = None
    part_of: tuple[str, str] | None = None
    velocity: float = field(default=np.inf, repr=False)  # decides no clearance, so no fingerprint


@dataclass(frozen=True, eq=False)
class Robot:
    """A tree of links.

    Attributes:
        link_names: every link, with or without a shape; the root first, parents before children.
        joints: `len(link_names) - 1` joints, in the order of their child links.
        bodies: the links that have a shape (in the link frame), in the order of `link_names`.
        notes: what loading had to mend or leave out, one line each, for the report.
        notices: suspect input and warnings that only loading can find.
        own_matrix: which pairs of links the robot's own file excuses, and why; None where it says nothing of them.
        states: positions of joints [rad] or [m] that its own file names, by the state's name and the joint's.
        reference: those at which its own file has it, by joint; the others are 0.
    """

    name: str
    link_names: tuple[str, ...]
    joints: tuple[Joint, ...]
    bodies: tuple[Body, ...]
    notes: tuple[str, ...] = ()
    notices: tuple[Notice, ...] = ()
    own_matrix: CollisionMatrix | None = None
    states: Mapping[str, Mapping[str, float]] = field(default_factory=dict)
    reference: Mapping[str, float] = field(default_factory=dict)

    def __post_init__(self) -> None:
        require_types(self, link_names=[str], joints=[Joint], bodies=[Body])

    def __repr__(self) -> str:
        n_links, n_joints = len(self.bodies), len(self.moving_joints)
        return f"<Robot {self.name!r}: links with shapes {n_links}, moving joints {n_joints}>"

    @cached_property
    def moving_joints(self) -> tuple[Joint, ...]:
        """The joints that a trajectory can name: not fixed and not mimicking."""
        return tuple(j for j in self.joints if j.kind is not JointKind.FIXED and j.mimic is None)

    @property
    def brings_surroundings(self) -> bool:
        """True if its own file has a floor or walls: its root link is called `WORLD_LINK` and has a shape."""
        root = self.link_names[0]
        return root == WORLD_LINK and any(body.name == root for body in self.bodies)


def require_moving_joints(robot: Robot, names: Iterable[str]) -> None:
    """Nothing, if all are names of joints that can be set.

    Raises:
        UnknownJoint: not there, with the nearest name; or fixed, or a mimic of another joint.
    """
    by_name = {joint.name: joint for joint in robot.joints}
    moving = [joint.name for joint in robot.moving_joints]
    for name in names:
        if name not in by_name:
            raise UnknownJoint(f"unknown joint {name!r}", valid=nearest_name(name, moving))
        joint = by_name[name]
        if joint.kind is JointKind.FIXED:
            raise UnknownJoint(
                f"joint {name!r} is fixed", valid=f"moving joints: {', '.join(moving)}"
            )
        if joint.mimic is not None:
            raise UnknownJoint(
                f"joint {name!r} mimics {joint.mimic.joint!r} and cannot be set",
                valid=f"leave it out or give {joint.mimic.joint!r}",
            )
