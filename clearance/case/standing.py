"""Where all is that frames of a program may be on: what stands as long as a case runs, and what the program moves.

Obstacles stand, links that no trajectory moves, and what rides on those. Not for: the frames (`program`).
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import NamedTuple

import numpy as np

from clearance.world.case import PlacedRobot
from clearance.world.kinematic_chain import chain_between
from clearance.world.kinematics import link_poses, moving_positions


class Rider(NamedTuple):
    """An obstacle: its pose (4, 4) [m] in the world, or on what it is on. moves: it has a motion of its own."""

    name: str
    on: str | None
    pose: np.ndarray
    moves: bool


class Place(NamedTuple):
    """Where something is: its pose (4, 4) [m] on a link that the program moves; in the world if that is empty."""

    link: str
    pose: np.ndarray

    def on_it(self, pose: np.ndarray) -> Place:
        """The place of a pose (4, 4) that is given on this one."""
        return Place(self.link, self.pose @ pose)


IN_WORLD = Place("", np.eye(4))


def standing_frames(
    robots: Sequence[PlacedRobot], obstacles: Iterable[Rider], moved: Mapping[str, str]
) -> dict[str, Place | None]:
    """Where all is, by name; None for what is there and may move otherwise than the program says.

    Args:
        robots: as the links of several robots are called; those with a program left out, and what it drives.
        moved: the links that the program may move, by all names that they have.
    """
    waiting: list[Rider | PlacedRobot] = [*obstacles, *robots]
    found: dict[str, Place | None] = {name: Place(link, np.eye(4)) for name, link in moved.items()}
    n_found = -1
    while len(found) > n_found:
        n_found, left = len(found), []
        for one in waiting:
            below = _below(one)
            if below is None or below in found:
                found |= _on(one, IN_WORLD if below is None else found[below])
            else:
                left.append(one)
        waiting = left
    for one in waiting:
        found |= _on(one, None)
    return found


def _on(one: Rider | PlacedRobot, base: Place | None) -> dict[str, Place | None]:
    """What one brings that is on a base, which may move if it is None."""
    if isinstance(one, PlacedRobot):
        return dict(_of_robot(one, base))
    return {one.name: None if base is None or one.moves else base.on_it(one.pose)}


def _below(one: Rider | PlacedRobot) -> str | None:
    if isinstance(one, PlacedRobot):
        return None if one.mount is None else one.mount.on
    return one.on


def _of_robot(placed: PlacedRobot, base: Place | None) -> Iterator[tuple[str, Place | None]]:
    """The links of a robot, which stand where no joint above them moves."""
    asked, root = placed.trajectory, placed.robot.link_names[0]
    moving: set[str] = set()
    names, first = tuple[str, ...](), np.zeros((1, 0))
    if asked is not None:
        names, first = asked.joint_names, asked.positions[:1]
        goes = np.ptp(asked.positions, axis=0) > 0.0
        if asked.velocities is not None:
            goes |= asked.velocities.any(axis=0)
        moving = {name for name, does in zip(names, goes, strict=True) if does}
    local = link_poses(placed, moving_positions(placed, names, first))[0]
    for i, link in enumerate(placed.robot.link_names):
        masters = {joint.name for joint in chain_between(placed.robot, root, link).masters}
        own = None if base is None or masters & moving else base.on_it(local[i])
        yield f"{placed.robot.name}/{link}", own
