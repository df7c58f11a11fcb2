"""Robots that the program of another one moves, as a turntable: joined to it while the program is followed, each
with its own part of the motion after.

Not for: other robots of a case, which move by trajectories of their own.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import NamedTuple

import numpy as np

from clearance.case.places import IN_WORLD, Places
from clearance.errors import BadProgram
from clearance.formats.schema import program as schema
from clearance.geometry.pose import inverse
from clearance.world.body import Obstacle
from clearance.world.carry import Carry
from clearance.world.placed_robot import PlacedRobot
from clearance.world.robot import Joint, JointKind, Mimic, Robot
from clearance.world.trajectory import Trajectory


class ProgrammedMotion(NamedTuple):
    """The motion of a program's robot, a line each on what was assumed, and that of robots that it drives."""

    trajectory: Trajectory
    notes: tuple[str, ...]
    driven: Mapping[str, Trajectory]


@dataclass(frozen=True)
class Surroundings:
    """All but the robot of a program: other robots, those whose own program is read among them, and obstacles.

    Attributes:
        driven: the robots that the programs of others move, by name.
    """

    robots: tuple[PlacedRobot, ...] = ()
    obstacles: tuple[Obstacle, ...] = ()
    carries: tuple[Carry, ...] = ()
    driven: frozenset[str] = frozenset()


@dataclass(frozen=True, eq=False)
class ProgramCell:
    """The robot of a program among others, some of which it may drive: those whose base stands and that have no
    trajectory.

    Attributes:
        own: the robot of the program.
    """

    own: PlacedRobot
    around: Surroundings

    @cached_property
    def _bases(self) -> dict[str, np.ndarray]:
        """(4, 4) `world_from_base` of the robots whose base stands, whatever the program drives, by name [m]."""
        others = self.around.robots
        moving = [one for one in others if one.trajectory is not None]
        places, found = Places(moving, self.around.obstacles, self.around.carries, {}), {}
        for one in (self.own, *others):
            known = one.mount is None or one.mount.on in places.names
            below = IN_WORLD if one.mount is None else places.of(one.mount.on) if known else ""
            if not isinstance(below, str) and not below.on:
                local = one.world_from_base if one.mount is None else one.mount.pose
                found[one.robot.name] = below.pose @ local
        return found

    @property
    def world_from_own(self) -> np.ndarray | None:
        """(4, 4) where the base of the program's robot stands [m]; None where it may move."""
        return self._bases.get(self.own.robot.name)

    @cached_property
    def _others(self) -> dict[str, PlacedRobot]:
        """The robots that may be driven, by name; none whose name begins one of the program's own robot."""
        if self.world_from_own is None:
            return {}
        own = self.own.robot
        own_names = (*own.link_names, *(joint.name for joint in own.joints))
        prefixes = {name.partition("/")[0] for name in own_names if "/" in name}
        names = self._bases.keys() - prefixes
        others = {one.robot.name: one for one in self.around.robots if one.trajectory is None}
        return {name: one for name, one in others.items() if name in names}

    @cached_property
    def robot(self) -> Robot:
        """The robot of the program, joined with those that may be driven; links and joints of these have their
        names before their own (`turntable/plate`)."""
        own = self.own.robot
        links, joints = [*own.link_names], [*own.joints]
        for name, placed in self._others.items():
            at = inverse(self._bases[own.name]) @ self._bases[name]
            root, *more = (f"{name}/{link}" for link in placed.robot.link_names)
            links += [root, *more]
            joints.append(Joint(f"{name}/", JointKind.FIXED, own.link_names[0], root, at))
            joints += (_named(joint, f"{name}/") for joint in placed.robot.joints)
        if len(links) == len(own.link_names):
            return own
        return replace(own, link_names=tuple(links), joints=tuple(joints), bodies=())

    def driven(self, program: schema.Program) -> tuple[str, ...]:
        """The robots that a program drives.

        Raises:
            BadInput: one that it may not.
        """
        own = {joint.name for joint in self.own.robot.joints}
        named = {name.partition("/")[0] for name in program.joints_named - own if "/" in name}
        for one in self.around.robots:
            if one.robot.name in named - set(self._others):
                raise self._not_driven(one)
        return tuple(name for name in self._others if name in named)

    def _not_driven(self, other: PlacedRobot) -> BadProgram:
        """Why the program may not drive a robot whose joints its moves name."""
        valid = "no trajectory of that robot, and bases that stand"
        if other.robot.name in self.around.driven:
            why = "the program of another robot moves them too"
            valid = "one program that moves it: two on one positioner are not read"
        elif other.trajectory is not None:
            why = f"robot {other.robot.name!r} follows a trajectory of its own"
        else:
            one = self.own if self.world_from_own is None else other
            assert one.mount is not None
            why = f"robot {one.robot.name!r} stands on {one.mount.on!r}, which may move"
        return BadProgram(
            f"the program moves joints of robot {other.robot.name!r}, and {why}",
            valid=valid,
        )

    def start(self, driven: Sequence[str]) -> dict[str, float]:
        """Where the case has the joints of driven robots, by their names in `robot` [rad or m]."""
        return {
            f"{name}/{joint}": value
            for name in driven
            for joint, value in self._others[name].fixed_positions.items()
        }

    def places(self, driven: Sequence[str]) -> Places:
        """Where all is that a frame may be on."""
        own = self.own.robot
        links = {link: link for link in own.link_names}
        links |= {f"{own.name}/{link}": link for link in own.link_names}
        others = []
        for one in self.around.robots:
            if one.robot.name in driven:
                names = (f"{one.robot.name}/{link}" for link in one.robot.link_names)
                links |= {name: name for name in names}
            else:
                others.append(one)
        return Places(others, self.around.obstacles, self.around.carries, links)

    def mounts(self, driven: Sequence[str]) -> set[str]:
        """What the own robot and driven ones are on, where that is not the world."""
        robots = (self.own, *(self._others[name] for name in driven))
        return {one.mount.on for one in robots if one.mount is not None}

    def parted(
        self, made: Trajectory, driven: Sequence[str], program: schema.Program
    ) -> tuple[Trajectory, dict[str, Trajectory]]:
        """The motion of `robot` as the own robot's, and that of each robot that is driven.

        Joints that no move leaves free are on their cubics exactly.
        """
        paths = (move.lin or move.circ for move in program.moves)
        free = {name.partition("/")[0] for path in paths if path for name in path.free}
        others = {}
        for name in driven:
            part = _of(made, name, driven)
            others[name] = Trajectory(
                *(part.times, part.joint_names, part.positions, part.velocities),
                path_error=part.path_error if name in free else 0.0,
                corners=tuple(zone for zone in part.corners if zone.links),
            )
        return replace(_of(made, "", driven), drives=tuple(driven)), others


