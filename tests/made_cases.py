"""Bodies made to measure for tests, beside those of `scripts/makers/hostile_cases.py`, which are here by name too.

Not for: exact answers (tests/oracle).
"""

from __future__ import annotations

import itertools
from collections.abc import Callable, Sequence

import numpy as np

from clearance.geometry.polyhedron import Polyhedron
from clearance.geometry.shapes import box
from clearance.kernels.arithmetic.lanes import WIDTH
from clearance.kernels.mesh.surface import Surface
from clearance.world.body import Body
from clearance.world.case import Case
from clearance.world.placed_robot import PlacedRobot
from clearance.world.robot import Joint, JointKind, Mimic, Robot
from clearance.world.trajectory import Trajectory
from scripts.makers.hostile_cases import (
    WORST,
    arm,
    arm_among_obstacles,
    at,
    ball,
    flying,
    spindle,
    torus,
)

__all__ = (
    "SOLIDS", "WORST", "arm", "arm_among_obstacles", "at", "ball", "corners_moved", "dented", "driven",
    "faces_below", "faces_of", "flying", "l_prism", "prism", "random_robot", "resampled", "spindle", "torus",
    "with_copies",
)  # fmt: skip


def corners_moved(shape: Polyhedron, vertices: np.ndarray) -> Polyhedron:
    """The faces of a shape between other corners (n, 3)."""
    return Polyhedron(vertices, faces_of(shape))


def dented(
    random: np.random.Generator, n_halvings: int = 1, depth: float = 0.6, radius: float = 1.0
) -> Polyhedron:
    """A ball whose corners are pushed in and out: ridges, valleys and saddles."""
    shape = ball(radius, n_halvings)
    pushed = random.uniform(1.0 - depth, 1.0 + depth, (len(shape.vertices), 1))
    return corners_moved(shape, shape.vertices * pushed)


SOLIDS: dict[str, Callable[[np.random.Generator], Polyhedron]] = {
    "ball": lambda random: ball(1.0, 2),
    "dented": lambda random: dented(random, 2),
    "box": lambda random: box(random.uniform(0.2, 2.0, 3)),
    "ring": lambda random: torus(0.8, 0.3, 12, 8),
}
"""Solids of about one size, smooth, rough, angular and with a hole."""


def faces_of(shape: Polyhedron) -> list[list[int]]:
    """The vertex indices of each face, as the oracle takes them."""
    return [shape.face_vertices[i:j].tolist() for i, j in itertools.pairwise(shape.face_starts)]


def l_prism() -> Polyhedron:
    """An L of legs 2 along x and 3 along y, 1 wide and 1 thick: convex faces only, one concave edge."""
    rim = [(0, 0), (2, 0), (2, 1), (1, 1), (1, 3), (0, 3)]
    points = np.array([(x, y, z) for z in (0.0, 1.0) for x, y in rim])
    caps = [[6, 7, 8, 9], [6, 9, 10, 11], [3, 2, 1, 0], [5, 4, 3, 0]]
    return Polyhedron(points, caps + [[i, (i + 1) % 6, (i + 1) % 6 + 6, i + 6] for i in range(6)])


def prism(radius: float, height: float, n: int = 64) -> Polyhedron:
    """An upright prism about the origin, its two caps of `n` corners first, so that they own all corners."""
    angles = 2.0 * np.pi * np.arange(n) / n
    ring = radius * np.stack([np.cos(angles), np.sin(angles)], axis=1)
    low, high = (np.column_stack([ring, np.full(n, z)]) for z in (-0.5 * height, 0.5 * height))
    sides = [(i, (i + 1) % n, n + (i + 1) % n, n + i) for i in range(n)]
    faces = [tuple(range(n))[::-1], tuple(range(n, 2 * n)), *sides]
    return Polyhedron(np.concatenate([low, high]), faces)


def with_copies(shape: Polyhedron, faces: Sequence[int], *, turned_round: bool) -> Polyhedron:
    """The shape with some of its faces once more, each from another corner on."""
    copies = [np.roll(faces_of(shape)[face], 1 + face % 2) for face in faces]
    return Polyhedron(
        shape.vertices, faces_of(shape) + [tuple(f[::-1] if turned_round else f) for f in copies]
    )


def faces_below(surface: Surface) -> list[set[int]]:
    """For each node of the tree the faces below it."""
    below: list[set[int]] = [set() for _ in surface.children]
    for node in reversed(range(len(surface.children))):
        first, count = surface.children[node]
        if count == 0:
            below[node] = {int(first)}
        elif count > 0:
            below[node] = set().union(*below[WIDTH * first : WIDTH * first + count])
    return below


def driven(
    shape: Polyhedron,
    kind: JointKind,
    positions: Sequence[float],
    *,
    axis: Sequence[float] = (0.0, 0.0, 1.0),
    velocities: Sequence[float] | None = None,
    base: np.ndarray | None = None,
    name: str = "robot",
    link: str = "tool",
) -> PlacedRobot:
    """A robot of one body, a link on the joint `joint` of its base, at these positions second by second."""
    joint = Joint("joint", kind, "base", link, np.eye(4), np.array(axis, dtype=float))
    rates = None if velocities is None else np.array(velocities, dtype=float)[:, None]
    rows = np.array(positions, dtype=float)[:, None]
    path = Trajectory(np.arange(float(len(rows))), ("joint",), rows, rates)
    robot = Robot(name, ("base", link), (joint,), (Body(link, shape),))
    return PlacedRobot(robot, path, np.eye(4) if base is None else base)


def resampled(case: Case, times: np.ndarray) -> Case:
    """The case of one robot at other times, on the lines between its samples."""
    asked = case.robots[0].given_trajectory
    columns = [np.interp(times, asked.times, column) for column in asked.positions.T]
    return case.with_trajectory(times, np.column_stack(columns), joint_names=asked.joint_names)


def random_robot(
    rng: np.random.Generator, n_joints: int, *, sizes: Sequence[float] = (0.5,), mimics: float = 0.0
) -> Robot:
    """A chain of joints of any kind, turned and shifted at random.

    Args:
        sizes: [m] one of them bounds each shift along an axis.
        mimics: share of the moving joints that follow one before, which may follow another.
    """
    joints: list[Joint] = []
    for i in range(n_joints):
        offset = np.eye(4)
        offset[:3, :3] = np.linalg.qr(rng.normal(size=(3, 3)))[0]
        offset[:3, :3] *= np.sign(np.linalg.det(offset[:3, :3]))
        offset[:3, 3] = rng.uniform(-1.0, 1.0, 3) * rng.choice(sizes)
        kind = JointKind(
            rng.choice(["revolute", "continuous", "prismatic", "fixed"], p=[0.4, 0.1, 0.3, 0.2])
        )
        axis = rng.normal(size=3)
        axis /= np.linalg.norm(axis)
        before = [joint.name for joint in joints if joint.kind is not JointKind.FIXED]
        mimic = None
        if before and kind is not JointKind.FIXED and rng.random() < mimics:
            mimic = Mimic(str(rng.choice(before)), *rng.uniform(-2.0, 2.0, 2))
        joints.append(Joint(f"j{i}", kind, f"l{i}", f"l{i + 1}", offset, axis, mimic=mimic))
    return Robot("robot", tuple(f"l{i}" for i in range(n_joints + 1)), tuple(joints), ())
