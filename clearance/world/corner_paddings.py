"""What corner zones take of clearances: while one is passed, the links of its robot are padded by how far they
may be off.

Not for: how far that is (room `programs`).
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np

from clearance.errors import BadProgram, BadTime
from clearance.world.body import Obstacle
from clearance.world.case import Case
from clearance.world.extents import farthest_corner
from clearance.world.forest import links_by_name, owner_of, resolved_mount
from clearance.world.pairs import BodyIndex
from clearance.world.phase import Phase
from clearance.world.placed_robot import PlacedRobot
from clearance.world.timing import Window, time_text
from clearance.world.trajectory import CornerZone


def corner_windows(case: Case) -> list[tuple[int, CornerZone, Window]]:
    """The corner zones of all robots, by robot, and when they are passed [s] of the run.

    Raises:
        BadInput: a robot that repeats its program, or carries another. BadTime: a part that is picked up or let
            go of in a zone.
    """
    found = [
        (i, zone, _window(placed, zone))
        for i, placed in enumerate(case.robots)
        if placed.trajectory is not None
        for zone in placed.trajectory.corners
    ]
    for i, _, window in found:
        _require_alone(case, i)
        for carry in case.carries:
            for end in carry.window.ends:
                if window.start < end < window.end:
                    raise BadTime(
                        f"part {carry.part!r} changes hands at {time_text(end)} s, in a corner zone",
                        where="carry",
                        valid="a move that stops there (no zone)",
                    )
    return found


def with_corner_paddings(
    phases: Sequence[Phase], windows: Sequence[tuple[int, CornerZone, Window]]
) -> list[Phase]:
    """The phases, in which bodies are padded by how far the corner zones passed let them be off."""
    found = []
    for phase in phases:
        case = phase.case
        for i_robot, zone, window in windows:
            if window.holds(*phase.span):
                case = _padded(case, i_robot, zone)
        found.append(phase if case is phase.case else replace(phase, case=case))
    return found


def corner_off(case: Case, phase: Phase, body: BodyIndex) -> float:
    """[m] How far a body of a case may be off its nominal motion in a phase, since a corner zone is passed."""
    return body.padding_in(phase.case) - body.padding_in(case)


def _window(placed: PlacedRobot, zone: CornerZone) -> Window:
    if placed.timing.after == "loop":
        raise BadProgram("a program with corner zones repeats (after: loop)", valid="after: hold")
    return Window(*map(float, placed.timing.run_times(np.array([zone.start, zone.end]))))


def _require_alone(case: Case, i_robot: int) -> None:
    for other in case.robots:
        if other.mount is not None and owner_of(case, other.mount) == (False, i_robot):
            raise BadProgram(
                f"robot {other.robot.name!r} stands on one whose program has corner zones",
                valid="a program without zones",
            )


def _padded(case: Case, i_robot: int, zone: CornerZone) -> Case:
    placed = case.robots[i_robot]
    padding = dict(placed.padding)
    for name, off in _off(placed, zone):
        padding[name] = padding.get(name, 0.0) + off
    robots = list(case.robots)
    robots[i_robot] = replace(placed, padding=padding)
    obstacles = [
        replace(one, padding=one.padding + _off_on_link(case, i_robot, zone, one))
        if one.mount is not None
        else one
        for one in case.obstacles
    ]
    return replace(case, robots=tuple(robots), obstacles=tuple(obstacles))


def _off(placed: PlacedRobot, zone: CornerZone) -> Iterator[tuple[str, float]]:
    """Each link with a shape that may be off, and by how much [m]."""
    for body in placed.robot.bodies:
        if body.name in zone.links:
            yield body.name, zone.links[body.name].at(farthest_corner(body))


def _off_on_link(case: Case, i_robot: int, zone: CornerZone, obstacle: Obstacle) -> float:
    """[m] How far an obstacle may be off that rides on the robot: 0 where it does not."""
    assert obstacle.mount is not None
    if owner_of(case, obstacle.mount) != (False, i_robot):
        return 0.0
    if obstacle.moves is not None:
        raise BadProgram(
            f"obstacle {obstacle.name!r} moves on a robot whose program has corner zones",
            valid="a program without zones",
        )
    mount = resolved_mount(case, obstacle.mount)
    link = case.robots[i_robot].robot.link_names[links_by_name(case)[mount.on][1]]
    if link not in zone.links:
        return 0.0
    return zone.links[link].at(
        float(np.linalg.norm(mount.pose[:3, 3])) + farthest_corner(obstacle.body)
    )
