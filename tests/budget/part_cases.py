"""Arms and gantries that carry a cube, so simple that the worst of their errors is worked out by hand."""

from __future__ import annotations

import numpy as np

import clearance as cl
from clearance.world.body import Body, Mount, Obstacle
from clearance.world.budget import Budget, JointTolerance, RobotTolerance
from clearance.world.case import Case
from clearance.world.placed_robot import PlacedRobot
from clearance.world.robot import Joint, JointKind, Robot
from clearance.world.trajectory import Trajectory
from tests.budget.budget_cases import X, Z, bar
from tests.made_cases import at

OUT, HALF, THIN = 0.9, 0.05, 0.01
"""[m] How far from the axis the cube is gripped; half of its edges; half of what a bar is thick."""

QUARTER = 0.5 * np.pi

END = OUT - 0.5 - HALF
"""[m] Where a face of the cube is when a gantry has slid it."""


def robot(name: str, kind: JointKind, axis: np.ndarray, lift: float = 0.0) -> Robot:
    """One joint `j`, and a bar that ends before the cube, or `lift` [m] above it."""
    joint = Joint("j", kind, "base", "bar", at(), axis)
    shape = bar(0.5, 2.0 * THIN).transformed(at(0.0, 0.0, lift))
    return Robot(name, ("base", "bar"), (joint,), (Body("bar", shape),))


def driven(one: Robot, positions, base: np.ndarray | None = None) -> PlacedRobot:
    """A robot whose joint is at these positions, second by second."""
    rows = np.asarray(positions, dtype=float)[:, None]
    table = Trajectory(np.arange(float(len(rows))), ("j",), rows)
    return PlacedRobot(one, table, at() if base is None else base)


def arm(name: str, *positions: float) -> PlacedRobot:
    """Turns about z."""
    return driven(robot(name, JointKind.REVOLUTE, Z), positions)


def gantry(name: str, *positions: float, lift: float = 3.0) -> PlacedRobot:
    """Slides along x, far above all else."""
    return driven(robot(name, JointKind.PRISMATIC, X, lift), positions)


def cube(name: str = "part", pose: np.ndarray | None = None, mount: Mount | None = None):
    """Stands `OUT` along x unless it rides on something."""
    body = Body(name, cl.box([2.0 * HALF] * 3))
    if mount is not None:
        return Obstacle(body, mount=mount)
    return Obstacle(body, at(OUT) if pose is None else pose)


def wall(x: float) -> Obstacle:
    """A wall across x that ends there."""
    return Obstacle(Body("wall", cl.box([0.1, 3.0, 3.0])), at(x - 0.05))


def carried(by: str, start: float, end: float = np.inf, part: str = "part", **how) -> cl.Carry:
    """From when until when a part is."""
    return cl.Carry(part, by, cl.Window(start, end), **how)


def off_by(size: float, *robots: str) -> Budget:
    """The joints `j` of some robots leave their course by so much."""
    own = RobotTolerance({"j": JointTolerance(tracking=size)})
    return Budget(dict.fromkeys(robots or ("arm",), own))


def quarter_turn(gap: float, size: float, **how) -> Case:
    """The arm grips the cube and carries it a quarter turn, up to `gap` [m] from a wall."""
    return Case(
        "quarter turn",
        (arm("arm", 0.0, QUARTER),),
        (cube(), wall(-HALF - gap)),
        carries=(carried("bar", 0.0, **how),),
        tolerance=off_by(size),
    )


def turned_face(angle: float) -> float:
    """[m] By how much the cube gets nearer to that wall when it is turned about the post by `angle` [rad]."""
    return (OUT + HALF) * np.sin(angle) - HALF * (1.0 - np.cos(angle))


def passing(gap: float, **how) -> Case:
    """The cube is laid down after a quarter turn; a second robot's bar passes its face at `gap` [m]."""
    passer = robot("right", JointKind.PRISMATIC, Z)
    right = driven(passer, [3.0, 3.0, 0.0], at(-HALF - gap - 0.5, OUT))
    return Case(
        "passing",
        (arm("left", 0.0, QUARTER, QUARTER), right),
        (cube(),),
        carries=(carried("left/bar", 0.0, 1.0, **how),),
        tolerance=off_by(0.03, "left"),
    )


def turned_past(gap: float, angle: float) -> float:
    """[m] What is left there when the cube was turned about the post by `angle` [rad]."""
    return (gap + HALF) * np.cos(angle) - HALF - (OUT + THIN) * np.sin(angle)


def slid(budget: Budget, *carries: cl.Carry, robots=None, obstacles=None) -> Case:
    """A gantry slides the cube by -0.5 m, up to 0.1 m before a wall, unless others are given."""
    return Case(
        "slid",
        robots or (gantry("arm", 0.0, -0.5),),
        (*(obstacles or (cube(),)), wall(END - 0.1)),
        carries=carries or (carried("bar", 0.0),),
        tolerance=budget,
    )
