"""Cases in contact, made of those that are apart: an obstacle is pushed into the path, a link through a torus.

Not for: measuring (`contact`).
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from inputs import SHARED

from clearance import Polyhedron, box, load_case
from clearance.simulate.measure.layout import PairsInMotion
from clearance.simulate.measure.measure import measure
from clearance.simulate.measure.resources import Resources
from clearance.world.body import Body, Obstacle
from clearance.world.case import Case, PlacedRobot
from clearance.world.motion import kinematic_motion
from clearance.world.pairs import measured_pairs
from clearance.world.robot import Joint, JointKind, Robot
from clearance.world.trajectory import Trajectory

PUSHED = {
    "fetch": ("fetch_cage_planned", 0.03),
    "fetch_deep": ("fetch_cage_planned", 0.15),
    "kuka": ("kuka_iiwa_valve_wall", 0.03),
    "lbr": ("lbr_puzzle_grinder", 0.03),
    "lbr_deep": ("lbr_puzzle_grinder", 0.1),
    "panda": ("panda_bookshelf_thin_planned", 0.03),
    "panda_deep": ("panda_bookshelf_thin_planned", 0.1),
}
"""Of which shared case, and how far [m] the obstacle that is nearest goes into the link that it is nearest to."""


def pushed(name: str) -> Case:
    """A shared case whose nearest obstacle stands in the way of the link that comes nearest to it."""
    folder, depth = PUSHED[name]
    case = load_case(SHARED / folder / "case.yaml")
    motions = tuple(kinematic_motion(placed) for placed in case.robots)
    pairs, _ = measured_pairs(case)
    found = measure(PairsInMotion(case, motions, pairs), "minimum", Resources(jobs=1))
    worst = int(np.nanargmin(found.clearance))
    on_link, on_obstacle = found.points[worst]
    way = (on_link - on_obstacle) / np.linalg.norm(on_link - on_obstacle)
    return _moved(case, pairs[found.pair[worst]].b.i_body, on_link - on_obstacle + depth * way)


def _moved(case: Case, i_obstacle: int, shift: np.ndarray) -> Case:
    obstacle = case.obstacles[i_obstacle]
    pose = obstacle.world_from_body.copy()
    pose[:3, 3] += shift
    others = list(case.obstacles)
    others[i_obstacle] = replace(obstacle, world_from_body=pose)
    return replace(case, name=f"{case.name}_pushed", obstacles=tuple(others))


def through_torus(n_triangles: int, n_steps: int = 300) -> Case:
    """A block of 0.2 m that slides along x through the wall of a torus of radii 1 and 0.3 m."""
    joint = Joint("rail", JointKind.PRISMATIC, "ground", "block", np.eye(4))
    robot = Robot("cart", ("ground", "block"), (joint,), (Body("block", box((0.2, 0.2, 0.2))),))
    at = np.linspace(0.0, 2.0, n_steps)
    path = Trajectory(np.linspace(0.0, 3.0, n_steps), ("rail",), at[:, None])
    ring = Obstacle(Body("torus", torus(n_triangles)), np.eye(4))
    return Case(f"torus_{n_triangles}", (PlacedRobot(robot, path, np.eye(4)),), (ring,))


def torus(n_triangles: int, radius: float = 1.0, tube: float = 0.3) -> Polyhedron:
    """About as many triangles round the z axis."""
    n = round((n_triangles / 4.0) ** 0.5)
    i, j = np.meshgrid(np.arange(2 * n), np.arange(n), indexing="ij")
    u, v = np.pi * i / n, 2.0 * np.pi * j / n
    away = radius + tube * np.cos(v)
    points = np.stack([away * np.cos(u), away * np.sin(u), tube * np.sin(v)], axis=-1)
    a, b = i * n + j, (i + 1) % (2 * n) * n + j
    c, d = (i + 1) % (2 * n) * n + (j + 1) % n, i * n + (j + 1) % n
    faces = np.concatenate(
        [np.stack([a, b, c], -1).reshape(-1, 3), np.stack([a, c, d], -1).reshape(-1, 3)]
    )
    return Polyhedron(points.reshape(-1, 3), faces)
