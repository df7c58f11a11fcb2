"""Small machines whose least change is known by hand: a block on slides along x and y, past walls and balls."""

import numpy as np

import clearance as cl
from clearance.world.robot import Joint, JointKind
from tests.made_cases import at

X, Y = np.eye(3)[:2]


def gantry(name="gantry", size=(0.1, 0.1, 0.1), y_range=(-np.inf, np.inf)):
    """A block that slides along x and y."""
    joints = (
        Joint("x", JointKind.PRISMATIC, "base", "cart", np.eye(4), X),
        Joint("y", JointKind.PRISMATIC, "cart", "tool", np.eye(4), Y, *y_range),
    )
    return cl.Robot(name, ("base", "cart", "tool"), joints, (cl.Body("tool", cl.box(size)),))


def along_x(robot, times=None, start=-1.0, end=1.0, y=0.0, base=(0.0, 0.0, 0.0)):
    """The block goes along x, 1 s."""
    times = np.linspace(0.0, 1.0, 41) if times is None else times
    positions = np.stack([np.linspace(start, end, len(times)), np.full(len(times), y)], axis=1)
    return cl.PlacedRobot(robot, cl.Trajectory(times, ("x", "y"), positions), at(*base))


def standing(name, shape, xyz):
    """An obstacle at a place."""
    return cl.Obstacle(cl.Body(name, shape), at(*xyz))


def slot(fail=0.04, off=0.03, shift=(0.0, 0.0, 0.0)):
    """A bar through a slot, off its middle: 0.05 less `off` is left on the side of y, more on the other."""
    bar = gantry(size=(0.4, 0.1, 0.1))
    wall = cl.box((0.5, 0.4, 2.0))
    walls = [
        standing(name, wall, np.add((0.0, y, 0.0), shift))
        for name, y in (("left", 0.3), ("right", -0.3))
    ]
    placed = along_x(bar, y=off, base=shift)
    return cl.Case("slot", (placed,), tuple(walls), cl.Limits(fail=fail))


def crossing(fail=0.1):
    """Two blocks that cross at the origin at the same time, one along x, one along y."""
    one = along_x(gantry("one"))
    times = one.trajectory.times
    positions = one.trajectory.positions[:, ::-1].copy()
    other = cl.PlacedRobot(gantry("other"), cl.Trajectory(times, ("x", "y"), positions))
    return cl.Case("crossing", (one, other), (), cl.Limits(fail=fail))
