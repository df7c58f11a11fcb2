"""Warnings on boxes that stand for infinite planes, where something may get past their end."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from clearance.world.case import Case
from clearance.world.extents import (
    PLANE_SIZE,
    farthest_corner,
    greatest,
    length_of,
    metres,
    own_floor,
    reach_of,
)
from clearance.world.notice import Notice, Severity, listed
from clearance.world.whereabouts import Place, bases_of, obstacle_place

END = 0.5 * PLANE_SIZE[0]
"""[m] From the middle of a box that stands for a plane."""


def notices_on_planes(case: Case) -> Iterator[Notice]:
    """A warning on each plane that a robot, a moving obstacle, or a part in a hand may get past the end of."""
    without = replace(case, carries=())  # a part may get as far as what carries it, and its length
    for name, plane in _planes(without):
        from_plane = np.linalg.inv(plane.pose)
        found = []
        for who, place, reach in _movers(without, _longest_part(case)):
            local = np.abs(from_plane @ place.pose[:, 3])[:2].max()
            farthest = float(local) + reach + place.travel + plane.travel
            if farthest > END and who != name:
                found.append((farthest, f"{who} may get {metres(farthest)} m from there"))
        if found:
            who = listed([text for _, text in greatest(found)])
            ends = f"stands for a plane without end, and ends {metres(END)} m from its middle"
            yield Notice(Severity.WARNING, "plane", f"{name} {ends}: {who}")


def _planes(case: Case) -> Iterator[tuple[str, Place]]:
    """The boxes that stand for planes."""
    for placed, base in zip(case.robots, bases_of(case), strict=True):
        for body in placed.robot.bodies:
            if body.name == own_floor(placed) and length_of(body) >= PLANE_SIZE[0]:
                yield f"link {case.prefix_of(placed) + body.name!r}", base
    for i, obstacle in enumerate(case.obstacles):
        sides = np.ptp(obstacle.body.shape.bounds, axis=0)
        if np.allclose(sides[:2], PLANE_SIZE[:2]):
            yield f"obstacle {obstacle.name!r}", obstacle_place(case, i)


def _movers(case: Case, held: float) -> Iterator[tuple[str, Place, float]]:
    """What moves, and how far [m] it, and a part that it holds, gets from its place."""
    for placed, base in zip(case.robots, bases_of(case), strict=True):
        yield f"robot {placed.robot.name!r}", base, reach_of(placed) + held
    for i, one in enumerate(case.obstacles):
        if not one.stands:
            yield (
                f"obstacle {one.name!r}",
                obstacle_place(case, i),
                farthest_corner(one.body) + held,
            )


def _longest_part(case: Case) -> float:
    """[m] No two points of a part that is carried are farther apart."""
    parts = {carry.part for carry in case.carries}
    boxes = [one.body.shape.bounds for one in case.obstacles if one.name in parts]
    return max((float(np.linalg.norm(np.ptp(box, axis=0))) for box in boxes), default=0.0)
