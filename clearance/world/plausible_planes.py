"""Warnings on boxes that stand for infinite planes, where something may get past their end."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from clearance.errors import NothingToMeasure
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
from clearance.world.pairs import OBSTACLE, BodyIndex, measured_pairs
from clearance.world.whereabouts import Place, bases_of, ground_of, obstacle_place

END = 0.5 * PLANE_SIZE[0]
"""[m] From the middle of a box that stands for a plane."""

DEPTHS = PLANE_SIZE[2], 1.0
"""[m] Such a box is as deep; those in scenes that earlier releases have converted are 1 m deep."""


class Mover(NamedTuple):
    """A robot or an obstacle that moves.

    Attributes:
        thing: which, as `BodyIndex.thing`. origins: (n, 4) [m] in the world, between which its own frame gets.
        reach: [m] no point of it, or of a part that it holds, is farther from them.
    """

    name: str
    thing: tuple[bool, int]
    origins: np.ndarray
    reach: float


def notices_on_planes(case: Case) -> Iterator[Notice]:
    """A warning on each plane that a robot, a moving obstacle, or a part in a hand may get past the end of."""
    # a part may get as far as what carries it, and its length
    without = replace(case, carries=()) if case.carries else case
    for plane, name, place in _planes(without):
        plane_from_world = np.linalg.inv(place.pose)
        found = []
        for mover in _movers(without, _longest_part(case)):
            local = np.abs(mover.origins @ plane_from_world.T)[:, :2].max()
            farthest = float(local) + mover.reach + place.travel
            if farthest > END and _is_measured(case, plane, mover.thing):
                found.append((farthest, f"{mover.name} may get {metres(farthest)} m from there"))
        if found:
            who = listed([text for _, text in greatest(found)])
            ends = f"stands for a plane without end, and ends {metres(END)} m from its middle"
            yield Notice(Severity.WARNING, "plane", f"{name} {ends}: {who}")


def _planes(case: Case) -> Iterator[tuple[BodyIndex, str, Place]]:
    """The boxes that stand for planes."""
    for i, (placed, base) in enumerate(zip(case.robots, bases_of(case), strict=True)):
        for k, body in enumerate(placed.robot.bodies):
            if body.name == own_floor(placed) and length_of(body) >= PLANE_SIZE[0]:
                yield BodyIndex(i, k), f"link {case.prefix_of(placed) + body.name!r}", base
    for i, obstacle in enumerate(case.obstacles):
        sides = np.ptp(obstacle.body.shape.bounds, axis=0)
        if sides[0] > END and any(np.allclose(sides, (*PLANE_SIZE[:2], one)) for one in DEPTHS):
            yield BodyIndex(OBSTACLE, i), f"obstacle {obstacle.name!r}", obstacle_place(case, i)


def _movers(case: Case, held: float) -> Iterator[Mover]:
    """All that moves; with a part of a length [m] in its hand."""
    for i, (placed, base) in enumerate(zip(case.robots, bases_of(case), strict=True)):
        reach = reach_of(placed) + held + base.travel
        yield Mover(f"robot {placed.robot.name!r}", (False, i), base.pose[None, :, 3], reach)
    for i, one in enumerate(case.obstacles):
        if not one.stands:
            ground = ground_of(case, i)
            places = np.zeros((1, 3)) if one.moves is None else one.moves.positions
            origins = np.column_stack([places, np.ones(len(places))]) @ ground.pose.T
            reach = farthest_corner(one.body) + held + ground.travel
            yield Mover(f"obstacle {one.name!r}", (True, i), origins, reach)


def _is_measured(case: Case, plane: BodyIndex, thing: tuple[bool, int]) -> bool:
    """True if a body of a robot, or an obstacle, is measured against a plane, as far as hands are empty."""
    if case.carries:
        return plane.thing != thing  # a part in a hand may be
    try:
        pairs, _ = measured_pairs(case)
    except NothingToMeasure:
        return False
    others = [pair.a if pair.b == plane else pair.b for pair in pairs if plane in pair]
    return any(other.thing == thing for other in others)


def _longest_part(case: Case) -> float:
    """[m] No two points of a part that is carried are farther apart."""
    parts = {carry.part for carry in case.carries}
    boxes = [one.body.shape.bounds for one in case.obstacles if one.name in parts]
    return max((float(np.linalg.norm(np.ptp(box, axis=0))) for box in boxes), default=0.0)