def require_as_read(placed: PlacedRobot, around: Surroundings) -> None:
    """Nothing, if what the frames of a robot's program are on moves as was known when the program was read.

    Args:
        around: all but the robot, as they move by the programs of all robots.

    Raises:
        BadInput: a program that was read later moves it.
    """
    made = placed.given_trajectory
    places = ProgramCell(placed, around).places(made.drives)
    known = {"", *places.moved.values(), *made.rides}
    for name in made.frames:
        found = places.of(name)
        if isinstance(found, str) or found.on not in known:
            fault = f"the program of another robot moves {name!r}, which frames are on"
            raise BadProgram(fault, valid="that robot before this one, and no corner zone there")


def _of(made: Trajectory, robot: str, driven: Sequence[str]) -> Trajectory:
    """The part of a motion that is of one of the driven robots; of the own one, where it has no name."""
    columns = [i for i, name in enumerate(made.joint_names) if _owner(name, driven) == robot]
    found = made.of_columns(columns)
    names = tuple(name.removeprefix(f"{robot}/") for name in found.joint_names)
    corners = tuple(
        replace(zone, links={
            name.removeprefix(f"{robot}/"): off for name, off in zone.links.items()
            if _owner(name, driven) == robot and off.at(1.0) > 0.0
        })
        for zone in made.corners
    )  # fmt: skip
    return replace(found, joint_names=names, corners=corners)


def _owner(name: str, driven: Sequence[str]) -> str:
    """The driven robot whose joint or link it is; empty for the own one's."""
    before = name.partition("/")[0]
    return before if "/" in name and before in driven else ""


def _named(joint: Joint, before: str) -> Joint:
    """A joint with something before its names."""
    mimic = joint.mimic
    if mimic is not None:
        mimic = Mimic(before + mimic.joint, mimic.multiplier, mimic.offset)
    parent, child = before + joint.parent, before + joint.child
    return replace(joint, name=before + joint.name, parent=parent, child=child, mimic=mimic)
