"""Bodies and whole cases made to measure: one size for all, fixed seeds, hostile to search on purpose.

Where everything is equally near, or nothing is where it was a step ago, no bound cuts anything; `WORST` names
such cases, small enough for tests at their default size. Tests and benchmarks ask for the same ones.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from clearance.geometry.polyhedron import Polyhedron
from clearance.world.body import Body, Obstacle
from clearance.world.case import Case
from clearance.world.placed_robot import PlacedRobot
from clearance.world.robot import Joint, JointKind, Robot
from clearance.world.trajectory import Trajectory
from scripts.makers.polygon_pairs import rotations

AXES = np.eye(3)


def grid_surface(points: np.ndarray, closed_rows: bool) -> Polyhedron:
    """Triangles between the rows of a (rows, columns, 3) grid whose columns close on themselves.

    None are merged, coplanar or not: so many facets are wanted.
    """
    n_rows, n_columns = points.shape[:2]
    rows = np.arange(n_rows if closed_rows else n_rows - 1)[:, None]
    columns = np.arange(n_columns)[None]
    here, up = rows * n_columns, (rows + 1) % n_rows * n_columns
    right = (columns + 1) % n_columns
    quads = [here + columns, here + right, up + right, up + columns]
    a, b, c, d = (np.broadcast_to(q, (len(rows), n_columns)).ravel() for q in quads)
    triangles = np.concatenate([np.stack([a, b, c], 1), np.stack([a, c, d], 1)])
    return Polyhedron(points.reshape(-1, 3), triangles)


def torus(great: float, small: float, around: int, across: int) -> Polyhedron:
    """About z: 2 around across triangles."""
    turn = 2 * np.pi * np.arange(around)[:, None] / around
    tilt = 2 * np.pi * (np.arange(across)[None] + 0.5) / across
    reach = great + small * np.cos(tilt)
    ring = np.broadcast_arrays(reach * np.cos(turn), reach * np.sin(turn), small * np.sin(tilt))
    return grid_surface(np.stack(ring, -1), closed_rows=True)


def spindle(radius: float, half_length: float, n: int) -> Polyhedron:
    """An ellipsoid about x: 2 n^2 triangles in n + 1 bands, the last of them to the poles."""
    turn = 2 * np.pi * np.arange(n) / n
    height = np.pi * np.arange(1, n + 1) / (n + 1)
    rings = np.stack(
        np.broadcast_arrays(
            half_length * np.cos(height)[:, None],
            radius * np.sin(height)[:, None] * np.cos(turn),
            radius * np.sin(height)[:, None] * np.sin(turn),
        ),
        -1,
    )
    points = np.concatenate([rings.reshape(-1, 3), [[half_length, 0, 0], [-half_length, 0, 0]]])
    k, ahead = np.arange(n), (np.arange(n) + 1) % n
    rows = np.arange(n - 1)[:, None] * n
    between = np.concatenate(
        [
            np.stack(np.broadcast_arrays(rows + k, rows + n + k, rows + n + ahead), -1).reshape(
                -1, 3
            ),
            np.stack(np.broadcast_arrays(rows + k, rows + n + ahead, rows + ahead), -1).reshape(
                -1, 3
            ),
        ]
    )
    first = np.stack([np.full(n, n * n), k, ahead], 1)
    last = np.stack([np.full(n, n * n + 1), (n - 1) * n + ahead, (n - 1) * n + k], 1)
    return Polyhedron(points, np.concatenate([between, first, last]))


def ball(radius: float, n_halvings: int) -> Polyhedron:
    """A geodesic sphere of 20 * 4^n triangles."""
    import trimesh

    mesh = trimesh.creation.icosphere(subdivisions=n_halvings, radius=radius)
    return Polyhedron.from_triangles(mesh.vertices, mesh.faces)


def at(x: float = 0.0, y: float = 0.0, z: float = 0.0, turned: np.ndarray = AXES) -> np.ndarray:
    """(4, 4) a pose [m]."""
    pose = np.eye(4)
    pose[:3, :3], pose[:3, 3] = turned, (x, y, z)
    return pose


def flying(
    name: str,
    shape: Polyhedron,
    obstacles: list[tuple[Polyhedron, np.ndarray]],
    positions: np.ndarray,
) -> Case:
    """One body that goes anywhere: three slides [m], then turns about x, y and z [rad], columns of (n, 6)."""
    kinds = [JointKind.PRISMATIC] * 3 + [JointKind.CONTINUOUS] * 3
    joints = tuple(
        Joint(f"j{i}", kind, f"l{i}", f"l{i + 1}", np.eye(4), AXES[i % 3])
        for i, kind in enumerate(kinds)
    )
    links = tuple(f"l{i}" for i in range(7))
    return _case(name, Robot("flying", links, joints, (Body("l6", shape),)), obstacles, positions)


def arm(
    name: str,
    shapes: list[Polyhedron],
    obstacles: list[tuple[Polyhedron, np.ndarray]],
    positions: np.ndarray,
) -> Case:
    """Links of 0.25 m along x, one behind the other, their joints turning about z and y by turns."""
    n = len(shapes)
    joints = tuple(
        Joint(
            f"j{i}",
            JointKind.CONTINUOUS,
            f"l{i}",
            f"l{i + 1}",
            at(0.25 * (i > 0)),
            AXES[1 + (i + 1) % 2],
        )
        for i in range(n)
    )
    bodies = tuple(
        Body(f"l{i + 1}", shape.transformed(at(0.125))) for i, shape in enumerate(shapes)
    )
    return _case(
        name,
        Robot("arm", tuple(f"l{i}" for i in range(n + 1)), joints, bodies),
        obstacles,
        positions,
    )


def _case(
    name: str, robot: Robot, obstacles: list[tuple[Polyhedron, np.ndarray]], positions: np.ndarray
) -> Case:
    names = tuple(joint.name for joint in robot.moving_joints)
    placed = PlacedRobot(robot, Trajectory(0.01 * np.arange(len(positions)), names, positions))
    standing = tuple(
        Obstacle(Body(f"o{i}", shape), pose) for i, (shape, pose) in enumerate(obstacles)
    )
    return Case(name, (placed,), standing)


def arm_among_obstacles(n: int = 32, n_steps: int = 300, coherent: bool = True) -> Case:
    """Seven links among 20 obstacles, 2 n^2 triangles each; n = 32 is the scene of the comparisons.

    The joints swing; where not `coherent`, they are anywhere at every step.
    """
    random = np.random.default_rng(8)
    shapes = [
        spindle(0.06, 0.14, n) if i % 2 else torus(0.07, 0.03, 2 * n, n // 2) for i in range(7)
    ]
    obstacles = []
    for i in range(20):
        shape = torus(0.12, 0.05, 2 * n, n // 2) if i % 2 else spindle(0.1, 0.2, n)
        direction = random.normal(size=3)
        away = random.uniform(0.6, 1.8) * direction / np.linalg.norm(direction)
        obstacles.append((shape, at(*away, turned=rotations(random, 1)[0])))
    phase, speed = random.uniform(0, 2 * np.pi, 7), random.uniform(0.3, 1.2, 7)
    positions = 1.2 * np.sin(phase + speed * np.linspace(0.0, 2 * np.pi, n_steps)[:, None])
    if not coherent:
        positions = random.uniform(-np.pi, np.pi, positions.shape)
    return arm("arm_among_obstacles" if coherent else "teleporting", shapes, obstacles, positions)


def linked_tori(across: int = 12, n_steps: int = 24) -> Case:
    """Two rings of 4 across^2 triangles through each other, the one turning within the other's hole."""
    share = np.linspace(0.0, 1.0, n_steps)[:, None]
    ring = torus(1.0, 0.25, 2 * across, across)
    upright = at(x=1.0, turned=np.array([[1.0, 0, 0], [0, 0, -1], [0, 1, 0]]))
    return flying(
        "linked_tori", ring, [(ring, upright)], share * [0.02, 0.01, 0.02, 0.05, 0.04, 2.0]
    )


