"""Where all is that frames of a program may be on: what stands as long as a case runs, what the program moves, and
what moves by a table of its own.

Obstacles and links, and what rides on those. Not for: the frames (`program`), and how joints follow (`programs`).
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np

from clearance.geometry.pose import inverse
from clearance.programs.carriage import (
    Carriage,
    Handed,
    Step,
    series_of,
    steps_of_joint,
    steps_of_poses,
)
from clearance.world.body import Obstacle
from clearance.world.carry import Carry
from clearance.world.kinematic_chain import KinematicChain, chain_between
from clearance.world.kinematics import link_poses, moving_positions
from clearance.world.knots import knots_of_motion, knots_of_poses
from clearance.world.motion import kinematic_motion
from clearance.world.placed_robot import PlacedRobot


class Place(NamedTuple):
    """Where something is: its pose (4, 4) [m] on a link that the program moves, or on what moves by itself; in the
    world if that is empty."""

    on: str
    pose: np.ndarray

    def on_it(self, pose: np.ndarray) -> Place:
        """The place of a pose (4, 4) that is given on this one."""
        return Place(self.on, self.pose @ pose)


IN_WORLD = Place("", np.eye(4))

NOT_PLACED = (
    "an obstacle or a link that stands, that the program moves, or that moves by a table of its own"
)


class NotThere(str):
    """Why something has no place: what it is on is not there, or has a program that is not read yet."""


class _Mover(NamedTuple):
    """What moves by itself: an obstacle, or a link of a robot, and what it is on."""

    of: Obstacle | PlacedRobot
    base: Place
    link: str = ""


@dataclass(frozen=True, eq=False)
class Places:
    """Where all is, by name.

    Args:
        robots: as the links of several robots are called, without that of the program and what it drives.
        obstacles: all. carries: who carries them, and when.
        moved: the links that the program may move, by all names that they have.
    """

    robots: Sequence[PlacedRobot]
    obstacles: Sequence[Obstacle]
    carries: Sequence[Carry]
    moved: Mapping[str, str]

    @property
    def names(self) -> tuple[str, ...]:
        """All that is there."""
        return (*self._found,)

    def of(self, name: str) -> Place | str:
        """Where one is that is there; or in words why a program cannot say."""
        return self._found[name]

    def carriage(self, name: str, seen_from: np.ndarray) -> Carriage:
        """The motion of what moves by itself, seen from what stands at a pose (4, 4) [m]."""
        assert name in self._found  # which finds all that moves
        return Carriage(name, (inverse(seen_from), *self._steps(name)))

    def _steps(self, name: str, within: tuple[str, ...] = ()) -> tuple[Step, ...]:
        """From the world to what moves by itself; within: the parts that are carried by it at some time."""
        mover = self._movers[name]
        base = self._steps_to(mover.base, within)
        if isinstance(mover.of, PlacedRobot):
            return (*base, *_steps_of_link(mover.of, mover.link))
        found = (*base, *_steps_of_obstacle(mover.of))
        carries = self._carries_of(name)
        return (self._handed(name, carries, found, within),) if carries else found

    def _steps_to(self, place: Place, within: tuple[str, ...]) -> tuple[Step, ...]:
        return (*(self._steps(place.on, within) if place.on else ()), place.pose)

    def _carries_of(self, part: str) -> list[Carry]:
        """Who carries an obstacle, the first first."""
        own = (one for one in self.carries if one.part == part)
        return sorted(own, key=lambda one: one.window.start)

    def _handed(
        self, part: str, carries: list[Carry], first: tuple[Step, ...], within: tuple[str, ...]
    ) -> Handed:
        """A part that changes hands, which goes by some steps at first."""
        within = (*within, part)
        starts, ways = list[float](), [first]
        ends = [*(one.window.start for one in carries[1:]), np.inf]
        for carry, following in zip(carries, ends, strict=True):
            start, end, by = carry.window.start, carry.window.end, self._found.get(carry.by)
            if not isinstance(by, Place) or by.on in {*self.moved.values(), *within}:
                return Handed(np.array(starts), tuple(ways), start)
            carrier = self._steps_to(by, within)
            starts.append(start)
            ways.append((*carrier, inverse(_pose(carrier, start)) @ _pose(ways[-1], start)))
            if end < following:
                starts.append(end)
                ways.append((_pose(ways[-1], end),))
        return Handed(np.array(starts), tuple(ways))

    @cached_property
    def _movers(self) -> dict[str, _Mover]:
        return {}

    @cached_property
    def _found(self) -> dict[str, Place | str]:
        waiting: list[Obstacle | PlacedRobot] = [*self.obstacles, *self.robots]
        found: dict[str, Place | str] = {
            name: Place(link, np.eye(4)) for name, link in self.moved.items()
        }
        n_found = -1
        while len(found) > n_found:
            n_found, left = len(found), []
            for one in waiting:
                below = _below(one)
                if below is None or below in found:
                    found |= self._on(one, IN_WORLD if below is None else found[below])
                else:
                    left.append(one)
            waiting = left
        for one in waiting:
            why = f"is on {_below(one)!r}, which is not there, or has a program with a frame on this robot"
            found |= self._on(one, NotThere(why))
        return found

    def _on(self, one: Obstacle | PlacedRobot, base: Place | str) -> dict[str, Place | str]:
        """What one brings that is on a base, or on what has no place."""
        if isinstance(one, PlacedRobot):
            return dict(self._of_robot(one, base))
        if isinstance(base, str):
            return {one.name: base}
        if one.moves is None and not self._carries_of(one.name):
            return {one.name: base.on_it(_own_pose(one))}
        after = "hold" if one.moves is None else one.moves.timing.after
        return {one.name: self._mover(one.name, _Mover(one, base), after)}

    def _mover(self, name: str, mover: _Mover, after: str) -> Place | str:
        """The place of what moves by itself, from its first sample to its last and beyond."""
        if name in self.moved:
            return "has the name of a link that the program may move"
        if after != "hold":
            return f"does not stay where its table ends (after: {after})"
        if mover.base.on in self.moved.values():
            return f"moves by itself on {mover.base.on!r}, which the program moves"
        self._movers[name] = mover
        return Place(name, np.eye(4))

    def _of_robot(
        self, placed: PlacedRobot, base: Place | str
    ) -> Iterator[tuple[str, Place | str]]:
        """The links of a robot, which stand where no joint above them moves."""
        robot, asked = placed.robot, placed.trajectory
        if placed.mount is not None and not isinstance(base, str):
            base = base.on_it(placed.mount.pose)
        moving: set[str] = set()
        names, first = tuple[str, ...](), np.zeros((1, 0))
        if asked is not None:
            names, first = asked.joint_names, asked.positions[:1]
            goes = np.ptp(asked.positions, axis=0) > 0.0
            if asked.velocities is not None:
                goes |= asked.velocities.any(axis=0)
            moving = {name for name, does in zip(names, goes, strict=True) if does}
        local = link_poses(placed, moving_positions(placed, names, first))[0]
        above = {joint.child: joint.parent for joint in robot.joints}
        for i, link in enumerate(robot.link_names):
            name, carrier = f"{robot.name}/{link}", link
            while carrier in above and not moving & _masters(placed, above[carrier], carrier):
                carrier = above[carrier]
            if isinstance(base, str) or carrier not in above:
                yield name, base if isinstance(base, str) else base.on_it(local[i])
                continue
            own = self._link(placed, base, carrier)
            on_carrier = inverse(local[robot.link_names.index(carrier)]) @ local[i]
            yield name, own if isinstance(own, str) else own.on_it(on_carrier)

    def _link(self, placed: PlacedRobot, base: Place, link: str) -> Place | str:
        """The place of a link right below a joint that a table moves."""
        asked = placed.given_trajectory
        if asked.corners:
            return "moves by a program with corner zones, in which it may be elsewhere"
        if asked.unproven:
            return "moves by a program, part of which is not proven"
        if asked.not_measured:
            return "is not measured all the time (gaps: not_measured)"
        mover = _Mover(placed, base, link)
        return self._mover(f"{placed.robot.name}/{link}", mover, placed.timing.after)


def _masters(placed: PlacedRobot, parent: str, child: str) -> set[str]:
    """The joints that a link follows, seen from its parent."""
    return {joint.name for joint in chain_between(placed.robot, parent, child).masters}


def _below(one: Obstacle | PlacedRobot) -> str | None:
    return None if one.mount is None else one.mount.on


def _own_pose(one: Obstacle) -> np.ndarray:
    """(4, 4) [m] in the world, or on what it is on."""
    return one.world_from_body if one.mount is None else one.mount.pose


def _pose(steps: Sequence[Step], time: float) -> np.ndarray:
    """(4, 4) at the end of steps at a time [s]."""
    return np.asarray(series_of(steps, np.array([time]), np.ones(1)).poses[0])


def _steps_of_obstacle(one: Obstacle) -> Iterator[Step]:
    """From what an obstacle is on, or the world, to the obstacle by its own table."""
    if one.moves is None or one.mount is not None:
        yield _own_pose(one)
    if one.moves is not None:
        yield from steps_of_poses(knots_of_poses(one.moves))


def _steps_of_link(placed: PlacedRobot, link: str) -> Iterator[Step]:
    """From what a robot stands on to a link that its table moves."""
    chain: KinematicChain = chain_between(placed.robot, placed.robot.link_names[0], link)
    knots, names = knots_of_motion(kinematic_motion(placed)), _columns(placed)
    off = placed.given_trajectory.path_error
    yield placed.world_from_base
    for joint in chain.joints:
        yield from steps_of_joint(joint, knots, names[chain.masters[joint.column].name], off)
    yield chain.end


def _columns(placed: PlacedRobot) -> dict[str, int]:
    return {joint.name: i for i, joint in enumerate(placed.robot.moving_joints)}
