"""A small cell made without any file, in which everything moves: two sliders over a table, a door, a part that is
picked up, handed over and let go, a robot that comes and goes, rules with windows, and padding.

Everything slides along x or z at z = 0.5 [m], so every clearance can be worked out by hand.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

import clearance as cl
from clearance.world.body import Body, Mount, Obstacle
from clearance.world.carry import Carry
from clearance.world.case import Case, Limits
from clearance.world.notice import NOT_MEASURED
from clearance.world.placed_robot import PlacedRobot
from clearance.world.pose_table import PoseTable
from clearance.world.robot import Joint, JointKind, Robot
from clearance.world.rules import Allowance, Rule
from clearance.world.timing import Timing, Window
from clearance.world.trajectory import Hole, Trajectory
from tests.made_cases import at

UNTURNED = (0.0, 0.0, 0.0, 1.0)


def slider(name: str, axis=(1.0, 0.0, 0.0), size=(0.1, 0.1, 0.1)) -> Robot:
    """One box on one slide."""
    joint = Joint("s", JointKind.PRISMATIC, "base", "tool", np.eye(4), np.array(axis), -5.0, 5.0)
    return Robot(name, ("base", "tool"), (joint,), (Body("tool", cl.box(size)),))


def sliding(name: str, samples, base=None, **changes) -> PlacedRobot:
    """A slider that follows samples of (time [s], place [m]); `changes` are fields of it."""
    times, places = np.array(samples, dtype=float).T
    pose = {} if "mount" in changes else {"world_from_base": at(z=0.5) if base is None else base}
    return PlacedRobot(slider(name), Trajectory(times, ("s",), places[:, None]), **pose | changes)


def table_of(samples, **timing) -> PoseTable:
    """Poses without a turn at (time, x, y, z)."""
    rows = np.array(samples, dtype=float)
    turns = np.tile(UNTURNED, (len(rows), 1))
    return PoseTable(rows[:, 0], rows[:, 1:], turns, Timing(**timing))


def box(name: str, size, pose=None, **changes) -> Obstacle:
    """A box that stands, or what `changes` make of it."""
    given = {} if pose is None else {"world_from_body": pose}
    return Obstacle(Body(name, cl.box(size)), **given | changes)


LEFT = [(0, 0), (1, 1), (2, 1), (3, 0), (4, 0)]
RIGHT = [(0, 3), (1, 3), (2, 1.2355), (3, 3), (4, 3)]
RULES = (
    Rule(("left/tool", "fence"), name="fence", fail=0.005, warn=0.5),
    Rule(("part", "*"), while_carried="part", name="held <part>", fail=0.02, warn=0.04),
    Rule(("right/*", "part"), window=Window(1.5, 2.5), name="handover", fail=0.0002, warn=0.0004),
)


def cell(rules=RULES, robots=None, obstacles=None, carries=None, **changes) -> Case:
    """The cell: left brings the part to right, which takes it away; a door swings by, a cart comes and goes."""
    robots = robots or (
        sliding("left", LEFT, padding={"tool": 0.002}),
        sliding("right", RIGHT),
    )
    obstacles = obstacles or (
        box("part", (0.05, 0.05, 0.05), at(1.16, 0, 0.5)),
        box("table", (4, 4, 0.1)),
        box("fence", (0.1, 1.0, 1.0), at(-0.104, 0, 0.6)),
        box(
            "door",
            (0.4, 0.05, 0.8),
            moves=table_of([(0, 1, 0.9, 0.6), (2, 1.4, 0.5, 0.6), (4, 1, 0.9, 0.6)]),
        ),
        box(
            "cart",
            (0.3, 0.3, 0.2),
            moves=table_of([(1, 0.2, -1, 0.2), (3, 1.6, -1, 0.2)], after="absent"),
        ),
        box("crate", (0.1, 0.1, 0.1), mount=Mount("cart", at(z=0.17))),
    )
    if carries is None:
        carries = (
            Carry("part", "left/tool", Window(1.0, 2.0)),
            Carry("part", "right/tool", Window(2.0)),
        )
    limits = Limits(0.0, 0.01, rules=rules)
    return Case(
        "two <sliders> & a door",
        tuple(robots),
        tuple(obstacles),
        limits,
        carries=carries,
        **changes,
    )


def with_a_hole() -> Case:
    """A slider of which nothing is known from 0.3 to 1.1 s passes a post that stands in between."""
    placed = sliding("arm", [(0.1 * i, 0.1 * i) for i in (0, 1, 2, 3, 11, 12, 13)])
    hole = Hole(("s",), placed.trajectory.times[3], placed.trajectory.times[4], 0.1, NOT_MEASURED)
    placed = replace(placed, trajectory=replace(placed.trajectory, holes=(hole,)))
    return Case("gap", (placed,), (box("post", (0.1,) * 3, at(0.7, z=0.5)),))


__all__ = ["Allowance", "box", "cell", "slider", "sliding", "table_of", "with_a_hole"]