def nested_shells(n_halvings: int = 2, n_steps: int = 24) -> Case:
    """A ball turning in the hollow of a shell, some hundredths of the radius apart all round, and a second
    shell about the first."""
    hollow = [
        Polyhedron.merged([ball(radius + 0.05, n_halvings), ball(radius, n_halvings).flipped()])
        for radius in (1.05, 1.2)
    ]
    share = np.linspace(0.0, 1.0, n_steps)[:, None]
    positions = np.array([[0.004, -0.003, 0.005, 0.5, 0.3, 0.9]]) * share
    return flying(
        "nested_shells", ball(1.0, n_halvings), [(shape, np.eye(4)) for shape in hollow], positions
    )


def everything_equidistant(n: int = 12, n_steps: int = 24) -> Case:
    """A rod turning facet by facet in the middle of a tube of as many facets: every facet is as near as any."""

    def wall(radius: float) -> Polyhedron:
        turn = 2 * np.pi * np.arange(2 * n) / (2 * n)
        rows = np.linspace(-1.0, 1.0, n + 1)[:, None]
        ring = np.broadcast_arrays(radius * np.cos(turn), radius * np.sin(turn), rows)
        return grid_surface(np.stack(ring, -1), closed_rows=False)

    positions = np.zeros((n_steps, 6))
    positions[:, 5] = np.linspace(0.0, np.pi / 2, n_steps)
    return flying("everything_equidistant", wall(0.5), [(wall(0.6), np.eye(4))], positions)


def facing_plates(n: int = 12, n_steps: int = 24) -> Case:
    """Two bumpy plates over each other, all bumps of one height: n^2 tops of either as near as any other."""

    def bumps(up: float) -> Polyhedron:
        peak = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0.5, 0.5, up]]) / n
        sides = np.array([[0, 1, 4], [1, 2, 4], [2, 3, 4], [3, 0, 4]])
        places = (
            np.stack([*np.meshgrid(np.arange(n), np.arange(n)), np.zeros((n, n))], -1).reshape(
                -1, 1, 3
            )
            / n
        )
        points = (places + peak).reshape(-1, 3)
        return Polyhedron.from_triangles(
            points, (5 * np.arange(n * n)[:, None, None] + sides).reshape(-1, 3)
        )

    positions = np.zeros((n_steps, 6))
    positions[:, 0] = np.linspace(0.0, 3.0 / n, n_steps)
    return flying("facing_plates", bumps(0.5), [(bumps(-0.5), at(z=1.2 / n))], positions)


def teleporting(n: int = 8, n_steps: int = 24) -> Case:
    """The arm among obstacles with its joints anywhere at every step: nothing carried over holds."""
    return arm_among_obstacles(n, n_steps, coherent=False)


WORST: dict[str, Callable[..., Case]] = {
    "linked_tori": linked_tori,
    "nested_shells": nested_shells,
    "everything_equidistant": everything_equidistant,
    "facing_plates": facing_plates,
    "teleporting": teleporting,
}
