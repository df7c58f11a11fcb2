"""Warnings on boxes that stand for infinite planes, where something may get past their end."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from clearance.world.case import Case
from clearance.world.extents import PLANE_SIZE, length_of, metres, own_floor, reach_of
from clearance.world.notice import Notice, Severity
from clearance.world.whereabouts import bases_of, obstacle_place


def notices_on_planes(case: Case) -> Iterator[Notice]:
    """A warning on each robot that may get past the end of a box that stands for an infinite plane."""
    for placed, base in zip(case.robots, bases_of(case), strict=True):
        reach = reach_of(placed)
        floors = [body for body in placed.robot.bodies if body.name == own_floor(placed)]
        ends = [(f"link {one.name!r}", reach) for one in floors if length_of(one) >= PLANE_SIZE[0]]
        for i, obstacle in enumerate(case.obstacles):
            sides = np.ptp(obstacle.body.shape.bounds, axis=0)
            if np.allclose(sides[:2], PLANE_SIZE[:2]):
                place = obstacle_place(case, i)
                gets = reach + base.travel + place.travel
                local = np.abs(place.pose[:3, :3].T @ (base.pose[:3, 3] - place.pose[:3, 3]))
                ends.append((f"obstacle {obstacle.name!r}", float(local[:2].max()) + gets))
        for name, farthest in ends:
            if farthest > 0.5 * PLANE_SIZE[0]:
                text = (
                    f"{name} stands for a plane without end, and ends {metres(0.5 * PLANE_SIZE[0])} m from its "
                    f"middle: robot {placed.robot.name!r} may get {metres(farthest)} m from there"
                )
                yield Notice(Severity.WARNING, "plane", text)
