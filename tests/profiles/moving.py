"""Small cases whose sweeps can be said in closed form."""

import numpy as np

from clearance.geometry.polyhedron import Polyhedron
from clearance.geometry.shapes import box
from clearance.sketch import Sketch
from clearance.world.body import Body
from clearance.world.case import Case
from clearance.world.placed_robot import PlacedRobot
from clearance.world.robot import Joint, JointKind, Robot
from clearance.world.trajectory import Trajectory

Z = np.array([0.0, 0.0, 1.0])


def shifted(shape, offset):
    """The shape moved by (3,) [m]."""
    pose = np.eye(4)
    pose[:3, 3] = offset
    return shape.transformed(pose)


def slab(low, high):
    """A box by its least and greatest corner."""
    low, high = np.array(low, float), np.array(high, float)
    return shifted(box(high - low), 0.5 * (low + high))


def joint(i, kind, axis, offset=(0.0, 0.0, 0.0)):
    """The joint between l(i) and l(i + 1)."""
    pose = np.eye(4)
    pose[:3, 3] = offset
    return Joint(f"j{i}", kind, f"l{i}", f"l{i + 1}", pose, np.array(axis, float))


def moved(joints, shapes, positions, velocities=None, times=None):
    """The case of a chain of joints; shapes by the number of the link."""
    positions = np.atleast_2d(np.array(positions, float))
    names = tuple(f"l{i}" for i in range(len(joints) + 1))
    bodies = tuple(Body(f"l{i}", shape) for i, shape in sorted(shapes.items()))
    robot = Robot("robot", names, tuple(joints), bodies)
    times = np.arange(len(positions), dtype=float) if times is None else np.array(times, float)
    asked = Trajectory(times, tuple(j.name for j in joints), positions, velocities)
    return Case("made", (PlacedRobot(robot, asked),), ())


def turning(shape, angles):
    """The shape turning about z through the angles."""
    return moved([joint(0, JointKind.REVOLUTE, Z)], {1: shape}, np.array(angles)[:, None])


def sliding(shape, ways, axis=(1.0, 0.0, 0.0)):
    """The shape sliding along an axis."""
    return moved([joint(0, JointKind.PRISMATIC, axis)], {1: shape}, np.array(ways)[:, None])


def tetrahedron(rng, size):
    """A random closed tetrahedron, outward."""
    return Polyhedron(
        size * rng.uniform(-1, 1, (4, 3)), [[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]]
    ).outward()


def rows(profile):
    """The contours as the oracle takes them."""
    return [np.column_stack([c.vertices, c.bulges]).tolist() for c in profile.contours]


def drawn(*outlines):
    """A sketch of closed outlines, segments from corner to corner."""
    sketch = Sketch()
    for corners in outlines:
        points = [sketch.point(*corner) for corner in corners]
        for one, other in zip(points, [*points[1:], points[0]], strict=True):
            sketch.segment(one, other)
    return sketch


def free_circle(radius):
    """A sketch of a circle about the origin, whose radius is free."""
    sketch = Sketch()
    sketch.radius(sketch.circle(sketch.point(0.0, 0.0), radius), radius, name="r", driven=True)
    return sketch
